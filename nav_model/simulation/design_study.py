"""The Monte Carlo study of a design, compared with the design's closed forms.

A `Design` says what `SimulationSpec` needs once the flight, the number of runs and the outages are chosen;
`specification` is that one step. The closed forms come from `nav_model.budget.analyse`, so the simulator is compared
with the same figures as everywhere else.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Final, cast

import numpy as np
from numpy.typing import NDArray

from nav_model.analytic.steady_state import yaw_variance
from nav_model.base.errors import InputError
from nav_model.budget import analyse
from nav_model.budget.inputs import inputs_of
from nav_model.design import Design
from nav_model.design.parts import Accelerometer, Filter, Gyro, quantity
from nav_model.simulation.specification import (
    SLOW_STATES,
    TRAJECTORY_KINDS,
    Aids,
    FilterModel,
    GnssModel,
    ImuModel,
    InitialSigma,
    SimulationSpec,
    TrajectorySpec,
    TriadModel,
)

if TYPE_CHECKING:
    from nav_model.simulation.departures import Departure
    from nav_model.simulation.result import SimulationResult
    from nav_model.simulation.single_run import RunRecord
    from nav_model.simulation.statistics import Statistics

FloatArray = NDArray[np.float64]
NAMED_TRAJECTORIES: Final = tuple(kind for kind in TRAJECTORY_KINDS if kind != "file")
LONGEST_OUTAGE: Final = 7200.0
"""Seconds: as far as the closed forms of a design are followed."""


def specification(
    design: Design,
    *,
    trajectory: str | TrajectorySpec = "wandering",
    runs: int = 100,
    seed: int = 1,
    duration: float = 500.0,
    outages: Sequence[tuple[float, float]] = (),
    every: float = 1.0,
    keep_runs: bool = False,
) -> SimulationSpec:
    """The study of a design.

    The IMU takes the design's random walks with its vibration factor, its rate, all errors of the sections [gyro] and
    [accelerometer], and its residual biases, that of vibration among them: drawn for each run, they act from the last
    fix on while no fix comes. GNSS takes the fix noise, horizontal and vertical, the interval, the velocity noise,
    the lever arm, and the slow error where it is switched on. The filter is that of the section [filter]. Two
    antennas, barometer, errors of lever arm and time, the bank that loses fixes and what follows a loss are those of
    the design's section [trajectory]. The flight starts at the design's latitude, altitude, speed and heading. Errors
    start at the closed form's horizontal steady-state sigmas [T-3] on all axes, position with the slow error of the
    fixes where the filter knows it, so that little time is spent settling; yaw starts at the initial heading error.

    Parameters
    ----------
    design : Design
        The design.
    trajectory : str or TrajectorySpec, optional
        One of `NAMED_TRAJECTORIES`, or a `TrajectorySpec` such as a file gives.
    runs, seed : int, optional
        Number of runs, and the seed of their noise.
    duration, every : float, optional
        Of the flight, and between results, s.
    outages : sequence of pair, optional
        Start and end of each, s.
    keep_runs : bool, optional
        True to keep every run's arrays.

    Raises
    ------
    InputError
        Naming the key of the design, or the option, that cannot be flown.
    """
    imu, gnss, section, tuning = design.imu, design.gnss, design.trajectory, design.filter
    settled, velocity = analyse(design).steady_state.closed, inputs_of(design).velocity_of_fix or (None, None)
    longest = max((stop - start for start, stop in outages), default=0.0)
    if longest > LONGEST_OUTAGE:
        raise InputError("outage", f"{longest:g} s are too long. Give at most {LONGEST_OUTAGE:g} s.", longest)
    if late := [start for start, _ in outages if start >= duration]:
        raise InputError("outage", f"{late[0]:g} s is after the flight, which ends at {duration:g} s.", late[0])
    slow = inputs_of(design).slow
    gyro = TriadModel(imu.angle_random_walk, residual_bias=imu.gyro_bias, **_errors(design.gyro))
    accelerometer = TriadModel(
        imu.velocity_random_walk, residual_bias=float(inputs_of(design).bias), **_errors(design.accelerometer)
    )
    triads = gyro, accelerometer
    inertial = 21 if any(m.mixed for m in triads) else 15 if any(m.biased for m in triads) else 9
    return SimulationSpec(
        imu=ImuModel(
            gyro=gyro,
            accelerometer=accelerometer,
            rate=imu.rate,
            vibration_factor=imu.vibration_factor,
        ),
        gnss=GnssModel(
            position_noise=gnss.position_noise,
            vertical_position_noise=gnss.vertical_position_noise,
            interval=gnss.interval,
            markov_noise=0.0 if slow is None else float(np.asarray(slow.horizontal)),
            vertical_markov_noise=0.0 if slow is None else float(np.asarray(slow.vertical)),
            markov_time=gnss.correlation_time,
            velocity_noise=None if velocity[0] is None else float(velocity[0]),
            vertical_velocity_noise=None if velocity[1] is None else float(velocity[1]),
            lever_arm=(gnss.lever_forward, gnss.lever_right, gnss.lever_down),
            lever_arm_error=section.lever_arm_error,
            time_offset=section.time_offset,
            bank_limit=section.bank_limit,
            after_loss=section.after_loss,
        ),
        aiding=Aids(
            heading_noise=section.heading_noise,
            barometer_noise=section.barometer_noise,
            heading_slow_noise=section.heading_slow_noise,
            heading_time=section.heading_correlation_time,
            barometer_slow_noise=section.barometer_slow_noise,
            barometer_time=section.barometer_correlation_time,
        ),
        trajectory=named_flight(design, trajectory) if isinstance(trajectory, str) else trajectory,
        filter=FilterModel(
            states=tuning.states or inertial + (SLOW_STATES if slow else 0),
            propagation_rate=tuning.propagation_rate,
            process_noise_scale=tuning.process_noise_scale,
            gnss_noise_scale=tuning.gnss_noise_scale,
        ),
        initial=InitialSigma(
            position=settled["horizontal_position"],
            velocity=settled["horizontal_velocity"],
            tilt=settled["tilt"],
            yaw=tuning.initial_yaw,
        ),
        runs=runs,
        seed=seed,
        duration=duration,
        outages=tuple((float(start), float(stop)) for start, stop in outages),
        every=every,
        keep_runs=keep_runs,
        radar_time_offset=section.radar_time_offset,
    )


def _errors(sensor: Gyro | Accelerometer) -> dict[str, float]:
    """Errors of a sensor beyond its white noise, by the names of a `TriadModel`."""
    return {name: getattr(sensor, name) for name in sensor.inputs()}


def beside_noise(design: Design) -> dict[str, float]:
    """Numbers beside the noise of sensors and receiver that runs and flights take, where given: key -> value, SI."""
    keys = [f"{part.section}.{name}" for part in (Gyro, Accelerometer, Filter) for name in part.inputs()]
    keys += [f"gnss.lever_{way}" for way in ("forward", "right", "down")]
    numbers = [key for key in keys if key != "filter.states" and design.uses(key)]
    return {key: value for key in numbers if (value := cast("float", design[key])) != quantity(key).default}


def named_flight(design: Design, kind: str) -> TrajectorySpec:
    """The flight of one of `NAMED_TRAJECTORIES` from the design's place, at its speed and heading."""
    if kind not in NAMED_TRAJECTORIES:
        reason = f"{kind!r} is not a trajectory. Choose {', '.join(NAMED_TRAJECTORIES)}, or a CSV file."
        raise InputError("trajectory", reason, kind)
    flight = design.flight
    return TrajectorySpec(
        kind=kind,  # type: ignore[arg-type]  # checked above
        speed=flight.speed,
        latitude=flight.latitude,
        height=flight.altitude,
        heading=flight.heading,
    )


@dataclass(frozen=True)
class DesignClosedForm:
    """The closed forms of a design as `simulate` takes them; picklable, so it travels to a worker.

    initial_yaw: sigma at the start [rad].
    Called with (coast_s, elapsed_s), both (outputs,), it gives the sigmas (outputs, 9) of `result.STATES`:
    [T-3], [T-4] where fixes come, with what a slow GNSS error adds [T-8]; [T-9], [T-10] in an outage, from the
    covariance just after its last fix. Residual biases in quadrature; yaw [T-5], and in an outage the gyro's.
    """

    design: Design
    initial_yaw: float

    def __call__(self, coast_s: FloatArray, elapsed_s: FloatArray) -> FloatArray:
        budget = analyse(self.design, coast_s)
        coast, settled = budget.coast, budget.steady_state.average
        horizontal, vertical, speed, sink, tilt = (
            np.where(coast_s > 0, drifting, settled[name])
            for name, drifting in (
                ("horizontal_position", coast.position_horizontal),
                ("vertical_position", coast.position_vertical),
                ("horizontal_velocity", coast.velocity_horizontal),
                ("vertical_velocity", coast.velocity_vertical),
                ("tilt", coast.tilt),
            )
        )
        imu = self.design.imu
        density, drift = imu.angle_random_walk * imu.vibration_factor, imu.gyro_bias * coast_s
        yaw = np.sqrt(self.initial_yaw**2 + yaw_variance(density, elapsed_s) + drift**2)
        sigmas: FloatArray = np.stack([horizontal, horizontal, vertical, speed, speed, sink, tilt, tilt, yaw], axis=1)
        return sigmas


def closed_form(design: Design, spec: SimulationSpec) -> DesignClosedForm:
    """The closed forms of `design` for a study of it."""
    return DesignClosedForm(design, spec.initial.yaw)


@dataclass(frozen=True, eq=False)
class SimulationStudy:
    """A study of a design, compared with its closed forms. Arrays over the result's `time_s` (outputs,).

    refined_sigma: position north, east, down [m] by [T-17], residual biases in quadrature, shape
    (outputs, 3); NaN outside outages. path: along the initial track, right of it and up, from the start [m],
    shape (outputs, 3). departures: where filter and closed form differ. conditions: how the simulated world differs.
    """

    design: Design
    result: SimulationResult
    refined_sigma: FloatArray
    path: FloatArray
    departures: tuple[Departure, ...]
    conditions: tuple[str, ...]


def study_of(design: Design, result: SimulationResult) -> SimulationStudy:
    """Compare a finished study with the closed forms of its design."""
    from nav_model.simulation.conditions import conditions
    from nav_model.simulation.departures import chain, departures

    return SimulationStudy(
        design=design,
        result=result,
        refined_sigma=_refined(design, result.coast_s),
        path=_path(result),
        departures=tuple(departures(result, chain(design, result.spec), settling_s=settling(design))),
        conditions=conditions(design, result.spec),
    )


def simulation_study(design: Design, *, workers: int = 1, **options: Any) -> SimulationStudy:
    """Simulated runs of a design with its filter, beside the formulas.

    Parameters
    ----------
    design : Design
    workers : int, optional
        Processes; 1 flies in this thread.
    **options
        Of `specification`: trajectory, runs, seed, duration [s], outages [s], every [s].

    Raises
    ------
    InputError
        Naming the key of the design, or the option, that cannot be flown.

    Examples
    --------
    >>> from nav_model import parse_design, simulation_study
    >>> design = parse_design("imu.rate = '10 Hz'")
    >>> study = simulation_study(design, trajectory="straight", runs=20, duration=60.0, outages=[(30.0, 50.0)])
    >>> study.result.rms.shape  # of the runs: before and after fixes, at each of result.time_s, nine states
    (2, 61, 9)
    """
    from nav_model.simulation.monte_carlo import simulate

    spec = specification(design, **options)
    return study_of(design, simulate(spec, workers=workers, closed_form=closed_form(design, spec)))


def moments(study: SimulationStudy) -> tuple[tuple[str, int], ...]:
    """Times at which a study is summarised: name of each and its index in the result's `time_s`.

    The last fix before the longest outage and the end of that outage; without one, the last fix of the flight.
    """
    spec, time_s = study.result.spec, study.result.time_s
    outage = max(spec.outages, key=lambda pair: pair[1] - pair[0], default=None)
    named = [("at the last fix", outage[0] if outage else spec.duration)]
    if outage:
        named.append(("at the end of the outage", min(outage[1], spec.duration)))
    return tuple((name, int(np.argmin(np.abs(time_s - at)))) for name, at in named)


def settling(design: Design) -> float:
    """Seconds until a run has forgotten its start: four time constants of the slower channel, the vertical one,
    s²/v11; at least a minute. [T-4], [T-8]
    """
    gnss = design.gnss
    noise = gnss.vertical_position_noise or gnss.position_noise
    sigma = analyse(design).steady_state.closed["vertical_position"]
    return max(60.0, 4.0 * gnss.interval * (noise / sigma) ** 2)


def conclude(
    design: Design, spec: SimulationSpec, total: Statistics, nominal: RunRecord, wall_s: float
) -> SimulationStudy:
    """The study from the runs summed so far, `spec.runs` of them, for a worker process to make.

    Parameters
    ----------
    design : Design
        The design.
    spec : SimulationSpec
        Its study.
    total : Statistics
        As `monte_carlo.run_chunk` gives them.
    nominal : RunRecord
        As `single_run.fly_without_errors` gives it.
    wall_s : float
        Time that the runs took.
    """
    from nav_model.simulation.result import summarise

    return study_of(design, summarise(spec, total, nominal, closed_form(design, spec), wall_s))


def _refined(design: Design, coast_s: FloatArray) -> FloatArray:
    coast = analyse(design, coast_s).coast
    horizontal, vertical = coast.refined_horizontal, coast.refined_vertical
    sigmas: FloatArray = np.stack([horizontal, horizontal, vertical], axis=1)
    return np.where(coast_s[:, None] > 0.0, sigmas, np.nan)


def _path(result: SimulationResult) -> FloatArray:
    """Along, right, up [m], integrated from the true velocity: a constant heading is a straight line."""
    velocity = result.truth.velocity
    trajectory = result.spec.trajectory
    heading = trajectory.heading
    if trajectory.kind == "file":
        heading = math.atan2(velocity[0, 1], velocity[0, 0])
    c, s = math.cos(heading), math.sin(heading)
    along, right = c * velocity[:, 0] + s * velocity[:, 1], c * velocity[:, 1] - s * velocity[:, 0]
    rates = np.stack([along, right], axis=1)
    steps = 0.5 * (rates[1:] + rates[:-1]) * np.diff(result.time_s)[:, None]
    horizontal = np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
    up = result.truth.position[:, 2] - result.truth.position[0, 2]
    path: FloatArray = np.column_stack([horizontal, up])
    return path


def to_document(study: SimulationStudy) -> dict[str, Any]:
    """The study as plain data for JSON: `result.to_json`, and the refined curve, departures and conditions.

    ``refined_sigma_m`` of each position axis is null outside outages.
    """
    from nav_model.simulation.result import to_json

    document = to_json(study.result)
    for column, axis in enumerate(("north", "east", "down")):
        document["position"][axis]["refined_sigma_m"] = [
            None if math.isnan(sigma) else sigma for sigma in study.refined_sigma[:, column].tolist()
        ]
    document["departures"] = [
        {
            "group": departure.group,
            "axis": departure.axis,
            "phase": departure.phase,
            "start_s": departure.start_s,
            "stop_s": departure.stop_s,
            "filter_over_closed_form": departure.ratio,
            "simulated_over_closed_form": departure.simulated,
            "steps": [{"cause": cause, "factor": factor} for cause, factor in departure.steps],
            "reason": departure.reason,
        }
        for departure in study.departures
    ]
    document["conditions"] = list(study.conditions)
    document["added"] = {key: quantity(key).show(value) for key, value in beside_noise(study.design).items()}
    document["design"] = study.design.name
    return document
