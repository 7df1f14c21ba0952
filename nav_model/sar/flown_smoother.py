"""The RTS smoother of the simulator's nine-state filter: gains along the aperture, the same for every run.

The covariance follows from the filter's own dynamics [T-1] with the Earth's terms, along the true path, so one pass
serves a whole ensemble; the smoother then works on the errors of each run, to which it is linear.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import Array
from nav_model.sar.smoother import rts_smooth, smoother_gain
from nav_model.simulation.kalman import error_dynamics, propagate, update
from nav_model.simulation.specification import SimulationSpec
from nav_model.simulation.trajectory import plan_trajectory
from nav_model.simulation.truth import TruthStates, specific_force_and_rate, true_states

_STATES = 9
_BETWEEN_FIXES = 16  # times per fix interval at which gains are computed; between them corrections are interpolated


@dataclass(frozen=True)
class FlownSmoother:
    """Gains from one fix on.

    ``prior``, ``posterior`` (k, 9, 9) at its k fixes, ``transition`` (k - 1, 9, 9) between them. ``node_time`` (m,)
    [s in the flight], ``node_fix`` (m,): which is the next fix; ``node_gain`` (m, 3, 9): effect of a correction there
    on the position. Nothing is corrected after the last fix.
    """

    prior: Array
    posterior: Array
    transition: Array
    node_time: Array
    node_fix: NDArray[np.intp]
    node_gain: Array

    def until(self, fixes: int) -> FlownSmoother:
        """The smoother with only the first `fixes` of its fixes."""
        has = self.node_fix < fixes
        nodes = (self.node_time[has], self.node_fix[has], self.node_gain[has])
        return FlownSmoother(self.prior[:fixes], self.posterior[:fixes], self.transition[: fixes - 1], *nodes)

    def correction(self, time: Array, prior: Array, posterior: Array) -> Array:
        """Correction to add to the flown filter's position error (runs, n, 3) at ``time`` (n,) [s in the flight].

        At a fix the error just after it is meant.

        Parameters
        ----------
        time : array
        prior, posterior : array (k, runs, 9)
            Errors of the filter, just before and just after each fix.
        """
        change = rts_smooth(posterior, self.posterior, prior, self.prior, self.transition) - prior
        corrected = np.einsum("mij,mrj->rmi", self.node_gain, change[self.node_fix])
        added = np.zeros((prior.shape[1], len(time), 3))
        for fix in np.unique(self.node_fix):
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


def flown_smoother(spec: SimulationSpec, fix_times: Array, first: int, end: int | None = None) -> FlownSmoother:
    """Carry the covariance along the true path.

    Parameters
    ----------
    spec : SimulationSpec
    fix_times : array
        Of the flight, s.
    first : int
        The fix from which on gains are kept.
    end : int, optional
        Positions are needed after the fixes before this one. Default: after every fix.
    """
    corrected = range(first, len(fix_times) - 1 if end is None else end)  # fixes after which positions are needed
    moments = _moments(spec, fix_times, fix_times[corrected.start : corrected.stop + 1])
    path, force = _true_path(spec, moments)
    state = np.concatenate([path.position, path.velocity], axis=1)
    covariance, f_matrix, work = (
        _initial_covariance(spec),
        np.empty((_STATES, _STATES)),
        np.empty((4, _STATES, _STATES)),
    )
    densities = (
        spec.imu.accelerometer.random_walk * spec.imu.vibration_factor,
        spec.imu.gyro.random_walk * spec.imu.vibration_factor,
    )
    variances = np.array([*spec.gnss.axis_noise, *spec.gnss.axis_velocity_noise]) ** 2
    rows = np.eye(len(variances), _STATES)
    prior, posterior, transitions = [], [], []
    nodes: list[tuple[float, Array, Array]] = []  # since the last fix: time, covariance, transition from that fix
    node_time, node_fix, node_gain = [], [], []
    phi, before, fix = np.eye(_STATES), 0.0, 0
    for moment, place, f, matrix in zip(moments, state, force, path.matrix, strict=True):
        # P along the path, and from the first fix on Phi since the last fix, to third order in the step.
        elapsed, before = moment - before, moment
        error_dynamics(place, f, matrix, f_matrix)
        propagate(covariance, f_matrix, f, elapsed, *densities, np.zeros(6), np.zeros(6), work)
        if fix > first:
            step = f_matrix * elapsed
            phi = (np.eye(_STATES) + step + step @ step / 2 + step @ step @ step / 6) @ phi
        if fix - 1 in corrected:
            nodes.append((moment, covariance.copy(), phi))
        if fix == len(fix_times) or abs(moment - fix_times[fix]) > 1e-8:
            continue
        # At a fix: gains of the times since the last one, with Phi from each of them to here.
        if nodes:
            times, covariances, since = (np.array(each) for each in zip(*nodes, strict=True))
            node_time += times.tolist()
            node_fix += [fix - first] * len(times)
            node_gain += list(smoother_gain(covariances, phi @ np.linalg.inv(since), covariance)[:, :3])
        if fix > first:
            transitions.append(phi)
        if fix >= first:
            prior.append(covariance.copy())
        for row, variance in zip(rows, variances, strict=True):
            update(covariance, row, 0.0, variance, np.zeros(_STATES), work)
        if fix >= first:
            posterior.append(covariance.copy())
        phi = np.eye(_STATES)
        nodes = [(moment, covariance.copy(), phi)] if fix in corrected else []
        fix += 1
    return FlownSmoother(
        np.stack(prior),
        np.stack(posterior),
        np.stack(transitions) if transitions else np.empty((0, _STATES, _STATES)),
        np.array(node_time),
        np.array(node_fix, int),
        np.array(node_gain).reshape(-1, 3, _STATES),
    )


def _moments(spec: SimulationSpec, fix_times: Array, within: Array) -> Array:
    """Times [s] to carry the covariance to: the filter's steps, the fixes, and densely between the fixes `within`."""
    dense = [np.linspace(start, stop, _BETWEEN_FIXES + 1) for start, stop in pairwise(within)]
    rate = spec.filter.propagation_rate
    steps = np.arange(1, math.floor(fix_times[-1] * rate) + 1) / rate
    outside = steps[(steps < within[0]) | (steps > within[-1])]
    return np.unique(np.concatenate([outside[outside < fix_times[-1]], fix_times, *dense]).round(9))


def _true_path(spec: SimulationSpec, moments: Array) -> tuple[TruthStates, Array]:
    """True states amid the steps to every moment, and the specific force there, (n, 3), north, east, down [m/s²]."""
    trajectory = plan_trajectory(spec.trajectory, spec.duration)
    middle = (moments + np.concatenate([[0.0], moments[:-1]])) / 2
    path = true_states(trajectory, middle)
    return path, np.einsum("nij,nj->ni", path.matrix, specific_force_and_rate(trajectory, middle)[:, :3])


def _initial_covariance(spec: SimulationSpec) -> Array:
    """Of the filter as it begins, (9, 9)."""
    sigma = np.repeat([spec.initial.position, spec.initial.velocity, spec.initial.tilt], 3)
    sigma[8] = spec.initial.yaw
    return np.diag(sigma**2)
