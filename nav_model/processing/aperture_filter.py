"""The aperture as a filter on the spectrum of the line-of-sight error. [P-5]

Over an aperture of T seconds an oscillation exp(i w t) has the Legendre coefficients (2m + 1) iᵐ j_m(x), with
x = w T/2 and j_m the spherical Bessel function. Quadratic and cubic phase, the slope and what is left after autofocus
are therefore integrals of the spectrum times functions of x alone.
"""

import math
from collections.abc import Mapping
from functools import cache
from types import MappingProxyType

import numpy as np

from nav_model.base.arrays import Array, as_numbers

_SERIES_BELOW = 4.0  # in x: the power series there, the recurrence above
_TERMS = 30
_HIGHEST = 24  # order of j_m beyond which nothing is left of it below the seam
OSCILLATING = 16 * math.pi
"""x beyond which filters are taken without their oscillation."""


def spherical_bessel(x: Array, highest: int = 3) -> Array:
    """j_0 to j_`highest` of x > 0, shape (highest + 1, ...), good to rounding relative to each function's size.

    Power series below x = 4; above, the recurrence upwards, which is stable while the order stays below x. Takes
    complex steps.
    """
    x = as_numbers(x)
    near = x.real < _SERIES_BELOW
    j = np.empty((highest + 1, *x.shape), x.dtype)
    small, large = x[near], x[~near]
    sums = np.vander(-(small**2) / 2, _TERMS, increasing=True) @ _series()[:, : highest + 1]
    j[:, near] = (np.vander(small, highest + 1, increasing=True) * sums).T
    j_m = np.sin(large) / large
    j_next = (j_m - np.cos(large)) / large
    for m in range(highest + 1):
        j[m, ~near] = j_m
        j_m, j_next = j_next, (2 * m + 3) / large * j_next - j_m
    return j


@cache
def _series() -> Array:
    """Coefficients of j_m(x)/x^m in powers of -x²/2, shape (terms, orders)."""
    series = np.empty((_TERMS, _HIGHEST + 1))
    for m in range(_HIGHEST + 1):
        series[0, m] = 1 / math.prod(range(1, 2 * m + 2, 2))
        for k in range(1, _TERMS):
            series[k, m] = series[k - 1, m] / (k * (2 * m + 2 * k + 1))
    return series


def _left(x: Array, square: Array) -> dict[str, Array]:
    """Mean square left after the polynomials up to orders 1, 2, 3: one less the sum of (2m + 1) j_m².

    Below the seam as the sum of the higher orders, which does not cancel: x⁴/45 after order 1, x⁶/1575 after 2.
    `square` holds those terms for the orders up to 3.
    """
    near = x.real < _SERIES_BELOW
    order_3 = np.asarray(1 - square.sum(axis=0))
    weight = 2 * np.arange(4, _HIGHEST + 1) + 1
    order_3[near] = np.tensordot(weight, spherical_bessel(x[near], _HIGHEST)[4:] ** 2, 1)
    return {"left_3": order_3, "left_2": order_3 + square[3], "left_1": order_3 + square[3] + square[2]}


def filters(x: Array) -> dict[str, Array]:
    """Each filter at x = w T/2.

    ``quadratic`` and ``cubic`` are of the coefficients of x² and x³ (as in `nav_model.aperture.phase`), ``left_1`` to
    ``left_3`` of the mean square after autofocus to that order, ``slope`` of half the aperture times the slope
    of the line, ``mean`` of the mean over the aperture.
    """
    x = as_numbers(x)
    j0, j1, j2, j3 = spherical_bessel(x)
    square = np.stack([j0**2, 3 * j1**2, 5 * j2**2, 7 * j3**2])
    return _left(x, square) | {
        "quadratic": 9 / 4 * 5 * square[2],
        "cubic": 25 / 4 * 7 * square[3],
        "slope": 3 * square[1],
        "mean": square[0],
    }


AVERAGES: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "quadratic": (0.0, 9 / 8 * 25), "cubic": (0.0, 25 / 8 * 49), "slope": (0.0, 9 / 2), "mean": (0.0, 1 / 2),
        **{f"left_{n}": (1.0, -sum((2 * m + 1) / 2 for m in range(n + 1))) for n in (1, 2, 3)},
    }
)  # fmt: skip
"""Each filter far above x = 1 without its oscillation: the one plus the other over x². Beyond `OSCILLATING`, a
multiple of pi/2, what oscillates integrates to nothing in first order."""
