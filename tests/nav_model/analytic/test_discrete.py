"""The sawtooth of the discrete filter against Newton's method in 40 digits and against plain filtering."""

import numpy as np
import pytest

from nav_model.analytic.discrete import SlowError, cycle
from nav_model.analytic.steady_state import horizontal, vertical

pytestmark = pytest.mark.long

ORACLE = "SciPy's discrete Riccati solver on [T-1], refined by Newton steps in 40 digits"
MEASURE = "largest ratio − 1"


def _vertical_matrix(v, i):
    return np.array([[v.v11[i], v.v12[i]], [v.v12[i], v.v22[i]]])


@pytest.fixture(scope="module")
def ours(fleet):
    return cycle(fleet.sigma_a, fleet.sigma_w, fleet.g, fleet.interval, fleet.sigma, fleet.sigma_vertical)


def test_horizontal_cycle(fleet, reference, ours, compared, ratio_off):
    prior, posterior = ours.prior.horizontal.matrix(), ours.posterior.horizontal.matrix()
    off = []
    for i in range(fleet.size):
        exact = reference.discrete(fleet.sigma_a[i], fleet.sigma_w[i], fleet.sigma[i], fleet.interval[i], fleet.g[i])
        off += [ratio_off(prior[i], exact.prior), ratio_off(posterior[i], exact.posterior)]
    compared(
        "Before and after a fix, horizontal, 240 designs",
        "T-8",
        "solver written by others",
        ORACLE,
        off,
        1e-9,
        MEASURE,
    )


def test_vertical_cycle(fleet, reference, ours, compared, ratio_off):
    off = []
    for i in range(fleet.size):
        exact = reference.discrete(
            fleet.sigma_a[i], 0.0, fleet.sigma_vertical[i], fleet.interval[i], fleet.g[i], order=2
        )
        off.append(ratio_off(_vertical_matrix(ours.prior.vertical, i), exact.prior))
        off.append(ratio_off(_vertical_matrix(ours.posterior.vertical, i), exact.posterior))
    compared(
        "Before and after a fix, vertical, 240 designs", "T-8", "solver written by others", ORACLE, off, 1e-9, MEASURE
    )


def test_slow_error_cycle(fleet, reference, compared, ratio_off):
    """The filter augmented with a Gauss-Markov state, 0.1 to 3 m and 5 to 2000 s."""
    rng = np.random.default_rng(7)
    few = slice(0, fleet.size, 6)
    n = len(range(fleet.size)[few])
    sigma, correlation = np.exp(rng.uniform(np.log(0.1), np.log(3), n)), np.exp(rng.uniform(1.6, 7.6, n))
    a, w, g, dt, fix, up = (
        x[few] for x in (fleet.sigma_a, fleet.sigma_w, fleet.g, fleet.interval, fleet.sigma, fleet.sigma_vertical)
    )
    ours = cycle(a, w, g, dt, fix, up, SlowError(sigma, correlation))
    off = []
    for i in range(n):
        exact = reference.discrete(a[i], w[i], fix[i], dt[i], g[i], slow=(sigma[i], correlation[i]))
        off.append(ratio_off(ours.prior.horizontal.matrix()[i], exact.prior[:3, :3]))
        off.append(ratio_off(ours.posterior.horizontal.matrix()[i], exact.posterior[:3, :3]))
        exact = reference.discrete(a[i], 0.0, up[i], dt[i], g[i], order=2, slow=(sigma[i], correlation[i]))
        off.append(ratio_off(_vertical_matrix(ours.prior.vertical, i), exact.prior[:2, :2]))
        off.append(ratio_off(_vertical_matrix(ours.posterior.vertical, i), exact.posterior[:2, :2]))
    off = np.concatenate([part.ravel() for part in off])
    compared(
        "Before and after a fix with a slow GNSS error", "T-8", "solver written by others", ORACLE, off, 1e-9, MEASURE
    )


def test_plain_filtering_settles_there(worked):
    """Predict and update, 3000 times, as a flight computer would."""
    ours = cycle(worked.sigma_a, worked.sigma_w, worked.g, 1.0, 1.0, 1.0)
    phi = np.array([[1, 1, worked.g / 2], [0, 1, worked.g], [0, 0, 1]])
    f = np.array([[0.0, 1, 0], [0, 0, worked.g], [0, 0, 0]])
    nodes, weights = np.polynomial.legendre.leggauss(6)
    q = np.zeros((3, 3))
    for x, weight in zip((nodes + 1) / 2, weights / 2, strict=True):
        e = np.eye(3) + f * x + f @ f * x**2 / 2
        q += weight * e @ np.diag([0, worked.sigma_a**2, worked.sigma_w**2]) @ e.T
    p = np.eye(3)
    for _ in range(3000):
        prior = phi @ p @ phi.T + q
        gain = prior[:, 0] / (prior[0, 0] + 1)
        p = prior - np.outer(gain, prior[0])
        p = (p + p.T) / 2
    np.testing.assert_allclose(ours.prior.horizontal.matrix(), prior, rtol=1e-9)
    np.testing.assert_allclose(ours.posterior.horizontal.matrix(), p, rtol=1e-9)


def test_closed_form_lies_between_and_is_the_limit_of_frequent_fixes(fleet, ours):
    p = horizontal(fleet.sigma_a, fleet.sigma_w, fleet.s, fleet.g)
    v = vertical(fleet.sigma_a, fleet.sigma_vertical * np.sqrt(fleet.interval))
    # At lambda dt = 6.9 the tilt's closed form lies below both ends: the flag at 0.5 is there for a reason.
    usual = p.p11 * fleet.interval / fleet.s**2 < 2
    assert usual.sum() > 200
    for low, middle, high in (
        *((getattr(ours.posterior.horizontal, k), getattr(p, k), getattr(ours.prior.horizontal, k))
          for k in ("p11", "p22", "p33")),
        *((getattr(ours.posterior.vertical, k), getattr(v, k), getattr(ours.prior.vertical, k))
          for k in ("v11", "v22")),
    ):  # fmt: skip
        assert np.all((low < middle)[usual])
        assert np.all((middle < high)[usual])
    often = cycle(fleet.sigma_a, fleet.sigma_w, fleet.g, 1e-5, fleet.s / 10**-2.5, fleet.s / 10**-2.5)
    np.testing.assert_allclose(often.prior.horizontal.p11, p.p11, rtol=1e-3)
    np.testing.assert_allclose(often.posterior.horizontal.p33, p.p33, rtol=1e-3)


def test_a_slow_error_hurts_and_vanishes_with_its_size(worked):
    args = (worked.sigma_a, worked.sigma_w, worked.g, 1.0, 1.0, 1.0)
    white = cycle(*args)
    tiny = cycle(*args, SlowError(1e-6, 100.0))
    np.testing.assert_allclose(tiny.prior.horizontal.matrix(), white.prior.horizontal.matrix(), rtol=1e-9)
    last = float(white.prior.horizontal.p11)
    for sigma in (0.1, 0.5, 2.0):
        now = float(cycle(*args, SlowError(sigma, 100.0)).prior.horizontal.p11)
        assert now > last
        last = now
    assert last == pytest.approx(4.0, rel=0.25)  # a bias of the fixes that the inertial unit cannot see
    # An error that is forgotten between fixes is white noise on top of theirs.
    fast, sum_ = cycle(*args, SlowError(1.0, 0.01)), cycle(*args[:4], np.sqrt(2), np.sqrt(2))
    np.testing.assert_allclose(fast.prior.horizontal.matrix(), sum_.prior.horizontal.matrix(), rtol=1e-9)


def test_cycle_broadcasts(worked):
    grid = cycle(worked.sigma_a, worked.sigma_w, worked.g, np.array([[0.5], [1.0]]), np.array([0.1, 1.0, 2.0]), 1.0)
    assert grid.prior.horizontal.p11.shape == (2, 3)
    one = cycle(worked.sigma_a, worked.sigma_w, worked.g, 1.0, 2.0, 1.0)
    assert grid.posterior.horizontal.p23[1, 2] == pytest.approx(float(one.posterior.horizontal.p23), rel=1e-11)
