"""Residual biases along a flight: what the filter has not absorbed at the last fix, sources as in the budget.

No state of the filter has them. From the last fix on they act in full: b t²/2 of position on each axis, g d t³/6 on
the horizontal ones, which the turns of the flight do not change. While fixes come, a tilt of b/g cancels the
accelerometer's, and neither reaches position and velocity. A smoother takes both up, but for that tilt. [S-5], [T-17]
Nothing shows the vertical gyro's part but what shows the heading: it alone goes through the filter's gains, as an
error that the filter does not know (`HEADING_DRIFT`).
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.analytic.coast import bias_position, bias_velocity
from nav_model.budget.inputs import RECTIFICATION, Inputs
from nav_model.budget.shares import ACCELEROMETER_BIAS, GYRO_BIAS
from nav_model.simulation.layout import ATTITUDE, BIASES, POSITION, VELOCITY

FloatArray = NDArray[np.float64]
HEADING_DRIFT = "heading drift"
"""Group of the state that the vertical gyro's residual bias has."""
_ROUNDING = 1e-6  # s


class Growth(NamedTuple):
    """Error of one axis at some times since the last fix: position [m] and velocity [m/s], on how many axes, north
    first; and the tilt [rad] of roll and pitch."""

    position: FloatArray
    velocity: FloatArray
    axes: int
    tilt: FloatArray


def residual_biases(x: Inputs) -> Mapping[str, float]:
    """Source -> residual bias [m/s²] or [rad/s], 1 sigma, of those that are not zero."""
    rectified = 0.0 if x.rectified is None else float(x.rectified)
    sizes = {ACCELEROMETER_BIAS: float(x.bias_a), RECTIFICATION: rectified, GYRO_BIAS: float(x.bias_w)}
    return {source: size for source, size in sizes.items() if size > 0.0}


def growths(x: Inputs, since: FloatArray) -> Mapping[str, Growth]:
    """Growth by each residual bias `since` seconds after the last fix, any shape."""
    g, made = float(x.g), {}
    for source, size in residual_biases(x).items():
        gyro = source == GYRO_BIAS
        sizes, axes = ((0.0, size), 2) if gyro else ((size, 0.0), 3)
        position, velocity = (grown(*sizes, g, since)[gyro] for grown in (bias_position, bias_velocity))
        tilt = size * since if gyro else np.full(np.shape(since), size / g)
        made[source] = Growth(position, velocity, axes, tilt)
    return made


def since_fix(fixes: FloatArray, at: FloatArray, interval: float) -> FloatArray:
    """Time since the last of the position fixes [s] at some times; 0 where it is no more than an interval ago.

    A flight begins with a fix.
    """
    ends = np.concatenate([[0.0], fixes])
    since = at - ends[np.searchsorted(ends, at + _ROUNDING, side="right") - 1]
    return np.where(since > interval + _ROUNDING, since, 0.0)


def of_states(x: Inputs, since: FloatArray, *, smoothed: bool) -> Mapping[str, FloatArray]:
    """Source -> variances (outputs, 8) of position, velocity, roll and pitch, `since` the last fix (outputs) [s]."""
    variances = {}
    for source, growth in growths(x, since).items():
        of_source = variances[source] = np.zeros((len(since), BIASES - 1))
        if not smoothed:
            of_source[:, POSITION : POSITION + growth.axes] = growth.position[:, None] ** 2
            of_source[:, VELOCITY : VELOCITY + growth.axes] = growth.velocity[:, None] ** 2
        if not (smoothed and source == GYRO_BIAS):
            of_source[:, ATTITUDE:] = growth.tilt[:, None] ** 2
    return variances


def of_images(x: Inputs, since: FloatArray, weights: FloatArray) -> Mapping[str, FloatArray]:
    """Source -> variances (apertures, columns) of sums over apertures, whose weights (apertures, nodes, columns, 6)
    are on position and velocity at nodes `since` seconds after the last fix before each (apertures, nodes)."""
    variances = {}
    for source, growth in growths(x, since).items():
        by_axis = np.einsum("ancx,an->acx", weights[..., : growth.axes], growth.position)
        by_axis += np.einsum("ancx,an->acx", weights[..., 3 : 3 + growth.axes], growth.velocity)
        variances[source] = (by_axis**2).sum(axis=2)
    return variances
