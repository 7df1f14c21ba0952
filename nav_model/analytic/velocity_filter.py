"""The sampled filter with fixes of position and velocity: its Riccati equation, solved by doubling. [T-8], [P-6]

Two kinds of fixes leave no scalar to factor, as `nav_model.analytic.sampled_filter` does. The structure-preserving
doubling algorithm squares the closed loop at each step, so some fifteen steps settle any filter; it broadcasts and
takes complex steps.

Source: Chu, Fan, Lin and Wang, Int. J. Control 77(8), 2004.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic.steady_state import Array, Horizontal, Vertical, as_numbers

_MOST_STEPS = 60
_SETTLED = 1e-14


def horizontal_cycle_with_velocity(
    sigma_a: ArrayLike,
    sigma_w: ArrayLike,
    g: ArrayLike,
    interval: ArrayLike,
    sigma_fix: ArrayLike,
    sigma_velocity: ArrayLike,
    slow: tuple[ArrayLike, ArrayLike] | None = None,
) -> tuple[Horizontal, Horizontal, Array]:
    """Covariance of a horizontal channel just before a fix of position and velocity and just after it. [T-8]

    Third, as `nav_model.analytic.slow_error_filter` has it: after the fix, the covariance [m rad] of the tilt error
    with the slow error of the fixes; zero without one.

    Parameters
    ----------
    sigma_a, sigma_w, g : array_like
        Velocity random walk [m/s/√s], angle random walk [rad/√s], gravity [m/s²].
    interval, sigma_fix, sigma_velocity : array_like
        Between fixes [s]; one fix, 1σ [m]; its velocity, 1σ [m/s].
    slow : pair of array_like, optional
        Slow error of the position fixes, estimated: 1σ [m], correlation time [s].

    Raises
    ------
    ArithmeticError
        If the equation does not settle in double precision.
    """
    g = as_numbers(g)
    gyro = g * as_numbers(sigma_w)
    before, after = _cycle(as_numbers(sigma_a), gyro, interval, sigma_fix, sigma_velocity, slow)
    unit = (1, 1, 1 / g)

    def channel(p: Array) -> Horizontal:
        places = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
        return Horizontal(*(p[..., i, j] * unit[i] * unit[j] for i, j in places))

    with_slow = -after[..., 2, 3] / g if slow else np.zeros(())
    return channel(before), channel(after), with_slow


def vertical_cycle_with_velocity(
    sigma_a: ArrayLike,
    interval: ArrayLike,
    sigma_fix: ArrayLike,
    sigma_velocity: ArrayLike,
    slow: tuple[ArrayLike, ArrayLike] | None = None,
) -> tuple[Vertical, Vertical]:
    """Covariance of the vertical channel just before a fix and just after it; as the horizontal one. [T-8]"""
    ends = _cycle(as_numbers(sigma_a), None, interval, sigma_fix, sigma_velocity, slow)
    before, after = (Vertical(p[..., 0, 0], p[..., 0, 1], p[..., 1, 1]) for p in ends)
    return before, after


def _cycle(
    a: Array,
    gyro: Array | None,
    interval: ArrayLike,
    sigma_fix: ArrayLike,
    sigma_velocity: ArrayLike,
    slow: tuple[ArrayLike, ArrayLike] | None,
) -> tuple[Array, Array]:
    """Prior and posterior of (position, velocity, acceleration by tilt, slow error) as far as there are such."""
    h, r, velocity = (as_numbers(x) for x in (interval, sigma_fix, sigma_velocity))
    # the fix interval is the unit of time, the noise of a fix that of length
    qa = (a * h * np.sqrt(h) / r) ** 2
    qw = 0 * qa if gyro is None else (gyro * h * h * np.sqrt(h) / r) ** 2
    noise = [
        [qa / 3 + qw / 20, qa / 2 + qw / 8, qw / 6],
        [qa / 2 + qw / 8, qa + qw / 3, qw / 2],
        [qw / 6, qw / 2, qw],
    ]
    states = 2 if gyro is None else 3
    phi: list[list[Any]] = [list(row[:states]) for row in ((1, 1, 0.5), (0, 1, 1), (0, 0, 1))[:states]]
    q: list[list[Any]] = [list(row[:states]) for row in noise[:states]]
    units: list[Any] = [r, r / h, r / h**2][:states]
    seen: list[Any] = [1, 0, 0][:states]
    if slow is not None:
        rate = h / as_numbers(slow[1])
        phi = [*([*row, 0] for row in phi), [*([0] * states), np.exp(-rate)]]
        q = [*([*row, 0] for row in q), [*([0] * states), -np.expm1(-2 * rate) * (as_numbers(slow[0]) / r) ** 2]]
        units, seen = [*units, r], [*seen, 1]
    position = _matrix([[one * other for other in seen] for one in seen])
    fast = np.zeros_like(position)
    fast[1, 1] = 1
    known = position + fast * ((r / (h * velocity)) ** 2)[..., None, None]
    prior = _settled(np.swapaxes(_matrix(phi), -1, -2), known, _matrix(q))
    posterior = np.linalg.solve(np.eye(len(units)) + prior @ known, prior)
    scale = _matrix([units])[..., 0, :]
    scale = scale[..., :, None] * scale[..., None, :]
    return prior * scale, posterior * scale


def _matrix(rows: Sequence[Sequence[ArrayLike]]) -> Array:
    entries = np.broadcast_arrays(*(as_numbers(entry) for row in rows for entry in row))
    return np.stack(entries, axis=-1).reshape(*entries[0].shape, len(rows), len(rows[0]))


def _settled(a: Array, g: Array, x: Array) -> Array:
    """X of X = Aᵀ X (1 + G X)⁻¹ A + Q, from X = Q on."""
    a, g, x = np.broadcast_arrays(a, g, x)
    unit = np.eye(a.shape[-1])
    for _ in range(_MOST_STEPS):
        inverse = np.linalg.inv(unit + g @ x)
        through = a @ inverse
        flipped = np.swapaxes(a, -1, -2)
        more = flipped @ x @ inverse @ a
        g = g + through @ g @ flipped
        a = through @ a
        x = x + (more + np.swapaxes(more, -1, -2)) / 2
        size = np.diagonal(x, axis1=-2, axis2=-1).real
        if np.all(np.abs(np.diagonal(more, axis1=-2, axis2=-1)) <= _SETTLED * size):
            return x
    raise ArithmeticError("the filter with velocity fixes did not settle")
