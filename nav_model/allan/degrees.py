"""Degrees of freedom of an overlapping Allan variance (C. Greenhall and W. Riley, PTTI 2003).

Overlapping pairs are correlated: n of them determine the variance only as well as a smaller number of independent
pairs, the equivalent degrees of freedom, which depend on the slope of the noise. Section and table numbers here are
those of that paper ("Uncertainty of stability variances based on finite differences").
"""

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import Array

_MOST_TERMS = 100  # of the sum; beyond, the tables

# Table 2, second differences: 1/edf ≈ (a0 − a1/r)/r for each slope alpha; slope 1 over (b0 + b1 ln m)² of table 3.
_TABLE_2 = {1: (790.0, 410.0), 0: (2 / 3, 1 / 3), -1: (0.852, 0.375), -2: (1.079, 0.368)}
_TABLE_3 = (15.23, 12.0)
_LAG_CORRELATION = (
    2 / 3,
    1 / 6,
)  # magnitude, of second differences of white phase, one and two averaging times apart


@lru_cache(maxsize=1 << 15)
def degrees_of_freedom(alpha: int, factor: int, samples: int) -> float:
    """Equivalent degrees of freedom of the overlapping Allan variance of `samples` rates.

    Parameters
    ----------
    alpha : int
        Slope of the spectrum of the rate, S(f) ∝ f^alpha: 2, 1, 0, -1 or -2.
    factor : int
        Averaging time in samples, at most a third of `samples`.
    samples : int
        Length of the log.

    Returns
    -------
    float
        Number of independent pairs that would determine the variance as well.

    Examples
    --------
    >>> round(degrees_of_freedom(0, 10, 1000), 1)
    135.1
    """
    pairs = samples + 1 - 2 * factor
    ratio = pairs / factor
    if alpha == 2:
        # Second differences of white phase share samples only at whole averaging times apart. From a ratio of 2 on
        # this is the paper's (a0 − a1/r)/pairs with a0 = 35/18 and a1 = 1.
        lags = enumerate(_LAG_CORRELATION, start=1)
        return pairs / (1.0 + 2.0 * sum(max(0.0, 1.0 - lag / ratio) * rho**2 for lag, rho in lags))
    terms = min(pairs, 3 * factor)
    if terms <= _MOST_TERMS:
        # Continuous averaging (an infinite factor) is accurate enough, and keeps its digits, for large factors.
        smooth = alpha <= 0 and 3 * factor > _MOST_TERMS
        return pairs / _basic_sum(alpha, terms, pairs, factor, math.inf if smooth else factor)
    log_term = (_TABLE_3[0] + _TABLE_3[1] * math.log(factor)) ** 2 if alpha == 1 else 1.0
    if ratio > 3.0:
        a0, a1 = _TABLE_2[alpha]
        return ratio * log_term / (a0 - a1 / ratio)
    # At most this many terms are summed: fewer and coarser steps over the same length of log.
    step = _MOST_TERMS / ratio
    if alpha == 1:
        middle = float(_covariance(np.zeros(1), step, alpha)[0]) ** 2
        return _MOST_TERMS * log_term / (_basic_sum(alpha, _MOST_TERMS, _MOST_TERMS, step, step) * middle)
    return _MOST_TERMS / _basic_sum(alpha, _MOST_TERMS, _MOST_TERMS, step, math.inf)


def pooled_degrees(alpha: int, factor: int, lengths: NDArray[np.int64]) -> float:
    """Degrees of freedom of the mean over stretches of these lengths, each weighted by its number of pairs.

    Stretches are taken as independent. Those of less than three averaging times, of which little is known, count as
    one degree of freedom each.
    """
    used = lengths[lengths >= 2 * factor]
    variance, pairs = 0.0, float(np.sum(used + 1 - 2 * factor))
    for length, count in zip(*np.unique(used, return_counts=True), strict=True):
        weight = float(length + 1 - 2 * factor) / pairs
        freedom = degrees_of_freedom(alpha, factor, int(length)) if length >= 3 * factor else 1.0
        variance += float(count) * weight**2 / freedom
    return 1.0 / variance


def _basic_sum(alpha: int, terms: int, pairs: int, per_time: float, factor: float) -> float:
    """Sum of squared correlations of pairs 0 to `terms` steps apart, of which `per_time` make one averaging time
    (equation 10 over the variance squared)."""
    steps = np.arange(terms + 1)
    squared = _covariance(steps / per_time, factor, alpha) ** 2
    weights = 2.0 * (1.0 - steps / pairs)
    weights[0] = 1.0
    weights[-1] /= 2.0
    return float(weights @ squared) / float(squared[0])


def _covariance(lags: Array, factor: float, alpha: int) -> Array:
    """Covariance of two second differences, `lags` averaging times apart, up to a scale (equation 9)."""
    return (
        6.0 * _of_averages(lags, factor, alpha)
        - 4.0 * (_of_averages(lags - 1.0, factor, alpha) + _of_averages(lags + 1.0, factor, alpha))
        + (_of_averages(lags - 2.0, factor, alpha) + _of_averages(lags + 2.0, factor, alpha))
    )


def _of_averages(lags: Array, factor: float, alpha: int) -> Array:
    """Structure function of the phase, sampled `factor` times in an averaging time or without end (equation 8)."""
    if math.isinf(factor):
        return _of_phase(lags, alpha + 2)
    nearer, farther = _of_phase(lags - 1.0 / factor, alpha), _of_phase(lags + 1.0 / factor, alpha)
    return factor**2 * (2.0 * _of_phase(lags, alpha) - nearer - farther)


def _of_phase(lags: Array, alpha: int) -> Array:
    """Generalised covariance of the phase, but for its sign (equation 7): |t|^p, times ln|t| where p is even."""
    size, power = np.abs(lags), 3 - alpha
    if power % 2:
        return size**power
    return size**power * np.log(np.where(size > 0.0, size, 1.0))
