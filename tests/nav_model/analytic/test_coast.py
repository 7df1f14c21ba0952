"""Outage polynomials against matrix exponentials."""

import numpy as np
import pytest
import riccati
from hypothesis import given
from hypothesis import strategies as st

from nav_model.analytic.coast import (
    bias_position,
    bias_velocity,
    horizontal_growth,
    initial_tilt,
    perfect_start,
    vertical_growth,
)
from nav_model.analytic.steady_state import Horizontal, Vertical, horizontal, vertical

TIMES = (0.0, 0.3, 7.0, 50.0, 400.0)


def _grow(reference, start, a, w, s, g, t, order):
    """P(t) = Phi P Phi' + Q(t) by Van Loan, in the units of the channel; `start` and result in SI."""
    tau, state, f, q, _ = reference.channel(a, w, s, g, order)
    phi, added = riccati.van_loan(f, q, t / tau)
    unit = np.outer(state, state)
    return (phi @ (start / unit) @ phi.T + added) * unit


def test_outage_from_the_steady_state(fleet, reference, compared, ratio_off):
    p = horizontal(fleet.sigma_a, fleet.sigma_w, fleet.s, fleet.g)
    v = vertical(fleet.sigma_a, fleet.s)
    starts, ups = p.matrix(), np.array([[v.v11, v.v12], [v.v12, v.v22]])
    off, off_vertical = [], []
    for t in TIMES:
        level = horizontal_growth(p, fleet.sigma_a, fleet.sigma_w, fleet.g, t)
        upright = vertical_growth(v, fleet.sigma_a, t)
        for i in range(fleet.size):
            a, w, s, g = fleet.sigma_a[i], fleet.sigma_w[i], fleet.s[i], fleet.g[i]
            grown = _grow(reference, starts[i], a, w, s, g, t, 3)
            off.append(ratio_off([level.position[i], level.velocity[i], level.tilt[i]], np.diag(grown)))
            grown = _grow(reference, ups[:, :, i], a, 0.0, s, g, t, 2)
            off_vertical.append(ratio_off([upright.position[i], upright.velocity[i]], np.diag(grown)))
    oracle = "SciPy's matrix exponential (Van Loan) of [T-1], written out in the test"
    compared("Outage to 400 s, horizontal, 240 designs", "T-9", "solver written by others", oracle, off, 1e-9)
    compared(
        "Outage to 400 s, vertical, 240 designs",
        "T-10",
        "solver written by others",
        oracle,
        off_vertical,
        1e-9,
    )


def test_outage_from_any_covariance(reference):
    """Random positive definite starts: every cross term carries its own coefficient."""
    rng = np.random.default_rng(3)
    for _ in range(50):
        root = rng.standard_normal((3, 3)) * np.array([1.0, 0.1, 0.01])[:, None]
        start = root @ root.T
        a, w, t, g = 1e-2, 1e-3, rng.uniform(0.1, 20), 9.8
        grown = _grow(reference, start, a, w, 1.0, g, t, 3)
        ours = horizontal_growth(Horizontal.of(start), a, w, g, t)
        np.testing.assert_allclose(ours, np.diagonal(grown), rtol=1e-9)
        up = start[:2, :2]
        grown = _grow(reference, up, a, 0.0, 1.0, g, t, 2)
        ours_v = vertical_growth(Vertical(up[0, 0], up[0, 1], up[1, 1]), a, t)
        np.testing.assert_allclose(ours_v, np.diagonal(grown), rtol=1e-9)


def test_perfect_start_and_tilt_share(fleet, reference, compared, ratio_off):
    off, off_tilt = [], []
    p33 = horizontal(fleet.sigma_a, fleet.sigma_w, fleet.s, fleet.g).p33
    for t in TIMES[1:]:
        level, upright = perfect_start(fleet.sigma_a, fleet.sigma_w, fleet.g, t)
        tilted = initial_tilt(p33, fleet.g, t)
        for i in range(0, fleet.size, 4):
            a, w, s, g = fleet.sigma_a[i], fleet.sigma_w[i], fleet.s[i], fleet.g[i]
            across = _grow(reference, np.zeros((3, 3)), a, w, s, g, t, 3)[0, 0]
            down = _grow(reference, np.zeros((2, 2)), a, 0.0, s, g, t, 2)[0, 0]
            off.append(ratio_off([level[i], upright[i]], [across, down]))
            only_tilt = np.diag([0, 0, p33[i]])
            off_tilt.append(ratio_off(tilted[i], _grow(reference, only_tilt, a, w, s, g, t, 3)[0, 0] - across))
    oracle = "SciPy's matrix exponential (Van Loan) of [T-1], written out in the test"
    compared("Outage from a perfect start", "T-11", "solver written by others", oracle, off, 1e-9)
    compared("Share of the initial tilt", "T-12", "solver written by others", oracle, off_tilt, 1e-6)


@given(st.floats(0, 500), st.floats(0, 0.1), st.floats(0, 1e-3))
def test_biases_integrate_the_deterministic_equations(t, b, d):
    """p'' = b + g tilt, tilt' = d, in exact polynomials of NumPy."""
    g = 9.81
    tilt = np.polynomial.Polynomial([0, d])
    for source, i in ((np.polynomial.Polynomial([b]), 0), (g * tilt, 1)):
        velocity = source.integ()
        assert float(bias_velocity(b, d, g, t)[i]) == pytest.approx(velocity(t), rel=1e-14, abs=1e-300)
        assert float(bias_position(b, d, g, t)[i]) == pytest.approx(velocity.integ()(t), rel=1e-14, abs=1e-300)
