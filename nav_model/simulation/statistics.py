"""Sums over the runs of a Monte Carlo study, in memory that does not grow with their number."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from nav_model.simulation.single_run import POSTERIOR, RunRecord

FloatArray = NDArray[np.float64]
BINS_PER_DECADE: Final = 50
LOWEST_DECADE: Final = -2
DECADES: Final = 4
BINS: Final = BINS_PER_DECADE * DECADES + 2
"""Bins of |error| / scale: below 0.01, logarithmic from 0.01 to 100 (4.7 % wide), above 100."""


@dataclass(eq=False)
class Statistics:
    """Sums over some runs; `scale` (outputs, states) fixes the histogram's units and is the same for all of
    them.

    error, square, variance: shape (2, outputs, states), sums of error, error^2 and the filter's variance,
    before and after the fix. nees: (outputs,) sum. run_nees: sum and sum of squares over runs of a run's mean
    NEES. nis: sum, number of fixes, and of what they measured. histogram: (outputs, states, BINS) counts of
    |error| after the fix. run_errors: run -> error history.
    """

    scale: FloatArray
    error: FloatArray
    square: FloatArray
    variance: FloatArray
    nees: FloatArray
    histogram: NDArray[np.uint32]
    runs: int = 0
    run_nees: FloatArray = field(default_factory=lambda: np.zeros(2))
    nis: float = 0.0
    fixes: int = 0
    measured: int = 0
    worst: RunRecord | None = None
    run_errors: dict[int, FloatArray] = field(default_factory=dict)

    @classmethod
    def empty(cls, scale: FloatArray) -> Statistics:
        """No runs yet."""
        shape = (2, *scale.shape)
        histogram = np.zeros((*scale.shape, BINS), dtype=np.uint32)
        return cls(scale, np.zeros(shape), np.zeros(shape), np.zeros(shape), np.zeros(scale.shape[0]), histogram)

    def add(self, record: RunRecord, keep: bool) -> None:
        """Take one run in."""
        self.runs += 1
        self.error += record.error
        self.square += record.error**2
        self.variance += record.filter_sigma**2
        self.nees += record.nees
        mean = float(np.mean(record.nees))
        self.run_nees += (mean, mean * mean)
        self.nis += float(np.sum(record.nis))
        self.fixes += len(record.nis)
        self.measured += record.measured
        error = record.error[POSTERIOR]
        rows, columns = np.indices(error.shape, sparse=True)
        self.histogram[rows, columns, _bin(np.abs(error) / self.scale)] += 1
        self.worst = _worse(self.worst, record)
        if keep:
            self.run_errors[record.run] = error

    def merge(self, later: Statistics) -> None:
        """Take in the sums over later runs. Merging the same chunks in the same order gives the same bits."""
        for name in (
            "runs",
            "error",
            "square",
            "variance",
            "nees",
            "histogram",
            "run_nees",
            "nis",
            "fixes",
            "measured",
        ):
            setattr(self, name, getattr(self, name) + getattr(later, name))
        if later.worst is not None:
            self.worst = _worse(self.worst, later.worst)
        repeated = self.run_errors.keys() & later.run_errors.keys()
        if repeated:
            raise RuntimeError(f"run {min(repeated)} arrived twice")
        self.run_errors |= later.run_errors

    def percentile(self, percent: float) -> FloatArray:
        """Percentile of |error| after the fix, shape (outputs, states); within a bin, 4.7 % wide,
        interpolated.

        Shares the rank convention of `numpy.percentile` to within a bin. Values above 100 or below 0.01 of
        `scale` come out as that bound.
        """
        edges = 10.0 ** (LOWEST_DECADE + np.arange(BINS - 1) / BINS_PER_DECADE)
        edges = np.concatenate([[edges[0]], edges, [edges[-1]]])
        below = np.cumsum(self.histogram, axis=-1, dtype=np.float64)
        rank = percent / 100.0 * (self.runs - 1) + 0.5
        bins = np.argmax(below >= rank, axis=-1)
        count = np.take_along_axis(self.histogram, bins[..., None], axis=-1)[..., 0].astype(np.float64)
        before = np.take_along_axis(below, bins[..., None], axis=-1)[..., 0] - count
        share = (rank - before) / np.maximum(count, 1.0)
        value: FloatArray = self.scale * edges[bins] * (edges[bins + 1] / edges[bins]) ** share
        return value


def _bin(ratio: FloatArray) -> NDArray[np.intp]:
    logarithm = np.log10(np.maximum(ratio, 1e-12))
    place = np.floor((logarithm - LOWEST_DECADE) * BINS_PER_DECADE).astype(np.intp) + 1
    clipped: NDArray[np.intp] = np.clip(place, 0, BINS - 1)
    return clipped


def largest_horizontal_error(record: RunRecord) -> float:
    """Largest horizontal position error of a run after the fixes [m]: the worst run has the largest."""
    error = record.error[POSTERIOR]
    return float(np.max(np.hypot(error[:, 0], error[:, 1])))


def _worse(worst: RunRecord | None, other: RunRecord) -> RunRecord:
    if worst is None:
        return other
    order = [(largest_horizontal_error(record), -record.run) for record in (worst, other)]
    return worst if order[0] > order[1] else other
