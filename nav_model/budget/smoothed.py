"""The figures after the flight, when a smoother has every fix. [P-3], [P-5]

What is not here is the same in both processings (`nav_model.budget.real_time`). Constant residual biases cost
nothing: the smoother takes them up.
"""

from functools import cached_property

import numpy as np

from nav_model.analytic.turning import TURNING, Turn, smoothed_bent_variance, turn_weights
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
        Channel(x.sigma_a, None, x.fix_vertical, x.interval, vertical, interval, upright, time),
    )


class Smoothed(RealTime):
    """The figures of one design, or of arrays of designs, with a smoother."""

    processing = POST_PROCESSED

    @cached_property
    def error(self) -> SmoothedError:
        """The smoothed error of a horizontal axis, and of the vertical one."""
        x = self.x
        return SmoothedError(channels(x), x.aperture, x.leg_after, x.before_aperture)

    def variances_of(self, name: str) -> None:  # the smoother weighs all sources together
        return None

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

    @property
    def quadratic_phase(self) -> Array:
        return self.to_phase * np.sqrt(self.sight_variance("quadratic"))

    @property
    def cubic_phase(self) -> Array:
        return self.to_phase * np.sqrt(self.sight_variance("cubic"))

    def detrended(self, order: int) -> Array:
        """Phase [rad] that is left after autofocus of an order."""
        return self.to_phase * np.sqrt(self.sight_variance(f"left_{order}"))

    @property
    def along_track_quadratic_phase(self) -> Array:
        x = self.x
        turn = x.speed * np.cos(x.squint) ** 2 * x.aperture / (2 * x.slant_range)
        return np.asarray(self.to_phase * turn * np.sqrt(self.error["turned"][0]))

    @property
    def lines(self) -> tuple[AxisError, AxisError]:
        """Line in the smoothed position error over the aperture, horizontal and vertical. [P-7]"""
        mean, slope, both = (self.error[name] for name in ("mean", "slope", "mean_slope"))
        return AxisError(mean[0], slope[0], both[0]), AxisError(mean[1], slope[1], both[1])

    @property
    def slope_shift(self) -> Array:
        """Azimuth shift without the position along the track, m: R/V times the slope of the line of sight."""
        return np.asarray(azimuth_lever(self.x) * np.sqrt(self._along_sight("slope") + fast_slope(self.x)))

    # Along the line of sight as it turns over the aperture: [S-2] and the terms that it omits.

    def _turning(self, column: str, of: str = "") -> Array:
        x = self.x
        turn: Turn = turn_weights(x.grazing_angle, x.squint, x.speed / x.slant_range, x.aperture)
        horizontal, vertical = ({name: self.error[of + name][axis] for name in TURNING} for axis in (0, 1))
        axes = ((turn.along, horizontal), (turn.across, horizontal), (turn.down, vertical))
        return np.asarray(self.sight_variance(column) + sum(smoothed_bent_variance(*pair) for pair in axes))

    @property
    def turning_quadratic_phase(self) -> Array:
        """Quadratic phase [rad] with the turn of the line of sight."""
        return self.to_phase * np.sqrt(self._turning("quadratic"))

    @property
    def turning_detrended_phase_1(self) -> Array:
        """What autofocus of order 1 leaves [rad] with the turn: that after the next order, which the turn hardly
        changes (0.08 % in the examples, 0.7 % where it is 0.225 rad to each side), and the turning quadratic."""
        return self.to_phase * np.sqrt(self.sight_variance("left_2") + 4 / 45 * self._turning("quadratic"))

    @property
    def turning_detrended_phase_2(self) -> Array:
        """Likewise for order 2, with the turning cubic."""
        return self.to_phase * np.sqrt(self.sight_variance("left_3") + 4 / 175 * self._turning("cubic", "cubic_"))

    @property
    def turn_of_quadratic(self) -> Array:
        """By how much the turn changes quadratic and along-track phase together, a part of them."""
        together = np.sqrt(self.quadratic_phase**2 + self.along_track_quadratic_phase**2)
        return np.asarray(self.turning_quadratic_phase / together - 1)

    @property
    def turn_of_detrended(self) -> Array:
        """The same of what the design's autofocus leaves; nothing after order 3, which removes the turn."""
        order = self.x.autofocus_order
        if order == 3:
            return np.zeros(())
        return np.asarray(getattr(self, f"turning_detrended_phase_{order}") / self.detrended_phase - 1)


def model_of(x: Inputs) -> RealTime:
    """The figures in the design's processing."""
    return Smoothed(x) if x.processing == POST_PROCESSED else RealTime(x)
