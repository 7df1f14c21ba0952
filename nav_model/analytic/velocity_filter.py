"""The sampled filter with fixes of position and velocity: its Riccati equation, solved by doubling. [T-8], [P-6]

Two kinds of fixes leave no scalar to factor, as `nav_model.analytic.sampled_filter` does. Everything broadcasts and
takes complex steps.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic.doubling import Segment, drift, settled
from nav_model.analytic.stacks import plus_one, solved, times
from nav_model.analytic.steady_state import Array, Horizontal, Vertical, as_numbers

_TILT = 2  # of the states


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
        return Horizontal(*(p[i, j] * unit[i] * unit[j] for i, j in places))

    with_slow = -after[2, 3] / g if slow else np.zeros(())
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
    before, after = (Vertical(p[0, 0], p[0, 1], p[1, 1]) for p in ends)
    return before, after


def _cycle(
    a: Array,
    gyro: Array | None,
    interval: ArrayLike,
    sigma_fix: ArrayLike,
    sigma_velocity: ArrayLike,
    slow: tuple[ArrayLike, ArrayLike] | None,
) -> tuple[Array, Array]:
    """Prior and posterior of (position, velocity, acceleration by tilt, slow error), in the units of the inputs."""
    h, r, velocity = (as_numbers(x) for x in (interval, sigma_fix, sigma_velocity))
    # the fix interval is the unit of time, the noise of a fix that of length
    qa = (a * h * np.sqrt(h) / r) ** 2
    qw = 0 * qa if gyro is None else (gyro * h * h * np.sqrt(h) / r) ** 2
    error = None if slow is None else ((as_numbers(slow[0]) / r) ** 2, as_numbers(slow[1]) / h)
    fast = (r / (h * velocity)) ** 2
    qa, qw, fast = np.broadcast_arrays(qa, qw, fast)
    phi, noise = drift(np.ones(()), qa, qw, error)
    info = np.zeros(phi.shape, np.result_type(fast, noise))
    seen = [0] if slow is None else [0, 3]
    info[np.ix_(seen, seen)] = 1
    info[1, 1] = fast
    units = [r, r / h, r / h**2, r]
    if gyro is None:  # a state that nothing drives does not settle
        kept = [state for state in range(len(phi)) if state != _TILT]
        info, phi, noise = (part[np.ix_(kept, kept)] for part in (info, phi, noise))
        del units[_TILT]
    prior = settled(Segment(info, phi, noise))
    posterior = solved(plus_one(times(prior, info)), prior)
    unit = np.stack([np.broadcast_to(one, phi.shape[2:]) for one in units[: len(phi)]])
    scale = unit[:, None] * unit[None, :]
    return prior * scale, posterior * scale
