"""The charts of a flown flight, as plain data."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from app.charts.kinds import CLOCK, Array, Chart, LimitLine, Line, Points, Span
from app.document.numbers import number
from app.subjects.flown.run import FlownFlight
from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.units import from_si
from nav_model.budget.verdict import confidence_of
from nav_model.design.figures import FIGURES, figure_in_sentence

if TYPE_CHECKING:
    from nav_model.flown.result import FlownLine

_AXES = ("north", "east", "down")
_TO_SCALE = 5.0  # longer and narrower flights would be one line on a map to scale
_MOST_JUMPS, _APART = 6, 0.08  # named on a chart, and how far apart on its time axis
_ROOM_FOR_A_NAME = 0.012  # of the time axis, a letter
IN_APERTURES = (
    "detrended_phase", "quadratic_phase", "cubic_phase", "phase_before_autofocus", "path_before_autofocus",
)  # fmt: skip
"""Figures that a flight shows aperture by aperture."""
_STYLES = {"met": "closes", "not met": "does not close"}
_OF_BAND = {
    "smoothed": "The band is the budget's spread of the difference.",
    "reverse": "The band is the budget of one pass; the difference has the errors of both.",
    "independent": "The band is the budget of the solution's own error; the reference adds its own.",
    "claims": "There is no second solution: only what the file claims.",
}


def timelines(flight: FlownFlight | None, name: str) -> tuple[Chart, ...]:
    """The figure `name` of each aperture, and the difference north, east and down with the budget's band. All on one
    time array; before there is a flight, their axes."""
    factor = 1.0 if flight is None else flight.design.requirements.confidence
    time, how = _times(flight), "" if flight is None else _OF_BAND[flight.result.relation]
    spans = () if flight is None else _line_spans(flight, time)
    charts = []
    for number_, axis in enumerate(_AXES):
        difference, sigma, claimed = _difference(flight, number_)
        band, claim = factor * sigma, factor * claimed
        lines = (
            Line("difference", "difference", time, difference, "exact", "solution less reference", ""),
            Line("above", f"budget, {factor:g}σ", time, band, "reference", "covariance", ""),
            Line("below", f"budget, −{factor:g}σ", time, -band, "reference", "covariance", ""),
            Line("claim", f"claimed, {factor:g}σ", time, claim, "filter", "the file", ""),
            Line("claim below", f"claimed, −{factor:g}σ", time, -claim, "filter", "the file", ""),
        )
        points = _jumps(flight) if flight is not None and axis == "down" else ()
        charts.append(
            Chart(f"flown-{axis}", f"Difference {axis}", CLOCK, f"{axis} [m]", lines, points=points, spans=spans,
                  y_range=_around(lines), knowledge=f"Solution less reference; every sample, or evenly some. {how}")
        )  # fmt: skip
    return (_figure_chart(flight, name, time, spans), *charts)


def _times(flight: FlownFlight | None) -> Array:
    """Seconds since the flight's start, at which its difference is known, or else its places."""
    if flight is None:
        return np.array([0.0, 300.0])
    compared = flight.result.compared
    clock = flight.result.solution.time_s if compared is None else compared.time_s
    return np.asarray(clock - flight.start_s)


def _difference(flight: FlownFlight | None, axis: int) -> tuple[Array, Array, Array]:
    """Difference, its spread by the budget and the claim of the solution along an axis [m], 1σ."""
    time = _times(flight)
    nothing = np.full(len(time), np.nan)
    if flight is None:
        return nothing, nothing, nothing
    result, at = flight.result, time + flight.start_s
    claims = result.solution.claims
    claimed = nothing
    if claims is not None and claims.position is not None:
        claimed = np.interp(at, result.solution.time_s, claims.position[:, axis])
    if result.compared is None or result.series is None:
        return nothing, nothing, claimed
    spread = np.interp(at, result.series.budget_s, result.series.budget[:, axis], np.nan, np.nan)
    return np.asarray(result.compared.position[:, axis]), spread, claimed


def _figure_chart(flight: FlownFlight | None, name: str, time: Array, spans: tuple[Span, ...]) -> Chart:
    """A figure of each aperture at the confidence of its limit, the budget's beside it."""
    figure, label = FIGURES[name], figure_in_sentence(name)
    unit = DIMENSIONS[figure.dimension].default_unit
    factor = 1.0 if flight is None else confidence_of(flight.design, name)
    scale = from_si(1.0, unit, figure.dimension)
    flown, budget = np.full(len(time), np.nan), np.full(len(time), np.nan)
    limits: list[LimitLine] = []
    if flight is not None:
        for line in lines_of(flight):
            start, stop = line.start_s - flight.start_s, line.stop_s - flight.start_s
            on = (time >= start) & (time <= stop)
            if (one := line.figures.get(name)) is not None:
                budget[on] = scale * one.budget
                if one.limit is not None:
                    limits.append(
                        LimitLine(f"limit {line.name}", f"limit on {label}", start, stop, scale * one.limit)
                    )
            series = flight.result.series
            if series is not None and name in series.apertures:
                inside = (series.aperture_s >= line.start_s) & (series.aperture_s <= line.stop_s)
                middles = series.aperture_s[inside] - flight.start_s
                if len(middles):
                    values = np.interp(time, middles, series.apertures[name][inside], np.nan, np.nan)
                    flown[on] = scale * factor * values[on]
    lines = (
        Line("flown", f"{label}, flown", time, flown, "simulated", "by aperture, navigation alone", ""),
        Line("budget", f"{label}, budget", time, budget, "reference", "covariance", ""),
    )
    top = max([*(_most(line.y) for line in lines), *(limit.level for limit in limits)])
    return Chart(
        "flown-figure", figure.label, CLOCK, f"{label.rpartition(' ')[2]}, {factor:g}σ [{unit}]", lines,
        limits=tuple(limits), spans=spans, y_range=(0.0, 1.1 * top or 1.0),
        knowledge=f"{figure.label} of each aperture, a quarter of it apart, of navigation alone; the budget is the "
        "line's.",
    )  # fmt: skip


def _most(values: Array) -> float:
    return float(np.nanmax(np.abs(values))) if np.isfinite(values).any() else 0.0


def _around(lines: tuple[Line, ...]) -> tuple[float, float]:
    """Bounds around zero that have the curves."""
    top = 1.1 * max(_most(line.y) for line in lines) or 1.0
    return -top, top


def lines_of(flight: FlownFlight) -> tuple[FlownLine, ...]:
    """The lines of a flight, without all lines together."""
    from nav_model.flown.result import ALL

    return tuple(line for line in flight.result.lines if line.name != ALL)


def _jumps(flight: FlownFlight) -> tuple[Points, ...]:
    """Times of the largest jumps, as there is room for their names."""
    apart, places = _APART * float(np.ptp(_times(flight))), list[float]()
    for jump in sorted(flight.result.jumps, key=lambda jump: -jump.size_m):
        place = jump.time_s - flight.start_s
        if len(places) < _MOST_JUMPS and all(abs(place - other) > apart for other in places):
            places.append(place)
    at = np.array(places)
    return (Points("jumps", "jump", at, np.zeros(len(at)), tuple("jump" for _ in at), "mark", "name"),)


def _line_spans(flight: FlownFlight, time: Array) -> tuple[Span, ...]:
    """The lines, named as there is room."""
    whole, spans = float(np.ptp(time)), []
    for number_, line in enumerate(lines_of(flight), 1):
        share = (line.stop_s - line.start_s) / whole
        label = line.name if share > _ROOM_FOR_A_NAME * len(line.name) else str(number_) if share > 0.015 else ""
        start, stop = line.start_s - flight.start_s, line.stop_s - flight.start_s
        spans.append(Span(f"line {number_}", label, start, stop, _STYLES.get(state_of(line)[0], "path"), True))
    return tuple(spans)


def state_of(line: FlownLine) -> tuple[str, float]:
    """The state of a line, which is its worst, and how much of the nearest limit it takes; of its budget where
    nothing limits it."""
    known = [one for one in line.figures.values() if math.isfinite(one.flown)]
    limited = [one for one in known if one.limit is not None]
    # What cannot be told is no distance to a limit: the output of a filter has steps that its image has not.
    ratios = [one.flown / one.limit for one in limited if one.limit and one.verdict != "cannot be told"]
    states = {one.verdict for one in limited}
    state = next((each for each in ("not met", "open", "met") if each in states), "")
    of_budget = [one.ratio for one in known if math.isfinite(one.ratio) and not limited]
    return state, max(ratios or of_budget, default=math.nan)


def map_chart(flight: FlownFlight) -> Chart:
    """The track seen from above: each line by its state, with how much of its limit it takes."""
    time = flight.result.solution.time_s
    east, north = flight.east / 1000, flight.north / 1000
    drawn = {style: np.full(len(north), np.nan) for style in ("closes", "does not close", "path")}
    names = []
    for number_, line in enumerate(lines_of(flight), 1):
        state, ratio = state_of(line)
        on = (time >= line.start_s) & (time <= line.stop_s)
        drawn[_STYLES.get(state, "path")][on] = north[on]
        names.append(f"{number_}" if math.isnan(ratio) else f"{number_}: {number(ratio, 2)} ×")
    places = _places(flight)
    labels = {"closes": "limits met", "does not close": "a limit not met", "path": "open, or no limit"}
    wide, high = np.ptp(east), np.ptp(north)
    to_scale = bool(max(wide, high) < _TO_SCALE * min(wide, high) or not min(wide, high))
    return Chart(
        key="flown-map",
        title="Map",
        x_label="east of the start [km]",
        y_label="north of the start [km]",
        lines=(
            Line("flight", "track", east, north, "turn", "the solution"),
            *(Line(style, labels[style], east, y, style, "the solution") for style, y in drawn.items()),
        ),
        points=(
            Points("lines", "line: × its limit", np.interp(places, time, east), np.interp(places, time, north),
                   tuple(names), "everything", "name"),
        ),
        square=to_scale,
        aside="" if to_scale else "not to scale",
        knowledge="Beside a line's number: how much of its nearest limit it takes, or of its budget where nothing "
        "limits it.",
    )  # fmt: skip


def _places(flight: FlownFlight) -> Array:
    """Times [s] at which each line is named, so that the names of parallel lines are not beside each other."""
    ends = np.array([(line.start_s, line.stop_s) for line in lines_of(flight)]).reshape(-1, 2)
    time = flight.result.solution.time_s
    along = np.column_stack([np.diff(np.interp(ends, time, way))[:, 0] for way in (flight.east, flight.north)])
    shares = (np.arange(len(ends)) + 0.5) / max(len(ends), 1)
    if len(ends):
        shares = np.where(along @ along[0] < 0, 1.0 - shares, shares)
    return np.asarray(ends[:, 0] + shares * (ends[:, 1] - ends[:, 0]))


def receiver_chart(flight: FlownFlight) -> Chart:
    """Changes of fixes over a time lag, seen and as declared; empty where the receiver is not told."""
    receiver = flight.result.receiver
    nothing = np.array([math.nan])
    lags = np.array(receiver.get("lags_s") or nothing)
    seen, declared = (np.array(receiver.get(key) or nothing) for key in ("seen_m", "declared_m"))
    return Chart(
        "flown-receiver", "How far fixes move over time", "time between fixes [s]", "horizontal axis, 1σ [m]",
        (
            Line("seen", "seen", lags, seen, "measured", "fixes less reference"),
            Line("declared", "declared", lags, declared, "fit", "the design"),
        ),
        x_log=True, y_log=True,
        knowledge="Half the mean square change over a lag, as a sigma: white noise is level, a slow error grows.",
    )  # fmt: skip
