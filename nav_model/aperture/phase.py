"""The phase-error budget of an inertial aperture, source by source, in closed form.

The aperture lasts `aperture` seconds and begins `coast` seconds after the last fix; the navigation filter
starts a free INS there. Position and velocity errors at the last fix only shift and scale the image; what
grows inside the aperture defocuses it. Variances are of line-of-sight position [m²]; two-way phase is
4 pi/lambda times that [T-13]. Everything broadcasts over arrays.

Sources: theory.md section 4, sar.md [S-5], [S-6]; derived with shifted Legendre polynomials, on which the
residual after removing a least-squares polynomial is the sum of the higher coefficients.
"""

from collections.abc import Mapping
from functools import partial, reduce
from operator import add
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from nav_model.aperture.autofocus import Residual
from nav_model.aperture.geometry import line_of_sight_weights
from nav_model.base.arrays import Array, as_numbers

INITIAL_TILT = "initial tilt"
SOURCES = (
    INITIAL_TILT,
    "accelerometer noise",
    "gyro noise",
    "accelerometer bias",
    "gyro bias",
    "coast before aperture",
)
"""The lines of the budget."""


class PhaseVariances(NamedTuple):
    """Line-of-sight variances [m²] of one source over the aperture.

    ``quadratic`` and ``cubic`` are of the coefficients of x² and x³ with x = -1 at the aperture's start and
    +1 at its end; ``detrended`` is the mean over the aperture of the residual after autofocus.
    """

    quadratic: Array
    cubic: Array
    detrended: Array


# Mean residual variance over [0, T] after a least-squares polynomial of order 1, 2, 3 is removed. [T-14], [S-6]
_WHITE_ACCELERATION = {1: 1 / 420, 2: 1 / 2520, 3: 1 / 6930}  # of T³: noise integrated twice
_WHITE_JERK = {1: 17 / 30240, 2: 1 / 55440, 3: 1 / 540540}  # of T⁵: integrated three times
_ACCELERATION = {1: 1 / 720, 2: 0.0, 3: 0.0}  # of T⁴: constant
_JERK = {1: 1 / 100800, 2: 1 / 100800, 3: 0.0}  # of T⁶: constant, its acceleration zero in mid-aperture


def phase_budget(
    p33: ArrayLike,
    sigma_a: ArrayLike,
    sigma_w: ArrayLike,
    accelerometer_bias: ArrayLike,
    gyro_bias: ArrayLike,
    g: ArrayLike,
    aperture: ArrayLike,
    coast: ArrayLike,
    grazing_angle: ArrayLike,
    autofocus_order: int | Residual = 1,
) -> Mapping[str, PhaseVariances]:
    """Variances of quadratic, cubic and detrended line-of-sight error by source. [T-15], [S-5], [S-6]

    Parameters
    ----------
    p33 : array_like
        Tilt variance at the last fix, rad².
    sigma_a, sigma_w : array_like
        Velocity random walk [m/s/√s], angle random walk [rad/√s].
    accelerometer_bias, gyro_bias : array_like
        Residual biases at the last fix, 1σ, m/s² and rad/s.
    g, aperture, coast, grazing_angle : array_like
        m/s², s, s, rad.
    autofocus_order : {1, 2, 3} or Residual
        Highest polynomial order removed before the detrended residual, 1 for the line only; or what an autofocus
        leaves of all three.

    Returns
    -------
    mapping
        One entry for each of `SOURCES`.

    Raises
    ------
    ValueError
        For an order that has no closed form here.
    """
    residual = autofocus_order if isinstance(autofocus_order, Residual) else _after(autofocus_order)
    p33, sigma_a, sigma_w, b, d, g, t, tc = (
        as_numbers(x) for x in (p33, sigma_a, sigma_w, accelerometer_bias, gyro_bias, g, aperture, coast)
    )
    # Tilt, and what the gyro makes of it, is on the horizontal axis alone, whose weight in the line of sight is this.
    horizontal, vertical = line_of_sight_weights(grazing_angle)
    s_a, s_g = sigma_a**2, horizontal * (g * sigma_w) ** 2
    # A gyro bias is a jerk: its acceleration in mid-aperture has grown since the last fix.
    jerk, middle = horizontal * (g * d) ** 2, (tc + t / 2) ** 2
    constant = partial(_times, residual.quadratic / 64, t**4)
    by_bias = constant(jerk * middle)
    return {
        INITIAL_TILT: constant(horizontal * g**2 * p33),
        "accelerometer noise": _times(residual.white, t**3, s_a),
        "gyro noise": _times(residual.walk, t**5, s_g),
        # Each axis has its own bias, so the weights add up to one.
        "accelerometer bias": constant((horizontal + vertical) * b**2),
        "gyro bias": PhaseVariances(
            *(one + other for one, other in zip(by_bias, _times(residual.cubic / 2304, t**6, jerk), strict=True))
        ),
        "coast before aperture": constant(s_g * tc),
    }


def _times(shares: Array, power: Array, variance: Array) -> PhaseVariances:
    """Shares of an acceleration error of this variance or density, times a power of the aperture, in each measure."""
    return PhaseVariances(*(share * variance * power for share in shares.tolist()))


def _after(order: int) -> Residual:
    """Measures before autofocus, and what remains of the mean square after a polynomial is removed. [S-5], [S-6]"""
    if order not in _WHITE_ACCELERATION:
        raise ValueError(f"autofocus_order: {order!r} is not one of 1, 2, 3")
    return Residual(
        np.array([1.0, 0.0, 64 * _ACCELERATION[order]]),
        np.array([0.0, 1.0, 2304 * _JERK[order]]),
        np.array([0.0, 0.0, 1.0]),
        np.array([(10 / 7) / 64, (25 / 4) * (7 / 3960), _WHITE_ACCELERATION[order]]),
        np.array([(181 / 462) / 64, (25 / 4) * (7 / 61776), _WHITE_JERK[order]]),
        order,
    )


def total(budget: Mapping[str, PhaseVariances]) -> PhaseVariances:
    """Sum over the sources, which are independent."""
    return PhaseVariances(*(reduce(add, column) for column in zip(*budget.values(), strict=True)))
