"""Where closed form and simulation differ, and why, found by changing one thing at a time.

A chain of covariances connects the closed form and the simulated errors, each with one more of the simulator's
properties than the one before: discrete fixes on a flat Earth, the start and the outages, the simulator's Earth, its
flight, its filter and instruments, its errors. A departure is the product of the steps, so each cause has a measured
share, and without the cause its step is 1.
"""

import math
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from nav_model.analytic import coast as growth
from nav_model.analytic.discrete import Sawtooth
from nav_model.analytic.rise import gravity_gradient, vertical_velocity
from nav_model.analytic.steady_state import Horizontal, Vertical
from nav_model.budget.inputs import inputs_of
from nav_model.budget.real_time import RealTime
from nav_model.design import Design
from nav_model.simulation.kalman import propagate, update
from nav_model.simulation.result import STATES, SimulationResult, chi_square_band
from nav_model.simulation.schedule import FIX, OUTPUT, plan
from nav_model.simulation.single_run import POSTERIOR, coast, fly_without_errors
from nav_model.simulation.specification import (
    SLOW_STATES,
    Aids,
    FilterModel,
    GnssModel,
    ImuModel,
    SimulationSpec,
    TrajectorySpec,
    TriadModel,
)
from nav_model.simulation.trajectory import plan_trajectory
from nav_model.simulation.tuning import believed_covariance, tuning_of

FloatArray = NDArray[np.float64]

CAUSES: Final = {
    "biases": "the formula includes the tilt that cancels the residual accelerometer bias, this covariance does not",
    "fixes": "the filter's sawtooth between fixes, of which the formula gives the average [T-8]",
    "settling": "settling; the formula holds for steady state",
    "earth": "Schuler, Coriolis and transport terms, gravity with height, local gravity [T-17]",
    "flight": "turns, climbs or wander, where [T-1] assumes straight and level",
    "filter": "the filter differs from that of the formula",
    "errors": "errors that the filter does not model",
}
"""Steps of the chain in its order."""
SMALL: Final = "several small differences, none above 3 %"
_TOLERANCE = 0.1  # relative: differences up to it are no departures
_LEAST_STEP = 0.03  # of a factor: smaller steps explain nothing a reader would ask about
_LEAST_SHARE = 0.25  # of the largest step
_CHANCE = 1e-3  # probability that a correct study reports a difference of the simulated errors


@dataclass(frozen=True)
class Departure:
    """One state over one phase of the flight.

    group, axis: as in the JSON. phase: "settling" (after the start or an outage), "aided" or "coast". stretch: how
    many outages have ended before. start_s, stop_s: when they differ by more than the tolerance. ratio: filter sigma
    over closed form where they differ most. simulated: the same of the simulated errors, smoothed over the phase.
    steps: (key of `CAUSES`, factor) of what matters, in the order of the chain; their product is `simulated` but for
    the steps too small to name. reason: the same in words.
    """

    group: str
    axis: str
    phase: str
    stretch: int
    start_s: float
    stop_s: float
    ratio: float
    simulated: float
    steps: tuple[tuple[str, float], ...]
    reason: str


@dataclass(frozen=True, eq=False)
class Chain:
    """The covariances between closed form and filter as sigmas (outputs, 9), in the order of `STATES`.

    bare: the closed form without the tilt that cancels an accelerometer bias. fixes: as long after the last fix, by a
    settled filter on a flat Earth [T-8]. settling: the same filter from the study's start and through its outages.
    earth: the simulator's filter with the design's white noises and slow GNSS error, flown straight and level.
    flight: the same along the study's flight.
    """

    bare: FloatArray
    fixes: FloatArray
    settling: FloatArray
    earth: FloatArray
    flight: FloatArray


def chain(design: Design, spec: SimulationSpec) -> Chain:
    """The chain of a study; cached for the last few studies, as a page asks again while runs are flying."""
    return _chain(design, replace(spec, runs=1, seed=0, keep_runs=False))


@lru_cache(maxsize=4)
def _chain(design: Design, spec: SimulationSpec) -> Chain:
    x, imu, gnss = inputs_of(design), spec.imu, spec.gnss
    plain = replace(
        spec,
        imu=ImuModel(
            TriadModel(random_walk=imu.gyro.random_walk, residual_bias=imu.gyro.residual_bias),
            TriadModel(random_walk=imu.accelerometer.random_walk, residual_bias=imu.accelerometer.residual_bias),
            imu.rate,
            imu.vibration_factor,
        ),
        gnss=GnssModel(
            gnss.position_noise,
            gnss.vertical_position_noise,
            gnss.interval,
            velocity_noise=gnss.velocity_noise,
            vertical_velocity_noise=gnss.vertical_velocity_noise,
            markov_noise=gnss.markov_noise,
            vertical_markov_noise=gnss.vertical_markov_noise,
            markov_time=gnss.markov_time,
        ),
        aiding=Aids(),
        filter=FilterModel(states=9 + (SLOW_STATES if any(gnss.axis_markov_noise) else 0)),
        radar_time_offset=0.0,
    )
    schedule = plan(plain)
    fixes, outputs = (np.flatnonzero(schedule.events & kind) for kind in (FIX, OUTPUT))
    last = np.concatenate([[0], fixes])[np.searchsorted(fixes, outputs, side="right")]
    longest = np.where(schedule.coast_s > 0.0, np.inf, gnss.interval)  # after an outage the next fix may be late
    coasted = schedule.coast_s
    b, d, g = imu.accelerometer.residual_bias, imu.gyro.residual_bias, x.g
    (place_a, place_w), (speed_a, speed_w) = (
        grown(b, d, g, coasted) for grown in (growth.bias_position, growth.bias_velocity)
    )
    yaw = np.sqrt(spec.initial.yaw**2 + x.sigma_w**2 * schedule.outputs.time_s + (d * coasted) ** 2)
    flat = []
    since_fix = np.minimum((outputs - last) / imu.rate, longest)
    model, coasting = RealTime(x), coasted > 0.0
    average, posterior = model.at_last_fix, model.cycle.posterior
    horizontal, vertical = (
        [np.where(coasting, after, mean) for after, mean in zip(last, settled, strict=True)]
        for last, settled in zip(posterior, average, strict=True)
    )
    by_formula = Sawtooth(Horizontal(*horizontal), Vertical(*vertical))
    for start, time_s in ((by_formula, coasted), (posterior, since_fix)):
        level = growth.horizontal_growth(start.horizontal, x.sigma_a, x.sigma_w, x.g, time_s)
        upright = growth.vertical_growth(start.vertical, x.sigma_a, time_s)
        sink = vertical_velocity(start.vertical, x.sigma_a, x.g, time_s)
        place, speed = level.position + place_a**2 + place_w**2, level.velocity + speed_a**2 + speed_w**2
        down = [upright.position + place_a**2, sink + speed_a**2]
        tilt = level.tilt + (d * coasted) ** 2
        flat.append(
            np.stack([*map(np.sqrt, (place, place, down[0], speed, speed, down[1], tilt, tilt)), yaw], axis=1)
        )
    earth, flight = (
        fly_without_errors(s).filter_sigma[POSTERIOR, :, :9]
        for s in (replace(plain, trajectory=_straight(spec)), plain)
    )
    return Chain(flat[0], flat[1], _settling(plain, float(x.g)), earth, flight)


def _settling(spec: SimulationSpec, gravity: float) -> FloatArray:
    """Sigmas (outputs, 9) just after the fix of the filter on a flat Earth, from the study's start. [T-1]"""
    imu, gnss, schedule, tuning = spec.imu, spec.gnss, plan(spec), tuning_of(spec)
    events = schedule.events
    accelerometer, gyro = (triad.random_walk * imu.vibration_factor for triad in (imu.accelerometer, imu.gyro))
    noises = [*gnss.axis_noise, *gnss.axis_velocity_noise]
    covariance, states = believed_covariance(spec), spec.filter.states
    dynamics, force, work = np.zeros((9, 9)), np.array([0.0, 0.0, -gravity]), np.empty((4, states, states))
    seen = np.eye(9, states)  # a fix shows the position with its slow error
    for axis, state in enumerate(range(spec.filter.inertial, states)):
        seen[axis, state] = tuning.slow_sigma[axis]
    dynamics[range(3), range(3, 6)] = 1.0
    dynamics[3, 7], dynamics[4, 6], dynamics[5, 2] = gravity, -gravity, gravity_gradient(gravity)
    sigmas, before, unabsorbed = [], 0, np.zeros((6, 9))
    for sample in np.flatnonzero(events & (FIX | OUTPUT)).tolist():
        elapsed = (sample - before) / imu.rate
        propagate(covariance, dynamics, force, elapsed, accelerometer, gyro, tuning.decay_rate, tuning.drive, work)
        if schedule.unaided[sample]:
            coast(
                covariance,
                unabsorbed,
                work[0],
                dynamics,
                elapsed,
                tuning.residual_accelerometer,
                tuning.residual_gyro,
            )
        before = sample
        for state, noise in enumerate(noises if events[sample] & FIX else ()):
            update(covariance, seen[state], 0.0, noise**2, np.zeros(states), work)
            unabsorbed[:] = 0.0
        if events[sample] & OUTPUT:
            sigmas.append(np.sqrt(np.diagonal(covariance)[:9]))
    return np.stack(sigmas)


def _straight(spec: SimulationSpec) -> TrajectorySpec:
    """Straight and level from where the study's flight starts."""
    start = plan(spec).outputs
    north, east, _ = (float(v) for v in start.velocity[0])
    latitude, longitude, height = (float(v) for v in start.position[0])
    flight = spec.trajectory
    if flight.kind == "file":
        flight = TrajectorySpec("straight", math.hypot(north, east), latitude, longitude, height)
        flight = replace(flight, heading=math.atan2(east, north))
    else:
        flight = replace(flight, kind="straight")
    try:
        plan_trajectory(flight, spec.duration)
    except ValueError:  # a file's flight that turns before the latitudes that its first heading would reach
        return spec.trajectory
    return flight


def departures(result: SimulationResult, links: Chain, settling_s: float = 60.0) -> list[Departure]:
    """Where filter or simulated errors differ from the closed form by more than 10 %.

    One finding per state and phase: each outage, `settling_s` seconds from the start and from each outage's end, the
    rest of the time with fixes before the next one; all just after the fix. Simulated errors count only if the
    difference of their rms over the phase is significant at 0.1 %. Empty where no closed form was given.
    """
    closed = result.closed_form_sigma
    if closed is None:
        return []
    believed, simulated = (sigma[POSTERIOR, :, :9] for sigma in (result.filter_sigma, result.rms))
    stops = sorted(stop for _, stop in result.spec.outages)
    stretch = np.searchsorted(stops, result.time_s - 0.5 / result.spec.imu.rate)
    young = result.time_s - np.array([0.0, *stops])[stretch] < settling_s
    phase_of = np.where(result.coast_s > 0.0, "coast", np.where(young, "settling", "aided"))
    phases = [(n, phase) for n in range(len(stops) + 1) for phase in ("settling", "aided", "coast")]
    low, high = (math.sqrt(bound) for bound in chi_square_band(float(result.spec.runs), 1.0 - _CHANCE))
    stretches = []
    for column, (group, axis, _unit) in enumerate(STATES):
        ratio = believed[:, column] / closed[:, column]
        for number, phase in phases:
            rows = np.flatnonzero((stretch == number) & (phase_of == phase))
            if len(rows) == 0:
                continue
            off = float(np.sqrt(np.mean((simulated[rows, column] / believed[rows, column]) ** 2)))
            by_chance = low <= off <= high
            apart = rows[np.abs(ratio[rows] - 1.0) > _TOLERANCE]
            if len(apart) == 0:
                if by_chance or abs(off * ratio[rows[-1]] - 1.0) <= _TOLERANCE:
                    continue
                apart = rows
                worst = rows[-1]
            else:
                worst = apart[np.argmax(np.abs(np.log(ratio[apart])))]
            curve = (closed, links.bare, links.fixes, links.settling, links.earth, links.flight, believed)
            factors = [float(after[worst, column] / before[worst, column]) for before, after in pairwise(curve)]
            steps = list(zip(CAUSES, (*factors, 1.0 if by_chance else off), strict=True))
            named = _that_matter(steps)
            stretches.append(
                Departure(
                    group,
                    axis,
                    phase,
                    number,
                    float(result.time_s[apart[0]]),
                    float(result.time_s[apart[-1]]),
                    float(ratio[worst]),
                    float(ratio[worst]) * off,
                    named,
                    in_words(named, result.spec),
                )
            )
    return stretches


def _that_matter(steps: list[tuple[str, float]]) -> tuple[tuple[str, float], ...]:
    largest = max(abs(math.log(factor)) for _, factor in steps)
    least = max(math.log1p(_LEAST_STEP), _LEAST_SHARE * largest)
    return tuple((key, factor) for key, factor in steps if abs(math.log(factor)) >= least)


def in_words(steps: tuple[tuple[str, float], ...], spec: SimulationSpec) -> str:
    """The steps as a sentence: each cause with its factor and its input in this study."""
    return "; ".join(f"{cause_in_words(key, spec)} (×{factor:.2f})" for key, factor in steps) or SMALL


def cause_in_words(key: str, spec: SimulationSpec) -> str:
    """A key of `CAUSES` in words, with its input in this study."""
    behind = {"filter": instruments_beside(spec), "errors": unmodelled(spec)}.get(key, [])
    return CAUSES[key] + (f": {', '.join(behind)}" if behind else "")


def instruments_beside(spec: SimulationSpec) -> list[str]:
    """Inputs that the filter models and the closed form does not."""
    gyro, accelerometer, tuning = spec.imu.gyro, spec.imu.accelerometer, spec.filter
    moving = gyro.biased or accelerometer.biased
    cases = (
        (
            tuning.inertial > 9 and moving,
            f"{tuning.states} states, {tuning.inertial - 9} of them biases, which the formula leaves out",
        ),
        (
            not tuning.slow and any(spec.gnss.axis_markov_noise),
            f"{tuning.states} states without the slow GNSS error, which the formula includes",
        ),
        (tuning.process_noise_scale != 1.0, f"process noise setting ×{tuning.process_noise_scale:g}"),
        (tuning.gnss_noise_scale != 1.0, f"fix noise setting ×{tuning.gnss_noise_scale:g}"),
        (spec.aiding.has_heading, "heading of two antennas"),
        (spec.aiding.has_height, "the barometer"),
        (spec.gnss.bank_limit is not None, "fixes lost in a bank"),
        (bool(spec.gnss.after_loss), "coarser fixes after a loss"),
    )
    return [words for holds, words in cases if holds]


def unmodelled(spec: SimulationSpec) -> list[str]:
    """Inputs that are simulated but not modelled by the filter, or modelled differently."""
    triads, tuning = (spec.imu.gyro, spec.imu.accelerometer), spec.filter
    biased = any(m.biased for m in triads)
    cases = (
        (tuning.inertial == 9 and biased, f"biases, which {tuning.states} states do not include"),
        (not tuning.slow and any(spec.gnss.axis_markov_noise), "the slow GNSS error"),
        (spec.gnss.lever_arm_error > 0.0, "the lever arm error"),
        (spec.gnss.time_offset > 0.0, "the time offset"),
        (spec.aiding.heading_slow_noise > 0.0, "the slow heading error"),
        (spec.aiding.barometer_slow_noise > 0.0, "the slow barometer error"),
        (spec.radar_time_offset > 0.0, "the radar's time offset"),
        (any(m.scale_factor for m in triads), "scale factor errors"),
        (any(m.misalignment for m in triads), "misalignment"),
        (spec.imu.gyro.g_sensitivity > 0.0, "g-sensitivity"),
        (any(m.quantization for m in triads), "quantization"),
        (tuning.process_noise_scale != 1.0 or tuning.gnss_noise_scale != 1.0, "mismatched tuning"),
    )
    return [words for holds, words in cases if holds]
