"""The charts of the page Close it: ranking of inputs, and a map of two inputs."""

import math

import numpy as np

from app.charts.kinds import LEVELS, Array, Band, Chart, Line, RankBar, RankChart, TradeMapChart
from app.charts.region import contour
from app.document.verdict import before_flight
from nav_model.base.dimensions import DIMENSIONS
from nav_model.budget.figures import figures
from nav_model.budget.inputs import inputs_of
from nav_model.budget.verdict import decisive, flown_names
from nav_model.design import Design
from nav_model.design.declaration import in_sentence
from nav_model.design.figures import figure_in_sentence
from nav_model.design.parts import quantity
from nav_model.explore.margins import ALL, label_of
from nav_model.explore.rank import InputSensitivity, rank, sentence, silent
from nav_model.explore.trade_map import is_log, place, trade_map
from nav_model.explore.uncertainty import UncertainVerdict

_SHOWN = 12  # bars of a ranking
_WORST = "Worst requirement"
_GIVEN = ("flight.gravity", "flight.latitude")  # inputs that are not chosen to improve a figure


def rank_chart(design: Design, figure: str) -> RankChart:
    """Chart of what halving (or doubling, where that helps) each input takes off a figure."""
    label = label_of(figure)
    bars = tuple(
        bar for item in rank(design, figure) if item.key not in _GIVEN and (bar := _bar(item, label)) is not None
    )
    zero = silent(design)
    missing = (
        f" Not ranked (value is zero): {', '.join(in_sentence(quantity(key).label) for key in zero)}." if zero else ""
    )
    return RankChart(
        key="ranking",
        title=f"What reduces {figure_in_sentence(figure)} most{before_flight(design)}",
        x_label="reduction [%]",
        bars=tuple(sorted(bars, key=lambda bar: -bar.percent)[:_SHOWN]),
        knowledge=(
            "Each bar: the value computed again with that input halved (plain) or doubled (hatched). The slopes in "
            f"the CSV are exact derivatives by complex step; for noises they are the shares of [T-18].{missing}"
        ),
    )


def _bar(item: InputSensitivity, figure_label: str) -> RankBar | None:
    doubled = item.slope < 0
    change = item.doubled if doubled else item.halved
    if math.isnan(change) or change > -5e-4:
        return None
    name = f"{'2 ×' if doubled else '½ ×'} {in_sentence(item.label)}{' (coarser image)' if item.coarser else ''}"
    return RankBar(name, -100 * change, doubled, sentence(item, figure_label), item.slope, item.bought)


def map_chart(design: Design, x_key: str, y_key: str, result: str) -> TradeMapChart:
    """The map of a result over two inputs, in the units the design is shown in."""
    trade = trade_map(design, x_key, y_key, result)
    outside = " Blank: the aperture would be longer than an hour." if np.isnan(trade.z).any() else ""
    knowledge = (
        f"{len(trade.x)} × {len(trade.y)} designs through the formulas of the budget. An IMU of the catalogue is "
        f"judged with all values of its data sheet (○ passes, ✕ fails), not by the colour under it.{outside}"
    )
    x_log, y_log = is_log(x_key), is_log(y_key)
    limited = not math.isnan(trade.limit)
    reference = "the limit" if limited else "this design's value"
    level = trade.limit
    if not limited:
        level = float(decisive(design, result)[0] * figures(inputs_of(design), (result,))[result])
    ratio = trade.z / level
    (x_factor, x_label), (y_factor, y_label) = _scale(design, trade.x_key), _scale(design, trade.y_key)
    x, y = trade.x / x_factor, trade.y / y_factor
    here = place(design, trade)
    return TradeMapChart(
        key="map",
        title=f"{_WORST if result == ALL else label_of(result)}: multiple of {reference}{before_flight(design)}",
        x_label=x_label,
        y_label=y_label,
        x=x,
        y=y,
        x_log=x_log,
        y_log=y_log,
        ratio=ratio.astype(np.float32),
        contours=_contours(x, y, ratio, x_log, y_log),
        reference=reference,
        points=trade.points,
        points_x=np.array([point.x for point in trade.points]) / x_factor,
        points_y=np.array([point.y for point in trade.points]) / y_factor,
        here=(here[0] / x_factor, here[1] / y_factor),
        knowledge=knowledge,
        trade=trade,
        level=level,
        decides=not flown_names(design),
    )


def margin_chart(design: Design, verdict: UncertainVerdict) -> Chart:
    """Histogram of the tightest margin over uncertain designs around this one."""
    edges, shares = verdict.histogram
    x, y = 1 - np.repeat(edges, 2)[1:-1], 100 * np.repeat(shares, 2)
    kinds = (("does not close", x >= 1, "reference"), ("closes", x <= 1, "exact"))
    return Chart(
        key="margins",
        title=f"{_WORST} over the designs{before_flight(design)}",
        x_label="worst requirement [× its limit]",
        y_label="designs in a bin [%]",
        lines=(Line("limit", "limit", np.ones(2), np.array([0.0, np.max(y)]), "limit"),),
        bands=tuple(Band(name, name, x[part], 0 * x[part], y[part], style) for name, part, style in kinds),
        knowledge="Half a per cent of the designs at either end is left out.",
    )


def _scale(design: Design, key: str) -> tuple[float, str]:
    """SI of one unit shown, and the axis label."""
    declaration = quantity(key)
    label = str(declaration.label)
    if not declaration.dimension:
        return 1.0, f"{label} [1]"
    unit = design.unit(key)
    return float(DIMENSIONS[declaration.dimension].units[unit]), f"{label} [{unit}]"


def _contours(x: Array, y: Array, ratio: Array, x_log: bool, y_log: bool) -> tuple[tuple[Array, Array], ...]:
    """Curves of the levels, found where the axes are straight."""
    across, up, z = np.log(x) if x_log else x, np.log(y) if y_log else y, np.log(ratio)
    curves = (contour(across, up, z, math.log(level)).T for level in LEVELS)
    return tuple((np.exp(cx) if x_log else cx, np.exp(cy) if y_log else cy) for cx, cy in curves)
