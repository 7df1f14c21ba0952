"""The figures after the flight, when a smoother has every fix. [P-3], [P-5]

What is not here is the same in both processings (`nav_model.budget.real_time`). Constant residual biases cost
nothing: the smoother takes them up.
"""

from functools import cached_property

import numpy as np

from nav_model.analytic.rise import gravity_gradient
from nav_model.analytic.turning import Bend
from nav_model.aperture.geometry import line_of_sight_weights
from nav_model.base.arrays import Array, as_numbers
from nav_model.budget.inputs import Inputs
from nav_model.budget.real_time import RealTime, azimuth_lever, fast_slope
from nav_model.design.processing import POST_PROCESSED
from nav_model.processing.flight import Channel
from nav_model.processing.geolocation import AxisError
from nav_model.processing.smoother import SmoothedError


def channels(x: Inputs) -> tuple[Channel, Channel]:
    """Inputs of the smoother for a horizontal axis and the vertical one."""
    level = upright = time = None
    if x.slow is not None:
        level, upright, time = map(as_numbers, x.slow)
    horizontal, vertical, interval = x.velocity, x.velocity_vertical, x.velocity_interval
    if horizontal is None:
        vertical = interval = None
    return (
        Channel(x.sigma_a, x.g * x.sigma_w, x.fix, x.interval, horizontal, interval, level, time),
        Channel(
            x.sigma_a, None, x.fix_vertical, x.interval, vertical, interval, upright, time, gravity_gradient(x.g)
        ),
    )


class Smoothed(RealTime):
    """The figures of one design, or of arrays of designs, with a smoother."""

    processing = POST_PROCESSED

    @cached_property
    def error(self) -> SmoothedError:
        """The smoothed error of a horizontal axis, and of the vertical one."""
        x = self.x
        return SmoothedError(channels(x), x.aperture, x.leg_after, x.before_aperture)

    @property
    def horizontal_position(self) -> Array:
        return np.asarray(np.sqrt(self.error["position"][0]))

    @property
    def vertical_position(self) -> Array:
        return np.asarray(np.sqrt(self.error["position"][1]))

    @property
    def horizontal_velocity(self) -> Array:
        return np.asarray(np.sqrt(self.error["velocity"][0]))

    @property
    def vertical_velocity(self) -> Array:
        return np.asarray(np.sqrt(self.error["velocity"][1]))

    @property
    def tilt(self) -> Array:
        return np.asarray(np.sqrt(self.error["tilt"][0] + self.x.bias**2) / self.x.g)

    def _along_sight(self, column: str) -> Array:
        """Variance along the line of sight from both axes. [S-1]"""
        weights = line_of_sight_weights(self.x.grazing_angle)
        return np.asarray(sum(weight * axis for weight, axis in zip(weights, self.error[column], strict=True)))

    def sight_variance(self, column: str) -> Array:
        """Variance along the line of sight with vibration, unsensed motion and oscillator."""
        fast = sum(getattr(effect, column) for effect in self.x.fast.values())
        return np.asarray(self._along_sight(column) + fast)

    def _bend(self, kind: str) -> tuple[Bend, Bend]:
        prefix = "" if kind == "quadratic" else "cubic_"
        columns = [self.error[prefix + name] for name in Bend._fields]
        return Bend(*(column[0] for column in columns)), Bend(*(column[1] for column in columns))

    @property
    def lines(self) -> tuple[AxisError, AxisError]:
        """Line in the smoothed position error over the aperture, horizontal and vertical. [P-7]"""
        mean, slope, both = (self.error[name] for name in ("mean", "slope", "mean_slope"))
        return AxisError(mean[0], slope[0], both[0]), AxisError(mean[1], slope[1], both[1])

    @property
    def slope_shift(self) -> Array:
        """Azimuth shift without the position along the track, m: R/V times the slope of the line of sight."""
        return np.asarray(azimuth_lever(self.x) * np.sqrt(self._along_sight("slope") + fast_slope(self.x)))


def model_of(x: Inputs) -> RealTime:
    """The figures in the design's processing."""
    return Smoothed(x) if x.processing == POST_PROCESSED else RealTime(x)
