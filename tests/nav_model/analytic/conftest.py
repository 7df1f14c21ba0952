"""Riccati solutions that owe nothing to the closed forms: SciPy's, in units that suit it, and by doubling in as many
digits as asked for."""

from types import SimpleNamespace

import numpy as np
import pytest
import riccati
from mpmath import mp
from scipy.linalg import solve_continuous_are

from nav_model.base.constants import MEAN_RADIUS

CHAIN = np.array([[0.0, 1, 0], [0, 0, 1], [0, 0, 0]])  # position, velocity, g x tilt


def _units(sigma_a, sigma_w, s, g):
    """Time and state units in which the channel is the chain of integrators with noises of at most one."""
    tau = np.sqrt(s / sigma_a)
    if sigma_w > 0:
        tau = min(tau, np.cbrt(s / (g * sigma_w)))
    length = s / np.sqrt(tau)
    state = np.array([length, length / tau, length / (g * tau**2)])
    q = np.diag([0, sigma_a**2 * tau**3 / length**2, (g * sigma_w) ** 2 * tau**5 / length**2])
    return tau, state, q


def _channel(sigma_a, sigma_w, s, g, order):
    tau, state, q = _units(sigma_a, sigma_w, s, g)
    return tau, state[:order], CHAIN[:order, :order], q[:order, :order], np.eye(order)[:1]


def continuous(sigma_a, sigma_w, s, g, order=3):
    """Steady covariance of one channel, SI, from SciPy's continuous Riccati solver."""
    _, state, f, q, h = _channel(sigma_a, sigma_w, s, g, order)
    return solve_continuous_are(f.T, h.T, q, np.eye(1)) * np.outer(state, state)


def discrete(sigma_a, sigma_w, sigma, interval, g, order=3, slow=None):
    """Prior and posterior of one channel, SI, from SciPy's discrete Riccati solver.

    Two states are the vertical channel, whose gravity decreases with height by 2 g/R.
    """
    tau, state, f, q, h = _channel(sigma_a, sigma_w, sigma * np.sqrt(interval), g, order)
    if order == 2:
        f = f + np.array([[0.0, 0.0], [2 * g / MEAN_RADIUS * tau**2, 0.0]])
    phi, added = riccati.van_loan(f, q, interval / tau)
    if slow is not None:
        slow_sigma, correlation = slow
        phi, added = (np.pad(part, (0, 1)) for part in (phi, added))
        phi[order, order] = np.exp(-interval / correlation)
        added[order, order] = -((slow_sigma / state[0]) ** 2) * np.expm1(-2 * interval / correlation)
        h, state = np.append(h, [[1.0]], axis=1), np.append(state, state[0])
    # The units have balanced it; balancing once more ends, in some processors' arithmetic, in a system so badly
    # scaled that SciPy gives up.
    prior, posterior = riccati.settled(phi, added, h, (sigma / state[0]) ** 2, balanced=False)
    unit = np.outer(state, state)
    return SimpleNamespace(prior=prior * unit, posterior=posterior * unit)


def _upright_channel(a, g, h):
    """The same of the vertical channel, with gravity that decreases with height by 2 g/R."""
    root = mp.sqrt(2 * g / mp.mpf(MEAN_RADIUS))
    sine, cosine, qa = mp.sinh(root * h) / root, mp.cosh(root * h), a**2
    rows = [
        [qa * (sine * cosine - h) / (2 * root**2), qa * sine**2 / 2, 0],
        [qa * sine**2 / 2, qa * (sine * cosine + h) / 2, 0],
        [0, 0, mp.mpf(10) ** -80],
    ]
    return rows, [[cosine, sine, 0], [root**2 * sine, cosine, 0], [0, 0, mp.mpf(1) / 2]]


def _exact_channel(a, w, g, h):
    """Process noise and transition, from the integrals of [T-1]."""
    qa, qw = a**2, (g * w) ** 2
    rows = [
        [qa * h**3 / 3 + qw * h**5 / 20, qa * h**2 / 2 + qw * h**4 / 8, qw * h**3 / (6 * g)],
        [qa * h**2 / 2 + qw * h**4 / 8, qa * h + qw * h**3 / 3, qw * h**2 / (2 * g)],
        [qw * h**3 / (6 * g), qw * h**2 / (2 * g), qw * h / g**2],
    ]
    return rows, [[1, h, g * h**2 / 2], [0, 1, g * h], [0, 0, 1]]


def doubled(sigma_a, sigma_w, g, interval, sigma, slow=None, digits=60, velocity=None):
    """Prior and posterior, SI, by structure-preserving doubling with `digits` digits; with velocity fixes too.

    Without an angle random walk, None, it is the vertical channel, and a third state that nothing depends on.

    Source: Chu, Fan, Lin and Wang, Int. J. Control 77(8), 2004.
    """
    with mp.workdps(digits):
        a, g, h, r = (mp.mpf(x) for x in (sigma_a, g, interval, sigma))
        upright = sigma_w is None
        noise, step = _upright_channel(a, g, h) if upright else _exact_channel(a, mp.mpf(sigma_w), g, h)
        n = 3 if slow is None else 4
        phi, x, row = mp.zeros(n), mp.zeros(n), mp.zeros(1, n)
        row[0] = 1
        for i in range(3):
            for j in range(3):
                phi[i, j], x[i, j] = step[i][j], noise[i][j]
        if slow is not None:
            size, correlation = (mp.mpf(value) for value in slow)
            phi[3, 3] = mp.exp(-h / correlation)
            x[3, 3], row[3] = size**2 * (1 - phi[3, 3] ** 2), 1
        seen = row.T * row / r**2
        if velocity is not None:
            seen[1, 1] = 1 / mp.mpf(velocity) ** 2
        at, gain = phi.T, seen
        for _ in range(200):
            inverse = (mp.eye(n) + gain * x) ** -1
            grown = at.T * x * inverse * at
            gain, at = gain + at * inverse * gain * at.T, at * inverse * at
            x = x + grown
            if all(grown[i, i] <= x[i, i] * mp.mpf(10) ** -45 for i in range(n)):
                return x, (x**-1 + seen) ** -1
    raise ArithmeticError


@pytest.fixture(scope="session")
def reference():
    """The independent solvers: continuous, discrete, doubled, with what they are given."""
    return SimpleNamespace(
        continuous=continuous, discrete=discrete, doubled=doubled, channel=_channel, exact_channel=_exact_channel
    )
