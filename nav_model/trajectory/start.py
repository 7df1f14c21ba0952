"""Where a flight begins: a filter that has settled on a straight leg, with its covariance, correlations included, and
with what has become of the errors that it does not know."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from nav_model.budget.shares import SLOW_GNSS
from nav_model.simulation.layout import ATTITUDE, BIASES, TRIADS, VELOCITY
from nav_model.simulation.specification import SimulationSpec, TrajectorySpec
from nav_model.simulation.trajectory import QuinticPath, plan_trajectory
from nav_model.simulation.truth import TruthStates, true_states
from nav_model.trajectory.errors import measurements, steps_between
from nav_model.trajectory.residual import HEADING_DRIFT
from nav_model.trajectory.states import States

FloatArray = NDArray[np.float64]
_YAW = ATTITUDE + 2
# Position [m], velocity [m/s] and tilt [rad] where the leg begins: no knowledge that would tell tilt from bias, or
# position from a slow error of the fixes.
_UNKNOWN = np.repeat([1000.0, 10.0, 0.1], (3, 3, 2))
_LEAST_DOUBLINGS, _MOST_DOUBLINGS = 6, 18  # of the leg's length, from one fix on
_STEPS_IN_TIME = 5  # steps in a correlation time, at least
_SETTLED = 0.003  # relative change of variances while the leg's length doubles


def settled_start(study: SimulationSpec, states: States, start: TruthStates) -> States:
    """The states of a flight at `start` (of one time), whose filter has settled on a straight level leg up to there.

    Where nothing measures the heading, no straight leg shows it: it takes no part and is the study's initial one. Of
    an error that the filter knows, what is not yet estimated has the correlation with the others that it got on the
    leg: tilt with an accelerometer bias above all, whose sum is all that fixes show there. An error that the filter
    does not know begins with what the leg has made of it.
    """
    (north, east, _), (latitude, longitude, height) = start.velocity[0].tolist(), start.position[0].tolist()
    speed, interval, m = max(math.hypot(north, east), 0.1), study.gnss.interval, states.estimated
    flight = TrajectorySpec("straight", speed, latitude, longitude, height, heading=math.atan2(east, north))
    level = replace(study, outages=(), gnss=replace(study.gnss, after_loss=(), bank_limit=None))
    trajectory, time_s = plan_trajectory(flight, interval), np.array([0.0, interval])
    truth = true_states(trajectory, time_s)
    rates = np.hstack([truth.velocity, np.zeros((2, BIASES - 3))])
    fixed = measurements(level, states, trajectory, truth, rates, time_s[1:])
    h, r = fixed["rows"][1], np.diag(fixed["variance"][1])
    heading_free = not study.aiding.has_heading
    processes = _unknown_processes(states)
    step, noises = _between_fixes(trajectory, interval, states, processes, heading_free=heading_free)
    unsettled = states.believed.copy()
    unsettled[:_YAW] = unsettled[:, :_YAW] = 0.0
    unsettled[:_YAW, :_YAW] = np.diag(_UNKNOWN) ** 2
    if heading_free:
        unsettled[_YAW] = unsettled[:, _YAW] = 0.0

    # A step and its fix take a covariance P to A (1 + P J)⁻¹ P A' + C; two such legs make one of twice the length.
    # Beside the filter's states, A and J have the errors that it does not know.
    identity, noise = np.eye(states.size), noises[0]
    inverse = np.linalg.inv(h @ noise @ h.T + r)
    update = identity - noise @ h.T @ inverse @ h
    a, c, j = update @ step, update @ noise, step.T @ h.T @ inverse @ h @ step
    # Fixes show position, velocity, and the sum of tilt and bias as a horizontal acceleration. Tilt alone they do
    # not: in hours, the Earth's rotation would tell it from bias.
    observed = np.eye(BIASES, m)
    observed[ATTITUDE:_YAW] = (step - identity)[VELOCITY : VELOCITY + 2, :m]
    before = np.full(BIASES, np.inf)
    for doublings in range(1, _MOST_DOUBLINGS + 1):
        through = a @ np.linalg.inv(identity + c @ j)
        a, c, j = through @ a, through @ c @ a.T + c, a.T @ j @ np.linalg.solve(identity + c @ j, a) + j
        settling = a[:m, :m] @ np.linalg.solve(np.eye(m) + unsettled @ j[:m, :m], unsettled)
        p = settling @ a[:m, :m].T + c[:m, :m]
        now = ((observed @ p) * observed).sum(axis=1)
        if doublings >= _LEAST_DOUBLINGS and np.all(np.abs(now - before) <= _SETTLED * now):
            break
        before = now
    p = 0.5 * (p + p.T)

    # An unknown error of the leg's start has gone into the states, less what the filter has seen of it as theirs.
    ends = a[:, m:].copy()
    ends[:m] -= settling @ j[:m, m:]
    # Its process has added to that since, through the gains of the settled filter.
    prior = step[:m, :m] @ p @ step[:m, :m].T + noise[:m, :m]
    gain = prior @ h[:, :m].T @ np.linalg.inv(h[:, :m] @ prior @ h[:, :m].T + r)
    update = identity - np.eye(states.size, m) @ gain @ h
    moved, added = update @ step, update @ noises[1:] @ update.T
    for _ in range(doublings):
        added, moved = moved @ added @ moved.T + added, moved @ moved
    if heading_free:
        p[_YAW, _YAW] = states.believed[_YAW, _YAW]
    return _started_with(states, p, _of_unknown(states, ends, processes, added))


def _between_fixes(
    trajectory: QuinticPath, interval: float, states: States, processes: Sequence[int], *, heading_free: bool
) -> tuple[FloatArray, FloatArray]:
    """The transition (n, n) from fix to fix, and what noises add: of the filter, and of each of some processes.

    Parameters
    ----------
    trajectory : QuinticPath
        The leg.
    interval : float
        From fix to fix, s.
    states : States
    processes : sequence of int
        Places in `States.drives`.
    heading_free : bool
        Whether heading takes no part.

    Returns
    -------
    step : array (n, n)
    noises : array (1 + processes, n, n)
    """
    # One step, or as many as the shortest process needs.
    shortest = min([error.time for error in states.drives if error.time > 0.0], default=math.inf)
    halvings = math.ceil(math.log2(max(_STEPS_IN_TIME * interval / shortest, 1.0)))
    between = steps_between(trajectory, np.array([0.0, interval / 2**halvings]), states)
    phi, decay_factor, factors, believed = (part[0] for part in between)
    m, step = states.estimated, np.diag(np.concatenate([np.zeros(BIASES), decay_factor]))
    step[:BIASES] = phi
    noises = np.zeros((1 + len(processes), states.size, states.size))
    noises[0, :m, :m] = believed
    for noise, place in zip(noises[1:], processes, strict=True):
        error = states.drives[place]
        into = np.array([*range(BIASES), *range(error.first, error.first + error.states)])
        factor = factors[place, : len(into)]
        noise[into[:, None], into] = factor @ factor.T
    if heading_free:
        step[_YAW] = step[:, _YAW] = noises[:, _YAW] = noises[:, :, _YAW] = 0.0
        if (drift := states.first.get(HEADING_DRIFT)) is not None:
            step[:BIASES, drift] = 0.0
    for _ in range(halvings):
        noises, step = step @ noises @ step.T + noises, step @ step
    return step, noises


def _unknown_processes(states: States) -> list[int]:
    """Places in `States.drives` of the Gauss-Markov processes that the filter does not know."""
    known = _filter_states(states)
    return [n for n, error in enumerate(states.drives) if error.time > 0.0 and error.first not in known]


def _of_unknown(
    states: States, ends: FloatArray, processes: Sequence[int], added: FloatArray
) -> tuple[list[FloatArray], list[int]]:
    """Columns of `States.initial`, with their owners, of the errors that the filter does not know.

    Parameters
    ----------
    states : States
        Before the leg.
    ends : array (n, n - m)
        What a unit of each at the leg's start does to every state at its end.
    processes : sequence of int
        Places in `States.drives`.
    added : array (processes, n, n)
        Covariance that each process has added on the leg.
    """
    columns, owners = list[FloatArray](), list[int]()
    m, known = states.estimated, _filter_states(states)
    for column, owner in zip(states.initial.T, states.owner.tolist(), strict=True):
        if (state := _state_of(column)) >= m and state not in known:
            columns.append(ends @ column[m:])
            owners.append(owner)
    for place, covariance in zip(processes, added, strict=True):
        scale = np.sqrt(np.where(np.diag(covariance) > 0.0, np.diag(covariance), 1.0))
        values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
        columns += list((scale[:, None] * vectors * np.sqrt(np.maximum(values, 0.0))).T)
        owners += [states.drives[place].source] * len(values)
    return columns, owners


def _state_of(column: FloatArray) -> int:
    """State of the error itself in a column of `States.initial`, after what it does to the filter's."""
    return int(np.flatnonzero(column)[-1])


def _started_with(states: States, covariance: FloatArray, unknown: tuple[list[FloatArray], list[int]]) -> States:
    """Copy of the states, of which the filter begins with a covariance (m, m), and so do the errors that it knows;
    those `unknown` to it begin with their columns and owners.

    Each column of its Cholesky factor, biases before attitude, velocity and position, goes to its state's source.
    Where one state of the filter is for several errors of a sensor, each has its part of the variance that the filter
    believes.
    """
    m = states.estimated
    order = np.array([*range(BIASES, m), *range(BIASES - 1, -1, -1)])
    scale = np.sqrt(np.where(np.diag(covariance) > 0.0, np.diag(covariance), 1.0))[order]
    correlation = covariance[np.ix_(order, order)] / np.outer(scale, scale)
    factor = np.zeros((m, m))
    factor[order] = scale[:, None] * np.linalg.cholesky(correlation + 1e-12 * np.eye(m))
    filter_states, (columns, owners) = _filter_states(states), unknown
    parts: dict[int, list[tuple[int, int, float]]] = {}
    for column, owner in zip(states.initial.T, states.owner.tolist(), strict=True):
        state = _state_of(column)
        if state < BIASES or state in filter_states:
            parts.setdefault(filter_states.get(state, state), []).append((owner, state, float(column[state])))
    for place, by_place in zip(order.tolist(), factor.T, strict=True):
        whole = math.hypot(*(sigma for _, _, sigma in parts.get(place, ())))
        if BIASES <= place < states.inertial:  # errors that are considered beside it may be part of what it believes
            whole = math.sqrt(states.believed[place, place])
        for owner, state, sigma in parts.get(place, ()):
            column = np.zeros(states.size)
            column[:m] = sigma / whole * by_place
            if state >= m:  # the error itself, not its estimate, is what is off
                column[state], column[place] = -column[place], 0.0
            columns.append(column)
            owners.append(owner)
    return replace(states, initial=np.array(columns).T, owner=np.array(owners, dtype=np.int64), believed=covariance)


def _filter_states(states: States) -> Mapping[int, int]:
    """State of an error that the filter knows -> the filter's state for it."""
    places = {SLOW_GNSS: states.inertial} if states.estimated > states.inertial else {}
    if states.inertial > BIASES:
        for name, first in (("accelerometer", BIASES), ("gyro", BIASES + 3)):
            places[f"{name} bias"] = first
            places[f"{name} bias instability"] = first + states.inertial - BIASES - TRIADS
    return {
        states.first[group] + n: first + n
        for group, first in places.items()
        if group in states.first
        for n in range(3)
    }
