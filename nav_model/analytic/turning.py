"""Quadratic phase from the turning line of sight, axis by axis: beyond [S-2], and under squint.

Over the aperture, x from -1 to 1, the line of sight is to second order

    u(x) = u0 + kappa (s u0 - e) x + kappa² ((3 s² - 1)/2 u0 - s e) x²,     kappa = V T / (2 R),  s = sin(squint)

with u0 that of mid-aperture and e along the track. The quadratic of u . dp is then, axis by axis, a weighted sum
of three functionals of the axis's error p: the quadratics of p, of x p (its velocity) and of x² p (its position).
A free INS's are Gaussian with the covariance written here: from the state it starts in, and from its noise (found
symbolically). Higher orders of the turn are omitted.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic.coast import carried
from nav_model.analytic.doubling import drift
from nav_model.analytic.steady_state import Horizontal
from nav_model.base.arrays import Array, as_numbers

# Covariance of the three functionals under white accelerometer noise (times S_a T³) and gyro noise (g² S_g T⁵).
_ACCELEROMETER = np.array(
    [[5 / 224, 1 / 32, 215 / 7392], [1 / 32, 213 / 2464, 9 / 112], [215 / 7392, 9 / 112, 21547 / 288288]]
)
_GYRO = np.array(
    [
        [181 / 29568, 15 / 1792, 4475 / 576576],
        [15 / 1792, 1739 / 144144, 421 / 37632],
        [4475 / 576576, 421 / 37632, 46523 / 4484480],
    ]
)

TURNING = ("turned", "curved", "with_turned", "with_curved", "turned_curved")
"""Covariances of the three functionals, but for the first one's variance, as `nav_model.processing` calls them."""


class Turn(NamedTuple):
    """Weights (..., 3) of the three functionals, for each axis: along the track, across, down."""

    along: Array
    across: Array
    down: Array


def turn_weights(
    grazing_angle: ArrayLike, squint_angle: ArrayLike, turn_rate: ArrayLike, aperture_time: ArrayLike
) -> Turn:
    """How the functionals of each axis add up along the line of sight; turn_rate V/R [rad/s]. Broadcasts."""
    s, down, kappa = np.broadcast_arrays(
        np.sin(as_numbers(squint_angle)),
        np.sin(as_numbers(grazing_angle)),
        as_numbers(turn_rate) * as_numbers(aperture_time) / 2,
    )
    # u0 = (s, across, down); across² is below zero by rounding alone: `analyse` refuses the rest.
    across_squared = 1 - s**2 - down**2
    across = np.sqrt(np.where(across_squared.real > 0, across_squared, 0.0))
    # Coefficients of 1, x and x² in u(x): those of u0 and those of e.
    powers = np.stack([np.ones_like(kappa), kappa * s, kappa**2 * (3 * s**2 - 1) / 2], axis=-1)
    track = np.stack([np.zeros_like(kappa), kappa, kappa**2 * s], axis=-1)
    return Turn(s[..., None] * powers - track, across[..., None] * powers, down[..., None] * powers)


def along_track_velocity(
    start: Horizontal,
    sigma_a: ArrayLike,
    sigma_w: ArrayLike,
    bias_a: ArrayLike,
    bias_w: ArrayLike,
    g: ArrayLike,
    coast: ArrayLike,
    aperture: ArrayLike,
) -> Array:
    """Variance [m²/s²] of the constant velocity error whose along-track quadratic phase is that of a free INS. [S-2]

    It has the same second functional as the INS's error over an aperture of `aperture` seconds that begins `coast`
    seconds after the last fix (docs/sar.md). Arguments as those of `nav_model.processing.geolocation.free_line`: SI,
    one sigma, any shapes that broadcast; complex numbers pass through.
    """
    sigma_a, sigma_w, b, d, g, c, t = (as_numbers(x) for x in (sigma_a, sigma_w, bias_a, bias_w, g, coast, aperture))
    p, age = carried(start, sigma_a, sigma_w, g, c), c + t / 2
    # A constant velocity has T/2 of the functional, hence 4/T² of the variance. What the aperture begins with counts
    # as in its middle.
    state = p.p22 + g * p.p23 * t + g**2 * p.p33 * t**2 / 4
    noise = 4 * (_ACCELEROMETER[1, 1] * sigma_a**2 * t + _GYRO[1, 1] * (g * sigma_w) ** 2 * t**3)
    variance: Array = state + noise + (b * age) ** 2 + (g * d * (age**2 / 2 + t**2 / 28)) ** 2
    return variance


def free_quadratic_variance(
    weights: Array,
    start: Array,
    accelerometer_noise: ArrayLike,
    tilt_noise: ArrayLike,
    aperture_time: ArrayLike,
    coast_time: ArrayLike = 0.0,
    jerk: ArrayLike = 0.0,
) -> Array:
    """Variance [m²] of the weighted sum of one axis's functionals under a free INS.

    Parameters
    ----------
    weights : ndarray (..., 3)
        One axis of `turn_weights`.
    start : ndarray (..., 3, 3)
        Covariance of position, velocity and acceleration error (g tilt + bias) at the last fix.
    accelerometer_noise, tilt_noise : array_like
        Densities [m/s/√s], [m/s²/√s]: sigma_a, g sigma_w.
    aperture_time, coast_time : array_like
        s; the coast lies between the last fix and the aperture.
    jerk : array_like
        g times the residual gyro bias, 1σ [m/s³].
    """
    t, coast, s_a, s_g, j = (
        np.asarray(x, float) for x in (aperture_time, coast_time, accelerometer_noise, tilt_noise, jerk)
    )
    # The covariance at the aperture's start, after the outage.
    s_a, s_g = s_a**2, s_g**2
    _, phi, coast_noise = drift(coast, s_a, s_g)
    covariance = phi @ start @ phi.mT + coast_noise
    # Weights of the three functionals times what each is for a unit position, velocity, acceleration and jerk.
    q, v, p = np.moveaxis(weights, -1, 0)
    h, age = t / 2, coast + t / 2
    by_state = np.stack(np.broadcast_arrays(p, (v + p) * h, (q + 2 * v + 13 / 7 * p) * t**2 / 8), axis=-1)
    by_jerk = q * age * t**2 / 8 + v * (age**2 * t / 4 + h**3 / 7) + p * (age**3 / 6 + 3 / 7 * age * h**2)
    noise = s_a * t**3 * np.einsum("...i,ij,...j", weights, _ACCELEROMETER, weights)
    noise = noise + s_g * t**5 * np.einsum("...i,ij,...j", weights, _GYRO, weights)
    return np.asarray(np.einsum("...i,...ij,...j", by_state, covariance, by_state) + noise + (j * by_jerk) ** 2)


def bent_variance(weights: Array, start: Array, *free: ArrayLike) -> Array:
    """What the turn adds to the variance [m²] of the quadratic: the variance with all weights minus that with the
    first.

    Arguments as `free_quadratic_variance`. It may be negative: the turn can work against the quadratic.
    """
    still = np.asarray(weights * np.array([1.0, 0.0, 0.0]))
    return np.asarray(free_quadratic_variance(weights, start, *free) - free_quadratic_variance(still, start, *free))


def smoothed_bent_variance(weights: Array, covariances: Mapping[str, Array]) -> Array:
    """The same of a smoothed error: from the covariances of `TURNING` [m²] of one axis."""
    q, v, p = (weights[..., k] for k in range(3))
    turned, curved, with_turned, with_curved, turned_curved = (covariances[name] for name in TURNING)
    squares = v**2 * turned + p**2 * curved
    products = q * v * with_turned + q * p * with_curved + v * p * turned_curved
    return np.asarray(squares + 2 * products)
