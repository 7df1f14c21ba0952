"""Residuals of a quadratic fitted to the fixes on one axis: the printed forms, and exact ones for given fixes."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nav_model.aperture.phase import phase_budget, total
from nav_model.base.constants import STANDARD_GRAVITY
from nav_model.sar.strategy_forms import QUADRATIC_MEAN_SQUARE, fit_quadratic_sigma

FloatArray = NDArray[np.float64]


def beyond_quadratic_variance(
    aperture_time: ArrayLike,
    accelerometer_noise: ArrayLike,
    gyro_noise: ArrayLike,
    gravity: ArrayLike = STANDARD_GRAVITY,
    gyro_bias: ArrayLike = 0.0,
) -> FloatArray:
    """Mean variance [m^2] of the INS error that no quadratic takes away [T-14]."""
    sensors = (0.0, accelerometer_noise, gyro_noise, 0.0, gyro_bias)
    return total(phase_budget(*sensors, gravity, aperture_time, 0.0, 0.0, 2)).detrended


def fit_noise_variance(
    gnss_sigma: ArrayLike, fix_interval: ArrayLike, aperture_time: ArrayLike, fixes: ArrayLike | None = None
) -> FloatArray:
    """Mean variance [m^2] after the line that the fit adds: (s^2/T) N^4 / ((N^2-1)(N^2-4)) of [T-16]."""
    return np.asarray(
        QUADRATIC_MEAN_SQUARE * fit_quadratic_sigma(gnss_sigma, fix_interval, aperture_time, fixes) ** 2
    )


def corrected_residual_variance(
    aperture_time: ArrayLike,
    accelerometer_noise: ArrayLike,
    gyro_noise: ArrayLike,
    gnss_sigma: ArrayLike,
    fix_interval: ArrayLike,
    gravity: ArrayLike = STANDARD_GRAVITY,
    gyro_bias: ArrayLike = 0.0,
    fixes: ArrayLike | None = None,
) -> FloatArray:
    """Strategy 5: mean variance [m^2] over the aperture after the line [T-16].

    Exact in the noise of the fixes; the inertial terms take the fit as continuous, see
    `exact_corrected_variance` for few fixes.
    """
    noise = fit_noise_variance(gnss_sigma, fix_interval, aperture_time, fixes)
    rest = beyond_quadratic_variance(aperture_time, accelerometer_noise, gyro_noise, gravity, gyro_bias)
    return np.asarray(noise + rest)


def exact_corrected_variance(
    aperture_time: float,
    accelerometer_noise: float,
    gyro_noise: float,
    gnss_sigma: float,
    fix_times: ArrayLike,
    gravity: float = STANDARD_GRAVITY,
    weight: float = 1.0,
    tilt_variance: float = 0.0,
    nodes: int = 40,
) -> float:
    """Strategy 5 (or 5w) exactly: mean variance [m^2] after the line, with the fit at the fixes themselves.

    The covariance of the integrated noises is carried through the fit and the removal of the line by Gauss
    quadrature over the aperture; one design at a time. Shows where the inertial terms of
    [T-16] stop holding: with fixes at both ends they are at most 13 % low; with the first
    fix one interval after the start they are 3.8 times too low at 3 fixes, 13 % at 11, 3 % at 21.
    """
    fixes = np.asarray(fix_times, float)
    if fixes.size < 3:
        raise ValueError(f"fix_times: {fixes.size} fixes; a quadratic fit needs at least 3")
    x, quadrature = np.polynomial.legendre.leggauss(nodes)
    time = (x + 1) / 2 * aperture_time
    where = np.concatenate([time, fixes])
    early = np.minimum(where[:, None], where[None, :])
    late = np.maximum(where[:, None], where[None, :])
    covariance = accelerometer_noise**2 * early**2 * (3 * late - early) / 6
    covariance += (gravity * gyro_noise) ** 2 * early**3 * (10 * late**2 - 5 * late * early + early**2) / 120
    covariance += gravity**2 * tilt_variance * early**2 * late**2 / 4
    middle = fixes.mean()
    basis, triangle = np.linalg.qr(np.vander(fixes - middle, 3, increasing=True))
    fitted = (np.vander(time - middle, 3, increasing=True) @ np.linalg.inv(triangle)) * [1.0, 1.0, weight]
    fitted = fitted @ basis.T
    share = quadrature / 2
    line = np.stack([np.ones_like(x), np.sqrt(3) * x])
    detrend = np.eye(nodes) - line.T @ (line * share)
    inertial = detrend @ np.hstack([np.eye(nodes), -fitted])
    noise = detrend @ fitted
    variance = np.einsum("ij,jk,ik->i", inertial, covariance, inertial) + gnss_sigma**2 * (noise**2).sum(axis=1)
    return float(share @ variance)
