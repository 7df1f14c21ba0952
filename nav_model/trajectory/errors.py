"""The simulator's errors as one linear model along a flight. [P-13]

The state is what the filter estimates (errors of position, velocity and attitude, and its bias estimates), then what
is really there: biases, scale factors, misalignments, the slow GNSS error, lever arm error, time offset. The filter's
gains act on the first part; the second is considered. Between two nodes of the flight the transition comes from the
simulator's `error_dynamics`. A source that is zero has no state and no noise.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.budget.shares import ACCELEROMETER_NOISE, GNSS_NOISE, GNSS_VELOCITY, GYRO_NOISE
from nav_model.earth.rotation import euler_error_map
from nav_model.simulation.fixes import observe
from nav_model.simulation.kalman import error_dynamics
from nav_model.simulation.layout import (
    ATTITUDE,
    BAROMETER,
    BIASES,
    GYRO,
    HEADING,
    HEIGHT,
    LATITUDE,
    MEASURED,
    POSITION,
    STATE_LENGTH,
    TRIADS,
    VELOCITY,
)
from nav_model.simulation.schedule import fix_noise, output_samples, samples_at_multiples
from nav_model.simulation.single_run import believed_sigma, initial_sigma, tuning_of
from nav_model.simulation.specification import SimulationSpec, TriadModel
from nav_model.simulation.trajectory import Trajectory, plan_trajectory
from nav_model.simulation.truth import TruthStates, specific_force_and_rate, true_states
from nav_model.trajectory.specification import CovarianceSpec

FloatArray = NDArray[np.float64]
_LARGEST_TURN = math.radians(3.0)  # of the body between two nodes
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(3)  # exact for noise through the chain gyro -> position
_APERTURE_PARTS = 5  # nodes in an aperture at least
_DENSEST = 0.02  # s between nodes, however short a correlation time
_BLOCK = 512  # steps at a time, for memory


@dataclass(frozen=True, eq=False)
class ErrorModel:
    """The linear model of a flight with k nodes, n states of which the filter has the first m, s sources.

    Sources with noise come first, `noisy` of them, then those that are constant through a flight; so do the states:
    noise moves the first `moving` ones. time_s (k); outputs: nodes of the results. top (k - 1, 9, n): rows of the
    transition from node to node, and kept (k - 1, n - 9) what is left of each further state, which none changes.
    driven: the sources with process noise; factors (k - 1, driven, 12, 9), whose square is the covariance of what one
    adds in a step to the first nine states and to three further ones from `own` on, 0 where it has none. late (k, 9):
    what position, velocity and roll, pitch, yaw change in a second; `radar` is the state that is the radar's time
    offset, None where there is none. filter_noise
    (k - 1, m, m): as the filter assumes it. initial (s, n): variances at time 0 by source; filter_start (m, m). rows
    (k, r, n): what the fix at a node measures, zeros where there is none, with the filter's variance (k, r) and
    the true ones by source (k, noisy, r).
    """

    time_s: FloatArray
    outputs: NDArray[np.int64]
    truth: TruthStates
    error_map: FloatArray
    late: FloatArray
    radar: int | None
    states: int
    moving: int
    sources: tuple[str, ...]
    noisy: int
    driven: tuple[int, ...]
    top: FloatArray
    kept: FloatArray
    factors: FloatArray
    own: tuple[int, ...]
    filter_noise: FloatArray
    initial: FloatArray
    filter_start: FloatArray
    rows: FloatArray
    variance: FloatArray
    noise: FloatArray
    is_fix: NDArray[np.bool_]


class _Error(NamedTuple):
    """What one source does to as many `states` from `first` on: sigma at the start, density that drives them
    [unit²/s], correlation time [s]; zero for none."""

    source: str
    first: int
    states: int
    sigma: float = 0.0
    drive: float = 0.0
    time: float = 0.0


class _Layout(NamedTuple):
    """All errors, the considered states among them by the first index of each group; how many states there are, and
    how many of them noise moves, which come first."""

    errors: tuple[_Error, ...]
    first: Mapping[str, int]
    size: int
    moving: int


def _layout(study: SimulationSpec) -> _Layout:
    gnss, start, vibration = study.gnss, initial_sigma(study), study.imu.vibration_factor
    triads = (("accelerometer", study.imu.accelerometer), ("gyro", study.imu.gyro))
    white = ((ACCELEROMETER_NOISE, VELOCITY), (GYRO_NOISE, ATTITUDE))
    errors = [
        _Error(source, state, 3, drive=(model.random_walk * vibration) ** 2)
        for (source, state), (_, model) in zip(white, triads, strict=True)
    ]
    first: dict[str, int] = {}
    size = study.filter.states

    def add(group: str, source: str, count: int, sigma: float, drive: float = 0.0, time: float = 0.0) -> None:
        nonlocal size
        if sigma > 0.0 or drive > 0.0:
            if group not in first:
                first[group] = size
                size += count
            errors.append(_Error(source, first[group], count, sigma, drive, time))

    for name, model in triads:
        add(f"{name} bias", f"{name} bias random walk", 3, 0.0, model.rate_random_walk**2)
        drive = 2.0 * model.bias_instability**2 / model.correlation_time
        source = f"{name} bias instability"
        add(source, source, 3, model.bias_instability, drive, model.correlation_time)
    if gnss.markov_noise > 0.0 or gnss.vertical_markov_noise > 0.0:
        slow = "slow GNSS error"
        add(slow, slow, 3, 1.0, 2.0 / gnss.markov_time, gnss.markov_time)  # its size is in what a fix measures
    moving = size
    constant = [("lever arm error", 3, gnss.lever_arm_error), ("time offset", 1, gnss.time_offset)]
    constant += [("radar time offset", 1, study.radar_time_offset)]
    for name, model in triads:
        constant += [(f"{name} bias", 3, model.turn_on_bias), (f"{name} scale factor", 3, model.scale_factor)]
        constant += [(f"{name} misalignment", 6, model.misalignment)]
    for name, count, sigma in constant:
        add(name, name, count, sigma)
    names = [*["initial position and velocity"] * 6, *["initial tilt"] * 2, "initial heading"]
    errors += [_Error(name, state, 1, float(start[state])) for state, name in enumerate(names)]
    return _Layout(tuple(errors), first, size, moving)


def error_model(spec: CovarianceSpec) -> ErrorModel:
    """The linear model of a flight.

    Raises InputError where the flight cannot be flown, as `plan_trajectory`.
    """
    study = spec.study
    trajectory, layout = plan_trajectory(study.trajectory, study.duration), _layout(study)
    scheduled = samples_at_multiples(study.gnss.interval, study) / study.imu.rate
    outputs = output_samples(study) / study.imu.rate
    time_s = _nodes(trajectory, study, np.union1d(scheduled, outputs), spec)
    truth = true_states(trajectory, time_s)
    driving = [error for error in layout.errors if error.drive > 0.0]
    sources, noisy = _sources(study, layout, [error.source for error in driving])
    tuning, m = tuning_of(study), study.filter.states
    decay = np.zeros(layout.size)
    decay[BIASES:m] = tuning.decay_rate[: m - BIASES]
    initial = np.zeros((len(sources), layout.size))
    for error in layout.errors:
        states = slice(error.first, error.first + error.states)
        if error.time > 0.0:
            decay[states] = 1.0 / error.time
        if error.sigma > 0.0:
            initial[sources.index(error.source), states] += error.sigma**2
    drives = [(error.first, error.drive) for error in driving]
    assumed = [(VELOCITY, tuning.accelerometer_density**2), (ATTITUDE, tuning.gyro_density**2)]
    assumed += [(first, tuning.bias_drive[first - BIASES]) for first in range(BIASES, m, 3)]
    assumed = [each for each in assumed if each[1] > 0.0]
    parts = [
        _steps(trajectory, time_s[first : first + _BLOCK + 1], layout, study, decay, drives, assumed)
        for first in range(0, len(time_s) - 1, _BLOCK)
    ]
    top, kept, factors, filter_noise = (np.concatenate(part) for part in zip(*parts, strict=True))
    # Over a tenth of a second: of a spline in latitude and longitude, the velocity is what is at hand.
    speeding = (trajectory.velocity(time_s + 0.05) - trajectory.velocity(time_s - 0.05)) / 0.1
    late = np.hstack([truth.velocity, speeding, trajectory.evaluate(time_s, 1)[:, 3:]])
    measured = _measurements(study, layout, trajectory, truth, late, scheduled, sources[:noisy])
    return ErrorModel(
        time_s=time_s,
        outputs=np.searchsorted(time_s, outputs - 1e-9),
        truth=truth,
        error_map=euler_error_map(truth.euler[:, 1], truth.euler[:, 2]),
        late=late,
        radar=layout.first.get("radar time offset"),
        states=m,
        moving=layout.moving,
        sources=sources,
        noisy=noisy,
        driven=tuple(sources.index(error.source) for error in driving),
        top=top,
        kept=kept,
        factors=factors,
        own=tuple(first if first >= BIASES else 0 for first, _ in drives),
        filter_noise=filter_noise,
        initial=initial,
        filter_start=np.diag(believed_sigma(study) ** 2),
        **measured,
    )


def _steps(
    trajectory: Trajectory,
    time_s: FloatArray,
    layout: _Layout,
    study: SimulationSpec,
    decay: FloatArray,
    drives: list[tuple[int, float]],
    assumed: list[tuple[int, float]],
) -> tuple[FloatArray, ...]:
    """`top`, `kept`, `factors` and `filter_noise` of the steps between some nodes, in the fields of `ErrorModel`.

    drives: first state and density [unit²/s] of the noises that there are; assumed: of those that the filter assumes.
    """
    steps, m = np.diff(time_s), study.filter.states
    powers = _powers(_dynamics(trajectory, time_s, layout, study), decay, steps)
    inner = [(0.5 * (1.0 + x), 0.5 * w * steps) for x, w in zip(_POINTS, _WEIGHTS, strict=True)]
    flows = [(_top(powers, part), _kept(decay, part * steps), np.sqrt(w)[:, None, None]) for part, w in inner]

    def driven_by(first: int, density: float) -> FloatArray:
        """Factor (k - 1, 12, 9) of white noise of this density on three states."""
        found = np.zeros((len(steps), BIASES + 3, 9))
        for n, (top, kept, root) in enumerate(flows):
            into = slice(3 * n, 3 * n + 3)
            found[:, :BIASES, into] = top[:, :, first : first + 3] * root
            if first >= BIASES:
                for i in range(3):
                    found[:, BIASES + i, 3 * n + i] = kept[:, first - BIASES + i] * root[:, 0, 0]
        found *= math.sqrt(density)
        return found

    filter_noise = np.zeros((len(steps), m, m))
    for first, density in assumed:
        into = np.array([*range(BIASES), *range(max(first, BIASES), max(first + 3, BIASES))])
        factor = driven_by(first, density)[:, : len(into)]
        filter_noise[:, into[:, None], into] += factor @ factor.swapaxes(1, 2)
    factors = np.stack([driven_by(*drive) for drive in drives], axis=1)
    return _top(powers, 1.0), _kept(decay, steps), factors, filter_noise


def _sources(study: SimulationSpec, layout: _Layout, driving: list[str]) -> tuple[tuple[str, ...], int]:
    """The sources that are not zero, and how many of them have noise, which come first: white, then `driving`."""
    measured = {
        GNSS_NOISE: study.gnss.position_noise,
        GNSS_VELOCITY: study.gnss.velocity_noise,
        "heading aiding": study.aiding.heading_noise,
        "barometer": study.aiding.barometer_noise,
    }
    white = [source for source in (ACCELEROMETER_NOISE, GYRO_NOISE) if source in driving]
    noisy = dict.fromkeys([*white, *(source for source, sigma in measured.items() if sigma), *driving])
    starting = (error.source for error in layout.errors if error.sigma > 0.0)
    return tuple(dict.fromkeys([*noisy, *starting])), len(noisy)


def _nodes(trajectory: Trajectory, study: SimulationSpec, anchors: FloatArray, spec: CovarianceSpec) -> FloatArray:
    """Times of the nodes: the anchors, and between them as many as turns, aperture and correlation times need."""
    triads: tuple[TriadModel, ...] = (study.imu.accelerometer, study.imu.gyro)
    times = [model.correlation_time / 5.0 for model in triads if model.bias_instability > 0.0]
    times += [spec.aperture.duration / _APERTURE_PARTS] if spec.aperture else []
    longest = max(min([1.0, *times]), _DENSEST)
    grid = np.union1d(np.arange(0.0, study.duration, 0.25), anchors)
    rate = np.linalg.norm(trajectory.evaluate(grid, 1)[:, 3:], axis=1)
    found = [anchors[:1]]
    for before, after in pairwise(anchors.tolist()):
        inside = slice(np.searchsorted(grid, before), np.searchsorted(grid, after) + 1)
        parts = math.ceil((after - before) * max(1.0 / longest, float(rate[inside].max()) / _LARGEST_TURN) - 1e-9)
        found.append(np.linspace(before, after, max(parts, 1) + 1)[1:])
    return np.concatenate(found)


def _dynamics(trajectory: Trajectory, time_s: FloatArray, layout: _Layout, study: SimulationSpec) -> FloatArray:
    """The first nine rows of the dynamics (k - 1, 9, n) in the middle of each step, with its mean specific force."""
    middle = 0.5 * (time_s[1:] + time_s[:-1])
    now = true_states(trajectory, middle)
    sensed = specific_force_and_rate(trajectory, middle)
    ends = specific_force_and_rate(trajectory, time_s)[:, :3]
    turned = np.einsum("kij,kj->ki", true_states(trajectory, time_s).matrix, ends)
    force = (turned[1:] + turned[:-1] + 4.0 * np.einsum("kij,kj->ki", now.matrix, sensed[:, :3])) / 6.0
    state, found = np.zeros(STATE_LENGTH), np.empty((len(middle), BIASES, BIASES + TRIADS))
    for k in range(len(middle)):
        state[LATITUDE : HEIGHT + 1], state[VELOCITY : VELOCITY + 3] = now.position[k], now.velocity[k]
        error_dynamics(state, force[k], now.matrix[k], found[k])
    return _of_all_states(found, sensed, study.filter.states, layout)


def _of_all_states(own: FloatArray, sensed: FloatArray, states: int, layout: _Layout) -> FloatArray:
    """Rows in all states (k, rows, n), of rows in position, velocity, attitude and one set of bias estimates (k,
    rows, 15), where the sensors measure `sensed` (k, 6).

    The true error of a sensor has the other sign, as an estimate is taken off.
    """
    found = np.zeros((*own.shape[:2], layout.size))
    found[:, :, :BIASES] = own[:, :, :BIASES]
    for first in range(BIASES, states, TRIADS):
        found[:, :, first : first + TRIADS] = own[:, :, BIASES:]
    for name, at in (("accelerometer", 0), ("gyro", GYRO)):
        error = -own[:, :, BIASES + at : BIASES + at + 3]
        by_axis = error[:, :, :, None] * sensed[:, None, None, at : at + 3]  # error of an axis by what another senses
        off = ~np.eye(3, dtype=np.bool_)
        effects = {
            f"{name} bias": error,
            f"{name} bias instability": error,
            f"{name} scale factor": np.einsum("kraa->kra", by_axis),
            f"{name} misalignment": by_axis[:, :, off],
        }
        for group in effects.keys() & layout.first.keys():
            first = layout.first[group]
            found[:, :, first : first + effects[group].shape[2]] = effects[group]
    return found


def _powers(dynamics: FloatArray, decay: FloatArray, steps: FloatArray) -> list[FloatArray]:
    """The first nine rows of (F dt)^i / i!, i from 1 to 4."""
    whole = dynamics * steps[:, None, None]
    found, rate = [whole], -decay[BIASES:] * steps[:, None]
    for i in range(2, 5):
        last = found[-1]
        new = last[:, :, :BIASES] @ whole / i
        new[:, :, BIASES:] += last[:, :, BIASES:] * rate[:, None, :] / i
        found.append(new)
    return found


def _top(powers: list[FloatArray], part: float) -> FloatArray:
    """The first nine rows of the transition over this part of each step, (k - 1, 9, n)."""
    found = np.asarray(sum(power * part**i for i, power in enumerate(powers, 1)))
    found[:, range(BIASES), range(BIASES)] += 1.0
    return found


def _kept(decay: FloatArray, times: FloatArray) -> FloatArray:
    return np.asarray(np.exp(-decay[BIASES:] * times[:, None]))


def _measurements(
    study: SimulationSpec,
    layout: _Layout,
    trajectory: Trajectory,
    truth: TruthStates,
    late: FloatArray,
    scheduled: FloatArray,
    sources: tuple[str, ...],
) -> dict[str, Any]:
    """What the fix at each node measures, in the fields of `ErrorModel`."""
    gnss, k = study.gnss, len(truth.time_s)
    at = np.searchsorted(truth.time_s, scheduled - 1e-9)
    sigma = np.full((k, MEASURED), np.inf)
    sigma[at] = fix_noise(study, truth.at(at))
    there = np.isfinite(sigma)
    arm, lever, swing = np.array(gnss.lever_arm), np.zeros((k, 3)), np.empty(3)
    own = np.zeros((k, MEASURED, BIASES + TRIADS))
    for node in np.flatnonzero(there.any(axis=1)):
        observe(truth.matrix[node], arm, truth.body_rate[node], lever[node], swing, own[node])
    rows = _of_all_states(own, specific_force_and_rate(trajectory, truth.time_s), study.filter.states, layout)
    position, velocity = slice(POSITION, POSITION + 3), slice(VELOCITY, VELOCITY + 3)
    if (place := layout.first.get("slow GNSS error")) is not None:
        sizes = [gnss.markov_noise, gnss.markov_noise, gnss.vertical_markov_noise]
        rows[:, position, place : place + 3] = -np.diag(sizes)
    if (place := layout.first.get("lever arm error")) is not None:
        rows[:, position, place : place + 3] = truth.matrix
        rows[:, velocity, place : place + 3] = truth.matrix @ _cross(truth.body_rate)
    if (place := layout.first.get("time offset")) is not None:
        rows[:, :HEADING, place], rows[:, HEADING, place] = late[:, :ATTITUDE], late[:, ATTITUDE + 2]
    noise = np.zeros((k, len(sources), MEASURED))
    for source, part in (
        (GNSS_NOISE, position),
        (GNSS_VELOCITY, velocity),
        ("heading aiding", HEADING),
        ("barometer", BAROMETER),
    ):
        if source in sources:
            noise[:, sources.index(source), part] = np.where(there, sigma, 0.0)[:, part] ** 2
    swung = (np.sum(arm**2) - lever**2) * study.imu.rate  # by the gyros' noise of one sample
    if GYRO_NOISE in sources:
        density = study.imu.gyro.random_walk * study.imu.vibration_factor
        noise[:, sources.index(GYRO_NOISE), velocity] = np.where(there[:, velocity], swung, 0.0) * density**2
    variance = (sigma * study.filter.gnss_noise_scale) ** 2
    variance[:, velocity] += swung * tuning_of(study).gyro_density ** 2
    used = there.any(axis=0)
    return {
        "rows": (rows * there[:, :, None])[:, used],
        "variance": np.where(there, variance, 1.0)[:, used],  # without effect where nothing is measured
        "noise": noise[:, :, used],
        "is_fix": there.any(axis=1),
    }


def _cross(vector: FloatArray) -> FloatArray:
    """[v x] of vectors (..., 3)."""
    found = np.zeros((*vector.shape, 3))
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        found[..., i, j], found[..., i, k] = -vector[..., k], vector[..., j]
    return found
