"""The filter as it is built: fixes at intervals, so a covariance that saws. [T-8]

The covariance is largest just before a fix (prior) and smallest just after (posterior); the closed form
[T-3] is its cycle rms. Both solve the discrete algebraic Riccati equation of one channel with exact transition
and process noise: in closed form (`nav_model.analytic.sampled_filter`) for white fix noise, by doubling when a
slow GNSS error enters, as a first-order Gauss-Markov state that the filter estimates.

Everything broadcasts: inputs of shape (...) give matrices of shape (..., n, n).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic.sampled_filter import horizontal_cycle, vertical_cycle
from nav_model.analytic.steady_state import Array, Horizontal, Vertical, as_numbers, horizontal, vertical

_MAX_DOUBLINGS = 60  # 2^60 fixes: only a defect gets there


class Sawtooth(NamedTuple):
    """Steady-state covariances of a horizontal and the vertical channel at one moment of the cycle."""

    horizontal: Horizontal
    vertical: Vertical


class Cycle(NamedTuple):
    """The two ends of the sawtooth: just before a fix and just after it.

    ``slow_with_tilt`` [m rad]: after the fix, covariance of a horizontal channel's tilt error with the slow error
    of the fixes itself; zero without one.
    """

    prior: Sawtooth
    posterior: Sawtooth
    slow_with_tilt: ArrayLike = 0.0


class SlowError(NamedTuple):
    """First-order Gauss-Markov error of the fixes: ``sigma`` [m] per axis, ``correlation_time`` [s]."""

    sigma: ArrayLike
    correlation_time: ArrayLike


def transition(g: ArrayLike, step: ArrayLike) -> Array:
    """Exact transition over `step` [s] of (position, velocity, tilt) under [T-1], shape (..., 3, 3)."""
    g, h = np.broadcast_arrays(as_numbers(g), as_numbers(step))
    phi = np.zeros((*h.shape, 3, 3), np.result_type(g, h))
    phi[..., [0, 1, 2], [0, 1, 2]] = 1
    phi[..., 0, 1] = h
    phi[..., 0, 2] = g * h**2 / 2
    phi[..., 1, 2] = g * h
    return phi


def process_noise(sigma_a: ArrayLike, sigma_w: ArrayLike, g: ArrayLike, step: ArrayLike) -> Array:
    """Exact covariance that the white noises of [T-1] add over `step` [s], shape (..., 3, 3)."""
    a, w, g, h = np.broadcast_arrays(*(as_numbers(x) for x in (sigma_a, sigma_w, g, step)))
    qa, qw = a**2, w**2
    q = np.zeros((*h.shape, 3, 3), np.result_type(a, w, g, h))
    q[..., 0, 0] = qa * h**3 / 3 + g**2 * qw * h**5 / 20
    q[..., 0, 1] = q[..., 1, 0] = qa * h**2 / 2 + g**2 * qw * h**4 / 8
    q[..., 0, 2] = q[..., 2, 0] = g * qw * h**3 / 6
    q[..., 1, 1] = qa * h + g**2 * qw * h**3 / 3
    q[..., 1, 2] = q[..., 2, 1] = g * qw * h**2 / 2
    q[..., 2, 2] = qw * h
    return q


def steady_prior(phi: Array, q: Array, row: Array, r: Array) -> Array:
    """Prior covariance of a time-invariant filter, by structure-preserving doubling.

    Parameters
    ----------
    phi, q : ndarray, shape (..., n, n)
        Transition and process noise between measurements.
    row : ndarray, shape (..., n)
        Measurement row.
    r : ndarray, shape (...)
        Measurement variance.

    Returns
    -------
    ndarray, shape (..., n, n)
        Solution X of X = phi (X - X h (h' X h + r)^-1 h' X) phi' + q.

    Raises
    ------
    ArithmeticError
        If the doubling does not settle on a covariance: an unobservable unstable state, or noises so far
        apart that double precision cannot hold both.

    Source: Chu, Fan, Lin and Wang, Int. J. Control 77(8), 2004.
    """
    n = phi.shape[-1]
    a = np.swapaxes(phi, -1, -2)
    gain = row[..., :, None] * row[..., None, :] / r[..., None, None]
    x = q
    identity = np.eye(n)
    with np.errstate(over="ignore", invalid="ignore"):  # what does not settle overflows first
        for _ in range(_MAX_DOUBLINGS):
            try:
                both = np.linalg.solve(identity + gain @ x, np.concatenate((a, gain), axis=-1))
            except np.linalg.LinAlgError as error:
                raise ArithmeticError("the discrete Riccati equation is singular") from error
            w_a, w_g = both[..., :n], both[..., n:]
            a_t = np.swapaxes(a, -1, -2)
            step = a_t @ x @ w_a
            gain = gain + a @ w_g @ a_t
            x = x + (step + np.swapaxes(step, -1, -2)) / 2
            a = a @ w_a
            if np.all(np.abs(step) <= 1e-16 * np.abs(x)) or not np.any(step):
                return x
    raise ArithmeticError("the discrete Riccati equation did not settle")


def after_fix(prior: Array, row: Array, r: Array) -> Array:
    """Covariance just after a measurement, in Joseph form: shapes as in `steady_prior`."""
    n = prior.shape[-1]
    cross = (prior @ row[..., :, None])[..., 0]
    innovation = np.sum(cross * row, axis=-1) + r
    gain = cross / innovation[..., None]
    keep = np.eye(n) - gain[..., :, None] * row[..., None, :]
    posterior: Array = keep @ prior @ np.swapaxes(keep, -1, -2)
    posterior += r[..., None, None] * gain[..., :, None] * gain[..., None, :]
    return posterior


def cycle(
    sigma_a: ArrayLike,
    sigma_w: ArrayLike,
    g: ArrayLike,
    interval: ArrayLike,
    sigma_fix: ArrayLike,
    sigma_fix_vertical: ArrayLike,
    slow: SlowError | None = None,
) -> Cycle:
    """Prior and posterior covariances of the horizontal and vertical channels. [T-8]

    Parameters
    ----------
    sigma_a, sigma_w, g : array_like
        Velocity random walk [m/s/√s], angle random walk [rad/√s], gravity [m/s²].
    interval : array_like
        Between fixes, s.
    sigma_fix, sigma_fix_vertical : array_like
        One fix, 1σ, m.
    slow : SlowError, optional
        Slow error of the fixes, modelled in the filter by state augmentation. Position variance is then that
        of the estimate about the truth, slow error included.

    """
    if slow is None:
        horizontal_ends = horizontal_cycle(sigma_a, sigma_w, g, interval, sigma_fix)
        vertical_ends = vertical_cycle(sigma_a, interval, sigma_fix_vertical)
        return Cycle(*(Sawtooth(*ends) for ends in zip(horizontal_ends, vertical_ends, strict=True)))
    return _augmented_cycle(sigma_a, sigma_w, g, interval, sigma_fix, sigma_fix_vertical, slow)


def _augmented_cycle(
    sigma_a: ArrayLike,
    sigma_w: ArrayLike,
    g: ArrayLike,
    interval: ArrayLike,
    sigma_fix: ArrayLike,
    sigma_fix_vertical: ArrayLike,
    slow: SlowError,
) -> Cycle:
    """Both channels with a slow error, solved in one batch by doubling.

    Each is in units of its own closed-form sigmas and of the fix interval, so that the numbers stay near one
    from MEMS to navigation grade.
    """
    a, w, g, dt, r_h, r_v, slow_sigma, slow_time = np.broadcast_arrays(
        *(as_numbers(x) for x in (sigma_a, sigma_w, g, interval, sigma_fix, sigma_fix_vertical, *slow))
    )
    root = np.sqrt(dt)
    closed_h, closed_v = horizontal(a, w, r_h * root, g), vertical(a, r_v * root)
    one = np.ones_like(dt)
    # The vertical channel rides along as a horizontal one without gravity; its third state is a dummy
    # random walk that decays, decoupled and of unit size.
    scale = np.stack(
        (
            np.stack((np.sqrt(closed_h.p11), np.sqrt(closed_h.p22), np.sqrt(closed_h.p33)), axis=-1),
            np.stack((np.sqrt(closed_v.v11), np.sqrt(closed_v.v22), one), axis=-1),
        )
    ).real
    channel_g = np.stack((g, np.zeros_like(g)))
    channel_w = np.stack((w, np.zeros_like(w)))
    phi = transition(channel_g, np.stack((dt, dt)))
    q = process_noise(np.stack((a, a)), channel_w, channel_g, np.stack((dt, dt)))
    phi[1, ..., 2, 2] = 0.5
    q[1, ..., 2, 2] = 0.75
    phi = phi * scale[..., None, :] / scale[..., :, None]
    q = q / (scale[..., None, :] * scale[..., :, None])
    row = np.zeros(scale.shape)
    row[..., 0] = 1
    r = np.stack((r_h, r_v)) ** 2 / scale[..., 0] ** 2
    phi, q, row = _augmented(phi, q, row, SlowError(slow_sigma, slow_time), dt, scale[..., 0])
    prior = steady_prior(phi, q, row, r)
    posterior = after_fix(prior, row, r)
    if not all(np.all(np.diagonal(matrix, axis1=-2, axis2=-1).real > 0) for matrix in (prior, posterior)):
        raise ArithmeticError("the discrete Riccati equation lost the covariance to rounding")
    before, after = (_split(matrix[..., :3, :3], scale) for matrix in (prior, posterior))
    # The estimate of the slow error is independent of the filter's errors; the error of that estimate is not.
    return Cycle(before, after, -posterior[0, ..., 2, 3] * scale[0, ..., 2] * scale[0, ..., 0])


def _augmented(
    phi: Array, q: Array, row: Array, slow: SlowError, dt: Array, unit: Array
) -> tuple[Array, Array, Array]:
    sigma = as_numbers(slow.sigma) / unit
    decay = np.exp(-dt / as_numbers(slow.correlation_time)) * np.ones_like(unit)
    shape = phi.shape[:-2]
    dtype = np.result_type(phi, q, sigma, decay)
    phi4, q4 = np.zeros((*shape, 4, 4), dtype), np.zeros((*shape, 4, 4), dtype)
    phi4[..., :3, :3], q4[..., :3, :3] = phi, q
    phi4[..., 3, 3] = decay
    q4[..., 3, 3] = -(sigma**2) * np.expm1(-2 * dt / as_numbers(slow.correlation_time))
    return phi4, q4, np.concatenate((row, np.ones((*shape, 1))), axis=-1)


def _split(matrix: Array, scale: Array) -> Sawtooth:
    matrix = matrix * scale[..., None, :] * scale[..., :, None]
    v = matrix[1]
    return Sawtooth(Horizontal.of(matrix[0]), Vertical(v[..., 0, 0], v[..., 0, 1], v[..., 1, 1]))
