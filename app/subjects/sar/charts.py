"""The charts of the Image page, as plain data, from a study of the strategies or a map."""

import io
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from app.charts.kinds import Array, Chart, Dot, DotChart, Line, MapChart, PictureChart, Points
from app.charts.region import contour
from app.document.numbers import degrees, number, percent, signed_decibels
from app.subjects.sar.tables import FORMULAS, judged_along, kind_of, strategies_of
from nav_model.aperture.geometry import metres_to_phase, phase_to_metres
from nav_model.aperture.impulse_response import aperture_of_phase, response_curve
from nav_model.budget import Budget
from nav_model.budget.verdict import decisive
from nav_model.design.figures import DETRENDED, QUADRATIC
from nav_model.design.processing import POST_PROCESSED
from nav_model.sar.advice import left_by
from nav_model.sar.design_map import gnss_map
from nav_model.sar.design_study import ClosedForms, SarStudy
from nav_model.sar.pictures import Pictures
from nav_model.sar.strategies import NAMES, STRATEGIES, STRATEGY_KEYS

_INERTIAL = ("2", "3", "5", "5w")
_FILTERED = ("4", "6", "7", "8", "9")
_DEG = 180 / math.pi
_COUNT = {4: "four", 5: "five"}
_ARROW = "An arrow: beyond the axis, which ends at some 30 times the limit or the least value."


def navigation_chart(study: SarStudy, keys: tuple[str, ...], title: str, name: str) -> Chart:
    """Line-of-sight error over the aperture of the typical run, what the autofocus removes removed."""
    rows = [STRATEGY_KEYS.index(key) for key in keys]
    curves = _candidate_curves(study, study.typical.residual[rows], rows)
    return Chart(
        key=name,
        title=f"Error history, {title}",
        x_label="time in the aperture [s]",
        y_label="line-of-sight error [mm]",
        lines=tuple(
            Line(key, NAMES[key], study.time, 1000 * curve, f"strategy {key}", STRATEGIES[row].source)
            for key, row, curve in zip(keys, rows, curves, strict=True)
        ),
        knowledge=f"{_typical(study)} Errors are along the line of sight as it turns. Rms over the runs: "
        + "; ".join(
            f"{NAMES[key]} {number(1000 * float(study.rms[row]))} mm"
            for key, row, curve in zip(keys, rows, curves, strict=True)
            if not np.isnan(curve).all()
        )
        + ".",
    )


def responses_chart(study: SarStudy, keys: tuple[str, ...], title: str, name: str) -> Chart:
    """Azimuth impulse responses of the typical run, overlaid."""
    keys_shown, sar = ("1", *keys), study.budget.sar
    rows = [STRATEGY_KEYS.index(key) for key in keys_shown]
    apertures = aperture_of_phase(metres_to_phase(study.typical.residual[rows], sar.wavelength))
    cells, power = response_curve(apertures, sar.window, extent_cells=8.0)  # type: ignore[arg-type]
    metres = cells * sar.cell_length
    return Chart(
        key=name,
        title=f"Impulse response, {title}",
        x_label="azimuth [m]",
        y_label="power over the error-free peak [dB]",
        lines=tuple(
            Line(key, NAMES[key], metres, np.maximum(values, -60.0), f"strategy {key}", "aperture integral")
            for key, values in zip(keys_shown, _candidate_curves(study, power, rows), strict=True)
        ),
        y_range=(-45.0, 2.0),
        knowledge=f"{_typical(study)} Azimuth, {sar.window} window; the table has medians and bands of all runs.",
    )


def _candidate_curves(study: SarStudy, curves: Array, rows: Sequence[int]) -> Array:
    """Curves of the strategies in some rows, NaN where one is not shown: a figure's lines stay the same."""
    candidates = np.array([row in dict(strategies_of(study.budget)) for row in rows])
    return np.where(candidates[:, None], curves, np.nan)


def _typical(study: SarStudy) -> str:
    return f"One of {study.runs} runs, in which {NAMES['2']} has the median rms, {left_by(study.budget)}."


def residual_chart(budget: Budget, closed: ClosedForms, study: SarStudy | None) -> DotChart:
    """Detrended phase of each strategy, the least first: formula beside the runs."""
    return _dot_chart(
        "sar-residual", "Strategies ranked by detrended phase", "detrended phase, rms", budget,
        closed.detrended, study, "rms", "residual_rms", DETRENDED,
        f"The rms {left_by(budget)}. {judged_along(budget)} {FORMULAS}. {_chosen(budget)}",
    )  # fmt: skip


def quadratic_chart(budget: Budget, closed: ClosedForms, study: SarStudy | None) -> DotChart:
    """Quadratic phase of each strategy before autofocus, the least first: formula beside the runs."""
    figure = "phase_before_autofocus" if budget.design.autofocus.works else QUADRATIC
    return _dot_chart(
        "sar-quadratic", "Strategies ranked by quadratic phase", "quadratic phase at the aperture's ends", budget,
        closed.quadratic, study, "quadratic_rms", "quadratic", figure,
        f"Before autofocus. Formulas [S-8], [S-7], {NAMES['9']} [P-5]. {_chosen(budget)}",
    )  # fmt: skip


def _chosen(budget: Budget) -> str:
    """Sentence on whether the whole-leg smoother is a candidate."""
    if budget.design.processing.mode == POST_PROCESSED:
        return f"The design is post-processed, so {NAMES['9']} can be the best."
    return (
        f"{NAMES['9']} needs post-processing. The design is processed in real time, so it is shown but cannot be the "
        "best."
    )


def _dot_chart(
    key: str, title: str, x_label: str, budget: Budget, closed: Mapping[str, float | None],
    study: SarStudy | None, over_runs: str, part: str, figure: str, knowledge: str,
) -> DotChart:  # fmt: skip
    """Everything is at the confidence of the lowest limit on the figure."""
    confidence, required = decisive(budget.design, figure)
    limit = math.nan if required is None else _DEG * required
    label = f"{x_label} [°]" if confidence == 1 else f"{x_label} at {confidence:g}σ [°]"
    to_degrees = confidence * _DEG * float(metres_to_phase(1.0, budget.sar.wavelength))
    dots = []
    for row, strategy in strategies_of(budget)[1:]:
        form = closed.get(strategy.key)
        ensemble = low = high = math.nan
        if study is not None:  # in the study's own wavelength, until it is run again
            scale = confidence * _DEG * float(metres_to_phase(1.0, study.budget.sar.wavelength))
            errors = getattr(study, over_runs), study.parts[part].low, study.parts[part].high
            ensemble, low, high = (scale * float(study.composed(figure, x)[row]) for x in errors)
        closed_phase = math.nan if form is None else to_degrees * form
        dots.append(Dot(strategy.name, closed_phase, ensemble, low, high, strategy.source, kind_of(strategy)))
    dots.sort(key=_rank)
    runs = ""
    if study is not None:
        worst = percent(float(np.max(study.rms_error[1:] / study.rms[1:])))
        runs = f" Runs: {study.runs}, seed {study.seed}; standard error of the rms at most {worst}."
    millimetres = 1000 * float(phase_to_metres(1 / _DEG, budget.sar.wavelength))
    return DotChart(key, title, label, tuple(dots), limit, millimetres, f"{knowledge}{runs} {_ARROW}")


def _rank(dot: Dot) -> float:
    """Value that ranks a row: of the runs, else the formula; rows without either last. Of equals, to the digits that
    are shown, the simplest stays first."""
    value = dot.closed if math.isnan(dot.ensemble) else dot.ensemble
    return math.inf if math.isnan(value) else float(f"{value:.3g}")


POINT_TITLE = "Point target under each strategy"


def point_pictures_of(study: SarStudy, points: Pictures, unfocused: Pictures | None) -> tuple[PictureChart, ...]:
    """The point under each strategy; before it, where the design's autofocus is at work, the point without it."""
    focused = point_picture(study.budget, points)
    if unfocused is None:
        return (focused,)
    before = point_picture(study.budget, unfocused)
    method = study.budget.design.autofocus.method
    to_degrees = _DEG * float(metres_to_phase(1.0, study.budget.sar.wavelength))
    captions = []
    for row, _ in strategies_of(study.budget):
        result = to_degrees * float(np.sqrt(np.mean(study.typical.residual[row] ** 2)))
        predicted = (
            "not predicted" if study.beyond[row] else f"predicted {number(to_degrees * float(study.rms[row]))}°"
        )
        captions.append(f"{number(result)}°, {predicted}")
    return (
        replace(before, key="sar-point-unfocused", title=f"{POINT_TITLE}, before autofocus"),
        replace(
            focused,
            title=f"{POINT_TITLE}, after {method}",
            captions=tuple(captions),
            knowledge=f"{focused.knowledge} Focused by a {method} at work on points in clutter. Degrees: the phase "
            "that is left, rms over the aperture, and its prediction, rms over the runs [S-9], [S-10].",
        ),
    )


def point_picture(budget: Budget, pictures: Pictures) -> PictureChart:
    """The focused point under each strategy."""
    cell = f"range cell {number(pictures.range_cell)} m" + (
        ", coarser than the azimuth resolution because the bandwidth is limited to 0.3 of the carrier"
        if pictures.bandwidth_cut
        else ", set equal to the azimuth resolution"
    )
    rows = [row for row, _ in strategies_of(budget)]
    power_db = pictures.power_db[rows]
    return PictureChart(
        key="sar-point",
        title=POINT_TITLE,
        x_label="azimuth [m]",
        y_label="range [m]",
        x=pictures.x,
        y=pictures.y,
        power_db=power_db,
        names=tuple(STRATEGIES[row].name for row in rows),
        captions=tuple(f"peak {signed_decibels(float(power.max()))}" for power in power_db),
        reference=f"relative to the error-free peak; typical run; {cell}",
        knowledge="All images share one scale, relative to the error-free peak. "
        f"Typical run of the ensemble; {cell}.",
    )


def uploaded_picture(pictures: Pictures, name: str, key: str) -> PictureChart:
    """A phase history of the user's as it is and with the error of a strategy, side by side."""
    (x, y), (moved_x, moved_y) = (_brightest(pictures, index) for index in (0, 1))
    loss = float(pictures.power_db[1].max() - pictures.power_db[0].max())
    return PictureChart(
        key="sar-phase-history",
        title=f"{name}, formed with and without the design's navigation error",
        x_label="x [m]",
        y_label="y [m]",
        x=pictures.x,
        y=pictures.y,
        power_db=pictures.power_db,
        names=("without navigation error", f"with the error of {NAMES[key]}"),
        captions=("brightest 0 dB", f"brightest {signed_decibels(loss)}"),
        reference=f"relative to the brightest pixel of {name}; Taylor window; the brightest pixel moves by "
        f"{number(math.hypot(moved_x - x, moved_y - y))} m",
    )


def to_npz(chart: PictureChart) -> bytes:
    """Pictures as numbers."""
    packed = io.BytesIO()
    np.savez_compressed(packed, names=np.array(chart.names), x_m=chart.x, y_m=chart.y, power_db=chart.power_db)
    return packed.getvalue()


def _brightest(pictures: Pictures, index: int) -> tuple[float, float]:
    row, column = np.unravel_index(int(pictures.power_db[index].argmax()), pictures.power_db[index].shape)
    return float(pictures.x[column]), float(pictures.y[row])


def winner_chart(budget: Budget) -> MapChart:
    """The best strategy by aperture time and position noise."""
    drawn = gnss_map(budget)
    confidence, limit = decisive(budget.design, DETRENDED)
    x, y, phase = drawn.aperture_time, drawn.other, confidence * drawn.phase
    at = "" if confidence == 1 else f" at {confidence:g}σ"
    line = np.full((1, 2), np.nan)
    if limit is not None:
        line = np.exp(contour(np.log(x), np.log(y), np.log(phase), math.log(limit)))
    here = Points(
        "design", "this design", np.array([drawn.here[0]]), np.array([drawn.here[1]]), ("this design",),
        "this design", "cross", "aperture and noise of the design",
    )  # fmt: skip
    return MapChart(
        key="sar-map-gnss",
        title="Best strategy by aperture and position noise",
        x_label="aperture time [s]",
        y_label="position noise, 1σ [m]",
        value_label=f"detrended phase of the best strategy{at} [°]",
        x=x,
        y=y,
        winner=drawn.winner,
        values=phase * _DEG,
        names=tuple(NAMES[k] for k in drawn.strategies),
        styles=tuple(f"strategy {k}" for k in drawn.strategies),
        points=(
            Points("catalogue", "catalogue radars", drawn.x, drawn.y, drawn.names, "reference", "circle",
                   "its aperture [S-3] with this design's GNSS"),
            here,
        ),
        contour=Line("limit", "phase limit", line[:, 0], line[:, 1], "limit", "requirement"),
        knowledge=(
            "Formulas at every point [T-15], [T-16], [S-7], [S-1], for the settled filter of each point, this "
            "design's squint and slow GNSS error. The map names the simplest strategy within 5 % of the least "
            f"detrended phase, of the {_COUNT[len(drawn.strategies)]} that have a formula and that the processing "
            f"allows. {_chosen(budget)} "
            + ("Set a limit on the detrended phase to see where it is met." if limit is None else
               f"The limit of {degrees(limit)}° at {confidence:g}σ is met towards shorter apertures.")
        ),
    )  # fmt: skip


_GROUPS = ((_INERTIAL, "INS and corrected INS", "ins"), (_FILTERED, "filters and smoothers", "filter"))

STRATEGY_CHARTS: tuple[Callable[[Budget, ClosedForms, SarStudy | None], DotChart], ...] = (
    residual_chart,
    quadratic_chart,
)
"""The strategies ranked: of the current budget, its formulas, and the runs."""

RUN_CHARTS: tuple[Callable[[SarStudy], Chart], ...] = (
    *(partial(navigation_chart, keys=keys, title=title, name=f"sar-error-{name}") for keys, title, name in _GROUPS),
    *(partial(responses_chart, keys=keys, title=title, name=f"sar-response-{name}") for keys, title, name in _GROUPS),
)
"""The typical run."""
