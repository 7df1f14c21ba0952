"""One axis of an inertial navigation system: its states between fixes, and what drives them. [T-1], [T-19]

States are position, velocity, acceleration error, and the slow error of the fixes where there is one. With a slow
error the first state is position and slow error together, as a position fix measures it: the two apart are known much
less well, and their difference would cost digits. For the same reason the acceleration error is the whole of it:
gravity times the tilt, and the accelerometer's bias. Where a sensor's bias varies, three states follow: the bias of
the accelerometer, and gravity times that of the gyro, a Gauss-Markov process and a random walk.
"""

from collections.abc import Callable
from typing import NamedTuple, Self

import numpy as np

from nav_model.analytic import doubling, taylor
from nav_model.analytic.doubling import Counts, Segment
from nav_model.analytic.taylor import System
from nav_model.base.arrays import Array

SENSOR_STATES = 3


class Biases(NamedTuple):
    """Sizes of the sensors' varying biases.

    ``markov``, ``markov_time``: 1σ [m/s²] and correlation time [s] of the accelerometer's instability; ``jerk``,
    ``jerk_time``: those of the gyro's times gravity [m/s³], [s]; ``walk``, ``jerk_walk``: rate random walks of the
    accelerometer [m/s²/√s], and of the gyro times gravity [m/s³/√s].
    """

    markov: Array
    markov_time: Array
    jerk: Array
    jerk_time: Array
    walk: Array
    jerk_walk: Array


class Noise(NamedTuple):
    """Noise that drives an axis, arrays of one shape in any unit of length and of time.

    ``accelerometer``, ``gyro``: densities of the white noises, of velocity random walk [m²/s³], and g² times that of
    angle random walk [m²/s⁵]. ``gradient``: decrease of gravity with height [1/s²]. ``slow``: variance [m²] and
    correlation time [s] of the slow error of the fixes. ``biases``: None where none varies.
    """

    accelerometer: Array
    gyro: Array
    gradient: Array
    slow: tuple[Array, Array] | None = None
    biases: Biases | None = None

    @property
    def size(self) -> int:
        """Number of states."""
        return 3 + (self.slow is not None) + SENSOR_STATES * (self.biases is not None)

    @property
    def position(self) -> Array:
        """The position as a row of the states."""
        row = np.zeros(self.size)
        row[0] = 1.0
        if self.slow is not None:
            row[3] = -1.0
        return row

    def of(self, rows: Counts) -> Self:
        """Noise of some rows."""
        return self.changed(lambda part: part[rows])

    def changed(self, change: Callable[[Array], Array]) -> Self:
        """Noise with every array changed."""
        white = change(self.accelerometer), change(self.gyro), change(self.gradient)
        slow = self.slow and (change(self.slow[0]), change(self.slow[1]))
        return type(self)(*white, slow, self.biases and Biases(*map(change, self.biases)))


def system(noise: Noise) -> System:
    """The axis between fixes as a linear system."""
    n, shape = noise.size, noise.accelerometer.shape
    every = [*noise[:3], *(noise.slow or ()), *(noise.biases or ())]
    dynamics = np.zeros((*shape, n, n), np.result_type(*every))
    drive = np.zeros((*shape, n, n - 1), dynamics.dtype)  # a noise for each state but the position
    dynamics[..., 0, 1] = dynamics[..., 1, 2] = 1
    dynamics[..., 1, 0] = noise.gradient
    drive[..., 1, 0], drive[..., 2, 1] = np.sqrt(noise.accelerometer), np.sqrt(noise.gyro)
    fastest = np.sqrt(np.abs(noise.gradient))
    if noise.slow is not None:
        variance, rate = noise.slow[0], 1 / noise.slow[1]
        dynamics[..., 0, 3] = dynamics[..., 3, 3] = -rate
        dynamics[..., 1, 3] = -noise.gradient  # height alone drives
        drive[..., 0, 2] = drive[..., 3, 2] = np.sqrt(2 * variance * rate)
        fastest = np.maximum(fastest, np.abs(rate))
    if noise.biases is not None:
        vary, (markov, jerk, walk) = noise.biases, range(n - SENSOR_STATES, n)
        of_a, of_w = 1 / vary.markov_time, 1 / vary.jerk_time
        dynamics[..., markov, markov], dynamics[..., jerk, jerk] = -of_a, -of_w
        # The accelerometer's bias is in the acceleration error, and so is its change.
        dynamics[..., 2, markov], dynamics[..., 2, jerk], dynamics[..., 2, walk] = -of_a, 1, 1
        drive[..., markov, markov - 1] = drive[..., 2, markov - 1] = vary.markov * np.sqrt(2 * of_a)
        drive[..., jerk, jerk - 1], drive[..., walk, walk - 1] = vary.jerk * np.sqrt(2 * of_w), vary.jerk_walk
        drive[..., 2, 1] = np.sqrt(noise.gyro + vary.walk**2)
        fastest = np.maximum(fastest, np.maximum(np.abs(of_a), np.abs(of_w)))
    return System(dynamics, drive, fastest)


def drift(span: Array, noise: Noise) -> Segment:
    """A span without fixes: in closed form where no sensor's bias varies, by `nav_model.analytic.taylor` else."""
    if noise.biases is None:
        return doubling.drift(span, noise.accelerometer, noise.gyro, noise.slow, noise.gradient)
    return taylor.drift(system(noise), span)


def tilt_variance(covariance: Array, noise: Noise) -> Array:
    """Variance of gravity times the tilt, with the accelerometer's instability in full, (...). [T-20]

    Fixes show the sum of tilt and bias alone. Over hours a filter tells the two apart, by how the bias decays. Nobody
    waits for that, so what it has learned of the bias is given back: the sum and all else stays as it is.

    Parameters
    ----------
    covariance : array (..., n, n)
        Of the states, position without the slow error or with it.
    noise : Noise
        Of (...).
    """
    whole = covariance[..., 2, 2]
    if noise.biases is not None:
        whole = whole - 2 * covariance[..., 2, -SENSOR_STATES] + noise.biases.markov**2
    return np.asarray(whole)
