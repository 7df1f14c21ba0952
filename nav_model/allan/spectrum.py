"""Cosine spectrum of one axis, single coefficients at low frequency and logarithmic bins above."""

from dataclasses import dataclass

import numpy as np

from nav_model.allan.noise_terms import FloatArray, cosine_ramp, cosine_variances

SINGLE_COEFFICIENTS = 128
BINS_PER_DECADE = 40
# Of the strongest bin. Doubles leave 1e-28; the least that a 24-bit count leaves of its own range is 1e-15.
_EMPTY = 1e-24
_EMPTY_SHARE = 0.2


@dataclass(frozen=True)
class CosineSpectrum:
    """Binned orthonormal DCT-II powers of a rate signal with its mean left out.

    Arrays have one entry per bin; the first `singles` bins hold one coefficient each, with its sign in
    `amplitude` (the ramp is fitted to them). `power` is the mean squared coefficient [unit² of the rate],
    `count` the number of coefficients in it, `peak` the largest squared coefficient over the bin's mean.
    """

    interval_s: float
    singles: int
    frequency_hz: FloatArray
    power: FloatArray
    count: FloatArray
    peak: FloatArray
    peak_frequency_hz: FloatArray
    amplitude: FloatArray
    shapes: FloatArray
    ramp: FloatArray

    @property
    def repeats(self) -> bool:
        """Whether the signal repeats itself exactly: coefficients between its lines are then empty to rounding.

        A stretch copied once behind itself leaves every fourth coefficient empty, more copies more.
        """
        empty = self.power[: self.singles] <= _EMPTY * self.power.max()
        return bool(empty.mean() > _EMPTY_SHARE)


def cosine_spectrum(rate_signal: FloatArray, interval_s: float) -> CosineSpectrum:
    """Transform one axis, shape (samples,), sampled every `interval_s` [s]; ValueError under 512 samples."""
    from scipy.fft import dct

    samples = len(rate_signal)
    if samples < 4 * SINGLE_COEFFICIENTS:
        raise ValueError(f"log has {samples} samples; at least {4 * SINGLE_COEFFICIENTS} are needed for a fit")
    coefficient = dct(rate_signal - rate_signal.mean(), norm="ortho", overwrite_x=True)
    singles = SINGLE_COEFFICIENTS
    decades = np.log10(samples / (singles + 1))
    edges = np.geomspace(singles + 1, samples, max(2, int(decades * BINS_PER_DECADE) + 1))
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
    centre = (first + last - 1) / 2.0
    to_hz = 1.0 / (2.0 * samples * interval_s)
    shapes = _bin_mean_shapes(first, last, samples, interval_s)
    return CosineSpectrum(
        interval_s=interval_s,
        singles=singles,
        frequency_hz=centre * to_hz,
        power=power,
        count=count,
        peak=largest / np.where(power > 0.0, power, 1.0),
        peak_frequency_hz=peak_index * to_hz,
        amplitude=coefficient[1 : singles + 1].copy(),
        shapes=shapes,
        ramp=cosine_ramp(centre[:singles], samples, interval_s),
    )


def _bin_mean_shapes(
    first: np.ndarray[tuple[int], np.dtype[np.int64]],
    last: np.ndarray[tuple[int], np.dtype[np.int64]],
    samples: int,
    interval_s: float,
) -> FloatArray:
    """Mean over each bin of the per-term variances, by a five-point Gauss rule (bins are 6 % wide)."""
    nodes, weights = np.polynomial.legendre.leggauss(5)
    middle = (first + last - 1) / 2.0
    half_width = (last - first) / 2.0 * (last - first > 1)
    total = np.zeros((4, len(first)))
    for node, weight in zip(nodes, weights, strict=True):
        total += weight / 2.0 * cosine_variances(middle + half_width * node, samples, interval_s)
    return total
