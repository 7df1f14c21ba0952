"""The figures after the flight, when a smoother has every fix. [P-3], [P-5]

What is not here is the same in both processings (`nav_model.budget.real_time`). Constant residual biases cost
nothing but a tilt: the smoother takes them up.
"""

from functools import cached_property

import numpy as np

from nav_model.analytic.turning import Bend
from nav_model.base.arrays import Array
from nav_model.budget.inputs import Inputs
from nav_model.budget.real_time import (
    RealTime,
    azimuth_lever,
    bends_of,
    fast_slope,
    line_of_sight,
    lines_of,
    of_fast,
    residual_of,
)
from nav_model.budget.varying import channels
from nav_model.design.processing import POST_PROCESSED
from nav_model.processing.geolocation import AxisError
from nav_model.processing.smoother import SmoothedError


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
        return np.asarray(np.sqrt(self.error["tilt"][0] / self.x.g**2 + self.x.settled_tilt))

    def sight_variance(self, column: str) -> Array:
        """Variance along the line of sight with vibration, unsensed motion and oscillator."""
        fast = sum(getattr(effect, column) for effect in self.x.fast.values())
        return np.asarray(line_of_sight(self.error[column], self.x.grazing_angle) + fast)

    def sight_residual(self, kind: str) -> Array:
        """As of real time, with vibration, unsensed motion and oscillator."""
        x = self.x
        residual = x.autofocus_order if x.residual is None else x.residual
        of_error = residual_of(lambda name: line_of_sight(self.error[name], x.grazing_angle), residual)
        fast = sum(getattr(of_fast(effect, residual), kind) for effect in x.fast.values())
        return np.asarray(getattr(of_error, kind) + fast)

    def _bend(self, kind: str) -> tuple[Bend, Bend]:
        return bends_of(self.error, kind)

    @property
    def lines(self) -> tuple[AxisError, AxisError]:
        """Line in the smoothed position error over the aperture, horizontal and vertical. [P-7]"""
        return lines_of(self.error)

    @property
    def slope_shift(self) -> Array:
        """Azimuth shift without the position along the track, m: R/V times the slope of the line of sight."""
        slope = line_of_sight(self.error["slope"], self.x.grazing_angle)
        return np.asarray(azimuth_lever(self.x) * np.sqrt(slope + fast_slope(self.x)))


def model_of(x: Inputs) -> RealTime:
    """The figures in the design's processing."""
    return Smoothed(x) if x.processing == POST_PROCESSED else RealTime(x)
