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
from nav_model.simulation.truth import specific_force_and_rate, true_states

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
        """What to add to the flown filter's position error (runs, n, 3) at ``time`` (n,) [s in the flight].

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
    wanted = range(first, len(fix_times) - 1 if end is None else end)
    within = fix_times[wanted.start : wanted.stop + 1]
    dense = [np.linspace(one, other, _BETWEEN_FIXES + 1) for one, other in pairwise(within)]
    rate = spec.filter.propagation_rate
    steps = np.arange(1, math.floor(fix_times[-1] * rate) + 1) / rate
    outside = steps[(steps < within[0]) | (steps > within[-1])]
    moments = np.unique(np.concatenate([outside[outside < fix_times[-1]], fix_times, *dense]).round(9))
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
    noise = np.array([*spec.gnss.axis_noise, *spec.gnss.axis_velocity_noise]) ** 2
    prior, posterior, transitions = [], [], []
    stretch: list[tuple[float, Array, Array]] = []  # since the last fix: time, covariance, transition
    node_time, node_fix, node_gain = [], [], []
    forward, before, fix = np.eye(_STATES), 0.0, 0
    for moment, place, f, matrix in zip(moments, state, force, path.matrix, strict=True):
        elapsed, before = moment - before, moment
        error_dynamics(place, f, matrix, dynamics)
        propagate(covariance, dynamics, f, elapsed, *densities, none, none, work)
        if fix > first:
            grown = dynamics * elapsed
            forward = (np.eye(_STATES) + grown + grown @ grown / 2 + grown @ grown @ grown / 6) @ forward
        if fix - 1 in wanted:
            stretch.append((moment, covariance.copy(), forward))
        if fix == len(fix_times) or abs(moment - fix_times[fix]) > 1e-8:
            continue
        if stretch:
            times, covariances, since = (np.array(each) for each in zip(*stretch, strict=True))
            node_time += times.tolist()
            node_fix += [fix - first] * len(times)
            node_gain += list(smoother_gain(covariances, forward @ np.linalg.inv(since), covariance)[:, :3])
        if fix > first:
            transitions.append(forward)
        if fix >= first:
            prior.append(covariance.copy())
        for seen, variance in enumerate(noise):
            row = np.zeros(_STATES)
            row[seen] = 1.0
            update(covariance, row, 0.0, variance, np.zeros(_STATES), work)
        if fix >= first:
            posterior.append(covariance.copy())
        forward = np.eye(_STATES)
        stretch = [(moment, covariance.copy(), forward)] if fix in wanted else []
        fix += 1
    return FlownSmoother(
        np.stack(prior),
        np.stack(posterior),
        np.stack(transitions) if transitions else np.empty((0, _STATES, _STATES)),
        np.array(node_time),
        np.array(node_fix, int),
        np.array(node_gain).reshape(-1, 3, _STATES),
    )
