"""The charts of a flight, as plain data. Each takes what was `Followed` and draws what is in it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from app.charts.kinds import CLOCK, Array, Band, Chart, LimitLine, Line, Points, Span, without_fixes
from app.document.display import AS_REQUIRED, ONE_SIGMA
from app.subjects.trajectory.figures import FIGURES, factor, limits_along
from app.work.flight import Followed
from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.units import clock, from_si
from nav_model.design.figures import figure_in_sentence

if TYPE_CHECKING:
    from nav_model.simulation.result import SimulationResult
    from nav_model.trajectory.result import LineResult, Processed

_DEG = 180 / math.pi
_MOST_SOURCES = 6
_TO_SCALE = 5.0  # longer and narrower flights would be one line on a map to scale
_ROOM_FOR_A_NAME = 0.012  # of the time axis, a letter
_SHARE_STYLES = ("horizontal", "vertical", "yaw", "tilt", "filter", "does not close", "reference")  # a colour each
_RUNS = {
    "horizontal_position": [0, 1], "vertical_position": [2], "horizontal_velocity": [3, 4],
    "vertical_velocity": [5], "tilt": [6, 7], "yaw": [8],
}  # fmt: skip
_ALIKE = (  # of two studies that fly the same
    "imu", "gnss", "aiding", "trajectory", "filter", "initial", "outages", "radar_time_offset",
)  # fmt: skip
_FORMULA = "Covariance analysis"
_HOW = f"{_FORMULA}, after each fix."
_USUAL = (("horizontal", "horizontal refined"), ("vertical", "vertical refined"))


def timelines(followed: Followed | None, name: str, flown: SimulationResult | None = None) -> tuple[Chart, ...]:
    """The figure `name`, position, velocity and attitude at the design's confidence; None: the frames alone. All on
    one time array.

    flown: simulated runs, laid over the curves where they are of the same flight.
    """
    figure, label = FIGURES[name], figure_in_sentence(name)
    unit = DIMENSIONS[figure.dimension].default_unit
    confidence = 1.0 if followed is None else factor(followed.design, name)
    display = ONE_SIGMA if followed is None else AS_REQUIRED.of(followed.design)
    scale, spread = confidence * from_si(1.0, unit, figure.dimension), f"{confidence:g}σ" if figure.scaled else "90 %"
    axis = f"{label.rpartition(' ')[2]}, {spread} [{unit}]"  # which has room for its last word
    time = np.array([0.0, 300.0]) if followed is None else followed.result.time_s
    nothing = np.full(len(time), np.nan)
    outages = () if followed is None else followed.result.spec.study.outages
    over = () if followed is None else tuple(_beyond(followed, name))
    spans = (
        without_fixes(outages)
        + _line_spans(followed)
        + tuple(Span(f"beyond {i}", "", *stretch, "limit") for i, stretch in enumerate(over))
    )

    runs = simulated(followed, flown)

    def pair(key: str, label: str, of: str, scale: float, styles: tuple[str, str]) -> list[Line]:
        """One figure in real time and post-processed, and of runs where they have it."""
        values = [nothing, nothing]
        if followed is not None:
            both = followed.result.real_time, followed.result.post_processed
            values = [scale * (part.figures[name] if of == "figure" else _after_fix(part)[of]) for part in both]
        ends = (label, "")
        processed = ("real time", "post-processed")
        lines = [
            Line(f"{key} {when}", f"{label}, {when}", time, y, style, "covariance", end)
            for when, y, style, end in zip(processed, values, styles, ends, strict=True)
        ]
        if of in _RUNS:
            y = scale * runs[of] if runs else nothing
            lines.append(Line(f"{key} runs", f"{label}, simulated", time, y, "reference", "runs, rms", ""))
        return lines

    def chart(
        key: str, title: str, y_label: str, lines: list[Line], limits: tuple[LimitLine, ...], how: str = _HOW
    ) -> Chart:
        return Chart(f"trajectory-{key}", title, CLOCK, y_label, tuple(lines), limits=limits, spans=spans,
                     y_log=True, knowledge=how)  # fmt: skip

    def limits(*names: str, scale: float = 1.0) -> tuple[LimitLine, ...]:
        return tuple(
            LimitLine(each, f"limit on {figure_in_sentence(each)}", start, stop, scale * level)
            for each in names
            for start, stop, level in (() if followed is None else limits_along(followed, each))
        )

    def level_and_up(kind: str) -> list[Line]:
        names = zip(("horizontal", "vertical"), _USUAL, strict=True)
        return [line for which, styles in names for line in pair(which, which, f"{which}_{kind}", 1.0, styles)]

    attitude = pair("tilt", "tilt", "tilt", _DEG, ("tilt", "tilt refined"))
    chosen = pair("figure", label, "figure", scale, ("exact", "horizontal refined"))
    attitude += pair("yaw", "heading", "yaw", _DEG, ("simulated, yaw", "yaw"))
    first = chart("figure", figure.label, axis, chosen, limits(name, scale=scale), judged_how(followed, name))
    places, speeds = (
        limits(*(f"{axis}_{kind}" for axis in ("horizontal", "vertical"))) for kind in ("position", "velocity")
    )
    return (
        replace(first, points=_passed(followed, name, over, scale)),
        display.timeline(chart("position", "Position", "position, 1σ [m]", level_and_up("position"), places)),
        display.timeline(chart("velocity", "Velocity", "velocity, 1σ [m/s]", level_and_up("velocity"), speeds)),
        display.timeline(
            chart("attitude", "Attitude", "attitude, 1σ [°]", attitude, limits("tilt", "heading", scale=_DEG))
        ),
    )


def _beyond(followed: Followed, name: str) -> Iterator[tuple[float, float]]:
    """Start and stop [s] of each stretch over which a figure is beyond a limit."""
    time = followed.result.time_s
    for start, stop, level in limits_along(followed, name):
        value = np.where((time >= start - 1e-9) & (time <= stop + 1e-9), followed.result.chosen.figures[name], 0.0)
        edges = np.flatnonzero(np.diff(np.concatenate(([False], value > level, [False])).astype(int)))
        for first, after in edges.reshape(-1, 2):
            yield float(time[first]), float(time[min(after, len(time) - 1)])


def _passed(
    followed: Followed | None, name: str, over: tuple[tuple[float, float], ...], scale: float
) -> tuple[Points, ...]:
    """When the figure is first beyond its limit, where it was within it before."""
    if followed is None:
        return ()
    time, value = followed.result.time_s, followed.result.chosen.figures[name]
    crossings = []
    for at, _ in over:
        before = int(np.searchsorted(time, at)) - 1
        for start, stop, level in limits_along(followed, name):
            if before >= 0 and start <= time[before] and at <= stop and value[before] <= level:
                crossings.append((at, level))
    moments, levels = np.array(crossings[:1]).reshape(-1, 2).T
    names = tuple(map(clock, moments))
    return (Points("passed", "first beyond the limit", moments, scale * levels, names, "limit", "name"),)


def judged_how(followed: Followed | None, name: str) -> str:
    """Source of the figure `name`, and for states the moment at which they are judged."""
    states = "horizontal", "vertical", "tilt", "heading"
    at = f"; {followed.result.moment}" if followed and name.startswith(states) else ""
    return f"{_FORMULA}{at}."


def _after_fix(part: Processed) -> dict[str, Array]:
    """States just after a fix, of the axis that is worse, by the names of `_RUNS`."""
    sigma = np.hstack([part.position, part.velocity, part.attitude])
    return {name: sigma[:, axes].max(axis=1) for name, axes in _RUNS.items()}


def _line_spans(followed: Followed | None) -> tuple[Span, ...]:
    """The lines of the flight, named as there is room on the time axis: by name, by number, or not at all."""
    if followed is None or not followed.result.spec.lines:
        return ()
    whole = followed.result.spec.study.duration
    spans = []
    for number, line in enumerate(followed.result.lines, 1):
        share = (line.stop_s - line.start_s) / whole
        label = line.name if share > _ROOM_FOR_A_NAME * len(line.name) else str(number) if share > 0.015 else ""
        spans.append(Span(f"line {number}", label, line.start_s, line.stop_s, _verdict_style(followed, line), True))
    return tuple(spans)


def _verdict_style(followed: Followed, line: LineResult) -> str:
    """Green or red by the line's verdict; neither without a limit, or on a flight that is not the design's."""
    if followed.study or (line.closes and not line.limits):
        return "path"
    return "closes" if line.closes else "does not close"


def map_chart(followed: Followed) -> Chart:
    """The flight seen from above: its lines numbered, green or red by their verdict, its turns thin and grey."""
    result = followed.result
    east, north = followed.east / 1000, followed.north / 1000
    off = np.full(len(north), np.nan)
    drawn = {style: off.copy() for style in ("closes", "does not close", "path")}
    for line in result.lines:
        on = (result.time_s >= line.start_s - 1e-9) & (result.time_s <= line.stop_s + 1e-9)
        drawn[_verdict_style(followed, line)][on] = north[on]
    places = _places(followed)
    labels = {"closes": "within the limits", "does not close": "beyond a limit", "path": "not judged"}
    wide, high = np.ptp(east), np.ptp(north)
    to_scale = bool(max(wide, high) < _TO_SCALE * min(wide, high) or not min(wide, high))
    on_lines = np.where(np.isnan([*drawn.values()]).all(axis=0), np.nan, 0.0)
    return Chart(
        key="trajectory-map",
        title="Map",
        x_label="east of the start [km]",
        y_label="north of the start [km]",
        lines=(
            Line("flight", "turns", east, north if result.spec.lines else off, "turn", "the flight"),
            *(Line(style, labels[style], east, y, style, result.spec.processing) for style, y in drawn.items()),
            *(
                Line(f"{end} range", "near and far range", x, y + on_lines, "reference", "limits kept")
                for end, x, y in _swath(followed)
            ),
        ),
        points=(
            Points("lines", "line", np.interp(places, result.time_s, east), np.interp(places, result.time_s, north),
                   tuple(str(number + 1) for number in range(len(places))), "everything", "name"),
        ),
        square=to_scale,
        aside="" if to_scale else "not to scale",
        knowledge=f"A line is green if it meets every limit, {result.spec.processing}. The radar looks "
        "to the right of the flight.",
    )  # fmt: skip


def _places(followed: Followed) -> Array:
    """Times [s] at which each line is numbered, so that the numbers of parallel lines are beside each other."""
    result = followed.result
    if not result.spec.lines:
        return np.array([])
    ends = np.array([(line.start_s, line.stop_s) for line in result.lines])
    along = np.column_stack(
        [np.diff(np.interp(ends, result.time_s, way))[:, 0] for way in (followed.east, followed.north)]
    )
    shares = (np.arange(len(ends)) + 0.5) / len(ends)
    shares = np.where(along @ along[0] < 0, 1 - shares, shares)
    return ends[:, 0] + shares * (ends[:, 1] - ends[:, 0])


def _swath(followed: Followed) -> Iterator[tuple[str, Array, Array]]:
    """Where near and far range are on the ground, right of the flight: east and north [km], NaN before they are
    solved."""
    swath, velocity = followed.result.swath, followed.result.truth.velocity
    ahead = velocity[:, :2].T / np.maximum(np.hypot(velocity[:, 0], velocity[:, 1]), 1e-9)
    for end in ("near", "far"):
        slant = getattr(swath, f"{end}_m", None)
        away = math.sqrt(max(slant**2 - swath.height_m**2, 0.0)) if swath and slant else math.nan
        yield end, (followed.east + away * ahead[0]) / 1000, (followed.north - away * ahead[1]) / 1000


def shares_chart(followed: Followed, name: str) -> Chart:
    """Shares of the figure's variance by source, stacked; the smaller sources together."""
    result = followed.result
    rows = result.chosen.shares[name]
    known = rows[:, np.isfinite(rows).all(axis=0)]
    order = np.argsort(-known.mean(axis=1)) if known.size else np.arange(len(rows))
    parts = [(result.sources[i], rows[i]) for i in order[:_MOST_SOURCES]]
    if len(order) > _MOST_SOURCES:
        parts.append(("all others", rows[order[_MOST_SOURCES:]].sum(axis=0)))
    tops = np.cumsum([100 * row for _, row in parts], axis=0)
    lows = np.vstack([np.zeros(len(result.time_s)), tops[:-1]])
    return Chart(
        key="trajectory-shares",
        title=f"Shares of {figure_in_sentence(name)}",
        x_label=CLOCK,
        y_label="share [%]",
        lines=(),
        bands=tuple(
            Band(label, label, result.time_s, low, top, style, result.spec.processing)
            for (label, _), low, top, style in zip(parts, lows, tops, _SHARE_STYLES, strict=False)
        ),
        y_range=(0.0, 100.0),
        knowledge=f"{judged_how(followed, name)} {result.spec.processing.capitalize()}; the shares add up to one at "
        "every time.",
    )


def simulated(followed: Followed | None, flown: SimulationResult | None) -> dict[str, Array]:
    """Rms of runs just after a fix, of the axis that is worse along the flight, by figure; none of another flight."""
    if followed is None or flown is None:
        return {}
    result = followed.result
    study = result.spec.study
    if any(getattr(study, part) != getattr(flown.spec, part) for part in _ALIKE):
        return {}
    sigma = np.hstack([result.real_time.position, result.real_time.velocity, result.real_time.attitude])
    rms = np.column_stack([np.interp(result.time_s, flown.time_s, flown.rms[1][:, axis]) for axis in range(9)])
    rms[result.time_s > flown.spec.duration] = np.nan  # runs of a shorter flight end where they end
    return {
        name: np.take_along_axis(rms, np.argmax(sigma[:, axes], axis=1)[:, None] + axes[0], axis=1)[:, 0]
        for name, axes in _RUNS.items()
    }
