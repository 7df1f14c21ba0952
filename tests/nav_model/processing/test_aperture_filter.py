"""The aperture's filters against SciPy's Bessel functions and exact integrals."""

import math

import numpy as np
import pytest
from scipy.special import spherical_jn

from nav_model.processing.aperture_filter import filters, spherical_bessel, table


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
    found = filters(x)
    np.testing.assert_allclose(found["left_1"], x**4 / 45, rtol=1e-4)
    np.testing.assert_allclose(found["left_2"], x**6 / 1575, rtol=1e-4)
    np.testing.assert_allclose(found["quadratic"], x**4 / 4, rtol=1e-4)
    np.testing.assert_allclose(found["turned"], x**2, rtol=1e-4)


def test_both_sides_of_the_seam_are_one_minus_the_lower_orders():
    x = np.linspace(2.0, 6.0, 41)
    found = filters(x)
    for order in (1, 2, 3):
        rest = 1 - sum((2 * m + 1) * spherical_jn(m, x) ** 2 for m in range(order + 1))
        np.testing.assert_allclose(found[f"left_{order}"], rest, atol=1e-14)


@pytest.mark.parametrize("corner", [1e-4, 0.03, 0.4, 3.0, 20.0])
@pytest.mark.parametrize("name", ["quadratic", "cubic", "slope", "turned", "cubic_turned", "mean"])
def test_nodes_and_weights(name, corner):
    """A spectrum with its poles 30° off the axis, against a fine rule that knows nothing of the corner's place."""
    made = table()
    ours = made.weights @ (made.filters[name] / (1 + (made.nodes / corner) ** 6))
    edges = np.concatenate([np.geomspace(1e-9 * corner, 1, 2001), np.linspace(1, 60 * max(corner, 5), 4001)[1:]])
    nodes, weights = np.polynomial.legendre.leggauss(3)
    half = np.diff(edges)[:, None] / 2
    x = edges[:-1, None] + half * (1 + nodes)
    j0, j1, j2, j3, j4 = (spherical_jn(m, x) for m in range(5))
    by_hand = {
        "quadratic": 9 / 4 * 25 * j2**2, "cubic": 25 / 4 * 49 * j3**2, "slope": 9 * j1**2,
        "turned": (3 * j1 - 9 / 2 * j3) ** 2, "cubic_turned": 25 / 4 * (3 * j2 - 4 * j4) ** 2, "mean": j0**2,
    }[name]  # fmt: skip
    theirs = np.sum(half * weights * by_hand / (1 + (x / corner) ** 6))
    assert ours == pytest.approx(theirs, rel=3e-4 if corner > 10 else 2e-5)
