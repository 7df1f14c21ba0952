"""The RTS smoother of the simulator's filter of nine states: gains along the aperture, the same for every run.

The covariance follows from the filter's own dynamics [T-1] with the Earth's terms, along the true path, so one pass
serves a whole ensemble; the smoother then works on the errors of each run, to which it is linear.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nav_model.sar.smoother import rts_smooth, smoother_gain
from nav_model.simulation.kalman import error_dynamics, propagate, update
from nav_model.simulation.specification import SimulationSpec
from nav_model.simulation.trajectory import plan_trajectory
from nav_model.simulation.truth import specific_force_and_rate, true_states

_FloatArray = NDArray[np.float64]
_STATES = 9
_BETWEEN_FIXES = 16  # moments a fix interval at which gains are taken; between them corrections are interpolated


@dataclass(frozen=True)
class FlownSmoother:
    """Gains over an aperture that begins with a fix.

    ``prior``, ``posterior`` (k, 9, 9) at its k fixes, ``transition`` (k - 1, 9, 9) between them; ``node_time`` (m,)
    [s in the flight], ``node_gain`` (m, 3, 9): what of a correction at the next fix reaches the position, and
    ``node_fix`` (m,): which fix that is. After the last fix there is nothing to correct.
    """

    prior: _FloatArray
    posterior: _FloatArray
    transition: _FloatArray
    node_time: _FloatArray
    node_gain: _FloatArray
    node_fix: NDArray[np.intp]

    def correction(self, time: _FloatArray, before: _FloatArray, after: _FloatArray) -> _FloatArray:
        """What to add to the filter's position error (runs, n, 3) at ``time`` (n,) [s in the flight].

        At a fix the error just after it is meant.
        ``before``, ``after`` (k, runs, 9): the filter's errors just before and just after each fix.
        """
        smoothed = rts_smooth(after, self.posterior, before, self.prior, self.transition)
        change = smoothed - before
        corrected = np.einsum("mij,mrj->rmi", self.node_gain, change[self.node_fix])
        added = np.zeros((before.shape[1], len(time), 3))
        for fix in range(1, len(before)):
            nodes = np.flatnonzero(self.node_fix == fix)
            inside = np.flatnonzero(
                (time >= self.node_time[nodes[0]] - 1e-9) & (time < self.node_time[nodes[-1]] - 1e-9)
            )
            place = np.interp(time[inside], self.node_time[nodes], np.arange(len(nodes)))
            low = np.minimum(place.astype(int), len(nodes) - 2)
            part = (place - low)[None, :, None]
            of_fix = corrected[:, nodes]
            added[:, inside] = of_fix[:, low] * (1 - part) + of_fix[:, low + 1] * part
        return added


def flown_smoother(spec: SimulationSpec, fix_times: _FloatArray, first: int) -> FlownSmoother:
    """Carry the covariance along the true path; ``fix_times`` [s] of the flight, from ``first`` on the aperture's."""
    nodes = [
        np.linspace(one, other, _BETWEEN_FIXES + 1)
        for one, other in zip(fix_times[first:-1], fix_times[first + 1 :], strict=True)
    ]
    step = 1 / spec.filter.propagation_rate
    early = np.arange(step, fix_times[first], step)
    moments = np.unique(np.concatenate([early, fix_times, *nodes]).round(9))
    trajectory = plan_trajectory(spec.trajectory, spec.duration)
    middle = (moments + np.concatenate([[0.0], moments[:-1]])) / 2
    path = true_states(trajectory, middle)
    force = np.einsum("nij,nj->ni", path.matrix, specific_force_and_rate(trajectory, middle)[:, :3])
    state = np.concatenate([path.position, path.velocity], axis=1)

    start = spec.initial
    sigma = np.repeat([start.position, start.velocity, start.tilt], 3)
    sigma[8] = start.yaw
    covariance, work, dynamics = np.diag(sigma**2), np.empty((4, _STATES, _STATES)), np.empty((_STATES, _STATES))
    none = np.zeros(6)
    densities = (
        spec.imu.accelerometer.random_walk * spec.imu.vibration_factor,
        spec.imu.gyro.random_walk * spec.imu.vibration_factor,
    )
    prior, posterior, transitions = [], [], []
    at, gathered, since = [], [], []  # nodes since the last fix: time, covariance, transition from the fix
    node_time, node_gain, node_fix = [], [], []
    forward, before, fix = np.eye(_STATES), 0.0, 0
    for moment, place, f, matrix in zip(moments, state, force, path.matrix, strict=True):
        elapsed, before = moment - before, moment
        error_dynamics(place, f, matrix, dynamics)
        propagate(covariance, dynamics, f, elapsed, *densities, none, none, work)
        inside = fix > first
        if inside:
            grown = dynamics * elapsed
            forward = (np.eye(_STATES) + grown + grown @ grown / 2 + grown @ grown @ grown / 6) @ forward
        falls = fix < len(fix_times) and abs(moment - fix_times[fix]) < 1e-8
        if inside:
            at.append(moment)
            gathered.append(covariance.copy())
            since.append(forward.copy())
        if not falls:
            continue
        if inside:
            onward = np.stack([forward @ np.linalg.inv(one) for one in since])
            gains = smoother_gain(np.stack(gathered), onward, covariance)
            node_time += at
            node_gain += list(gains[:, :3])
            node_fix += [fix - first] * len(at)
            transitions.append(forward)
        if fix >= first:
            prior.append(covariance.copy())
        for axis, noise in enumerate(spec.gnss.axis_noise):
            row = np.zeros(_STATES)
            row[axis] = 1.0
            update(covariance, row, 0.0, noise**2, np.zeros(_STATES), work)
        for axis in range(3) if spec.gnss.velocity_noise else ():
            row = np.zeros(_STATES)
            row[3 + axis] = 1.0
            update(covariance, row, 0.0, float(spec.gnss.velocity_noise or 0.0) ** 2, np.zeros(_STATES), work)
        if fix >= first:
            posterior.append(covariance.copy())
            forward = np.eye(_STATES)
            at, gathered, since = [moment], [covariance.copy()], [forward.copy()]
        fix += 1
    return FlownSmoother(
        np.stack(prior),
        np.stack(posterior),
        np.stack(transitions) if transitions else np.empty((0, _STATES, _STATES)),
        np.array(node_time),
        np.array(node_gain).reshape(-1, 3, _STATES),
        np.array(node_fix, int),
    )
