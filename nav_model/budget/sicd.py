"""Image location errors as the error statistics of SICD (NGA.STND.0024, volumes 1 and 3). [P-7]"""

import math
from typing import NamedTuple

import numpy as np

from nav_model.base.arrays import Array
from nav_model.budget.figures import begun, free_lines, smoothed_lines, with_fast
from nav_model.budget.inputs import inputs_of
from nav_model.design import Design
from nav_model.processing.geolocation import shifts


class ErrorStatistics(NamedTuple):
    """One sigma of the composite error at the scene's centre, and of the trajectory over the aperture.

    ``range`` and ``azimuth`` are in the slant plane [m], ``correlation`` is that of the two for a radar that looks to
    the right of the track (to the left, with the other sign). ``trajectory`` is the covariance of position and
    velocity in the axes up, along the track, across it: [m²], [m²/s], [m²/s²].
    """

    range: float
    azimuth: float
    correlation: float
    trajectory: Array


def error_statistics(design: Design) -> ErrorStatistics:
    """Error statistics of an image, in real time or post-processed as the design has it.

    Parameters
    ----------
    design : Design

    Examples
    --------
    >>> from nav_model import Design
    >>> found = error_statistics(Design())
    >>> found.trajectory.shape
    (6, 6)
    """
    x = inputs_of(design)
    level, upright = smoothed_lines(x) if x.post_processed else free_lines(x, begun(x))
    moved = with_fast(x, shifts(level, upright, x.grazing_angle, x.slant_range, x.speed, x.squint))
    trajectory = np.zeros((6, 6))
    for axis, line in enumerate((upright, level, level)):
        trajectory[axis, axis], trajectory[axis + 3, axis + 3] = line.mean, line.slope
        trajectory[axis, axis + 3] = trajectory[axis + 3, axis] = line.both
    sigma_range, sigma_azimuth = math.sqrt(float(moved.range)), math.sqrt(float(moved.azimuth))
    correlation = float(moved.both) / (sigma_range * sigma_azimuth)
    return ErrorStatistics(sigma_range, sigma_azimuth, correlation, trajectory)
