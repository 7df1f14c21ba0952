"""Attitude from star directions: three methods, their predicted covariances and the test of consistency.

All functions are batched: body and reference (..., k, 3) unit vectors with b = A r, weight (..., k) zero
where a scene has fewer stars. A turns reference (inertial) into body components. Noise is sigma rad per
axis in the tangent plane, the same for every star. Covariances are those of the rotation vector e of A_est
= exp([e x]) A, on body axes, rad² [B-9].
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError
from nav_model.earth.rotation import skew, vector_from_matrix

COLLINEAR = 1e-10
"""Below this product of the two smallest information eigenvalues over sigma the roll is not observable."""


Estimate = tuple[Array, Array]
"""Rotation (..., 3, 3) from reference to body axes, and its covariance (..., 3, 3), rad²."""


def information(body: Array, weight: Array) -> Array:
    """sum (I - b b^T), (..., 3, 3): inverse covariance of least squares in units of 1/sigma²."""
    count = np.sum(weight > 0.0, axis=-1)[..., None, None]
    seen = _of_stars(body, weight)
    return np.asarray(count * np.eye(3) - np.swapaxes(seen, -1, -2) @ seen)


def _of_stars(directions: Array, weight: Array) -> Array:
    """Directions of the stars there are, zeros for the others."""
    return np.where(weight[..., None] > 0.0, directions, 0.0)


def _optimal_covariance(body: Array, weight: Array, sigma: float) -> Array:
    return np.asarray(sigma**2 * np.linalg.inv(information(body, weight)))


def _profile(b: Array, r: Array, w: Array) -> Array:
    """Attitude profile sum a b r^T with weights normalised to one."""
    a = w / np.sum(w, axis=-1, keepdims=True)
    return np.asarray(np.swapaxes(a[..., None] * b, -1, -2) @ r)


def _nearest_rotation(matrix: Array) -> Array:
    u, _, vt = np.linalg.svd(matrix)
    flip = np.ones(matrix.shape[:-1])
    flip[..., 2] = np.linalg.det(u) * np.linalg.det(vt)
    return np.asarray((u * flip[..., None, :]) @ vt)


def triad(b: Array, r: Array, sigma: float, w: Array) -> Estimate:
    """TRIAD of the first two stars (put the two to be used first).

    Parameters
    ----------
    b, r : array (..., k, 3)
        Unit vectors to the stars, body axes and reference axes.
    sigma : float
        Error of a direction, one axis [rad].
    w : array (..., k)
        Weights, zero where there is no star.
    """

    def frame(v: Array) -> Array:
        cross = np.cross(v[..., 0, :], v[..., 1, :])
        second = cross / np.linalg.norm(cross, axis=-1, keepdims=True)
        return np.stack([v[..., 0, :], second, np.cross(v[..., 0, :], second)], axis=-1)

    b1, b2 = b[..., 0, :], b[..., 1, :]
    outer = b1[..., :, None] * b2[..., None, :]
    cross = np.sum(np.cross(b1, b2) ** 2, axis=-1)[..., None, None]
    dot = np.sum(b1 * b2, axis=-1)[..., None, None]
    covariance = sigma**2 * (np.eye(3) + dot * (outer + np.swapaxes(outer, -1, -2)) / cross)
    return frame(b) @ np.swapaxes(frame(r), -1, -2), covariance


def n_vector(b: Array, r: Array, sigma: float, w: Array) -> Estimate:
    """N-vector pseudo-inverse C = R_i R_b^T (R_b R_b^T)^-1, projected to the nearest rotation.

    Parameters
    ----------
    b, r, sigma, w
        As `triad`.
    """
    seen = _of_stars(b, w)
    inverse = np.linalg.inv(np.swapaxes(seen, -1, -2) @ seen)
    raw = np.swapaxes(_of_stars(r, w), -1, -2) @ seen @ inverse
    lever = seen @ inverse
    cross = skew(lever)
    tangent = np.eye(3) - b[..., :, None] * b[..., None, :]
    used = (w > 0.0)[..., None, None]
    covariance = sigma**2 / 4.0 * np.sum(np.where(used, cross @ tangent @ np.swapaxes(cross, -1, -2), 0.0), axis=-3)
    return np.swapaxes(_nearest_rotation(raw), -1, -2), covariance


def svd(b: Array, r: Array, sigma: float, w: Array) -> Estimate:
    """Least squares (Wahba's problem) by singular value decomposition, which q-method and QUEST solve as well.

    Parameters
    ----------
    b, r, sigma, w
        As `triad`.
    """
    rotation = _nearest_rotation(_profile(b, r, w))
    return rotation, _optimal_covariance(b, w, sigma)


METHODS: dict[str, Callable[[Array, Array, float, Array], Estimate]] = {
    "TRIAD": triad,
    "N-vector": n_vector,
    "SVD": svd,
}
"""The methods by name; each takes body, reference, sigma and weight of scenes that it can solve."""


def estimate(method: str, body: Array, reference: Array, sigma: float, weight: Array | None = None) -> Estimate:
    """Attitudes by one of the `METHODS`.

    Parameters
    ----------
    method : str
        Key of `METHODS`.
    body, reference : array (..., k, 3)
        Unit vectors to the stars, body axes and reference axes.
    sigma : float
        Error of a direction, one axis [rad].
    weight : array (..., k), optional
        Zero where there is no star; every star counts without it.

    Raises
    ------
    InputError
        For a scene that the method cannot solve (`solvable`).
    """
    weight = np.ones(body.shape[:-1]) if weight is None else weight
    if not np.all(solvable(method, body, weight)):
        raise InputError(method, "the stars of a scene are too few, or they are in one line or plane")
    return METHODS[method](body, reference, sigma, weight)


def solvable(method: str, body: Array, weight: Array) -> np.ndarray:
    """Scenes (...) that a method can solve: TRIAD needs the first two stars apart, the N-vector three that span
    space, SVD two apart."""
    b, w = (body[..., :2, :], weight[..., :2]) if method == "TRIAD" else (body, weight)
    apart = np.linalg.eigvalsh(information(b, w))[..., 0] >= COLLINEAR
    enough = np.sum(w > 0.0, axis=-1) >= (3 if method == "N-vector" else 2)
    if method != "N-vector":
        return np.asarray(apart & enough)
    seen = _of_stars(b, w)
    spanned = np.linalg.eigvalsh(np.swapaxes(seen, -1, -2) @ seen)[..., 0] >= COLLINEAR
    return np.asarray(apart & enough & spanned)


def attitude_error(estimate: Array, truth: Array) -> Array:
    """Rotation vector e of A_est = exp([e x]) A_true on body axes, (..., 3), rad."""
    return vector_from_matrix(estimate @ np.swapaxes(truth, -1, -2))


def nees(error: Array, covariance: Array) -> Array:
    """e^T P^-1 e, (...): 3 on average when the predicted covariance is right."""
    return np.asarray(np.sum(error * np.linalg.solve(covariance, error[..., None])[..., 0], axis=-1))


@dataclass(frozen=True)
class MethodScore:
    """One method over many scenes: mean total error and rms of each body axis, rad; mean NEES; scenes
    used."""

    method: str
    mean_error_rad: float
    axis_rms_rad: tuple[float, float, float]
    mean_nees: float
    scenes: int
    source: str


def compare_methods(
    body: Array, reference: Array, truth: Array, sigma: float, weight: Array | None = None
) -> tuple[MethodScore, ...]:
    """Every method on the same scenes.

    Parameters
    ----------
    body, reference : array (n, k, 3)
        Unit vectors to the stars, body axes and reference axes.
    truth : array (n, 3, 3)
        True attitudes.
    sigma : float
        Error of a direction, one axis [rad].
    weight : array (n, k), optional
        Zero where there is no star; every star counts without it.
    """
    scores: list[MethodScore] = []
    for name in METHODS:
        rotation, covariance = estimate(name, body, reference, sigma, weight)
        error = attitude_error(rotation, truth)
        rms = np.sqrt(np.mean(error**2, axis=0))
        scores.append(
            MethodScore(
                method=name,
                mean_error_rad=float(np.mean(np.linalg.norm(error, axis=-1))),
                axis_rms_rad=(float(rms[0]), float(rms[1]), float(rms[2])),
                mean_nees=float(np.mean(nees(error, covariance))),
                scenes=len(error),
                source=f"{len(error)} scenes, {name}, covariance [B-9]",
            )
        )
    return tuple(scores)
