"""Weightings of the aperture: uniform, Hamming and Taylor, and the first null of each."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

Window = Literal["uniform", "hamming", "taylor"]
WINDOWS: tuple[Window, ...] = ("uniform", "hamming", "taylor")

TAYLOR_LEVEL_DB = -35.0
TAYLOR_NBAR = 5

_FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Taper:
    """An aperture weighting: its name and, for Taylor, the side-lobe level [dB, negative] and nbar."""

    name: Window = "uniform"
    level_db: float = TAYLOR_LEVEL_DB
    nbar: int = TAYLOR_NBAR

    def __post_init__(self) -> None:
        if self.name not in WINDOWS:
            raise ValueError(f"window: {self.name!r} is not one of {', '.join(WINDOWS)}")
        if not (np.isfinite(self.level_db) and self.level_db < 0):
            raise ValueError(f"window level_db: {self.level_db} dB; a side-lobe level below 0 dB is needed")
        if self.nbar < 1:
            raise ValueError(f"window nbar: {self.nbar}; at least 1 is needed")

    def weights(self, x: ArrayLike) -> _FloatArray:
        """Weight at aperture positions x in [-1, 1]; Taylor after Taylor (1955), Carrara et al. (1995)."""
        x = np.asarray(x, float)
        if self.name == "uniform":
            return np.ones_like(x)
        if self.name == "hamming":
            return np.asarray(0.54 + 0.46 * np.cos(np.pi * x))
        weight = np.ones_like(x)
        for m, coefficient in enumerate(_taylor_coefficients(self.level_db, self.nbar), start=1):
            weight += 2 * coefficient * np.cos(np.pi * m * x)
        return weight


def as_taper(window: Window | Taper) -> Taper:
    """The window named, with the product's Taylor (-35 dB, nbar 5) unless a Taper says otherwise."""
    return window if isinstance(window, Taper) else Taper(window)


def ideal_null_cells(window: Window | Taper) -> float:
    """Distance from the peak to the first null (first minimum) of the error-free response [cells]."""
    return _ideal_null(as_taper(window))


@cache
def _taylor_coefficients(level_db: float, nbar: int) -> tuple[float, ...]:
    a = np.arccosh(10 ** (-level_db / 20)) / np.pi
    stretch = nbar**2 / (a**2 + (nbar - 0.5) ** 2)
    order = np.arange(1, nbar)
    coefficients = []
    for m in order:
        numerator = np.prod(1 - m**2 / (stretch * (a**2 + (order - 0.5) ** 2)))
        denominator = np.prod(1 - m**2 / order[order != m] ** 2)
        coefficients.append(float((-1) ** (m + 1) * numerator / (2 * denominator)))
    return tuple(coefficients)


@cache
def _ideal_null(taper: Taper) -> float:
    """First minimum of the error-free response, by golden-section refinement of a coarse line."""
    x, weights = np.polynomial.legendre.leggauss(64)
    weights = weights * taper.weights(x)

    def amplitude(cells: float) -> float:
        return abs(float(np.cos(np.pi * cells * x) @ weights))

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
