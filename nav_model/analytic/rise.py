"""The vertical channel under gravity that decreases with height: an error in height drives itself on.

With gamma = 2 g/R the channel is d(dr)/dt = dv, d(dv)/dt = gamma dr + w, of which [T-10] leaves out gamma. Over a
time t its transition has cosh and sinh of sqrt(gamma) t, 1/570 of a radian a second. Everything broadcasts, takes
complex steps, and is exact from microseconds to hours.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic.steady_state import Vertical
from nav_model.base.arrays import Array, as_numbers
from nav_model.base.constants import MEAN_RADIUS

_LEAST = 1e-30  # rad, so that no angle is divided by zero


def gravity_gradient(g: ArrayLike) -> Array:
    """Decrease of gravity with height at the ground, 2 g/R, 1/s²."""
    return 2 * as_numbers(g) / MEAN_RADIUS


class Rise(NamedTuple):
    """Transition and noise over a time t, by what they are without gamma.

    The transition of height and velocity is [[cosine, t sine], [gamma t sine, cosine]], with a cosine of 1 +
    ``risen``/2; a constant acceleration adds t²/2 ``twice`` to the height. Noise of density one on velocity adds t³
    ``noise[0]``, t² ``noise[1]`` and t ``noise[2]`` to the variance of height, its covariance with velocity and the
    variance of velocity.
    """

    sine: Array
    risen: Array
    twice: Array
    noise: tuple[Array, Array, Array]

    @property
    def cosine(self) -> Array:
        """Height after the time, of a height of one."""
        return 1 + self.risen / 2


def rise(gradient: ArrayLike, time: ArrayLike) -> Rise:
    """Transition and noise of the vertical channel over a time.

    Parameters
    ----------
    gradient : array_like
        gamma, 1/s²; zero for a channel without gravity.
    time : array_like
        Seconds.
    """
    angle = np.sqrt(as_numbers(gradient)) * as_numbers(time) + _LEAST
    sine = np.sinh(angle) / angle
    risen = 4 * np.sinh(angle / 2) ** 2
    # sinh y - y, which would cancel, from the third of y: sinh 3z = 3 sinh z + 4 sinh³ z. Three times, then a series.
    y = 2 * angle
    last = y / 27
    square = last**2
    remainder = 27 * last**3 / 6 * (1 + square / 20 * (1 + square / 42 * (1 + square / 72)))
    beyond = 4 * (np.sinh(y / 3) ** 3 + 3 * np.sinh(y / 9) ** 3 + 9 * np.sinh(last) ** 3) + remainder
    noise = beyond / (4 * angle**3), sine**2 / 2, (1 + sine * (1 + risen / 2)) / 2
    return Rise(sine, risen, risen / angle**2, noise)


def vertical_velocity(start: Vertical, sigma_a: ArrayLike, g: ArrayLike, time: ArrayLike) -> Array:
    """Variance of the vertical velocity after the last fix, m²/s². [T-17] without the coupling to the horizontal

    Parameters
    ----------
    start : Vertical
        Covariance at the last fix.
    sigma_a, g : array_like
        Velocity random walk [m/s/√s], gravity [m/s²].
    time : array_like
        Seconds since the last fix.
    """
    gradient, time = gravity_gradient(g), as_numbers(time)
    free = rise(gradient, time)
    lever = gradient * time * free.sine  # of the height at the last fix
    variance: Array = (
        start.v22 * free.cosine**2
        + 2 * start.v12 * lever * free.cosine
        + start.v11 * lever**2
        + as_numbers(sigma_a) ** 2 * time * free.noise[2]
    )
    return variance
