"""Oracle for a filter of [T-1] between fixes and settled: SciPy's matrix exponential and discrete Riccati solver."""

import numpy as np
from scipy.linalg import expm, solve_discrete_are


def channel(sigma_a, sigma_w, g):
    """Dynamics and noise density of position, velocity and tilt on one horizontal axis [T-1], SI."""
    return np.array([[0.0, 1, 0], [0, 0, g], [0, 0, 0]]), np.diag([0.0, sigma_a**2, sigma_w**2])


def van_loan(f, q, time):
    """Transition over `time` and covariance added, from one matrix exponential."""
    n = len(f)
    e = expm(np.block([[-f, q], [np.zeros((n, n)), f.T]]) * time)
    phi = e[n:, n:].T
    return phi, phi @ e[:n, n:]


def settled(phi, added, rows, noise, unit=1.0, balanced=True):
    """Covariance just before and just after the fixes of a filter that has run for ever.

    `rows` (k, n) is what fixes see, with a covariance `noise` (k, k), and the states times `unit` are of like size;
    SciPy balances them, or not.
    """
    unit = np.full(len(phi), unit) if np.isscalar(unit) else np.asarray(unit)
    each, noise = np.outer(unit, unit), np.atleast_2d(noise)
    step = (phi * unit[:, None] / unit).T
    prior = solve_discrete_are(step, (rows / unit).T, added * each, noise, balanced=balanced) / each
    return prior, prior - prior @ rows.T @ np.linalg.solve(rows @ prior @ rows.T + noise, rows @ prior)
