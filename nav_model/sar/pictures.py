"""Pictures with the navigation errors of a study: a point, a real phase history."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from nav_model.base.arrays import Array
from nav_model.base.constants import SPEED_OF_LIGHT
from nav_model.budget import Budget
from nav_model.sar.image import back_project, point_target_image, pulse_errors, read_phase_history

_MOST_BANDWIDTH = 0.3  # of the carrier
_POINT_AZIMUTH, _POINT_RANGE = 10.0, 5.0  # cells each side of the point


@dataclass(frozen=True)
class Pictures:
    """Power [dB] (k, y, x) on one scale; ``x`` azimuth and ``y`` range [m] about the middle.

    ``range_cell`` [m]; ``bandwidth_cut``: whether it was coarsened to keep the band below 0.3 of the carrier.
    """

    x: Array
    y: Array
    power_db: Array
    range_cell: float
    bandwidth_cut: bool


def point_pictures(budget: Budget, residual: ArrayLike) -> Pictures:
    """The focused point under each residual (k, n) [m], dB over the error-free peak.

    A design has no range resolution: its azimuth resolution is used.
    """
    cell, cut = _range_cell(budget)
    azimuth, ranges = np.linspace(-_POINT_AZIMUTH, _POINT_AZIMUTH, 121), np.linspace(-_POINT_RANGE, _POINT_RANGE, 61)
    power = point_target_image(
        residual,
        budget.sar.wavelength,
        cell,
        azimuth,
        ranges,
        budget.sar.window,  # type: ignore[arg-type]
    )
    return Pictures(azimuth * budget.sar.cell_length, ranges * cell, np.swapaxes(power, -1, -2), cell, cut)


def uploaded_pictures(
    name: str, data: bytes, time: ArrayLike, residual: ArrayLike, half_width: float, pixels: int = 256
) -> Pictures:
    """Images of a user's phase history, as it is and with each residual: (1 + k, y, x), brightest at 0 dB.

    The residual, which belongs to the design's aperture, is laid over the file's pulses from first to last; the
    phase it makes is that of the file's wavelength. The plane is z = 0, the window Taylor.

    Parameters
    ----------
    name : str
        Name of the file.
    data : bytes
        The file.
    time : array_like (n,)
        Seconds in the design's aperture.
    residual : array_like (k, n)
        m.
    half_width : float
        The picture is ± this about the scene centre, m.
    pixels : int, optional
        On a side.

    Raises
    ------
    ValueError
        Naming the file and what is wrong with it, or a half width that is not positive and finite.
    """
    if not (np.isfinite(half_width) and half_width > 0):
        raise ValueError(f"half_width: {half_width} m; a positive, finite number is needed")
    history = read_phase_history(name, data)
    laid = pulse_errors(time, np.atleast_2d(np.asarray(residual, float)), history.samples.shape[1])
    axis = np.linspace(-half_width, half_width, pixels)
    images = [back_project(history, axis, axis, range_error=error, window="taylor") for error in (0 * laid[0], *laid)]
    brightest = np.abs(images[0]).max()
    if not brightest > 0:
        raise ValueError(f"{name}: nothing lies within {half_width:g} m of the scene centre")
    with np.errstate(divide="ignore"):
        power = 20 * np.log10(np.abs(np.stack(images)) / brightest)
    band = float(np.ptp(history.frequency))
    return Pictures(axis, axis, power, SPEED_OF_LIGHT / (2 * band), False)


def _range_cell(budget: Budget) -> tuple[float, bool]:
    """Range cell c/(2B) [m] equal to the azimuth resolution, and whether the carrier forced a coarser one."""
    wanted = budget.design.radar.azimuth_resolution
    finest = SPEED_OF_LIGHT / (2 * _MOST_BANDWIDTH * budget.design.radar.frequency)
    return max(wanted, finest), wanted < finest
