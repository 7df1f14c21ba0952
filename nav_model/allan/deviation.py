"""Overlapping Allan deviation with confidence (NIST SP 1065; IEEE Std 952 annex C).

Thirty lines of NumPy, tested against Stable32, the NBS14 set and allantools. The latter is not used here because it
installs packages for tests and documentation.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nav_model.allan.degrees import pooled_degrees
from nav_model.allan.imu_log import NO_BREAKS
from nav_model.base.arrays import Array
from nav_model.base.sampling import Rows

TAUS_PER_DECADE = 12
_BLOCK = 1 << 14  # samples at a time: what is added up stays in the processor's cache

# Slope of the fractional-frequency spectrum that each noise term has, as Greenhall and Riley number them.
NOISE_ALPHA = {
    "quantization": 2,
    "random_walk": 0,
    "bias_instability": -1,
    "rate_random_walk": -2,
    "ramp": -2,
}


@dataclass(frozen=True)
class AllanDeviation:
    """Averaging times [s], and deviations with confidence limits in the rate's unit."""

    tau_s: Array
    deviation: Array
    low: Array
    high: Array


def averaging_times(samples: int, interval_s: float) -> Array:
    """Logarithmic averaging times [s], whole samples, from one sample to a quarter of the log."""
    longest = max(1, samples // 4)
    count = max(2, int(np.log10(longest) * TAUS_PER_DECADE) + 1)
    factors = np.unique(np.round(np.geomspace(1, longest, count)))
    return np.asarray(factors * interval_s, dtype=np.float64)


def overlapping_allan_deviation(
    rate_signal: Array,
    interval_s: float,
    tau_s: Array | None = None,
    alpha: Array | None = None,
    confidence: float = 0.95,
    breaks: Rows = NO_BREAKS,
) -> AllanDeviation:
    """Overlapping Allan deviation of a rate signal, with confidence limits.

    Over gaps in the signal it is the mean over the stretches between them, each with its number of pairs as weight.

    Parameters
    ----------
    rate_signal : array, shape (samples,)
        In any unit; its mean does not matter.
    interval_s : float
        Between two samples [s].
    tau_s : array, shape (times,), optional
        Averaging times [s]: whole multiples of `interval_s` up to a third of the longest stretch. Default:
        `averaging_times`.
    alpha : array, shape (times,), optional
        Slope of the noise that dominates at each averaging time (NOISE_ALPHA), on which the degrees of freedom
        depend. Default: white rate noise.
    confidence : float
        Share of cases in which the limits (chi-square) hold the true deviation.
    breaks : array, optional
        The first sample after each gap.

    Returns
    -------
    AllanDeviation
        One value for each averaging time.

    Raises
    ------
    ValueError
        If an averaging time is no multiple of the interval, or the log is too short for it.

    Examples
    --------
    >>> found = overlapping_allan_deviation(np.array([1.0, 2.0, 1.0, 2.0, 1.0, 2.0]), 0.5, np.array([0.5]))
    >>> round(float(found.deviation[0]), 3)
    0.707
    """
    edges = np.concatenate([[0], breaks, [len(rate_signal)]])
    lengths = np.diff(edges)
    longest = int(lengths.max())
    taus = averaging_times(longest, interval_s) if tau_s is None else np.asarray(tau_s, dtype=np.float64)
    factors = np.round(taus / interval_s).astype(np.int64)
    bad = (np.abs(factors * interval_s - taus) > 1e-6 * taus) | (factors < 1) | (3 * factors > longest)
    if len(taus) == 0 or np.any(bad):
        worst = taus[bad][0] if len(taus) else "none given"
        raise ValueError(
            f"tau_s: {worst} s; averaging times are whole multiples of {interval_s:g} s "
            f"up to a third of the log ({longest // 3 * interval_s:g} s)"
        )
    # In units of the sample: an angle for a rate. Without the mean, which cancels anyway, no digits are lost.
    phase = np.concatenate([[0.0], np.cumsum(rate_signal - np.mean(rate_signal))])
    stretch = np.repeat(np.arange(len(lengths)), lengths) if len(lengths) > 1 else None
    deviation = np.array([_deviation(phase, factor, stretch) for factor in factors])
    slopes = np.zeros(len(taus)) if alpha is None else np.asarray(alpha)
    degrees = np.array([pooled_degrees(int(a), int(m), lengths) for a, m in zip(slopes, factors, strict=True)])
    low, high = _limits(deviation, degrees, confidence)
    return AllanDeviation(taus, deviation, low, high)


def _deviation(phase: Array, factor: int, stretch: NDArray[np.int64] | None) -> float:
    """At one averaging time in samples (SP 1065 equation 11), over pairs of averages within one `stretch`."""
    pairs, squares, used = len(phase) - 2 * factor, 0.0, 0
    for start in range(0, pairs, _BLOCK):
        count = min(_BLOCK, pairs - start)
        early, middle, late = (phase[start + k * factor :][:count] for k in range(3))
        second = late - 2.0 * middle + early
        if stretch is not None:
            second = second[stretch[start:][:count] == stretch[start + 2 * factor - 1 :][:count]]
        used += len(second)
        squares += float(np.sum(np.square(second, out=second)))
    return float(np.sqrt(squares / used / 2.0) / factor)


def _limits(deviation: Array, degrees: Array, confidence: float) -> tuple[Array, Array]:
    """Lower and upper confidence limits of a deviation with so many degrees of freedom."""
    from scipy.special import chdtri

    tail = (1.0 - confidence) / 2.0
    low, high = (deviation * np.sqrt(degrees / chdtri(degrees, p)) for p in (tail, 1.0 - tail))
    return low, high
