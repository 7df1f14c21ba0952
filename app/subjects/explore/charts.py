"""The charts of the Explore page: what a figure answers to, and a map of two inputs."""

from __future__ import annotations

import math

import numpy as np

from app.charts.kinds import LEVELS, Array, RankBar, RankChart, TradeMapChart
from app.charts.region import contour
from nav_model.budget.figures import figures, inputs_of
from nav_model.design import Design
from nav_model.explore.margins import label_of, quantity
from nav_model.explore.rank import Sensitivity, rank, sentence, silent
from nav_model.explore.trade_map import is_log, place, trade_map
from nav_model.units import DIMENSIONS

_SHOWN = 12  # bars of a ranking
_GIVEN = ("flight.gravity", "flight.latitude")  # nobody chooses these to improve a figure


def rank_chart(design: Design, figure: str) -> RankChart:
    """What halving (or doubling, where that helps) each input takes off a figure."""
    label = label_of(figure)
    bars = tuple(
        bar for item in rank(design, figure) if item.key not in _GIVEN and (bar := _bar(item, label)) is not None
    )
    zero = silent(design)
    left = (
        f" Not ranked (value is zero): {', '.join(str(quantity(key).label).lower() for key in zero)}." if zero else ""
    )
    return RankChart(
        key="ranking",
        title=f"What reduces {label[0].lower()}{label[1:]} most",
        x_label="reduction [%]",
        bars=tuple(sorted(bars, key=lambda bar: -bar.percent)[:_SHOWN]),
        knowledge=(
            "Each bar is the whole figure evaluated again with that input halved or doubled; the slopes in the CSV "
            f"are exact derivatives by complex step, which for noises are the shares of [T-18].{left}"
        ),
    )


def _bar(item: Sensitivity, figure_label: str) -> RankBar | None:
    doubled = item.slope < 0
    change = item.doubled if doubled else item.halved
    if math.isnan(change) or change > -5e-4:
        return None
    name = item.label[0].lower() + item.label[1:]
    return RankBar(
        f"{'2 ×' if doubled else '½ ×'} {name}", -100 * change, doubled, sentence(item, figure_label), item.slope
    )


def map_chart(design: Design, x_key: str, y_key: str, result: str) -> TradeMapChart:
    """The map of a result over two inputs, in the units the design is shown in."""
    trade = trade_map(design, x_key, y_key, result)
    limited = not math.isnan(trade.limit)
    reference = "the limit" if limited else "this design's value"
    level = trade.limit
    if not limited:
        level = float(design.requirements.confidence * figures(inputs_of(design), (result,))[result])
    ratio = trade.z / level
    (x_factor, x_label), (y_factor, y_label) = _scale(design, x_key), _scale(design, y_key)
    x, y = trade.x / x_factor, trade.y / y_factor
    x_log, y_log = is_log(x_key), is_log(y_key)
    here = place(design, trade)
    outside = " Blank: the aperture would be longer than an hour." if np.isnan(ratio).any() else ""
    return TradeMapChart(
        key="map",
        title=f"{label_of(result)} over {reference}",
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
        knowledge=(
            f"{len(x)} × {len(y)} designs through the same closed forms as the budget. A unit of the catalogue is "
            "judged with every figure of its own sheet (●  meets the limit, ✕ does not), not by the colour under "
            f"it.{outside}"
        ),
        trade=trade,
        scale=(x_factor, y_factor),
        level=level,
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
