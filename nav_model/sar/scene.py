"""Images of a small scene of point targets by the design's radar, for each navigation error."""

import numpy as np
from numpy.typing import ArrayLike

from nav_model.aperture.geometry import cell_length
from nav_model.aperture.window import Window
from nav_model.base.arrays import Array
from nav_model.base.constants import SPEED_OF_LIGHT
from nav_model.sar.image import back_project, pulse_errors, simulate_phase_history
from nav_model.sar.line_of_sight import ApertureGeometry

# Beyond the scene by this factor, so that nothing folds back into it.
_ROOM = 1.5
_LEAST = 64


def scene_images(
    geometry: ApertureGeometry,
    aperture_time: float,
    wavelength: float,
    bandwidth: float,
    targets: Array,
    range_error: Array,
    amplitudes: ArrayLike,
    half_width: float,
    pixels: int,
    window: Window,
) -> tuple[Array, Array]:
    """Images of targets (m, 2) [m] on the ground, one for each ``range_error`` (k, n) [m].

    The errors run from end to end of the aperture. Pulses and frequencies are as many as the scene of
    +- ``half_width`` [m] needs not to fold.

    Returns the ground axis [m], along the track and away from it alike, and the power (k, y, x) [dB over a unit
    target].
    """
    azimuth_cell = cell_length(wavelength, geometry.slant_range, geometry.speed, aperture_time, geometry.squint)
    range_cell = SPEED_OF_LIGHT / (2 * bandwidth)
    diagonal = 2 * np.sqrt(2) * half_width * _ROOM
    pulses = max(_LEAST, int(np.ceil(diagonal / azimuth_cell)))
    frequencies = max(_LEAST, int(np.ceil(diagonal / range_cell)))
    time = np.linspace(0.0, aperture_time, pulses)
    band = (np.arange(frequencies) - frequencies // 2) * bandwidth / frequencies
    history = simulate_phase_history(
        geometry,
        time,
        SPEED_OF_LIGHT / wavelength + band,
        np.column_stack([targets, np.zeros(len(targets))]),
        amplitudes,
    )
    laid = pulse_errors(np.linspace(0, aperture_time, range_error.shape[-1]), range_error, pulses)
    axis = np.linspace(-half_width, half_width, pixels)
    images = [back_project(history, axis, axis, range_error=error, window=window) for error in laid]
    with np.errstate(divide="ignore"):
        return axis, 20 * np.log10(np.abs(np.stack(images)))
