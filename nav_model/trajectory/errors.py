"""The simulator's errors as one linear model along a flight. [P-13]

The state is what the filter estimates (errors of position, velocity and attitude, and its bias estimates), then what
is really there: biases, scale factors, misalignments, the slow GNSS error, lever arm error, time offset. The filter's
gains act on the first part; the second is considered. Between two nodes of the flight the transition comes from the
simulator's `error_dynamics`. A source that is zero has no state and no noise.
"""

import math
from dataclasses import dataclass, field
from itertools import pairwise
from typing import Any

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
    (k, r, n): what the fix at a node measures, zeros where there is none, with the filter's variance (k, r), infinite
    where there is none, and the true ones by source (k, noisy, r).
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


@dataclass
class _Layout:
    """Considered states as they are laid out: name of the group -> first index, and who starts and drives them."""

    size: int
    moving: int = 0
    first: dict[str, int] = field(default_factory=dict)
    start: list[tuple[str, int, int, float]] = field(default_factory=list)
    drive: list[tuple[str, int, float]] = field(default_factory=list)
    decay: dict[int, float] = field(default_factory=dict)

    def add(self, name: str, source: str, count: int, sigma: float, drive: float = 0.0, time: float = 0.0) -> None:
        """`count` states of this sigma, driven by a density [unit²/s], with a correlation time if it is not zero."""
        first = self.first.setdefault(name, self.size)
        if first == self.size:
            self.size += count
        self.start.append((source, first, count, sigma))
        if drive > 0.0:
            self.drive.append((source, first, drive))
        if time > 0.0:
            self.decay.update({first + i: 1.0 / time for i in range(count)})


def _layout(spec: CovarianceSpec) -> _Layout:
    study, gnss = spec.study, spec.study.gnss
    found = _Layout(study.filter.states)
    triads = (("accelerometer", study.imu.accelerometer), ("gyro", study.imu.gyro))
    for name, model in triads:
        if model.rate_random_walk > 0.0:
            found.add(f"{name} bias", f"{name} bias random walk", 3, 0.0, model.rate_random_walk**2)
        if model.bias_instability > 0.0:
            drive = 2.0 * model.bias_instability**2 / model.correlation_time
            source = f"{name} bias instability"
            found.add(source, source, 3, model.bias_instability, drive, model.correlation_time)
    if gnss.markov_noise > 0.0 or gnss.vertical_markov_noise > 0.0:
        slow = "slow GNSS error"
        found.add(slow, slow, 3, 1.0, 2.0 / gnss.markov_time, gnss.markov_time)  # its size is in what a fix measures
    found.moving = found.size
    constant = [("lever arm error", 3, gnss.lever_arm_error), ("time offset", 1, gnss.time_offset)]
    constant += [("radar time offset", 1, study.radar_time_offset)]
    for name, model in triads:
        constant += [(f"{name} bias", 3, model.turn_on_bias), (f"{name} scale factor", 3, model.scale_factor)]
        constant += [(f"{name} misalignment", 6, model.misalignment)]
    for name, count, sigma in constant:
        if sigma > 0.0:
            found.add(name, name, count, sigma)
    return found


def error_model(spec: CovarianceSpec) -> ErrorModel:
    """The linear model of a flight.

    Raises InputError where the flight cannot be flown, as `plan_trajectory`.
    """
    study = spec.study
    trajectory, layout = plan_trajectory(study.trajectory, study.duration), _layout(spec)
    scheduled = samples_at_multiples(study.gnss.interval, study) / study.imu.rate
    outputs = output_samples(study) / study.imu.rate
    time_s = _nodes(trajectory, study, np.union1d(scheduled, outputs), spec)
    truth = true_states(trajectory, time_s)
    sources, noisy = _sources(spec, layout)
    tuning = tuning_of(study)
    n, m = layout.size, study.filter.states
    decay = np.zeros(n)
    decay[BIASES:m] = tuning.decay_rate[: m - BIASES]
    for index, rate in layout.decay.items():
        decay[index] = rate
    vibration = study.imu.vibration_factor**2
    drives = [
        (ACCELEROMETER_NOISE, VELOCITY, study.imu.accelerometer.random_walk**2 * vibration),
        (GYRO_NOISE, ATTITUDE, study.imu.gyro.random_walk**2 * vibration),
        *layout.drive,
    ]
    drives = [drive for drive in drives if drive[2] > 0.0]
    assumed = [(VELOCITY, tuning.accelerometer_density**2), (ATTITUDE, tuning.gyro_density**2)]
    assumed += [(first, tuning.bias_drive[first - BIASES]) for first in range(BIASES, m, 3)]
    densities = [[(first, density) for _, first, density in drives], [each for each in assumed if each[1] > 0.0]]
    parts = [
        _steps(trajectory, time_s[first : first + _BLOCK + 1], layout, study, decay, *densities)
        for first in range(0, len(time_s) - 1, _BLOCK)
    ]
    top, kept, factors, filter_noise = (np.concatenate(part) for part in zip(*parts, strict=True))
    start = initial_sigma(study)
    initial = np.zeros((len(sources), n))
    begins = [("initial position and velocity", 0, start[:6]), ("initial tilt", 6, start[6:8])]
    begins += [("initial heading", 8, start[8:9])]
    for source, first, count, sigma in layout.start:
        begins.append((source, first, np.full(count, sigma)))
    for source, first, sigmas in begins:
        initial[sources.index(source), first : first + len(sigmas)] += sigmas**2
    # Over a tenth of a second: of a spline in latitude and longitude, the velocity is what is at hand.
    speeding = (trajectory.velocity(time_s + 0.05) - trajectory.velocity(time_s - 0.05)) / 0.1
    late = np.hstack([truth.velocity, speeding, trajectory.evaluate(time_s, 1)[:, 3:]])
    measured = _measurements(spec, layout, trajectory, truth, late, scheduled, sources[:noisy])
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
        driven=tuple(sources.index(source) for source, _, _ in drives),
        top=top,
        kept=kept,
        factors=factors,
        own=tuple(first if first >= BIASES else 0 for _, first, _ in drives),
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


def _sources(spec: CovarianceSpec, layout: _Layout) -> tuple[tuple[str, ...], int]:
    """The sources that are not zero, and how many of them have noise, which come first."""
    imu, gnss, aiding = spec.study.imu, spec.study.gnss, spec.study.aiding
    white = {
        ACCELEROMETER_NOISE: imu.accelerometer.random_walk,
        GYRO_NOISE: imu.gyro.random_walk,
        GNSS_NOISE: gnss.position_noise,
        GNSS_VELOCITY: gnss.velocity_noise,
        "heading aiding": aiding.heading_noise,
        "barometer": aiding.barometer_noise,
    }
    noisy = [name for name, value in white.items() if value] + [source for source, _, _ in layout.drive]
    starts = ("initial position and velocity", "initial tilt", "initial heading")
    constant = [source for source, *_ in layout.start if source not in noisy]
    return (*noisy, *constant, *starts), len(noisy)


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
    spec: CovarianceSpec,
    layout: _Layout,
    trajectory: Trajectory,
    truth: TruthStates,
    late: FloatArray,
    scheduled: FloatArray,
    sources: tuple[str, ...],
) -> dict[str, Any]:
    """What the fix at each node measures, in the fields of `ErrorModel`."""
    study, gnss, k = spec.study, spec.study.gnss, len(truth.time_s)
    at = np.searchsorted(truth.time_s, scheduled - 1e-9)
    sigma = np.full((k, MEASURED), np.inf)
    sigma[at] = fix_noise(study, TruthStates(*(values[at] for values in vars(truth).values())))
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
        "variance": variance[:, used],
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
