"""The simulator's errors as one linear model along a flight: transitions, noise, and what fixes measure. [P-13]

Between two nodes of the flight the transition comes from the simulator's `error_dynamics`; the states are those of
`states_of`.
"""

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nav_model.base.errors import InputError
from nav_model.budget.shares import GYRO_NOISE, SLOW_GNSS
from nav_model.earth.rotation import euler_error_map, skew
from nav_model.simulation.fixes import observe
from nav_model.simulation.kalman import error_dynamics
from nav_model.simulation.layout import (
    ATTITUDE,
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
from nav_model.simulation.schedule import assumed_noise, fix_noise, output_samples, samples_at_multiples
from nav_model.simulation.specification import SimulationSpec
from nav_model.simulation.trajectory import QuinticPath, plan_trajectory
from nav_model.simulation.truth import TruthStates, specific_force_and_rate, true_states
from nav_model.simulation.tuning import tuning_of
from nav_model.trajectory.residual import HEADING_DRIFT, residual_biases
from nav_model.trajectory.specification import CovarianceSpec
from nav_model.trajectory.states import G_SENSITIVITY, MEASURED_BY, RADAR_TIME, SLOW_AIDS, States, states_of

FloatArray = NDArray[np.float64]
_LARGEST_TURN = math.radians(3.0)  # of the body between two nodes
_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(3)  # exact for noise through the chain gyro -> position
_APERTURE_PARTS = {1: 5, 2: 7, 3: 9}  # steps in an aperture at least, by the order that autofocus removes
_ROUNDING = 1e-6  # s
_DENSEST = 0.02  # s between nodes, however short a correlation time
MOST_STEPS = 200_000
"""Steps of a flight unless fewer are allowed: a few minutes, and some 8 GB."""
_BLOCK = 512  # steps at a time, for memory


@dataclass(frozen=True, eq=False)
class ErrorModel:
    """The linear model of a flight with k nodes; n states, m of them the filter's, and s sources as in `States`.

    Attributes
    ----------
    time_s : array (k,)
        Times of the nodes.
    end_s : float
        Until when apertures may last.
    outputs : array of int
        Nodes of the results.
    before, after, middle : array (outputs,) of int
        Nodes of the states that a result's fix interval is judged by; the result's own where fixes are lost.
        `before`: node of the fix that ends the interval; `after`: of the fix that begins it;
        `middle`: where the smoothed state is taken.
    truth : TruthStates
        At the nodes.
    output_rows : array (outputs, 9, n)
        Position, velocity and roll, pitch, yaw as the radar takes them, of all states.
    rates : array (k, 9)
        Their change in a second.
    phi : array (k - 1, 9, n)
        Rows of the transition from node to node.
    decay_factor : array (k - 1, n - 9)
        That of each further state, which no other changes.
    factors : array (k - 1, drives, 12, 9)
        Their square is the covariance of what a process noise adds in a step to the first nine states and to the
        up to three that it drives, where those are further ones.
    filter_noise : array (k - 1, m, m)
        Process noise, as the filter assumes it.
    rows : array (k, r, n)
        Measurement of the fix at a node, zeros where there is none.
    variance, noise : array (k, r), array (k, measuring, r)
        Variances of the measurement: the filter's, and the true ones of the sources in `measuring`.
    measuring : array of int
        Sources of measurement noise.
    is_fix, of_position : array (k,) of bool
        True where there is a fix, and one that measures the position.
    """

    states: States
    time_s: FloatArray
    end_s: float
    outputs: NDArray[np.int64]
    before: NDArray[np.int64]
    after: NDArray[np.int64]
    middle: NDArray[np.int64]
    truth: TruthStates
    output_rows: FloatArray
    rates: FloatArray
    phi: FloatArray
    decay_factor: FloatArray
    factors: FloatArray
    filter_noise: FloatArray
    rows: FloatArray
    variance: FloatArray
    noise: FloatArray
    measuring: NDArray[np.int64]
    is_fix: NDArray[np.bool_]
    of_position: NDArray[np.bool_]


def error_model(spec: CovarianceSpec, most_steps: int = MOST_STEPS) -> ErrorModel:
    """The linear model of a flight of `most_steps` steps at most.

    Raises InputError where the flight cannot be flown, as `plan_trajectory`, or takes more steps.
    """
    study = spec.study
    trajectory = plan_trajectory(study.trajectory, study.duration, spec.flown_further)
    whole = replace(study, duration=study.duration + spec.flown_further)
    states = states_of(study, residual_biases(spec.inputs))
    scheduled = samples_at_multiples(study.gnss.interval, whole) / study.imu.rate
    wanted = output_samples(study) / study.imu.rate
    anchors = np.union1d(scheduled, wanted)
    if spec.smoothed_after > 0.0 and scheduled.size:
        inside = _last(scheduled, wanted) + spec.smoothed_after
        inside = inside[(inside < anchors[-1]) & (np.abs(inside - _last(anchors, inside)) > _ROUNDING)]
        anchors = np.union1d(anchors, inside)
    end = float(anchors[anchors <= study.duration + _ROUNDING][-1])
    time_s = _nodes(trajectory, states, anchors, spec, most_steps)
    outputs, truth = np.searchsorted(time_s, wanted - 1e-9), true_states(trajectory, time_s)
    parts = [
        steps_between(trajectory, time_s[first : first + _BLOCK + 1], states)
        for first in range(0, len(time_s) - 1, _BLOCK)
    ]
    phi, decay_factor, factors, filter_noise = (np.concatenate(part) for part in zip(*parts, strict=True))
    # Over a tenth of a second: of a spline in latitude and longitude, the velocity is what is at hand.
    speeding = (trajectory.velocity(time_s + 0.05) - trajectory.velocity(time_s - 0.05)) / 0.1
    rates = np.hstack([truth.velocity, speeding, trajectory.evaluate(time_s, 1)[:, 3:]])
    output_rows = np.tile(np.eye(BIASES, states.size), (len(outputs), 1, 1))
    output_rows[:, ATTITUDE:, ATTITUDE:BIASES] = euler_error_map(*truth.euler[outputs, 1:].T)
    if (place := states.first.get(RADAR_TIME)) is not None:
        output_rows[:, :, place] = rates[outputs]
    measured = measurements(study, states, trajectory, truth, rates, scheduled)
    before, after, middle = _moments(time_s, outputs, measured["is_fix"], study.gnss.interval, spec.smoothed_after)
    return ErrorModel(
        states=states,
        time_s=time_s,
        end_s=end,
        outputs=outputs,
        before=before,
        after=after,
        middle=middle,
        truth=truth,
        output_rows=output_rows,
        rates=rates,
        phi=phi,
        decay_factor=decay_factor,
        factors=factors,
        filter_noise=filter_noise,
        **measured,
    )


def _last(times: FloatArray, at: FloatArray) -> FloatArray:
    """The last of some `times` at or before each time."""
    return np.asarray(times[np.maximum(np.searchsorted(times, at + _ROUNDING) - 1, 0)])


def _moments(
    time_s: FloatArray, outputs: NDArray[np.int64], is_fix: NDArray[np.bool_], interval: float, smoothed_after: float
) -> tuple[NDArray[np.int64], ...]:
    """`before`, `after` and `middle` of `ErrorModel`."""
    fixes, now, longest = np.flatnonzero(is_fix), time_s[outputs], interval + _ROUNDING
    if not fixes.size:
        return outputs, outputs, outputs
    place = np.searchsorted(fixes, outputs)
    following = fixes[np.minimum(place, len(fixes) - 1)]
    soon = (following >= outputs) & (time_s[following] - now <= longest)
    before = np.where(soon, following, outputs)
    last = fixes[np.maximum(np.searchsorted(fixes, outputs, side="right") - 1, 0)]
    since = (last <= outputs) & (now - time_s[last] <= longest)
    after = np.where(since, last, outputs)
    at = time_s[after] + smoothed_after
    since &= at <= time_s[-1]
    return (
        before,
        after,
        np.where(since, np.searchsorted(time_s, np.minimum(at, time_s[-1]) - 2 * _ROUNDING), outputs),
    )


def steps_between(trajectory: QuinticPath, time_s: FloatArray, states: States) -> tuple[FloatArray, ...]:
    """`phi`, `decay_factor`, `factors` and `filter_noise` of the steps between nodes, as in `ErrorModel`."""
    steps, decay, m = np.diff(time_s), states.decay, states.estimated
    powers = _powers(_dynamics(trajectory, time_s, states), decay, steps)
    flows = [
        (_phi(powers, part), np.exp(-decay * part * steps[:, None]), np.sqrt(weight * steps)[:, None])
        for part, weight in zip(0.5 * (1.0 + _POINTS), 0.5 * _WEIGHTS, strict=True)
    ]

    def driven_by(first: int, density: float, count: int = 3) -> FloatArray:
        """Factor (k - 1, 12, 9) of white noise of this density on some states, three at most."""
        matrix = np.zeros((len(steps), BIASES + 3, 9))
        for n, (phi, decay_factor, root) in enumerate(flows):
            into = slice(3 * n, 3 * n + count)
            matrix[:, :BIASES, into] = phi[:, :, first : first + count] * root[:, None]
            if first >= BIASES:
                decayed = decay_factor[:, first - BIASES : first - BIASES + count] * root
                matrix[:, BIASES : BIASES + count, into] = decayed[:, None] * np.eye(count)
        matrix *= math.sqrt(density)
        return matrix

    filter_noise = np.zeros((len(steps), m, m))
    for first, density in states.assumed:
        into = np.array([*range(BIASES), *range(max(first, BIASES), max(first + 3, BIASES))])
        factor = driven_by(first, density)[:, : len(into)]
        filter_noise[:, into[:, None], into] += factor @ factor.swapaxes(1, 2)
    factors = np.stack([driven_by(error.first, error.drive, error.states) for error in states.drives], axis=1)
    return _phi(powers, 1.0), np.exp(-decay * steps[:, None]), factors, filter_noise


def _nodes(
    trajectory: QuinticPath, states: States, anchors: FloatArray, spec: CovarianceSpec, most: int
) -> FloatArray:
    """Times of the nodes: the anchors, and between them as many as turns, aperture and correlation times need."""
    times = [error.time / 5.0 for error in states.drives if error.time > 0.0]
    x = spec.inputs
    order = x.autofocus_order if x.residual is None else x.residual.order
    longest = max(min([1.0, float(x.aperture) / _APERTURE_PARTS[order], *times]), _DENSEST)
    grid = np.union1d(np.arange(0.0, anchors[-1], 0.25), anchors)
    rate = np.linalg.norm(trajectory.evaluate(grid, 1)[:, 3:], axis=1)
    at = np.searchsorted(grid, anchors)
    fastest = np.maximum(np.maximum.reduceat(rate, at)[:-1], rate[at[1:]])
    parts = np.ceil(np.diff(anchors) * np.maximum(1.0 / longest, fastest / _LARGEST_TURN) - 1e-9)
    counted = np.cumsum(np.insert(np.maximum(parts, 1.0), 0, 0.0))
    if counted[-1] > most:
        reason = f"the flight takes {counted[-1]:.0f} steps, at most {most}. Give a shorter one or fewer fixes."
        raise InputError("duration", reason)
    return np.interp(np.arange(counted[-1] + 1.0), counted, anchors)


def _dynamics(trajectory: QuinticPath, time_s: FloatArray, states: States) -> FloatArray:
    """The first nine rows of the dynamics (k - 1, 9, n) in the middle of each step, with its mean specific force."""
    middle = 0.5 * (time_s[1:] + time_s[:-1])
    now = true_states(trajectory, middle)
    sensed = specific_force_and_rate(trajectory, middle)
    ends = specific_force_and_rate(trajectory, time_s)[:, :3]
    in_navigation = np.einsum("kij,kj->ki", true_states(trajectory, time_s).matrix, ends)
    force = (in_navigation[1:] + in_navigation[:-1] + 4.0 * np.einsum("kij,kj->ki", now.matrix, sensed[:, :3])) / 6.0
    state, dynamics = np.zeros(STATE_LENGTH), np.empty((len(middle), BIASES, BIASES + TRIADS))
    for k in range(len(middle)):
        state[LATITUDE : HEIGHT + 1], state[VELOCITY : VELOCITY + 3] = now.position[k], now.velocity[k]
        error_dynamics(state, force[k], now.matrix[k], dynamics[k])
    extended = _of_all_states(dynamics, sensed, states)
    if (place := states.first.get(HEADING_DRIFT)) is not None:
        extended[:, ATTITUDE + 2, place] = 1.0
    return extended


def _of_all_states(rows: FloatArray, sensed: FloatArray, states: States) -> FloatArray:
    """Rows in all states (k, rows, n), of rows in position, velocity, attitude and one set of bias estimates (k,
    rows, 15), where the sensors measure `sensed` (k, 6).

    The true error of a sensor has the other sign, as an estimate is taken off.
    """
    extended = np.zeros((*rows.shape[:2], states.size))
    extended[:, :, :BIASES] = rows[:, :, :BIASES]
    for first in range(BIASES, states.inertial, TRIADS):
        extended[:, :, first : first + TRIADS] = rows[:, :, BIASES:]
    for name, at in (("accelerometer", 0), ("gyro", GYRO)):
        error = -rows[:, :, BIASES + at : BIASES + at + 3]
        by_axis = error[:, :, :, None] * sensed[:, None, None, at : at + 3]  # error of an axis by what another senses
        off = ~np.eye(3, dtype=np.bool_)
        effects = {
            f"{name} bias": error,
            f"{name} bias instability": error,
            f"{name} scale factor": np.einsum("kraa->kra", by_axis),
            f"{name} misalignment": by_axis[:, :, off],
        }
        if name == "gyro":
            effects[G_SENSITIVITY] = error * sensed[:, None, :GYRO]
        for group in effects.keys() & states.first.keys():
            first = states.first[group]
            extended[:, :, first : first + effects[group].shape[2]] = effects[group]
    return extended


def _powers(dynamics: FloatArray, decay: FloatArray, steps: FloatArray) -> list[FloatArray]:
    """The first nine rows of (F dt)^i / i!, i from 1 to 4."""
    whole = dynamics * steps[:, None, None]
    powers, rate = [whole], -decay * steps[:, None]
    for i in range(2, 5):
        last = powers[-1]
        new = last[:, :, :BIASES] @ whole / i
        new[:, :, BIASES:] += last[:, :, BIASES:] * rate[:, None, :] / i
        powers.append(new)
    return powers


def _phi(powers: list[FloatArray], part: float) -> FloatArray:
    """The first nine rows of the transition over this part of each step, (k - 1, 9, n)."""
    phi = np.asarray(sum(power * part**i for i, power in enumerate(powers, 1)))
    phi[:, range(BIASES), range(BIASES)] += 1.0
    return phi


def measurements(
    study: SimulationSpec,
    states: States,
    trajectory: QuinticPath,
    truth: TruthStates,
    rates: FloatArray,
    scheduled: FloatArray,
) -> dict[str, Any]:
    """Measurements of the fix at each node, in the fields of `ErrorModel`.

    Parameters
    ----------
    study : SimulationSpec
        Receiver and aids.
    states : States
        States of filter and truth.
    trajectory : QuinticPath
        The flight.
    truth : TruthStates
        At the nodes.
    rates : array (k, 9)
        Rates of the navigation states.
    scheduled : array
        Times of the fixes, s.
    """
    gnss, k, sources = study.gnss, len(truth.time_s), states.sources[: states.noisy]
    at = np.searchsorted(truth.time_s, scheduled - 1e-9)
    sigma = np.full((k, MEASURED), np.inf)
    sigma[at] = fix_noise(study, truth.at(at))
    there = np.isfinite(sigma)
    arm, lever, swing = np.array(gnss.lever_arm), np.zeros((k, 3)), np.empty(3)
    h = np.zeros((k, MEASURED, BIASES + TRIADS))
    for node in np.flatnonzero(there.any(axis=1)):
        observe(truth.matrix[node], arm, truth.body_rate[node], lever[node], swing, h[node])
    rows = _of_all_states(h, specific_force_and_rate(trajectory, truth.time_s), states)
    position, velocity = slice(POSITION, POSITION + 3), slice(VELOCITY, VELOCITY + 3)
    if (place := states.first.get(SLOW_GNSS)) is not None:
        sizes = np.diag(gnss.axis_markov_noise)
        rows[:, position, place : place + 3] = -sizes
        if states.estimated > states.inertial:
            rows[:, position, states.inertial : states.estimated] = sizes
    for source, measured in SLOW_AIDS.items():
        if (place := states.first.get(source)) is not None:
            rows[:, measured, place] = -1.0
    if (place := states.first.get("lever arm error")) is not None:
        rows[:, position, place : place + 3] = truth.matrix
        rows[:, velocity, place : place + 3] = truth.matrix @ skew(truth.body_rate)
    if (place := states.first.get("time offset")) is not None:
        rows[:, :HEADING, place], rows[:, HEADING, place] = rates[:, :ATTITUDE], rates[:, ATTITUDE + 2]
    noise = np.zeros((k, len(sources), MEASURED))
    for source, part in MEASURED_BY.items():
        if source in sources:
            noise[:, sources.index(source), part] = np.where(there, sigma, 0.0)[:, part] ** 2
    swung = (np.sum(arm**2) - lever**2) * study.imu.rate  # by the gyros' noise of one sample
    if GYRO_NOISE in sources:
        density = study.imu.gyro.random_walk * study.imu.vibration_factor
        noise[:, sources.index(GYRO_NOISE), velocity] = np.where(there[:, velocity], swung, 0.0) * density**2
    variance = assumed_noise(study, sigma) ** 2
    variance[:, velocity] += swung * tuning_of(study).gyro_density ** 2
    used, measuring = there.any(axis=0), np.flatnonzero(noise.any(axis=(0, 2)))
    return {
        "rows": (rows * there[:, :, None])[:, used],
        "variance": np.where(there, variance, 1.0)[:, used],  # without effect where nothing is measured
        "noise": noise[:, measuring][:, :, used],
        "measuring": measuring,
        "is_fix": there.any(axis=1),
        "of_position": there[:, POSITION],
    }
