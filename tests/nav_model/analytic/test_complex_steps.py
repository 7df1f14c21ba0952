"""Complex steps through the closed forms: shares against Lyapunov solutions, slopes against 50-digit differences."""

import numpy as np
from scipy.linalg import solve_continuous_lyapunov

from nav_model.analytic.steady_state import horizontal, vertical

STEP = 1e-20


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


def _slopes(of, *inputs):
    """d(element)/d ln(input) of every element, one list per input."""
    for which in range(len(inputs)):
        yield [np.imag(x) / STEP for x in of(*(x * (1 + 1j * STEP * (n == which)) for n, x in enumerate(inputs)))]


def test_shares_against_the_lyapunov_equation(fleet, reference, compared):
    """A source's part of a covariance is half its slope with the source's size: the gain is optimal."""
    inputs = fleet.sigma_a, fleet.sigma_w, fleet.s
    whole = horizontal(*inputs, fleet.g)
    parts = np.array(list(_slopes(lambda *x: horizontal(*x, fleet.g), *inputs))) / 2
    np.testing.assert_allclose(parts.sum(axis=0), np.array(whole), rtol=1e-12)  # of degree one in their squares
    off, places = [], ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
    for i in range(fleet.size):
        theirs = _lyapunov_parts(reference, *(x[i] for x in inputs), fleet.g[i])
        sigma = np.sqrt(np.diagonal(sum(theirs)))
        for ours, part in zip(parts, theirs, strict=True):
            off += [
                (ours[k, i] - part[place]) / (sigma[place[0]] * sigma[place[1]]) for k, place in enumerate(places)
            ]
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
    parts = np.array(list(_slopes(vertical, fleet.sigma_a, fleet.s))) / 2
    for i in range(0, fleet.size, 4):
        theirs = _lyapunov_parts(reference, fleet.sigma_a[i], 0.0, fleet.s[i], fleet.g[i], order=2)
        for ours, part in zip(parts[..., i], theirs, strict=True):
            np.testing.assert_allclose(ours, [part[0, 0], part[0, 1], part[1, 1]], rtol=1e-9)
