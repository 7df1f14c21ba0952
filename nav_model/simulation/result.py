"""The result of a study: error statistics against the filter's covariance and the closed form, and the verdict."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from nav_model.base.constants import STANDARD_GRAVITY
from nav_model.base.text.csv_text import csv_text
from nav_model.simulation.schedule import plan
from nav_model.simulation.single_run import POSTERIOR, PRIOR, RunRecord
from nav_model.simulation.specification import SimulationSpec
from nav_model.simulation.statistics import Statistics
from nav_model.simulation.truth import TruthStates

FloatArray = NDArray[np.float64]
ClosedForm = Callable[[FloatArray, FloatArray], FloatArray]
"""(coast_s, elapsed_s), both (outputs,), to sigmas (outputs, 9) in the order of `STATES`.

coast_s is the time since the last fix inside an outage and 0 where fixes come; elapsed_s is the time since
the start.
"""
CONFIDENCE: Final = 0.95
PERCENTILES: Final = (50.0, 90.0, 95.0, 99.0)
STATES: Final = (
    ("position", "north", "m"),
    ("position", "east", "m"),
    ("position", "down", "m"),
    ("velocity", "north", "m_s"),
    ("velocity", "east", "m_s"),
    ("velocity", "down", "m_s"),
    ("attitude", "roll", "rad"),
    ("attitude", "pitch", "rad"),
    ("attitude", "yaw", "rad"),
)
"""Group, axis and unit of the first nine states, as the JSON names them."""


@dataclass(frozen=True)
class Consistency:
    """A mean normalised error squared and the 95 % band a consistent filter's falls in.

    states: its expectation; of the NIS what a fix measures on average. degrees: degrees of freedom of the band's
    chi-square, over the runs.
    """

    mean: float
    low: float
    high: float
    states: float
    degrees: float

    @property
    def inside(self) -> bool:
        """True where the mean lies in the band."""
        return self.low <= self.mean <= self.high


@dataclass(frozen=True, eq=False)
class SimulationResult:
    """A finished study. Arrays over `time_s` (outputs,); states as in `RunRecord`.

    rms, mean, filter_sigma: (2, outputs, states), before and after the fix at that time. filter_sigma is the
    root mean of the runs' own variances; nominal_sigma the covariance along the true path. closed_form_sigma:
    (outputs, 9) or None. percentiles: percent -> |error| after the fix (outputs, states). nees_curve:
    (outputs,) with its chi-square band `nees_curve_band` for the mean over the runs. rms_band: factors on a
    true sigma between which the rms of this many runs lies with 95 % probability. run_errors: (runs, outputs,
    states) errors after the fix where the study kept them.
    """

    spec: SimulationSpec
    time_s: FloatArray
    coast_s: FloatArray
    truth: TruthStates
    rms: FloatArray
    mean: FloatArray
    filter_sigma: FloatArray
    nominal_sigma: FloatArray
    closed_form_sigma: FloatArray | None
    percentiles: dict[float, FloatArray]
    rms_band: tuple[float, float]
    nees: Consistency
    nis: Consistency | None
    nees_curve: FloatArray
    nees_curve_band: tuple[float, float]
    worst: RunRecord
    run_errors: FloatArray | None
    wall_s: float

    @property
    def consistent(self) -> bool:
        """The filter's covariance describes its errors: the mean NEES is inside its band."""
        return self.nees.inside

    @property
    def verdict(self) -> str:
        """The consistency verdict in words."""
        runs = f"{self.spec.runs} run" + ("" if self.spec.runs == 1 else "s")
        n = self.nees
        band = f"NEES {n.mean:.2f}, 95 % band {n.low:.2f} to {n.high:.2f}, {runs}"
        if n.inside:
            return f"consistent: {band}"
        if n.mean > n.high:
            return f"optimistic, errors larger than the filter believes: {band}"
        return f"pessimistic, errors smaller than the filter believes: {band}"

    @property
    def tilt_share_m(self) -> FloatArray:
        """Position sigma that the tilt at the last fix alone makes in each outage, g theta t^2 / 2 [T-12].

        Shape (outputs, 2), north (from the tilt about east) and east, with the runs' own rms tilt; 0 outside
        outages.
        """
        share = np.zeros((len(self.time_s), 2))
        heading = self.truth.euler[:, 2]
        for start, stop in self.spec.outages:
            first = int(np.argmin(np.abs(self.time_s - start)))
            inside = (self.coast_s > 0.0) & (self.time_s <= stop + 1e-9) & (self.time_s > start)
            roll, pitch = self.rms[POSTERIOR, first, 6], self.rms[POSTERIOR, first, 7]
            lever = 0.5 * STANDARD_GRAVITY * self.coast_s[inside] ** 2
            c, s = np.cos(heading[first]), np.sin(heading[first])
            share[inside, 0] = lever * np.hypot(pitch * c, roll * s)
            share[inside, 1] = lever * np.hypot(pitch * s, roll * c)
        return share


def chi_square_band(degrees: float, confidence: float = CONFIDENCE) -> tuple[float, float]:
    """Factors between which chi-square / degrees lies with a probability, 95 % unless told."""
    from scipy.special import chdtri

    tail = 0.5 * (1.0 - confidence)
    return float(chdtri(degrees, 1.0 - tail)) / degrees, float(chdtri(degrees, tail)) / degrees


def nees_consistency(mean: float, mean_square: float, runs: int, outputs: int, states: int) -> Consistency:
    """The mean NEES over runs and times, with a band that knows a run's errors are correlated in time.

    The mean over one run is treated as a scaled chi-square whose degrees of freedom follow from its spread
    from run to run (Satterthwaite): between `states` (one independent time) and `states` x `outputs`. With
    fewer than ten runs the spread is not known well enough and the widest band is taken.

    Parameters
    ----------
    mean, mean_square : float
        Over the runs, of a run's mean NEES and of its square.
    runs, outputs, states : int
        Numbers of runs, of times and of states.
    """
    freedom = float(states)
    if runs >= 10:
        variance = max((mean_square - mean * mean) * runs / (runs - 1), 1e-300)
        freedom = min(max(2.0 * mean * mean / variance, float(states)), float(states) * outputs)
    low, high = chi_square_band(freedom * runs)
    return Consistency(mean, states * low, states * high, states, freedom * runs)


def summarise(
    spec: SimulationSpec, total: Statistics, nominal: RunRecord, closed_form: ClosedForm | None, wall_s: float
) -> SimulationResult:
    """The result from the summed runs.

    Parameters
    ----------
    spec : SimulationSpec
        The study.
    total : Statistics
        Sums over the runs.
    nominal : RunRecord
        The filter's covariance along the true path.
    closed_form : ClosedForm or None
        Sigmas to compare with.
    wall_s : float
        Time that the runs took.

    Raises
    ------
    ValueError
        Where the closed form's array has another shape.
    """
    schedule = plan(spec)
    time_s = schedule.outputs.time_s
    runs, states = total.runs, spec.filter.inertial
    sigma = None
    if closed_form is not None:
        sigma = np.asarray(closed_form(schedule.coast_s, time_s), dtype=np.float64)
        if sigma.shape != (len(time_s), 9):
            raise ValueError(f"closed_form gave shape {sigma.shape}: must be {(len(time_s), 9)}")
    nis = None
    if total.fixes:
        low, high = chi_square_band(float(total.measured))
        m = total.measured / total.fixes
        nis = Consistency(total.nis / total.fixes, m * low, m * high, m, float(total.measured))
    mean_nees, mean_nees_square = (total.run_nees / runs).tolist()
    low, high = chi_square_band(float(states * runs))
    factors = chi_square_band(float(runs))
    if total.worst is None:
        raise RuntimeError("no run arrived")
    return SimulationResult(
        spec=spec,
        time_s=time_s,
        coast_s=schedule.coast_s,
        truth=schedule.outputs,
        rms=np.sqrt(total.square / runs),
        mean=total.error / runs,
        filter_sigma=np.sqrt(total.variance / runs),
        nominal_sigma=nominal.filter_sigma,
        closed_form_sigma=sigma,
        percentiles={percent: total.percentile(percent) for percent in PERCENTILES},
        rms_band=(float(np.sqrt(factors[0])), float(np.sqrt(factors[1]))),
        nees=nees_consistency(mean_nees, mean_nees_square, runs, len(time_s), states),
        nis=nis,
        nees_curve=total.nees / runs,
        nees_curve_band=(states * low, states * high),
        worst=total.worst,
        run_errors=np.stack([total.run_errors[run] for run in sorted(total.run_errors)]) if spec.keep_runs else None,
        wall_s=wall_s,
    )


def to_json(result: SimulationResult) -> dict[str, Any]:
    """The study under the contract's names, plain lists and floats.

    `rms_*` and `filter_sigma_*` are just after the fix at that time, `prior_*` just before it;
    `closed_form_sigma_*` is null where no closed form was given.
    """
    document: dict[str, Any] = {
        "runs": result.spec.runs,
        "seed": result.spec.seed,
        "simulated_s": result.spec.runs * result.spec.duration,
        "wall_s": result.wall_s,
        "consistent": result.consistent,
        "verdict": result.verdict,
        "nees": _consistency_json(result.nees),
        "nis": None if result.nis is None else _consistency_json(result.nis),
        "rms_band": list(result.rms_band),
        "time_s": result.time_s.tolist(),
        "coast_s": result.coast_s.tolist(),
        "nees_curve": {
            "mean": result.nees_curve.tolist(),
            "low": result.nees_curve_band[0],
            "high": result.nees_curve_band[1],
        },
    }
    for column, (group, axis, unit) in enumerate(STATES):
        closed = result.closed_form_sigma
        document.setdefault(group, {})[axis] = {
            f"rms_{unit}": result.rms[POSTERIOR, :, column].tolist(),
            f"filter_sigma_{unit}": result.filter_sigma[POSTERIOR, :, column].tolist(),
            f"closed_form_sigma_{unit}": None if closed is None else closed[:, column].tolist(),
            f"prior_rms_{unit}": result.rms[PRIOR, :, column].tolist(),
            f"prior_filter_sigma_{unit}": result.filter_sigma[PRIOR, :, column].tolist(),
            **{f"p{p:g}_{unit}": value[:, column].tolist() for p, value in result.percentiles.items()},
        }
    return document


def _consistency_json(value: Consistency) -> dict[str, float | int]:
    return {"mean": value.mean, "low": value.low, "high": value.high, "states": value.states}


def to_arrays(result: SimulationResult) -> dict[str, FloatArray]:
    """Everything numeric by name, for `numpy.savez`: statistics, truth, the worst run, and every kept run's
    errors."""
    arrays = {
        "time_s": result.time_s,
        "coast_s": result.coast_s,
        "true_latitude_longitude_height": result.truth.position,
        "true_velocity_m_s": result.truth.velocity,
        "true_roll_pitch_yaw_rad": result.truth.euler,
        "rms": result.rms,
        "mean": result.mean,
        "filter_sigma": result.filter_sigma,
        "nominal_sigma": result.nominal_sigma,
        "nees": result.nees_curve,
        "worst_run": np.array(result.worst.run),
        "worst_error": result.worst.error,
        "worst_filter_sigma": result.worst.filter_sigma,
        "worst_nees": result.worst.nees,
        "worst_nis": result.worst.nis,
        **{f"p{percent:g}": value for percent, value in result.percentiles.items()},
    }
    if result.closed_form_sigma is not None:
        arrays["closed_form_sigma"] = result.closed_form_sigma
    if result.run_errors is not None:
        arrays["run_errors"] = result.run_errors
    return arrays


def to_csv(result: SimulationResult) -> str:
    """One row per time: rms, filter and closed-form sigma of the nine states after the fix, and the mean NEES."""
    columns: list[tuple[str, FloatArray]] = [("time_s", result.time_s), ("nees", result.nees_curve)]
    for column, (group, axis, unit) in enumerate(STATES):
        name = f"{group}_{axis}"
        columns.append((f"{name}_rms_{unit}", result.rms[POSTERIOR, :, column]))
        columns.append((f"{name}_filter_sigma_{unit}", result.filter_sigma[POSTERIOR, :, column]))
        if result.closed_form_sigma is not None:
            columns.append((f"{name}_closed_form_sigma_{unit}", result.closed_form_sigma[:, column]))
    names, values = zip(*columns, strict=True)
    return csv_text((names, *zip(*values, strict=True)))
