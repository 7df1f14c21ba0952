"""Rauch-Tung-Striebel fixed-interval smoother (1965), for estimates or for errors."""

import numpy as np

from nav_model.base.arrays import Array


def smoother_gain(posterior: Array, phi: Array, next_prior: Array) -> Array:
    """Gains C = P Phi^T (P-)^-1, shape (..., m, m); a state without uncertainty is left as it is.

    Solved by the pseudo-inverse of the prior scaled to a unit diagonal: tilt and position differ by many
    orders of magnitude, and the vertical axis has a third state of no variance at all.
    """
    scale = np.sqrt(np.diagonal(next_prior, axis1=-2, axis2=-1))
    scale = np.where(scale > 0, scale, 1.0)
    correlation = next_prior / scale[..., :, None] / scale[..., None, :]
    inverse = np.linalg.pinv(correlation, rcond=1e-13, hermitian=True)
    inverse = inverse / scale[..., :, None] / scale[..., None, :]
    return np.asarray(posterior @ np.swapaxes(phi, -1, -2) @ inverse)


def rts_smooth(
    posterior_state: Array,
    posterior_covariance: Array,
    prior_state: Array,
    prior_covariance: Array,
    phi: Array,
) -> Array:
    """Smoothed states (k, ..., m) from the forward pass of a Kalman filter at k fixes.

    Parameters
    ----------
    posterior_state, prior_state : array (k, ..., m)
        Just after and just before each fix, estimates or errors alike (the recursion is linear).
    posterior_covariance, prior_covariance : array (k, m, m)
        Of these.
    phi : array (k - 1, m, m)
        Transition from fix i to fix i + 1.
    """
    gains = smoother_gain(posterior_covariance[:-1], phi, prior_covariance[1:])
    smoothed = np.array(posterior_state, float)
    for i in range(len(phi) - 1, -1, -1):
        smoothed[i] += (smoothed[i + 1] - prior_state[i + 1]) @ gains[i].T
    return smoothed
