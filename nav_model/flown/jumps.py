"""Where a difference of two solutions jumps: resets, gaps and changes of fix."""

import math

import numpy as np
from numpy.typing import NDArray

from nav_model.base.units import time_in_words
from nav_model.flown.budgeted import Budgeted
from nav_model.flown.relation import Compared
from nav_model.flown.result import Jump
from nav_model.flown.solution import Solution

FloatArray = NDArray[np.float64]
_SIGMAS = 6.0
_MEDIAN = 0.6745  # of the size of a normal number of one sigma
_LEAST = 1e-4  # m
_MOST = 500


def jumps_of(compared: Compared, x: Solution, interval: float, step_sigma: float) -> tuple[Jump, ...]:
    """Jumps of what is compared, in the order of time, the largest 500 of them.

    A step is a reset beyond six sigma of what fixes do: by the budget, or by the median of the largest steps of each
    fix interval, so that a receiver noisier than its budget makes none.

    Parameters
    ----------
    compared : Compared
    x : Solution
        Whose gaps and kinds of fix count.
    interval : float
        Between fixes [s].
    step_sigma : float
        Of what a fix does to an axis of the position by the budget [m].
    """
    time, steps = compared.time_s, np.abs(np.diff(compared.position, axis=0))
    # The largest step of each interval, as between fixes there is next to none.
    bins = np.floor((time[1:] - time[0]) / max(interval, float(np.median(np.diff(time)))) + 1e-6).astype(np.int64)
    edges = np.flatnonzero(np.diff(bins, prepend=-1))
    usual = np.median(np.maximum.reduceat(steps, edges, axis=0), axis=0) / _MEDIAN
    limit = _SIGMAS * np.maximum(np.maximum(usual, step_sigma), _LEAST)
    at = np.flatnonzero((steps > limit).any(axis=1))
    size = np.linalg.norm(np.diff(compared.position, axis=0), axis=1)
    jumps = [Jump(float(time[n + 1]), float(size[n]), "step") for n in at]
    jumps += [Jump(start, 0.0, f"gap of {time_in_words(stop - start)}") for start, stop in x.gaps]
    if x.fix is not None:
        for n in np.flatnonzero(np.diff(x.fix)):
            names = x.fix_names[x.fix[n]], x.fix_names[x.fix[n + 1]]
            near = min(int(np.searchsorted(time[1:], x.time_s[n + 1])), len(size) - 1)
            jumps.append(Jump(float(x.time_s[n + 1]), float(size[near]), f"{names[0]} to {names[1]}"))
    jumps = [jump for jump in jumps if time[0] <= jump.time_s <= time[-1]]
    jumps = sorted(jumps, key=lambda jump: jump.size_m, reverse=True)[:_MOST]
    return tuple(sorted(jumps, key=lambda jump: jump.time_s))


def step_sigma(budgeted: Budgeted, compared: Compared) -> float:
    """Move of a position from sample to sample by the budget [m]: by the error of velocity where that is
    largest, and of a filter's output by a fix, the root mean square of K S K'."""
    model, run = budgeted.followed.model, budgeted.followed.run
    speed = math.sqrt(float(budgeted.states(budgeted.processing)[:, 3:6].max()))
    moved = speed * float(np.median(np.diff(compared.time_s)))
    if budgeted.post_processed:
        return moved
    fixes = np.flatnonzero(model.is_fix)
    if not fixes.size:
        return moved
    taken = []
    for node in fixes[:: max(1, len(fixes) // 200)]:
        H, K = model.rows[node][:, : model.states.estimated], run.gain[node]
        S = np.linalg.inv(np.eye(len(H)) - H @ K) * model.variance[node]  # R = (I - H K) S
        taken.append(np.diag(K @ S @ K.T)[:3].max())
    return math.hypot(moved, math.sqrt(float(np.mean(taken))))
