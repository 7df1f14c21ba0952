"""Aperture, windows and line of sight against root finding, exact ranges and the page's tables."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from nav_model.aperture.geometry import (
    WINDOW_WIDTH,
    aperture_time,
    cell_length,
)


def _hamming(x):
    return 0.54 * np.sinc(x) + 0.23 * (np.sinc(x - 1) + np.sinc(x + 1))


def _taylor(level_db, nbar):
    """Taylor's pattern as a product over its zeros, from his 1955 definition."""
    a = math.acosh(10 ** (level_db / 20)) / math.pi
    sigma2 = nbar**2 / (a**2 + (nbar - 0.5) ** 2)

    def pattern(x):
        value = np.sinc(x)
        for n in range(1, nbar):
            value *= (1 - x**2 / (sigma2 * (a**2 + (n - 0.5) ** 2))) / (1 - (x / n) ** 2)
        return value

    return pattern


@pytest.mark.parametrize(
    ("window", "pattern", "printed"),
    [("uniform", np.sinc, 0.8859), ("hamming", _hamming, 1.3030), ("taylor", _taylor(35, 5), 1.1875)],
)
def test_window_widths_are_roots_of_the_transforms(window, pattern, printed, compared, ratio_off):
    half = brentq(lambda x: pattern(x) / pattern(0.0) - math.sqrt(0.5), 0.2, 0.9, xtol=1e-15)
    compared(
        "Half-power width of each window",
        "S-3",
        "solver written by others",
        "SciPy's root finder on each window's transform, written out in the test from Taylor 1955",
        ratio_off(WINDOW_WIDTH[window], 2 * half),
        1e-12,
    )
    assert WINDOW_WIDTH[window] == pytest.approx(printed, abs=5e-5)


def test_mathworks_example_of_the_presets_page(compared):
    """10 GHz, 10 km, 100 m/s, 1 m: 1.4990 s with k = 1."""
    t = aperture_time(299792458 / 10e9, 10e3, 100.0, 1.0, "uniform") / WINDOW_WIDTH["uniform"]
    compared(
        "Aperture time of a printed example",
        "S-3",
        "published figure",
        "MathWorks example, 1.4990 s",
        t - 1.4990,
        5e-5,
        "difference, s",
    )


@pytest.mark.parametrize("squint", [-0.7, 0.4])
def test_a_squinted_cell_is_half_a_wavelength_of_range_difference(squint):
    """Two points a cell apart across the line of sight: their exact ranges part by half a wavelength."""
    wavelength, far, speed, span = 0.031, 8000.0, 110.0, 4.0
    cell = float(cell_length(wavelength, far, speed, span, squint))
    target = far * np.array([np.sin(squint), np.cos(squint)])
    other = target + cell * np.array([np.cos(squint), -np.sin(squint)])
    ends = np.array([[-speed * span / 2, 0.0], [speed * span / 2, 0.0]])
    parted = [np.linalg.norm(other - end) - np.linalg.norm(target - end) for end in ends]
    assert abs(parted[1] - parted[0]) == pytest.approx(wavelength / 2, rel=1e-3)
    assert aperture_time(wavelength, far, speed, WINDOW_WIDTH["uniform"] * cell, "uniform", squint) == pytest.approx(
        span
    )
