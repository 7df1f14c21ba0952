"""The sampled filter with fixes of position and velocity: its Riccati equation, solved by doubling. [T-8], [P-6]

With two kinds of fixes there is no scalar spectrum to factor as in `nav_model.analytic.sampled_filter`. Everything
broadcasts and takes complex steps. A map of thousands of designs is computed at a few and interpolated, to 1e-4 of
the variances.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nav_model.analytic.doubling import Segment, drift, settled
from nav_model.analytic.few import from_few
from nav_model.analytic.stacks import plus_one, solved, times
from nav_model.analytic.steady_state import Horizontal, Vertical
from nav_model.base.arrays import Array, as_numbers

_MANY = 2000  # designs; a larger map is interpolated from a few of them
_NOTHING = 1e-300  # instead of zero under a logarithm

Channels = tuple[Horizontal, Vertical]


def cycle_with_velocity(
    sigma_a: ArrayLike,
    sigma_w: ArrayLike,
    g: ArrayLike,
    interval: ArrayLike,
    sigma_fix: tuple[ArrayLike, ArrayLike],
    sigma_velocity: tuple[ArrayLike, ArrayLike],
    slow: tuple[ArrayLike, ArrayLike] | None = None,
) -> tuple[Channels, Channels, Array]:
    """Covariances of both channels just before a fix of position and velocity and just after it. [T-8]

    Third, as `nav_model.analytic.slow_error_filter` has it: after the fix, the covariance [m rad] of the tilt error
    with the slow error of the fixes; zero without one.

    Parameters
    ----------
    sigma_a, sigma_w, g : array_like
        Velocity random walk [m/s/√s], angle random walk [rad/√s], gravity [m/s²].
    interval : array_like
        Between fixes, s.
    sigma_fix, sigma_velocity : pair of array_like
        One fix, 1σ [m], and its velocity, 1σ [m/s], horizontal and vertical.
    slow : pair of array_like, optional
        Slow error of the position fixes, estimated: 1σ [m], correlation time [s].

    Raises
    ------
    ArithmeticError
        If the equation does not settle in double precision.
    """
    g = as_numbers(g)
    a, gyro, h, *fixes, first, second = np.broadcast_arrays(
        *map(as_numbers, (sigma_a, g * as_numbers(sigma_w), interval, *sigma_fix, *sigma_velocity, *(slow or (0, 1))))
    )
    # Both channels are solved together; the vertical one has no gyro, and its third state stays zero and alone.
    r, velocity = np.stack(fixes[:2]), np.stack(fixes[2:])
    gyro = np.stack([gyro, 0 * gyro])
    # the fix interval is the unit of time, the noise of a fix that of length
    qa, qw = (a * h * np.sqrt(h) / r) ** 2, (gyro * h * h * np.sqrt(h) / r) ** 2
    inputs = [qa, qw, (r / (h * velocity)) ** 2, *(() if slow is None else ((first / r) ** 2, second / h + 0 * r))]
    a_map = qa[0].ndim == 2 and qa[0].size > _MANY and not any(map(np.iscomplexobj, inputs))
    before, after = _of_a_map(inputs) if a_map else _ends(inputs)
    unit = np.stack([r, r / h, r / h**2, r][: len(before)])
    before, after = (p * unit[:, None] * unit[None, :] for p in (before, after))
    return _channels(before, g), _channels(after, g), np.zeros(()) if slow is None else -after[2, 3, 0] / g


def _ends(inputs: Sequence[Array]) -> Array:
    """Covariances just before a fix and after it, of both channels, (2, n, n, 2, ...)."""
    qa, qw, fast, *slow = inputs
    phi, noise = drift(np.ones(()), qa, qw, (slow[0], slow[1]) if slow else None)
    phi[0, 2, 1] = phi[1, 2, 1] = 0
    info = np.zeros(phi.shape, np.result_type(fast, noise))
    seen = [0, 3] if slow else [0]
    info[np.ix_(seen, seen)] = 1
    info[1, 1] = fast
    before = settled(Segment(info, phi, noise))
    return np.stack([before, solved(plus_one(times(before, info)), before)])


def _of_a_map(inputs: Sequence[Array]) -> Array:
    """The same of a map, interpolated: variances to 1e-4, covariances to 1e-4 of their variances' mean."""
    shape = inputs[0].shape[1:]

    def exact(_: NDArray[np.int64], rows: NDArray[np.int64], columns: NDArray[np.int64]) -> Array:
        p = _ends([value[:, rows, columns] for value in inputs])
        sigma = np.sqrt(np.maximum(np.einsum("eii...->ei...", p), _NOTHING))
        p = p / (sigma[:, :, None] * sigma[:, None])
        np.einsum("eii...->ei...", p)[:] = np.log(sigma)
        return np.asarray(p.reshape(-1, len(rows)))

    size = 3 if len(inputs) == 3 else 4
    few = from_few([np.ones(shape, bool)], [(False, False)], 4 * size**2, exact)[0].reshape(2, size, size, 2, *shape)
    view = np.einsum("eii...->ei...", few)
    sigma = np.exp(view)
    view[:] = 1
    return np.asarray(few * sigma[:, :, None] * sigma[:, None])


def _channels(p: Array, g: Array) -> Channels:
    """From the covariance of (position, velocity, acceleration by tilt, slow error) of both, (n, n, 2, ...)."""
    unit = (1, 1, 1 / g)
    places = ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2))
    return (
        Horizontal(*(p[i, j, 0] * unit[i] * unit[j] for i, j in places)),
        Vertical(p[0, 0, 1], p[0, 1, 1], p[1, 1, 1]),
    )
