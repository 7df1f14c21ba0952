"""Weightings of the aperture: uniform, Hamming and Taylor, and the first null of each."""

from functools import cache
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

from nav_model.base.arrays import Array

Window = Literal["uniform", "hamming", "taylor"]
WINDOWS: tuple[Window, ...] = ("uniform", "hamming", "taylor")

TAYLOR_LEVEL_DB = -35.0
TAYLOR_NBAR = 5


def weights_of(window: Window, x: ArrayLike) -> Array:
    """Weight at aperture positions x in [-1, 1]; Taylor after Taylor (1955), Carrara et al. (1995)."""
    x = np.asarray(x, float)
    if window == "hamming":
        return np.asarray(0.54 + 0.46 * np.cos(np.pi * x))
    weight = np.ones_like(x)
    for m, coefficient in enumerate(_taylor_coefficients() if window == "taylor" else (), start=1):
        weight += 2 * coefficient * np.cos(np.pi * m * x)
    return weight


@cache
def _taylor_coefficients() -> tuple[float, ...]:
    a = np.arccosh(10 ** (-TAYLOR_LEVEL_DB / 20)) / np.pi
    stretch = TAYLOR_NBAR**2 / (a**2 + (TAYLOR_NBAR - 0.5) ** 2)
    order = np.arange(1, TAYLOR_NBAR)
    coefficients = []
    for m in order:
        numerator = np.prod(1 - m**2 / (stretch * (a**2 + (order - 0.5) ** 2)))
        denominator = np.prod(1 - m**2 / order[order != m] ** 2)
        coefficients.append(float((-1) ** (m + 1) * numerator / (2 * denominator)))
    return tuple(coefficients)


@cache
def ideal_null_cells(window: Window) -> float:
    """Distance from the peak to the first null (first minimum) of the error-free response [cells].

    By golden-section refinement of a coarse line.
    """
    x, quadrature = np.polynomial.legendre.leggauss(64)
    weighted = quadrature * weights_of(window, x)

    def amplitude(cells: float) -> float:
        return abs(float(np.cos(np.pi * cells * x) @ weighted))

    step = 1 / 64
    cells = 0.0
    while amplitude(cells + step) < amplitude(cells):
        cells += step
    low, high = cells - step, cells + step
    ratio = (np.sqrt(5) - 1) / 2
    while high - low > 1e-9:
        inner, outer = high - ratio * (high - low), low + ratio * (high - low)
        low, high = (low, outer) if amplitude(inner) < amplitude(outer) else (inner, high)
    return float((low + high) / 2)
