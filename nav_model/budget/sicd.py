"""Image location errors as the error statistics of SICD (NGA.STND.0024, volumes 1 and 3). [P-7]"""

import math
from typing import NamedTuple

import numpy as np

from nav_model.base.arrays import Array
from nav_model.budget.inputs import inputs_of
from nav_model.budget.smoothed import model_of
from nav_model.design import Design


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
    model = model_of(inputs_of(design))
    (horizontal, vertical), shift = model.lines, model.shift
    trajectory = np.zeros((6, 6))
    for axis, line in enumerate((vertical, horizontal, horizontal)):
        trajectory[axis, axis], trajectory[axis + 3, axis + 3] = line.mean, line.slope
        trajectory[axis, axis + 3] = trajectory[axis + 3, axis] = line.covariance
    sigma_range, sigma_azimuth = math.sqrt(float(shift.range)), math.sqrt(float(shift.azimuth))
    correlation = float(shift.covariance) / (sigma_range * sigma_azimuth)
    return ErrorStatistics(sigma_range, sigma_azimuth, correlation, trajectory)
