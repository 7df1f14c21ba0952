"""The azimuth impulse response of a quadratic phase, with what vibration and oscillator add. [S-5], [P-9], [P-11]"""

import math

import numpy as np

from nav_model.aperture import geometry
from nav_model.aperture.impulse_response import ImpulseResponse, with_echoes
from nav_model.aperture.polynomial_response import quadratic_response
from nav_model.base.arrays import Array
from nav_model.budget.fast import levels, power_at_target
from nav_model.budget.inputs import Inputs
from nav_model.design.figures import RESPONSE

NO_IMAGE = 1000.0
"""Quadratic phase [rad] that smears the response over more than 600 cells; no larger one is computed."""


def response_of(x: Inputs, quadratic: float) -> ImpulseResponse | None:
    """Impulse response of one design with a quadratic phase [rad]; None beyond `NO_IMAGE`."""
    return None if quadratic > NO_IMAGE else _response(quadratic, x.window, *map(float, _beside(x)))


def measures_of(response: ImpulseResponse, cell: float) -> dict[str, float]:
    """Figures of `RESPONSE`: width between the outermost half-power points [m] for cells of so many metres,
    amplitudes outside the error-free main lobe over the target's, and loss of the peak's power [dB]."""
    side = (float(response.pslr_fixed_db), float(response.islr_fixed_db))
    width, loss = float(response.half_power_extent_cells) * cell, -float(response.peak_loss_db)
    return dict(zip(RESPONSE, (width, *(10 ** (level / 20) for level in side), loss), strict=True))


def measures(x: Inputs, quadratic: Array) -> dict[str, Array]:
    """Figures of `RESPONSE` for quadratic phases [rad], beyond `NO_IMAGE` those of `NO_IMAGE`; NaN for NaN."""

    def measured(phase: float, *beside: float) -> tuple[float, ...]:
        if math.isnan(phase):
            return (math.nan,) * len(RESPONSE)
        return tuple(measures_of(_response(min(phase, NO_IMAGE), x.window, *beside), 1.0).values())

    values = np.vectorize(measured, otypes=[float] * len(RESPONSE))(quadratic, *_beside(x))
    cell = geometry.cell_length(x.wavelength, x.slant_range, x.speed, x.aperture, x.squint)
    return dict(zip(RESPONSE, (values[0] * cell, *values[1:]), strict=True))


def _response(quadratic: float, window: str, *beside: float) -> ImpulseResponse:
    response = quadratic_response(quadratic, window)  # type: ignore[arg-type]
    return with_echoes(response, *beside) if beside else response


def _beside(x: Inputs) -> tuple[Array, ...]:
    """Highest echo, and power that stays, all and with near errors alone; empty where there are no fast sources."""
    if not x.fast:
        return ()
    arguments = x.fast.values(), x.to_phase, x.aperture, x.window
    return levels(*arguments)["paired_echo"], *power_at_target(*arguments)
