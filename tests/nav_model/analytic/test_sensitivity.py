"""Shares by source against Lyapunov solutions; logarithmic derivatives against 50-digit differences."""

import numpy as np
import pytest
from mpmath import mp
from scipy.linalg import solve_continuous_lyapunov

from nav_model.analytic.sensitivity import (
    horizontal_parts,
    log_derivatives,
    vertical_parts,
)
from nav_model.analytic.steady_state import horizontal, vertical


def _lyapunov_parts(reference, a, w, s, g, order=3):
    """Covariances of each source under the frozen optimal gain, and their sum, SI."""
    _, state, f, q, h = reference.channel(a, w, s, g, order)
    p = reference.continuous(a, w, s, g, order) / np.outer(state, state)
    gain = p @ h.T
    closed = f - gain @ h
    sources = [np.diag([0, q[1, 1], 0][:order])]
    if order == 3:
        sources.append(np.diag([0, 0, q[2, 2]]))
    sources.append(gain @ gain.T)
    return [solve_continuous_lyapunov(closed, -source) * np.outer(state, state) for source in sources]


def horizontal_shares(a, w, s, g):
    """Of accelerometer, gyro and GNSS in the variances of position, velocity and tilt, in this order."""
    parts, whole = horizontal_parts(a, w, s, g), horizontal(a, w, s, g)
    return [[getattr(part, name) / getattr(whole, name) for part in parts] for name in ("p11", "p22", "p33")]


def test_shares_against_the_lyapunov_equation(fleet, reference, compared):
    off = []
    shares = horizontal_shares(fleet.sigma_a, fleet.sigma_w, fleet.s, fleet.g)
    parts = horizontal_parts(fleet.sigma_a, fleet.sigma_w, fleet.s, fleet.g)
    for i in range(fleet.size):
        theirs = _lyapunov_parts(reference, fleet.sigma_a[i], fleet.sigma_w[i], fleet.s[i], fleet.g[i])
        whole = sum(theirs)
        for element, share in enumerate(shares):
            for ours, part in zip(share, theirs, strict=True):
                off.append(ours[i] - part[element, element] / whole[element, element])
        for ours, part in zip(parts, theirs, strict=True):
            sigma = np.sqrt(np.diagonal(whole))
            np.testing.assert_allclose(
                ours.matrix()[i] / np.outer(sigma, sigma), part / np.outer(sigma, sigma), atol=1e-9
            )
    compared(
        "Shares by source, 240 designs",
        "T-18",
        "solver written by others",
        "SciPy's Lyapunov solver on [T-1] with the gain of SciPy's Riccati solver",
        off,
        1e-9,
        "largest difference of a share",
    )


def test_vertical_parts_against_the_lyapunov_equation(fleet, reference):
    accelerometer, gnss = vertical_parts(fleet.sigma_a, fleet.s)
    for i in range(0, fleet.size, 4):
        theirs = _lyapunov_parts(reference, fleet.sigma_a[i], 0.0, fleet.s[i], fleet.g[i], order=2)
        for ours, part in zip((accelerometer, gnss), theirs, strict=True):
            np.testing.assert_allclose(
                [ours.v11[i], ours.v12[i], ours.v22[i]], [part[0, 0], part[0, 1], part[1, 1]], rtol=1e-9
            )


def test_sums(fleet):
    for share in horizontal_shares(fleet.sigma_a, fleet.sigma_w, fleet.s, fleet.g):
        np.testing.assert_allclose(sum(share), 1, rtol=0, atol=1e-12)
        for part in share:
            assert np.all(part >= 0)
    parts = horizontal_parts(fleet.sigma_a, fleet.sigma_w, fleet.s, fleet.g)
    whole = horizontal(fleet.sigma_a, fleet.sigma_w, fleet.s, fleet.g)
    for i, element in enumerate(whole):
        np.testing.assert_allclose(parts[0][i] + parts[1][i] + parts[2][i], element, rtol=1e-12)
    for parts_v, element in zip(
        zip(*vertical_parts(fleet.sigma_a, fleet.s), strict=True),
        vertical(fleet.sigma_a, fleet.s),
        strict=True,
    ):
        np.testing.assert_allclose(sum(parts_v), element, rtol=1e-12)


def _page_elements(a, w, s, g):
    """[T-3] in mpmath, its quartic by root finding."""
    p11 = mp.findroot(
        lambda x: x**4 / 4 - 2 * g * w * s**5 * x - s**6 * a**2,
        mp.sqrt(2) * s**1.5 * mp.sqrt(a) + 2 * (s**5 * g * w) ** (mp.mpf(1) / 3),
    )
    return (
        p11, p11**2 / (2 * s**2), w * s, p11**3 / (2 * s**4) - g * w * s, p11 * w / s,
        p11**2 * w / (2 * g * s**3),
    )  # fmt: skip


def test_logarithmic_derivatives(fleet):
    ours = log_derivatives(fleet.sigma_a, fleet.sigma_w, fleet.s, fleet.g)
    with mp.workdps(50):
        step = mp.mpf(10) ** -18
        for i in range(0, fleet.size, 16):
            point = [mp.mpf(float(x[i])) for x in (fleet.sigma_a, fleet.sigma_w, fleet.s, fleet.g)]
            for which, derivative in enumerate(ours):
                low, high = list(point), list(point)
                low[which] *= mp.exp(-step)
                high[which] *= mp.exp(step)
                for element, (x, y) in enumerate(zip(_page_elements(*low), _page_elements(*high), strict=True)):
                    slope = float(mp.log(y / x) / (2 * step))
                    assert float(derivative[element][i]) == pytest.approx(slope, rel=1e-9, abs=1e-11)


def test_gyro_dominated_limit():
    shares = horizontal_shares(1e-9, 1e-3, 1.0, 9.8)
    for (_, by_gyro, by_gnss), gyro in zip(shares, (1 / 6, 1 / 2, 5 / 6), strict=True):
        assert float(by_gyro) == pytest.approx(gyro, abs=1e-6)
        assert float(by_gnss) == pytest.approx(1 - gyro, abs=1e-6)
