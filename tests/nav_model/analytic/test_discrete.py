"""The sawtooth of the discrete filter against SciPy's Riccati solver."""

import numpy as np
import pytest

from nav_model.analytic.discrete import SlowError, cycle

pytestmark = pytest.mark.long

ORACLE = "SciPy's discrete Riccati solver on [T-1], written out in the test"


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
    )


def test_vertical_cycle(fleet, reference, ours, compared, ratio_off):
    off = []
    for i in range(fleet.size):
        exact = reference.discrete(
            fleet.sigma_a[i], 0.0, fleet.sigma_vertical[i], fleet.interval[i], fleet.g[i], order=2
        )
        off.append(ratio_off(_vertical_matrix(ours.prior.vertical, i), exact.prior))
        off.append(ratio_off(_vertical_matrix(ours.posterior.vertical, i), exact.posterior))
    compared("Before and after a fix, vertical, 240 designs", "T-8", "solver written by others", ORACLE, off, 1e-9)


def test_slow_error_cycle(fleet, reference, compared, ratio_off):
    """The filter augmented with a Gauss-Markov state, 0.1 to 3 m and 5 to 2000 s."""
    rng = np.random.default_rng(7)
    few = slice(0, fleet.size, 6)
    n = len(range(fleet.size)[few])
    sigma, correlation = np.exp(rng.uniform(np.log(0.1), np.log(3), n)), np.exp(rng.uniform(1.6, 7.6, n))
    a, w, g, dt, fix, up = (
        x[few] for x in (fleet.sigma_a, fleet.sigma_w, fleet.g, fleet.interval, fleet.sigma, fleet.sigma_vertical)
    )
    ours = cycle(a, w, g, dt, fix, up, SlowError(sigma, sigma[::-1], correlation))
    off = []
    for i in range(n):
        exact = reference.discrete(a[i], w[i], fix[i], dt[i], g[i], slow=(sigma[i], correlation[i]))
        off.append(ratio_off(ours.prior.horizontal.matrix()[i], exact.prior[:3, :3]))
        off.append(ratio_off(ours.posterior.horizontal.matrix()[i], exact.posterior[:3, :3]))
        exact = reference.discrete(a[i], 0.0, up[i], dt[i], g[i], order=2, slow=(sigma[n - 1 - i], correlation[i]))
        off.append(ratio_off(_vertical_matrix(ours.prior.vertical, i), exact.prior[:2, :2]))
        off.append(ratio_off(_vertical_matrix(ours.posterior.vertical, i), exact.posterior[:2, :2]))
    off = np.concatenate([part.ravel() for part in off])
    # Its rounding: test_settled_filter has the covariances to nine digits.
    compared("Before and after a fix with a slow GNSS error", "T-8", "solver written by others", ORACLE, off, 1e-6)
