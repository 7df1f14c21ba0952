"""The sampled filter with velocity fixes, a slow GNSS error, or both: its Riccati equation by doubling. [T-8], [P-6]

With white position fixes alone there is a closed form, `nav_model.analytic.sampled_filter`. Everything broadcasts and
takes complex steps.
"""

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic.doubling import Powers, Segment, carried, drift, joined, measured, settled, without_slow_error
from nav_model.analytic.rise import gravity_gradient
from nav_model.analytic.steady_state import Horizontal, Vertical
from nav_model.base.arrays import Array, as_numbers

Channels = tuple[Horizontal, Vertical]


def settled_cycle(
    sigma_a: ArrayLike,
    sigma_w: ArrayLike,
    g: ArrayLike,
    interval: ArrayLike,
    sigma_fix: tuple[ArrayLike, ArrayLike],
    sigma_velocity: tuple[ArrayLike, ArrayLike] | None = None,
    slow: tuple[ArrayLike, ArrayLike, ArrayLike] | None = None,
) -> tuple[Channels, Channels, Array]:
    """Covariances of both channels just before a fix and just after it. [T-8]

    Parameters
    ----------
    sigma_a, sigma_w, g : array_like
        Velocity random walk [m/s/√s], angle random walk [rad/√s], gravity [m/s²].
    interval : array_like
        Between fixes, s.
    sigma_fix : pair of array_like
        One fix, 1σ [m], horizontal and vertical.
    sigma_velocity : pair of array_like, optional
        Its velocity, 1σ [m/s].
    slow : three of array_like, optional
        Slow error of the position fixes, estimated: 1σ [m], horizontal and vertical, correlation time [s].

    Returns
    -------
    before, after : pair of Horizontal and Vertical
    slow_with_tilt : array
        After the fix, covariance [m rad] of the tilt error with the slow error of the fixes; zero without one.
    """
    g = as_numbers(g)
    velocity = (np.inf, np.inf) if sigma_velocity is None else sigma_velocity
    inputs = map(as_numbers, (sigma_a, g * as_numbers(sigma_w), interval, *sigma_fix, *velocity, *(slow or ())))
    a, gyro, h, *fixes = np.broadcast_arrays(*inputs)
    # The fix interval is the unit of time, the noise of a fix that of length. Both channels are solved together; the
    # vertical one has no gyro, so that its third state stays zero, and gravity that decreases with height.
    r, v = np.stack(fixes[:2]), np.stack(fixes[2:4])
    level, upright = (
        drift(
            1.0,
            (a * h * np.sqrt(h) / fixes[axis]) ** 2,
            (noise * h * h * np.sqrt(h) / fixes[axis]) ** 2,
            None if slow is None else ((fixes[4 + axis] / fixes[axis]) ** 2, fixes[6] / h),
            rising,
        )
        for axis, (noise, rising) in enumerate(((gyro, None), (0 * gyro, gravity_gradient(g) * h**2)))
    )
    step = Segment(*map(np.stack, zip(level, upright, strict=True)))
    size = step.noise.shape[-1]
    fix = np.zeros((*r.shape, size, size), np.result_type(r, v, h))
    fix[..., 0, 0] = 1
    fix[..., 1, 1] = (r / h / v) ** 2
    after = settled(Powers(measured(step, fix), joined))
    unit = np.stack([r, r / h, r / h**2, r][:size], axis=-1)
    before, after = (
        without_slow_error(p) * unit[..., :, None] * unit[..., None, :] for p in (carried(after, step), after)
    )
    with_tilt = np.zeros(()) if slow is None else -after[0, ..., 2, 3] / g
    return _channels(before, g), _channels(after, g), with_tilt


def _channels(p: Array, g: Array) -> Channels:
    """From the covariances of position, velocity, acceleration by tilt and slow error of both, (2, ..., n, n)."""
    unit = (1, 1, 1 / g)
    places = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
    return (
        Horizontal(*(p[0, ..., i, j] * unit[i] * unit[j] for i, j in places)),
        Vertical(p[1, ..., 0, 0], p[1, ..., 0, 1], p[1, ..., 1, 1]),
    )
