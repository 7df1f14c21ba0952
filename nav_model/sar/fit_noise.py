"""Effect of a slow GNSS error on the quadratic fitted to INS - GNSS, in addition to the white noise of [S-7].

The fixes are evenly spaced, so the error of a fitted coefficient is a sum over lags: r(k) rho^k, r the
autocorrelation of the orthogonal polynomial over the fixes (a polynomial in k itself) and rho^k the correlation
of a first-order Gauss-Markov error k fixes apart. Autocorrelations in closed form, found symbolically.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from nav_model.base.arrays import Array

_DIRECT = 2048  # lags summed one by one; beyond, the sum is an integral to one part in its square
_DECAYED = 40.0  # correlation times after which nothing is left
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(64)


class SlowFit(NamedTuple):
    """Of the line and the quadratic fitted at n fixes, at the ends of the aperture.

    ``slope``: variance [1/s²] of the line's slope over that of the slow error. ``quadratic``: likewise of the
    quadratic at the ends of the aperture. ``quadratic_from_start`` [m]: the quadratic there for an error of 1 m at
    the first fix that then decays: what correlates it with the state at the start of the aperture.
    """

    slope: Array
    quadratic: Array
    quadratic_from_start: Array


def slow_fit(
    correlation_time: float | None, fix_interval: ArrayLike, aperture_time: ArrayLike, fixes: ArrayLike
) -> SlowFit:
    """Part in the fit of a slow error of 1 m, 1σ; zeros without one, and where there are too few fixes to fit.

    Parameters
    ----------
    correlation_time : float, optional
        Of the slow error, s; None without one.
    fix_interval, aperture_time : array_like
        s.
    fixes : array_like
        In the aperture, rounded down to whole ones. They broadcast together.
    """
    t, dt, n = np.broadcast_arrays(
        *(np.asarray(x, float) for x in (aperture_time, fix_interval, np.floor(np.asarray(fixes, float) + 1e-9)))
    )
    parts = np.zeros((3, *n.shape))
    if correlation_time is not None:
        pairs, place = np.unique(np.stack([n.ravel(), dt.ravel()]), axis=1, return_inverse=True)
        sums = np.array([_sums(int(count), step / correlation_time) for count, step in pairs.T]).T
        parts = sums[:, np.ravel(place)].reshape(3, *n.shape)
        bend = 6 * (t / (2 * dt)) ** 2  # 6 i² leads the quadratic polynomial; i counts fixes
        parts = np.stack([(2 / dt) ** 2 * parts[0], bend**2 * parts[1], bend * parts[2]])
    return SlowFit(*parts)


def _sums(n: int, rate: float) -> tuple[float, float, float]:
    """Per unit sigma: variance of the coefficient of 2i - (n - 1), of that of 6i² - 6i(n - 1) + (n - 1)(n - 2),
    and the latter for exp(-rate i)."""
    if n < 2:
        return 0.0, 0.0, 0.0
    n1 = n * (n**2 - 1) / 3
    slope = 2 * _over_lags(lambda k: (n - k) * (n * n - 1 - 2 * n * k - 2 * k * k) / 3, n, rate) / n1**2
    if n < 3:
        return slope, 0.0, 0.0
    n2 = float(n) * (n**2 - 1) * (n**2 - 4) / 5

    def lagged(k: Array) -> Array:
        inner = 6 * k**4 + 6 * k**3 * n - 4 * (k * n) ** 2 + 10 * k**2 - 4 * k * n**3 + 10 * k * n
        return np.asarray((n - k) * (inner + float(n) ** 4 - 5 * n**2 + 4) / 5)

    def itself(i: Array) -> Array:
        return np.asarray(6 * i**2 - 6 * i * (n - 1) + (n - 1) * (n - 2))

    return slope, 2 * _over_lags(lagged, n, rate) / n2**2, _over_lags(itself, n, rate, whole=True) / n2


def _over_lags(f: Callable[[Array], Array], n: int, rate: float, whole: bool = False) -> float:
    """Sum over k = 1 .. n - 1 of f(k) (exp(-rate k) - 1).

    The constant does not matter, since the polynomials sum to zero over the fixes (over all lags); without it a slow
    error keeps its digits. ``whole``: f does not vanish at the last fix.
    """
    if n <= _DIRECT:
        k = np.arange(1.0, n)
        return float(np.sum(f(k) * np.expm1(-rate * k)))
    if rate * _DIRECT > _DECAYED:  # decayed within the lags summed one by one; there the two sums separate exactly
        k = np.arange(1.0, _DIRECT)
        first = float(f(np.zeros(1))[0])
        return float(np.sum(f(k) * np.exp(-rate * k))) + (first if whole else first / 2)
    last = n - 1.0 if whole else float(n)
    total = 0.0
    for low, high in ((0.0, min(last, _DECAYED / rate)), (min(last, _DECAYED / rate), last)):
        k = low + (high - low) * (_NODES + 1) / 2
        total += float(np.sum(_WEIGHTS * f(k) * np.expm1(-rate * k)) * (high - low) / 2)
    end = np.array([last])
    return total + (float((f(end) * np.expm1(-rate * end))[0]) / 2 if whole else 0.0)
