"""Aperture and line of sight of a broadside synthetic-aperture radar. Everything broadcasts over arrays."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nav_model.base.arrays import Array, as_numbers

WINDOW_WIDTH: dict[str, float] = {
    "uniform": 0.8858929413789045,
    "hamming": 1.3029820808162347,
    "taylor": 1.1874775859198126,
}
"""Half-power width k of the error-free response in cells of lambda R/(2 V T): [S-3]. Taylor is -35 dB, n̄ = 5.

Roots of the windows' transforms; a test finds them again.
"""


def phase_to_metres(phase: ArrayLike, wavelength: ArrayLike) -> Array:
    """Line-of-sight error [m] of a two-way phase [rad]: pi/4 is lambda/16. [T-13], [S-4]"""
    metres: Array = as_numbers(phase) * as_numbers(wavelength) / (4 * np.pi)
    return metres


def metres_to_phase(metres: ArrayLike, wavelength: ArrayLike) -> Array:
    """Two-way phase [rad] of a line-of-sight error [m]. [T-13]"""
    phase: Array = 4 * np.pi * np.asarray(metres, float) / np.asarray(wavelength, float)
    return phase


def aperture_time(
    wavelength: ArrayLike,
    slant_range: ArrayLike,
    speed: ArrayLike,
    resolution: ArrayLike,
    window: str,
    squint: ArrayLike = 0.0,
) -> Array:
    """Aperture time [s] that gives the azimuth resolution with the window. [S-3]

    Resolution is across the line of sight; squint foreshortens the track by its cosine.

    Parameters
    ----------
    wavelength, slant_range, resolution : array_like
        m.
    speed : array_like
        m/s.
    window : str
        Key of `WINDOW_WIDTH`.
    squint : array_like, optional
        rad.

    Raises
    ------
    KeyError
        For a window that is not in `WINDOW_WIDTH`.
    """
    wavelength, slant_range, speed, resolution = (as_numbers(x) for x in (wavelength, slant_range, speed, resolution))
    across = speed * np.cos(as_numbers(squint))
    time: Array = WINDOW_WIDTH[window] * wavelength * slant_range / (2 * resolution * across)
    return time


def cell_length(
    wavelength: ArrayLike, slant_range: ArrayLike, speed: ArrayLike, aperture: ArrayLike, squint: ArrayLike = 0.0
) -> Array:
    """Azimuth cell lambda R/(2 V T) [m], across the line of sight: peak to first null, unweighted. [S-3]

    Parameters
    ----------
    wavelength, slant_range : array_like
        m.
    speed : array_like
        m/s.
    aperture : array_like
        Seconds.
    squint : array_like, optional
        rad.
    """
    wavelength, slant_range, speed, aperture = (as_numbers(x) for x in (wavelength, slant_range, speed, aperture))
    length: Array = wavelength * slant_range / (2 * speed * np.cos(as_numbers(squint)) * aperture)
    return length


def hidden(squint: ArrayLike, grazing_angle: ArrayLike) -> NDArray[np.bool_]:
    """True where no line of sight has both angles [rad]."""
    return np.asarray(np.cos(squint) < np.sin(grazing_angle) - 1e-12)


def line_of_sight_weights(grazing_angle: ArrayLike) -> tuple[Array, Array]:
    """Weights of a horizontal axis's and of the vertical variance in the line of sight. [S-1]

    They hold under squint too: the horizontal axes are alike, and share cos² of the grazing angle between them.
    """
    angle = as_numbers(grazing_angle)
    return np.cos(angle) ** 2, np.sin(angle) ** 2
