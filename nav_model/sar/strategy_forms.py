"""Closed forms of strategies 2, 3, 5 and 5w on one axis: residuals after the linear detrend.

All functions broadcast over plain SI arrays. Variances are of position [m^2]; the phase is 4 pi / lambda
times the root. A vertical axis has no tilt and no gyro: pass zeros. The inertial terms are those of `phase`,
seen along the axis; `winners` puts the axes together.
"""

import numpy as np
from numpy.typing import ArrayLike

from nav_model.aperture.phase import PhaseVariances, phase_budget, total
from nav_model.base.arrays import Array
from nav_model.base.constants import STANDARD_GRAVITY

# Mean square of x^2 about its mean on [-1, 1]: from the variance of a QPE to its detrended variance.
QUADRATIC_MEAN_SQUARE = 4 / 45
_ALONG_THE_AXIS = 0.0  # grazing angle at which the line of sight is the horizontal axis alone


def ins_variances(
    aperture_time: ArrayLike,
    accelerometer_noise: ArrayLike,
    gyro_noise: ArrayLike,
    tilt_variance: ArrayLike,
    coast_time: ArrayLike = 0.0,
    gravity: ArrayLike = STANDARD_GRAVITY,
    accelerometer_bias: ArrayLike = 0.0,
    gyro_bias: ArrayLike = 0.0,
) -> PhaseVariances:
    """Strategies 2 and 3, variances [m²]: the quadratic at the aperture ends [S-5], and what the line leaves.

    [T-15] with the coast of [S-5].

    Parameters
    ----------
    aperture_time, coast_time : array_like
        Seconds.
    accelerometer_noise, gyro_noise : array_like
        Velocity random walk [m/s/√s], angle random walk [rad/√s].
    tilt_variance : array_like
        At the last fix, rad².
    gravity, accelerometer_bias : array_like, optional
        m/s².
    gyro_bias : array_like, optional
        rad/s.
    """
    sensors = (tilt_variance, accelerometer_noise, gyro_noise, accelerometer_bias, gyro_bias)
    return total(phase_budget(*sensors, gravity, aperture_time, coast_time, _ALONG_THE_AXIS))


def fixes_in_aperture(aperture_time: ArrayLike, fix_interval: ArrayLike) -> Array:
    """Fixes in an aperture that starts with one: floor(T / dt) + 1."""
    return np.asarray(np.floor(np.divide(aperture_time, fix_interval) + 1e-9) + 1)


def fit_quadratic_sigma(
    gnss_sigma: ArrayLike, fix_interval: ArrayLike, aperture_time: ArrayLike, fixes: ArrayLike | None = None
) -> Array:
    """Standard deviation [m] of the quadratic that GNSS noise puts at the aperture ends [S-7].

    Infinite below three fixes, where nothing is determined.

    Parameters
    ----------
    gnss_sigma : array_like
        Of a fix, m.
    fix_interval, aperture_time : array_like
        Seconds.
    fixes : array_like, optional
        Number of fixes that are fitted; N = T / dt as in [C] by default (an aperture with a fix at both ends holds
        one more, and its noise is lower).
    """
    t, dt = np.asarray(aperture_time, float), np.asarray(fix_interval, float)
    n = np.asarray(t / dt if fixes is None else fixes, float)
    room = np.where(n > 2, n * (n**2 - 1) * (n**2 - 4), 0.0)
    with np.errstate(divide="ignore"):
        return np.asarray(t**2 / 4 * np.asarray(gnss_sigma, float) * np.sqrt(180 / room) / dt**2)


def shrunk_weight(ins_quadratic: ArrayLike, fit_quadratic: ArrayLike) -> Array:
    """Weight of the fitted quadratic in strategy 5w: var_INS / (var_INS + var_GNSS)."""
    ins, fit = np.asarray(ins_quadratic, float), np.asarray(fit_quadratic, float)
    total = ins + fit
    return np.asarray(np.divide(ins, total, out=np.zeros_like(total), where=total > 0))


def shrunk_residual_variance(
    ins_quadratic: ArrayLike, fit_quadratic: ArrayLike, beyond_quadratic: ArrayLike, covariance: ArrayLike = 0.0
) -> Array:
    """Strategy 5w: mean variance [m²] after the line: 4/45 of the quadratic left, plus the rest.

    The quadratic left is var_INS var_GNSS / (var_INS + var_GNSS): below both, so 5w loses to neither 2 nor 5 on
    one axis.

    Parameters
    ----------
    ins_quadratic, fit_quadratic : array_like
        Variances of the quadratics of INS and fit, m².
    beyond_quadratic : array_like
        Mean variance of the rest, m².
    covariance : array_like, optional
        Of the two quadratics, m², with a slow GNSS error; the weight leaves it out.
    """
    weight = shrunk_weight(ins_quadratic, fit_quadratic)
    with np.errstate(invalid="ignore"):
        quadratic = np.where(weight > 0, weight * np.asarray(fit_quadratic, float), 0.0)
    quadratic = np.where(np.isfinite(fit_quadratic), quadratic, ins_quadratic)
    quadratic = quadratic + 2 * weight * (1 - weight) * np.asarray(covariance, float)
    return np.asarray(QUADRATIC_MEAN_SQUARE * quadratic + np.asarray(beyond_quadratic, float))
