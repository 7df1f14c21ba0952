"""When samples were taken: rate, lost samples and jitter from time stamps, and values that are held.

Stamps are judged along a line through all of them. Jitter, and pairs from a bus, leave the line and come back to it;
a lost sample moves everything after it by whole sample intervals.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError

Rows = NDArray[np.int64]

_WHOLE = 0.3  # of an interval: steps this close to whole ones are counted one by one
_MOST_GAPS = 0.05  # of the steps; more are bursts from a bus
_LAG = 240  # samples, a whole number of the usual bursts
_MEANS = 24, 120  # samples of a mean, a whole number of the usual bursts; more where those do not do
_MEDIAN = 201  # means of a median
_PAUSE = 50  # samples; a longer step is a pause
_OTHER_CLOCK = 1e5  # s
_LEAST_EQUAL = 0.25
_HELD_SHARE = 0.9


@dataclass(frozen=True)
class Sampling:
    """Of samples in order: the interval [s]; `breaks`, the first sample after each gap; how many samples are lost in
    all gaps; the jitter of the stamps [s, 1σ]."""

    interval_s: float
    breaks: Rows
    lost: int
    jitter_s: float


@np.errstate(over="ignore")  # of stamps that no clock has, which are refused
def judge_stamps(stamps: Array, name: str, place: Callable[[int], str]) -> Sampling:
    """The sampling behind the time stamps [s] of all samples, shape (samples,), two at least.

    Raises InputError under `name`, with the `place` of a sample in the file: the time does not increase, runs
    backwards, or comes from two clocks.
    """
    steps = np.diff(stamps)
    _check_clock(stamps, steps, name, place)
    interval = float(np.median(steps))
    if interval > 0.0:
        whole = np.maximum(np.rint(steps / interval), 1.0)
        residual = steps - whole * interval
        if np.all(np.abs(residual) < _WHOLE * interval) and np.mean(whole > 1.0) < _MOST_GAPS:
            # Each step says by itself how many intervals it spans.
            interval = float(stamps[-1] - stamps[0]) / float(whole.sum())
            return _sampling(interval, whole - 1.0, float(np.std(steps - whole * interval)) / np.sqrt(2.0))
    backwards = InputError(name, f"{place(int(np.argmin(steps)) + 1)}: the time does not increase.")
    # Over many samples jitter and bursts are small, and a tenth of such spans or more has lost hardly any sample.
    lag = min(_LAG, max(1, len(steps) // 4))
    interval = float(np.quantile(stamps[lag:] - stamps[:-lag], 0.1 if lag == _LAG else 0.5)) / lag
    if interval <= 0.0:
        raise backwards
    for _ in range(2):  # the second time with the interval that the first has found
        missing, jitter = _missing(steps, interval, backwards)
        interval = _slope(np.concatenate([[0.0], np.cumsum(missing + 1.0)]), stamps, missing > _PAUSE)
    return _sampling(interval, missing, jitter)


def _sampling(interval: float, missing: Array, jitter: float) -> Sampling:
    return Sampling(interval, np.flatnonzero(missing > 0.0) + 1, int(missing.sum()), float(jitter))


def _slope(index: Array, stamps: Array, pauses: NDArray[np.bool_]) -> float:
    """Slope of a line of least squares, with an offset of its own after each pause, which says nothing of it."""
    part = np.concatenate([[0], np.cumsum(pauses)])
    x, y = (v - (np.bincount(part, v - v[0]) / np.bincount(part))[part] - v[0] for v in (index, stamps))
    return float((x @ y) / (x @ x))


def _check_clock(stamps: Array, steps: Array, name: str, place: Callable[[int], str]) -> None:
    """Refuse stamps of two clocks, and a clock that was set back."""
    sizes = float(np.median(np.abs(steps))), abs(float(stamps[-1] - stamps[0])) / len(steps)
    usual = min((size for size in sizes if size > 0.0), default=0.0)
    back, ahead = steps < -100.0 * usual, steps > max(_OTHER_CLOCK, 10.0 * len(steps) * usual)
    if not back.any() and not ahead.any():
        return
    first = int(np.flatnonzero(back | ahead)[0])
    jump = f"{place(first + 1)}: the time jumps by {steps[first]:.6g} where {usual:.3g} is usual"
    if ahead.any() or np.count_nonzero(back) > 1:
        raise InputError(name, f"{jump}. The column has stamps of two clocks. Give the rate, and skip it with '-'.")
    raise InputError(name, f"{jump}. Two logs are behind one another, or the clock was set. Cut the log there.")


def _missing(steps: Array, interval: float, backwards: InputError) -> tuple[Array, float]:
    """Samples lost in each step, and the jitter, from where the stamps leave their line for good.

    The line about a sample is the median over many of means over few: the means take bursts, the median late stamps
    that are caught up with. A lost sample moves the line by one.
    """
    from scipy.ndimage import median_filter

    pauses = steps > _PAUSE * interval
    if np.count_nonzero(pauses) * 4 * _PAUSE > len(steps):
        pauses = np.zeros_like(pauses)  # long bursts
    missing = np.where(pauses, steps / interval - 1.0, 0.0)
    spans = steps / interval - missing
    residual = np.concatenate([[0.0], np.cumsum(spans - 1.0)])
    for size in _MEANS:
        size = max(2, min(size, len(steps) // 2) // 2 * 2)
        sums = np.cumsum(np.concatenate([[0.0], residual]))
        means = np.pad((sums[size:] - sums[:-size]) / size, size, mode="edge")[size // 2 :][: len(residual)]
        line = median_filter(means, min(_MEDIAN, len(steps)) | 1, mode="nearest")
        reach = 2 * size // 3
        ends = np.pad(line, reach, mode="edge")
        lift = ends[2 * reach :][: len(steps)] - ends[: len(steps)]
        if lift.min() >= -0.5:
            break
    else:
        raise backwards
    # How far the means of the samples after a step are above those before it; the step itself decides between equals.
    about = np.pad(means, size // 2 + 1, mode="edge")
    score = about[size + 2 :][: len(steps)] - about[2:][: len(steps)] + 0.5 * (spans - 1.0)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], lift > 0.5, [False]]).astype(np.int8)))
    for start, stop in edges.reshape(-1, 2):
        lost = max(1, round(float(lift[start:stop].sum()) / (2 * reach)))
        for step in start + np.argsort(-score[start:stop], kind="stable"):
            if lost <= 0:
                break
            more = min(lost, max(1, round(float(spans[step])) - 1))
            missing[step] += more
            lost -= more
    return np.rint(missing), interval * float(np.std(residual - line))


def held_values(values: Array, breaks: Rows) -> tuple[Rows, float] | None:
    """The row of each sample of a sensor, shape (rows, axes), that holds its values over rows, and rows per sample.

    None where nothing is held. Neighbours that are equal by chance, as of a coarse sensor, come in runs of every
    length, and no more often than the shares of its values say; values that are held come in runs of one length or of
    two next to each other.
    """
    equal = values[1:, 0] == values[:-1, 0]
    for axis in values.T[1:]:
        equal &= axis[1:] == axis[:-1]
    if np.count_nonzero(equal) < _LEAST_EQUAL * len(equal) or not np.any(values != values[0]):
        return None
    starts = np.union1d(np.flatnonzero(~equal) + 1, np.append(breaks, 0))
    runs = np.diff(np.append(starts, len(values)))
    usual = int(np.median(runs))
    share, low = max((np.mean((runs == low) | (runs == low + 1)), low) for low in (usual - 1, usual))
    chance = np.prod([np.sum((np.unique(axis, return_counts=True)[1] / len(axis)) ** 2) for axis in values.T])
    if share < _HELD_SHARE or low < 1 or np.mean(equal) < 3.0 * chance:
        return None
    # A value that comes twice by chance makes one run of two samples.
    length = float(np.mean(runs[(runs == low) | (runs == low + 1)]))
    samples = np.maximum(1, np.rint(runs / length)).astype(np.int64)
    inner = slice(1, -1)  # the first and the last run may be cut
    return np.repeat(starts, samples), float(runs[inner].sum() / samples[inner].sum())
