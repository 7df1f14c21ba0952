"""Recorded places that no flight goes through: what is beside the others is left out, steps that stay are named."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.constants import STANDARD_GRAVITY
from nav_model.earth.wgs84 import metres_per_radian
from nav_model.trajectory.files.heights import Heights, counted

_NOISE = 8.0  # medians of the same measure over the recording
_GENTLE = 0.25 * STANDARD_GRAVITY
_SMOOTHER = 3.0  # the way around is so much smoother
_LEAST_STEP = 1.0  # m; less may be the last digit of a place
_LONGEST = 60.0  # s between a step and the one back
_FEWEST = 8  # places in which more than one can be judged
_MOST_STEPS = 10, 0.01  # and of the places; where there are more, the places are held between fixes
_MOST_LISTED = 3


class _Jump(NamedTuple):
    """Place at or before a jump, by its number in the recording, and size [m] north, east and, of one place, up."""

    at: int
    size: Array


def without_jumps(rows: Array, name: str, heights: Heights) -> Array:
    """Rows of time [s], latitude, longitude [°], height [m] and more, without those that their neighbours deny.

    One place is left out that is further from the cubic through the two before and the two after it than eight times
    what is usual in this recording, and than a quarter of g moves an aircraft in an interval, while the way around
    it bends by a third of that at most; a manoeuvre bends the way around too. Several are left out between a step and
    the step back. A step is an interval with a horizontal speed that those before and after it deny. One that stays
    is flown and named: nothing says which side of it is wrong.
    """
    if len(rows) < _FEWEST:
        return rows
    north, east = metres_per_radian(math.radians(rows[0, 1]), rows[0, 3])
    place = (rows[:, 1:4] - rows[0, 1:4]) * (math.radians(north), math.radians(east), 1.0)
    time = rows[:, 0]
    limit = _GENTLE * float(np.median(np.diff(time))) ** 2
    single = _singles(time, place, limit)
    others = np.delete(np.arange(len(rows)), [jump.at for jump in single])
    steps = [_Jump(int(others[jump.at]), jump.size) for jump in _steps(time[others], place[others, :2], limit)]
    back = [
        (step, after) for step, after in pairwise(steps)
        if _length(step.size + after.size) < _length(step.size) / _SMOOTHER
        and time[after.at] - time[step.at] <= min(_LONGEST, 0.2 * (time[-1] - time[0]))
    ]  # fmt: skip
    out = {jump.at for jump in single}.union(*(range(step.at + 1, after.at + 1) for step, after in back))
    if out:
        jumps = [*single, *(step for step, _ in back)]
        heights.note(f"{counted(len(out), 'place')} of {name} left out, beside the others by {_listed(jumps, time)}")
    stay = [step for step in steps if not any(step in pair for pair in back)]
    if 0 < len(stay) <= max(_MOST_STEPS[0], _MOST_STEPS[1] * len(rows)):
        heights.note(f"the places of {name} step by {_listed(stay, time)}, flown as if it were a manoeuvre")
    return np.delete(rows, sorted(out), axis=0)


def _singles(time: Array, place: Array, limit: float) -> list[_Jump]:
    """Places beside the cubic through two before and two after them."""
    around = np.arange(len(time) - 4)[:, None] + (0, 1, 3, 4)
    t, p, at = time[around], place[around], time[2:-2]
    cubic = np.zeros((len(at), 3))
    for j in range(4):
        others = [k for k in range(4) if k != j]
        weight = np.prod([(at - t[:, k]) / (t[:, j] - t[:, k]) for k in others], axis=0)
        cubic += weight[:, None] * p[:, j]
    beside = place[2:-2] - cubic
    speed = np.diff(p, axis=1) / np.diff(t, axis=1)[:, :, None]
    bend = 2.0 * np.diff(speed, axis=1) / (t[:, 2:] - t[:, :-2])[:, :, None]
    bends = _lengths(bend).max(axis=1) * np.median(np.diff(time)) ** 2
    return [_Jump(at + 2, beside[at]) for at in _beyond(beside, bends, limit)]


def _steps(time: Array, place: Array, limit: float) -> list[_Jump]:
    """Intervals with a speed that those before and after them deny."""
    interval = np.diff(time)[:, None]
    speed = np.diff(place, axis=0) / interval
    size = (speed[1:-1] - 0.5 * (speed[:-2] + speed[2:])) * interval[1:-1]
    change = _lengths((speed[2:] - speed[:-2]) * interval[1:-1])
    return [_Jump(at + 1, size[at]) for at in _beyond(size, change, max(limit, _LEAST_STEP))]


def _beyond(jumps: Array, around: Array, limit: float) -> list[int]:
    """Numbers of the jumps that are larger than a manoeuvre, than the noise, and than what is around them."""
    sizes = _lengths(jumps)
    limit = max(limit, _NOISE * float(np.median(sizes))) if len(sizes) else limit
    return [int(at) for at in np.flatnonzero((sizes > limit) & (around < sizes / _SMOOTHER))]


def _lengths(vectors: Array) -> Array:
    return np.asarray(np.linalg.norm(vectors, axis=-1))


def _length(vector: Array) -> float:
    return float(np.linalg.norm(vector))


def _listed(jumps: Sequence[_Jump], time: Array) -> str:
    """The first jumps with their times from the start."""
    early = sorted(jumps, key=lambda jump: jump.at)[:_MOST_LISTED]
    first = ", ".join(f"{_length(jump.size):.3g} m at {time[jump.at] - time[0]:.1f} s" for jump in early)
    more = len(jumps) - _MOST_LISTED
    return first + (f" and {more} more" if more > 0 else "")
