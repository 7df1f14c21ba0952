"""The aperture's filters against SciPy's Bessel functions and exact integrals."""

import math

import numpy as np
import pytest
import spectral
from scipy.special import spherical_jn

from nav_model.processing.aperture_filter import AVERAGES, OSCILLATING, filters, spherical_bessel


def test_spherical_bessel(compared):
    x = np.geomspace(1e-7, 3e3, 5000)
    ours = spherical_bessel(x)
    for m in range(4):
        size = np.minimum(1 / x, x**m / math.prod(range(1, 2 * m + 2, 2)))
        off = (ours[m] - spherical_jn(m, x)) / size
        compared(
            "Spherical Bessel functions of the aperture filters",
            "P-5",
            "solver written by others",
            "SciPy's spherical_jn",
            off,
            1e-12,
            "largest difference over the envelope",
        )


def test_near_zero_the_series():
    x = np.geomspace(1e-5, 1e-2, 20)
    result = filters(x)
    np.testing.assert_allclose(result["left_1"], x**4 / 45, rtol=1e-4)
    np.testing.assert_allclose(result["left_2"], x**6 / 1575, rtol=1e-4)
    np.testing.assert_allclose(result["quadratic"], x**4 / 4, rtol=1e-4)


def test_both_sides_of_the_seam_are_one_minus_the_lower_orders():
    x = np.linspace(2.0, 6.0, 41)
    result = filters(x)
    for order in (1, 2, 3):
        rest = 1 - sum((2 * m + 1) * spherical_jn(m, x) ** 2 for m in range(order + 1))
        np.testing.assert_allclose(result[f"left_{order}"], rest, atol=1e-14)


def test_filters_are_integrals_of_an_oscillation():
    """Against the fits' own kernels by quadrature, and beyond the oscillation their mean over a period."""
    x = np.linspace(0.01, 50.0, 400)
    result, theirs = filters(x), spectral.scaled(spectral.filters(x), 2.0)
    for name, values in result.items():
        np.testing.assert_allclose(values, theirs[name], atol=1e-12, err_msg=name)
    far = OSCILLATING * (1 + np.linspace(0, 0.5, 20_001))
    for name, values in filters(far).items():
        constant, fall = AVERAGES[name]
        mean = np.trapezoid(values - constant, far)
        assert mean == pytest.approx(np.trapezoid(fall / far**2, far), rel=0.02), name
