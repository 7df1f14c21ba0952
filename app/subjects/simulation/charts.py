"""The charts of a Monte Carlo study, as plain data. Each takes a `SimulationStudy` and draws what is in it."""

import math
from collections.abc import Callable

import numpy as np

from app.charts.kinds import Array, Band, Chart, Line, Span, without_fixes
from app.document.numbers import number, percent
from nav_model.simulation.design_study import SimulationStudy
from nav_model.simulation.result import STATES
from nav_model.simulation.single_run import POSTERIOR

_DEG = 180 / math.pi
_TIME = "time [s]"
_SIMULATED, _FILTER = "simulated errors, after the fix", "filter covariance, after the fix"
_AXES = {
    "position": "position, 1σ [m]",
    "velocity": "velocity, 1σ [m/s]",
    "attitude": "attitude, 1σ [°]",
    "consistency": "simulated / filter [1]",
    "nees": "mean NEES [1]",
}
"""Chart of the first screen -> label of its y axis."""
_UNITS = {"m": ("m", 1.0), "m_s": ("m/s", 1.0), "rad": ("°", _DEG)}


def _outages(study: SimulationStudy) -> tuple[Span, ...]:
    return without_fixes(study.result.spec.outages)


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


def _pooled(values: Callable[..., Array], study: SimulationStudy, columns: tuple[int, ...], scale: float) -> Array:
    """Root mean square over axes."""
    return np.sqrt(np.mean([values(study, column, scale) ** 2 for column in columns], axis=0))


def path_chart(study: SimulationStudy) -> Chart:
    """The path of the reference trajectory, seen from above and from the side."""
    along = study.path[:, 0] / 1000
    return Chart(
        key="sim-path",
        title="Reference trajectory: path",
        x_label="along the initial track [km]",
        y_label="from the start [m]",
        lines=(
            Line("right", "to the right", along, study.path[:, 1], "simulated", "true path"),
            Line("up", "upwards", along, study.path[:, 2], "simulated, second axis", "true path"),
        ),
        knowledge="Reference trajectory of every run; specific force and angular rate are its exact derivatives.",
    )


def designed_attitude_chart(study: SimulationStudy) -> Chart:
    """Roll, pitch and heading of the reference trajectory."""
    time, euler = study.result.time_s, study.result.truth.euler * _DEG
    return Chart(
        key="sim-flown-attitude",
        title="Reference trajectory: roll, pitch, heading",
        x_label=_TIME,
        y_label="angle [°]",
        lines=(
            Line("roll", "roll", time, euler[:, 0], "simulated", "true attitude"),
            Line("pitch", "pitch", time, euler[:, 1], "simulated, second axis", "true attitude"),
            Line("heading", "heading from its start", time, euler[:, 2] - euler[0, 2], "third axis", "true attitude"),
        ),
        spans=_outages(study),
        knowledge="Reference trajectory of every run.",
    )


def position_chart(study: SimulationStudy) -> Chart:
    """Position error, horizontal over both axes."""
    closed = "Formula [T-3], [T-4], in the outage [T-9], [T-10]."
    return _errors(study, "position", (0, 1), 2, ("horizontal", "vertical"), closed)


def velocity_chart(study: SimulationStudy) -> Chart:
    """Velocity error, horizontal over both axes."""
    closed = "Formula [T-3], [T-4], in the outage [T-9], [T-10]."
    return _errors(study, "velocity", (3, 4), 5, ("horizontal", "vertical"), closed)


def attitude_chart(study: SimulationStudy) -> Chart:
    """Tilt, which is roll and pitch together, and heading error."""
    closed = "Formula [T-3], in the outage [T-9]; heading [T-5], not observable on a straight path."
    return _errors(study, "attitude", (6, 7), 8, ("tilt", "heading"), closed)


def _errors(
    study: SimulationStudy, key: str, level: tuple[int, ...], other: int, names: tuple[str, str],
    closed: str,
) -> Chart:  # fmt: skip
    scale, time = _UNITS[STATES[other][2]][1], study.result.time_s
    (first, second), form = names, "formula, average between fixes"
    usual = ("simulated", "simulated, second axis")
    styles = ("simulated, tilt", "simulated, yaw") if key == "attitude" else usual

    def line(name: str, label: str, values: Callable[..., Array], columns: tuple[int, ...], style: str, source: str,
             end: str = "") -> Line:  # fmt: skip
        return Line(name, label, time, _pooled(values, study, columns, scale), style, source, end)

    return Chart(
        key=f"sim-{key}",
        title=f"{key.capitalize()} error",
        x_label=_TIME,
        y_label=_AXES[key],
        lines=(
            line("rms 1", f"{first}, simulated", _rms, level, styles[0], _SIMULATED, first),
            line("filter 1", f"{first}, filter", _sigma, level, "filter", _FILTER),
            line("closed 1", f"{first}, formula", _closed, level[:1], "formula", form),
            line("rms 2", f"{second}, simulated", _rms, (other,), styles[1], _SIMULATED, second),
            line("closed 2", f"{second}, formula", _closed, (other,), "formula, second axis", form),
        ),
        spans=_outages(study),
        y_log=True,
        knowledge=f"{_runs(study)}. {closed}",
    )


def consistency_chart(study: SimulationStudy) -> Chart:
    """Simulated rms over the filter's sigma, by kind of error."""
    (low, high), time = study.result.rms_band, study.result.time_s
    kinds = (
        ("position", (0, 1, 2), "x"), ("velocity", (3, 4, 5), "y"),
        ("tilt", (6, 7), "initial tilt"), ("heading", (8,), "z"),
    )  # fmt: skip

    def over_sigma(study: SimulationStudy, column: int, _: float) -> Array:
        return _rms(study, column) / _sigma(study, column)

    ratios = [_pooled(over_sigma, study, columns, 1.0) for _, columns, _ in kinds]
    most = max(float(np.nanmax(ratio)) for ratio in ratios)
    return Chart(
        key="sim-consistency",
        title="Consistency: simulated error over filter sigma",
        x_label=_TIME,
        y_label=_AXES["consistency"],
        lines=(
            *(Line(name, name, time, y, style, "rms over filter sigma", "")
              for (name, _, style), y in zip(kinds, ratios, strict=True)),
            *_edges(time, low, high, "95 % band of one axis"),
        ),
        spans=_outages(study),
        y_range=(0.0, 2.0 if most <= 2 else 1.2 * most),
        knowledge=f"{_runs(study)}. 1 = filter sigma is exact.",
    )  # fmt: skip


def _edges(time: Array, low: float, high: float, label: str) -> tuple[Line, Line]:
    level = np.ones_like(time)
    return (
        Line("high", f"{label}, top", time, high * level, "reference", "chi-square", "95 % band"),
        Line("low", f"{label}, bottom", time, low * level, "reference", "chi-square", ""),
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
        ("closed", "formula", _closed(study, 0), "formula", "polynomial [T-9]"),
        ("refined", "with Schuler and Coriolis terms", study.refined_sigma[:, 0], "refined",
         "linear covariance [T-17]"),
        ("tilt 1", "north, from the tilt at the last fix", result.tilt_share_m[:, 0], "worst run", "g θ t²/2 [T-12]"),
        ("tilt 2", "east, from the tilt at the last fix", result.tilt_share_m[:, 1], "worst run, second axis",
         "g θ t²/2 [T-12]"),
    )  # fmt: skip
    lines = tuple(Line(key, label, time, part(values), style, source) for key, label, values, style, source in curves)
    knowledge = "This study has no outage. Enter one to see the errors grow."
    if rows.any():
        share = result.tilt_share_m[rows, 0][-1] / result.rms[POSTERIOR, rows, 0][-1]
        knowledge = (
            f"{_runs(study)}. The tilt at the last fix alone (simulated rms × g t²/2 [T-12]) makes {percent(share)} "
            f"of the simulated northern error at {number(time[-1], 4, given=True)} s."
        )
    return Chart(
        key="sim-outage",
        title="Horizontal position in the outage",
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
        title="Spread of the runs: absolute position error",
        x_label=_TIME,
        y_label="position, absolute [m]",
        lines=(
            Line("median", "median", time, p50, "simulated", source),
            Line("p99", "99 % of the runs below", time, p99, "filter, second axis", source),
            Line("worst", "worst run", time, worst, "worst run, second axis", f"run {result.worst.run}"),
            Line("filter", "filter, 2σ", time, 2 * _sigma(study, column), "formula", _FILTER),
        ),
        bands=(Band("middle", "50 % to 95 % of the runs below", time, p50, p95, "simulated", source),),
        spans=_outages(study),
        y_log=True,
        knowledge=(
            f"Position {axis}, {result.spec.runs} runs. Percentiles from a histogram of 4.7 % bins. Worst run: "
            f"{result.worst.run}, by its largest horizontal position error. A consistent filter keeps 95 % of "
            "the errors below 2σ."
        ),
    )


def nees_chart(study: SimulationStudy) -> Chart:
    """Mean NEES at each time, with its band."""
    result, time = study.result, study.result.time_s
    return Chart(
        key="sim-nees",
        title="NEES: normalised estimation error squared",
        x_label=_TIME,
        y_label=_AXES["nees"],
        lines=(
            Line("nees", "mean over the runs", time, result.nees_curve, "simulated",
                 "errors by filter covariance", ""),
            *_edges(time, *result.nees_curve_band, "95 % band at one time"),
        ),
        spans=_outages(study),
        knowledge=(
            f"Band: chi-square of {result.nees.states} states over {result.spec.runs} runs, at one time. A "
            "consistent filter leaves this band 5 % of the time. The verdict uses the mean over all times, with a "
            "band that accounts for their correlation."
        ),
    )  # fmt: skip


TIMELINES = (position_chart, velocity_chart, attitude_chart)
CONSISTENCY = (consistency_chart, nees_chart)
"""The charts of the first screen, all on one time axis."""


def empty_charts(*names: str) -> list[Chart]:
    """Axes of charts of the first screen, before there is a study."""
    nothing = Line("none", "", np.array([0.0, 300.0]), np.full(2, np.nan), "reference", "", "")
    return [
        Chart(f"sim-{name}-empty", name, _TIME, _AXES[name], (nothing,), y_log=name not in ("consistency", "nees"))
        for name in names
    ]


CHARTS: tuple[Callable[[SimulationStudy], Chart], ...] = (
    *TIMELINES,
    *CONSISTENCY,
    outage_chart,
    ensemble_chart,
    path_chart,
    designed_attitude_chart,
)
"""Every chart of a study, in the order of the report."""
