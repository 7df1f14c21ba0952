"""The charts of a Monte Carlo study, as plain data. Each takes a `SimulationStudy` and draws what is in it."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np

from app.charts.kinds import Array, Band, Chart, Line, Span
from app.document.numbers import number, percent
from nav_model.simulation.design_study import SimulationStudy
from nav_model.simulation.result import STATES
from nav_model.simulation.single_run import POSTERIOR

MOST_OUTAGES = 4
"""Shaded spans a chart has room for; those a study does not use are not drawn."""

_DEG = 180 / math.pi
_TIME = "time [s]"
_SIMULATED, _FILTER = "simulated errors, after the fix", "filter covariance, after the fix"
_UNITS = {"m": ("m", 1.0), "m_s": ("m/s", 1.0), "rad": ("°", _DEG)}


def _outages(study: SimulationStudy) -> tuple[Span, ...]:
    given = [*study.result.spec.outages][:MOST_OUTAGES]
    parked = [(math.nan, math.nan)] * (MOST_OUTAGES - len(given))
    return tuple(Span(f"outage {i}", "no fixes", start, stop) for i, (start, stop) in enumerate(given + parked))


def _runs(study: SimulationStudy) -> str:
    low, high = study.result.rms_band
    return (
        f"{study.result.spec.runs} runs, seed {study.result.spec.seed}: with 95 % probability the rms lies between "
        f"{number(low)} and {number(high)} of the true sigma"
    )


def _rms(study: SimulationStudy, column: int, scale: float = 1.0) -> Array:
    return scale * study.result.rms[POSTERIOR, :, column]


def _sigma(study: SimulationStudy, column: int, scale: float = 1.0) -> Array:
    return scale * study.result.filter_sigma[POSTERIOR, :, column]


def _closed(study: SimulationStudy, column: int, scale: float = 1.0) -> Array:
    sigma = study.result.closed_form_sigma
    assert sigma is not None  # a study of a design has its closed forms
    return scale * sigma[:, column]


def path_chart(study: SimulationStudy) -> Chart:
    """The designed path: what the aircraft truly flies, seen from above and from the side."""
    along = study.path[:, 0] / 1000
    return Chart(
        key="sim-path",
        title="Designed path",
        x_label="along the initial track [km]",
        y_label="from the start [m]",
        lines=(
            Line("right", "to the right", along, study.path[:, 1], "simulated", "true path"),
            Line("up", "upwards", along, study.path[:, 2], "simulated, second axis", "true path"),
        ),
        knowledge="Reference trajectory of every run; specific force and angular rate are its exact derivatives.",
    )


def designed_attitude_chart(study: SimulationStudy) -> Chart:
    """The designed roll, pitch and yaw."""
    time, euler = study.result.time_s, study.result.truth.euler * _DEG
    return Chart(
        key="sim-attitude",
        title="Designed roll, pitch and yaw",
        x_label=_TIME,
        y_label="angle [°]",
        lines=(
            Line("roll", "roll", time, euler[:, 0], "simulated", "true attitude"),
            Line("pitch", "pitch", time, euler[:, 1], "simulated, second axis", "true attitude"),
            Line("yaw", "yaw from its start", time, euler[:, 2] - euler[0, 2], "third axis", "true attitude"),
        ),
        spans=_outages(study),
        knowledge="Reference trajectory of every run.",
    )


def axis_chart(study: SimulationStudy, what: str, axes: str) -> Chart:
    """Error of "position" or "velocity", "horizontal" or "vertical"."""
    column = ("position", "velocity").index(what) * 3
    if axes == "horizontal":
        lines = _pair(study, column, column + 1, "north", "east")
        closed = "Closed form [T-3], in the outage [T-9]"
    else:
        column += 2
        lines, closed = _single(study, column, "down"), "Closed form [T-4], in the outage [T-10]"
    if what == "position":
        lines, closed = (*lines, _refined(study, column)), f"{closed}; refined [T-17]"
    return _errors(study, f"{what}-{axes}", f"{axes.capitalize()} {what}", lines, f"{closed}.")


def tilt_chart(study: SimulationStudy) -> Chart:
    """Roll and pitch error, with the absolute error of the worst run."""
    time, worst = study.result.time_s, study.result.worst
    lines = [
        Line(f"worst {name}", f"{name}, worst run, absolute", time, _DEG * np.abs(worst.error[POSTERIOR, :, column]),
             style, f"run {worst.run}")
        for name, column, style in (("roll", 6, "worst run"), ("pitch", 7, "worst run, second axis"))
    ]  # fmt: skip
    closed = f"Closed form [T-3], in the outage [T-9]. Worst: run {worst.run}, largest horizontal position error."
    return _errors(study, "tilt", "Roll and pitch", (*_pair(study, 6, 7, "roll", "pitch"), *lines), closed)


def yaw_chart(study: SimulationStudy) -> Chart:
    """Yaw error."""
    closed = "Closed form [T-5]: unobservable on a straight path, so it only grows."
    return _errors(study, "yaw", "Yaw", _single(study, 8, "yaw"), closed)


def _errors(study: SimulationStudy, key: str, what: str, lines: tuple[Line, ...], closed: str) -> Chart:
    """A chart of one kind of error over the flight; position and velocity grow by decades, angles do not."""
    quantity = what.split()[-1]
    y_label = {"position": "position, 1σ [m]", "velocity": "velocity, 1σ [m/s]"}.get(quantity)
    return Chart(
        key=f"sim-{key}",
        title=f"{what} error",
        x_label=_TIME,
        y_label=y_label or "angle, 1σ [°]",
        lines=lines,
        spans=_outages(study),
        y_log=y_label is not None,
        knowledge=f"{_runs(study)}. {closed}",
    )


def _refined(study: SimulationStudy, column: int) -> Line:
    sigma = study.refined_sigma[:, column]
    return Line("refined", "refined", study.result.time_s, sigma, "refined", "linear covariance [T-17]")


def _pair(study: SimulationStudy, first: int, second: int, name: str, other: str) -> tuple[Line, ...]:
    time, scale = study.result.time_s, _UNITS[STATES[first][2]][1]
    return (
        Line("rms 1", f"{name}, simulated", time, _rms(study, first, scale), "simulated", _SIMULATED),
        Line("rms 2", f"{other}, simulated", time, _rms(study, second, scale), "simulated, second axis", _SIMULATED),
        Line("filter 1", f"{name}, filter", time, _sigma(study, first, scale), "filter", _FILTER),
        Line("filter 2", f"{other}, filter", time, _sigma(study, second, scale), "filter, second axis", _FILTER),
        Line("closed", "closed form", time, _closed(study, first, scale), "closed form", "cycle rms [T-3], [T-9]"),
    )


def _single(study: SimulationStudy, column: int, name: str) -> tuple[Line, ...]:
    time, scale = study.result.time_s, _UNITS[STATES[column][2]][1]
    mark = "[T-5]" if name == "yaw" else "cycle rms [T-4], [T-10]"
    return (
        Line("rms", f"{name}, simulated", time, _rms(study, column, scale), "simulated", _SIMULATED),
        Line("filter", f"{name}, filter", time, _sigma(study, column, scale), "filter", _FILTER),
        Line("closed", "closed form", time, _closed(study, column, scale), "closed form", mark),
    )


def outage_chart(study: SimulationStudy) -> Chart:
    """Growth of the horizontal position error in the longest outage, and the initial tilt's share of it."""
    result = study.result
    outage = max(result.spec.outages, key=lambda pair: pair[1] - pair[0], default=None)
    rows = np.zeros(len(result.time_s), dtype=bool)
    if outage:
        rows = (result.coast_s > 0) & (result.time_s > outage[0]) & (result.time_s <= outage[1] + 1e-9)

    def part(values: Array) -> Array:
        return values[rows] if rows.any() else np.array([np.nan])

    time = part(result.coast_s)
    curves = (
        ("rms 1", "north, simulated", _rms(study, 0), "simulated", _SIMULATED),
        ("rms 2", "east, simulated", _rms(study, 1), "simulated, second axis", _SIMULATED),
        ("filter", "north, filter", _sigma(study, 0), "filter", _FILTER),
        ("closed", "closed form", _closed(study, 0), "closed form", "polynomial [T-9]"),
        ("refined", "refined", study.refined_sigma[:, 0], "refined", "linear covariance [T-17]"),
        ("tilt 1", "north, tilt at the last fix alone", result.tilt_share_m[:, 0], "worst run", "g θ t²/2 [T-12]"),
        ("tilt 2", "east, tilt at the last fix alone", result.tilt_share_m[:, 1], "worst run, second axis",
         "g θ t²/2 [T-12]"),
    )  # fmt: skip
    lines = tuple(Line(key, label, time, part(values), style, source) for key, label, values, style, source in curves)
    knowledge = "This study has no outage. Enter one to see the errors grow."
    if rows.any():
        share = result.tilt_share_m[rows, 0][-1] / result.rms[POSTERIOR, rows, 0][-1]
        knowledge = (
            f"{_runs(study)}. The tilt at the last fix alone, simulated rms times g t²/2 [T-12], is {percent(share)} "
            f"of the simulated northern error at {number(time[-1], 4)} s."
        )
    return Chart(
        key="sim-outage",
        title="Outage growth, horizontal position",
        x_label="time since the last fix [s]",
        y_label="position, 1σ [m]",
        lines=lines,
        y_log=True,
        knowledge=knowledge,
    )


def ensemble_chart(study: SimulationStudy, axis: str = "north") -> Chart:
    """The ensemble of one position axis: percentiles of the absolute error, and the worst run."""
    result = study.result
    column = ("north", "east", "down").index(axis)
    time = result.time_s
    p50, p95, p99 = (result.percentiles[percent][:, column] for percent in (50.0, 95.0, 99.0))
    worst, source = np.abs(result.worst.error[POSTERIOR, :, column]), "percentile of the runs"
    return Chart(
        key="sim-ensemble",
        title="Ensemble: absolute position error of the runs",
        x_label=_TIME,
        y_label="position, absolute [m]",
        lines=(
            Line("median", "median", time, p50, "simulated", source),
            Line("p99", "99 % of the runs below", time, p99, "filter, second axis", source),
            Line("worst", "worst run", time, worst, "worst run, second axis", f"run {result.worst.run}"),
            Line("filter", "filter, 2σ", time, 2 * _sigma(study, column), "closed form", _FILTER),
        ),
        bands=(Band("middle", "50 % to 95 % of the runs below", time, p50, p95, "simulated", source),),
        spans=_outages(study),
        y_log=True,
        knowledge=(
            f"Position {axis}, {result.spec.runs} runs. Percentiles from a histogram of 4.7 % bins. Worst: run "
            f"{result.worst.run}, largest horizontal position error at any time. A consistent filter keeps 95 % of "
            "the errors below 2σ."
        ),
    )


def nees_chart(study: SimulationStudy) -> Chart:
    """Mean NEES at each time, with its band."""
    result = study.result
    time = result.time_s
    low, high = result.nees_curve_band
    level = np.ones_like(time)
    return Chart(
        key="sim-nees",
        title="Consistency: normalised estimation error squared",
        x_label=_TIME,
        y_label="mean NEES [-]",
        lines=(
            Line("nees", "mean over the runs", time, result.nees_curve, "simulated", "errors by filter covariance"),
            Line("expected", "expected", time, result.nees.states * level, "reference", "number of states"),
        ),
        bands=(
            Band("band", "95 % band at one time", time, low * level, high * level, "third axis", "chi-square"),
        ),
        spans=_outages(study),
        knowledge=(
            f"Band: chi-square of {result.nees.states} states over {result.spec.runs} runs, at one time; a "
            "consistent filter leaves it 5 % of the time. The verdict uses the mean over all times, with a "
            "band that accounts for their correlation."
        ),
    )  # fmt: skip


CHARTS: tuple[Callable[[SimulationStudy], Chart], ...] = (
    *(
        partial(axis_chart, what=what, axes=axes)
        for what in ("position", "velocity")
        for axes in ("horizontal", "vertical")
    ),
    tilt_chart,
    yaw_chart,
    outage_chart,
    ensemble_chart,
    nees_chart,
    path_chart,
    designed_attitude_chart,
)
"""Every chart of a study, in the order of page and report."""
