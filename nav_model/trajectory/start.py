"""Where a flight begins: the covariance of a filter that has settled on a straight leg, correlations included."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from nav_model.budget.shares import SLOW_GNSS
from nav_model.simulation.layout import ATTITUDE, BIASES, TRIADS
from nav_model.simulation.specification import SimulationSpec, TrajectorySpec
from nav_model.simulation.trajectory import plan_trajectory
from nav_model.simulation.truth import TruthStates, true_states
from nav_model.trajectory.errors import measurements, steps_between
from nav_model.trajectory.states import States

FloatArray = NDArray[np.float64]
_YAW = ATTITUDE + 2
# Position [m], velocity [m/s] and tilt [rad] where the leg begins: no knowledge that would tell tilt from bias, or
# position from a slow error of the fixes.
_UNKNOWN = np.repeat([1000.0, 10.0, 0.1], (3, 3, 2))
_LEAST_DOUBLINGS, _MOST_DOUBLINGS = 6, 18  # of the leg's length, from one fix on
_SETTLED = 0.003  # relative change of variances of position and velocity while the leg's length doubles


def settled_start(study: SimulationSpec, states: States, start: TruthStates) -> States:
    """The states of a flight at `start` (of one time), whose filter has settled on a straight level leg up to there.

    No straight leg shows the heading, so it takes no part and is the study's initial one. Of an error that the filter
    knows, what is not yet estimated has the correlation with the others that it got on the leg: tilt with an
    accelerometer bias above all, whose sum is all that fixes show there.
    """
    (north, east, _), (latitude, longitude, height) = start.velocity[0].tolist(), start.position[0].tolist()
    speed, interval, m = max(math.hypot(north, east), 0.1), study.gnss.interval, states.estimated
    flight = TrajectorySpec("straight", speed, latitude, longitude, height, heading=math.atan2(east, north))
    level = replace(study, outages=(), gnss=replace(study.gnss, after_loss=(), bank_limit=None))
    trajectory, time_s = plan_trajectory(flight, interval), np.array([0.0, interval])
    phi, decay_factor, _, noise = (part[0] for part in steps_between(trajectory, time_s, states))
    fixed = measurements(
        level, states, trajectory, true_states(trajectory, time_s), np.zeros((2, BIASES)), time_s[1:]
    )
    h, r = fixed["rows"][1, :, :m], np.diag(fixed["variance"][1])
    step = np.diag(np.concatenate([np.zeros(BIASES), decay_factor[: m - BIASES]]))
    step[:BIASES] = phi[:, :m]
    unsettled, before = states.believed.copy(), np.full(ATTITUDE, np.inf)
    unsettled[:_YAW] = unsettled[:, :_YAW] = 0.0
    unsettled[:_YAW, :_YAW] = np.diag(_UNKNOWN) ** 2
    for matrix in (step, noise, unsettled):
        matrix[_YAW] = matrix[:, _YAW] = 0.0
    # A step and its fix take a covariance P to A (1 + P J)⁻¹ P A' + C; two such legs make one of twice the length.
    identity = np.eye(m)
    gain = noise @ h.T @ np.linalg.inv(h @ noise @ h.T + r)
    a, c = (identity - gain @ h) @ step, (identity - gain @ h) @ noise
    j = step.T @ h.T @ np.linalg.solve(h @ noise @ h.T + r, h @ step)
    for doublings in range(1, _MOST_DOUBLINGS + 1):
        through = a @ np.linalg.inv(identity + c @ j)
        a, c, j = through @ a, through @ c @ a.T + c, a.T @ j @ np.linalg.solve(identity + c @ j, a) + j
        p = a @ np.linalg.solve(identity + unsettled @ j, unsettled) @ a.T + c
        now = np.diag(p)[:ATTITUDE].copy()  # in hours, the Earth's rotation would tell tilt from bias
        if doublings >= _LEAST_DOUBLINGS and np.all(np.abs(now - before) < _SETTLED * now):
            break
        before = now
    p = 0.5 * (p + p.T)
    p[_YAW, _YAW] = states.believed[_YAW, _YAW]
    return _started_with(states, p)


def _started_with(states: States, covariance: FloatArray) -> States:
    """Copy of the states, of which the filter begins with a covariance (m, m), and so do the errors that it knows.

    Each column of its Cholesky factor, biases before attitude, velocity and position, goes to its state's source.
    Where one state of the filter is for several errors of a sensor, each has its part of the variance.
    """
    m = states.estimated
    order = np.array([*range(BIASES, m), *range(BIASES - 1, -1, -1)])
    scale = np.sqrt(np.where(np.diag(covariance) > 0.0, np.diag(covariance), 1.0))[order]
    correlation = covariance[np.ix_(order, order)] / np.outer(scale, scale)
    factor = np.zeros((m, m))
    factor[order] = scale[:, None] * np.linalg.cholesky(correlation + 1e-12 * np.eye(m))
    filter_states, columns, owners = _filter_states(states), [], []
    parts: dict[int, list[tuple[int, int, float]]] = {}
    for column, owner in zip(states.initial.T, states.owner.tolist(), strict=True):
        state = int(np.flatnonzero(column)[-1])  # that of the error itself, after what it does to the filter's
        if state < BIASES or state in filter_states:
            parts.setdefault(filter_states.get(state, state), []).append((owner, state, float(column[state])))
        else:  # what the filter does not know is as large as before, and nothing has come of it yet
            columns.append(column)
            owners.append(owner)
    for place, by_place in zip(order.tolist(), factor.T, strict=True):
        whole = math.hypot(*(sigma for _, _, sigma in parts.get(place, ())))
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
