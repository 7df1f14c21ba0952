"""Cosine spectrum of one axis, single coefficients at low frequency and logarithmic bins above."""

from dataclasses import dataclass

import numpy as np

from nav_model.allan.imu_log import NO_BREAKS
from nav_model.allan.noise_terms import cosine_ramp, cosine_variances
from nav_model.base.arrays import Array
from nav_model.base.sampling import Rows

SINGLE_COEFFICIENTS = 128
BINS_PER_DECADE = 40
# Of the strongest bin. Doubles leave 1e-28; the least that a 24-bit count leaves of its own range is 1e-15.
_EMPTY = 1e-24
_EMPTY_SHARE = 0.2
_NODES = 16  # of a bin; stretches of every length are among its coefficients


@dataclass(frozen=True)
class CosineSpectrum:
    """Binned orthonormal DCT-II powers of a rate signal with its mean left out.

    Arrays have one entry per bin; the first `singles` bins hold one coefficient each, with its sign in
    `amplitude` (the ramp is fitted to them). `power` is the mean squared coefficient [unit² of the rate],
    `count` the number of coefficients in it, `peak` the largest squared coefficient over the bin's mean.
    """

    interval_s: float
    singles: int
    frequency_hz: Array
    power: Array
    count: Array
    peak: Array
    peak_frequency_hz: Array
    amplitude: Array
    shapes: Array
    ramp: Array

    @property
    def repeats(self) -> bool:
        """True if the signal repeats itself exactly: coefficients between its lines are then empty to rounding.

        A stretch copied once behind itself leaves every fourth coefficient empty, more copies more.
        """
        empty = self.power[: self.singles] <= _EMPTY * self.power.max()
        return bool(empty.mean() > _EMPTY_SHARE)


def cosine_spectrum(rate_signal: Array, interval_s: float, breaks: Rows = NO_BREAKS) -> CosineSpectrum:
    """Transform one axis, shape (samples,), sampled every `interval_s` [s]; ValueError under 512 samples.

    Each stretch between `breaks` is transformed by itself. The coefficients of all of them, in the order of their
    frequencies, make one spectrum: what a term adds to each depends on its number and its stretch's length.
    """
    singles = SINGLE_COEFFICIENTS
    coefficient, index, length = _coefficients(rate_signal, breaks)
    total = len(coefficient)
    if total < 4 * singles:
        raise ValueError(f"log has {len(rate_signal)} samples; at least {4 * singles} are needed for a fit")
    frequency = index / (2.0 * length * interval_s)
    decades = np.log10(total / (singles + 1))
    edges = np.geomspace(singles + 1, total, max(2, int(decades * BINS_PER_DECADE) + 1))
    starts = np.unique(np.round(edges).astype(np.int64))
    starts = np.concatenate([np.arange(1, singles + 1), starts])
    first, last = starts[:-1], starts[1:]
    count = (last - first).astype(np.float64)
    squared = np.square(coefficient[: last[-1]])
    power = np.add.reduceat(squared, first) / count
    largest = np.maximum.reduceat(squared, first)
    peak_index = np.array(
        [a + int(np.argmax(squared[a:b])) if b - a > 1 else a for a, b in zip(first, last, strict=True)]
    )
    return CosineSpectrum(
        interval_s=interval_s,
        singles=singles,
        frequency_hz=np.add.reduceat(frequency[: last[-1]], first) / count,
        power=power,
        count=count,
        peak=largest / np.where(power > 0.0, power, 1.0),
        peak_frequency_hz=frequency[peak_index],
        amplitude=coefficient[1 : singles + 1].copy(),
        shapes=_bin_mean_shapes(first, last, index, length, interval_s),
        ramp=cosine_ramp(index[1 : singles + 1], length[1 : singles + 1], interval_s),
    )


def _coefficients(rate_signal: Array, breaks: Rows) -> tuple[Array, Array, Array]:
    """DCT-II coefficients of all stretches, sorted by frequency; the number of each in its stretch, and the stretch's
    length. The first entry is the mean, which is left out."""
    from scipy.fft import dct

    if not len(breaks):
        coefficient = dct(rate_signal - rate_signal.mean(), norm="ortho", overwrite_x=True)
        samples = len(coefficient)
        return coefficient, np.arange(samples, dtype=np.float64), np.broadcast_to(float(samples), samples)
    stretches = [stretch for stretch in np.split(rate_signal, breaks) if len(stretch) > 1]
    coefficient = np.concatenate([dct(stretch, norm="ortho")[1:] for stretch in stretches])
    index = np.concatenate([np.arange(1.0, len(stretch)) for stretch in stretches])
    length = np.concatenate([np.full(len(stretch) - 1, float(len(stretch))) for stretch in stretches])
    order = np.argsort(index / length, kind="stable")
    coefficient, index, length = (
        np.concatenate([[lead], values[order]]) for lead, values in ((0.0, coefficient), (0.0, index), (1.0, length))
    )
    return coefficient, index, length


def _bin_mean_shapes(first: Rows, last: Rows, index: Array, length: Array, interval_s: float) -> Array:
    """Mean over each bin of the per-term variances, by a Gauss rule over its coefficients (bins are 6 % wide)."""
    nodes, weights = np.polynomial.legendre.leggauss(_NODES)
    middle = (first + last - 1) / 2.0
    half_width = (last - first) / 2.0 * (last - first > 1)
    total = np.zeros((4, len(first)))
    for node, weight in zip(nodes, weights, strict=True):
        at = np.rint(middle + half_width * node).astype(np.int64)
        total += weight / 2.0 * cosine_variances(index[at], length[at], interval_s)
    return total
