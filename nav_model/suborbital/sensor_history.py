"""Sensor errors along a flight [B-1]: bias, instability and total of each axis against time."""

from dataclasses import dataclass, field

import numpy as np

from nav_model.base.arrays import Array
from nav_model.suborbital.errors import ErrorSet, require_parameters
from nav_model.suborbital.flight import TrueFlight
from nav_model.suborbital.layout import ACCELEROMETERS, GYROS, MATRIX, SLOW_BIAS, SLOW_MATRIX
from nav_model.suborbital.mechanisation import oscillations


@dataclass(frozen=True)
class SensorHistory:
    """Errors of the measured quantities of c cases at m instants, body axes: time_s (m,), specific_force_m_s2
    and angular_rate_rad_s (c, m, 3), without the white noise, which has no value at an instant."""

    time_s: Array
    specific_force_m_s2: Array = field(repr=False)
    angular_rate_rad_s: Array = field(repr=False)


def sensor_history(flight: TrueFlight, parameters: Array, errors: ErrorSet, every: int = 10) -> SensorHistory:
    """df and domega [B-1] of the parameter vectors (c, 61) or (61,), in the order of `layout`.

    errors supplies the periods of the oscillating terms; every: spacing in steps, a divisor of their number.
    At burn-out the specific force is that of the step which begins there. Raises InputError for a wrong
    shape or spacing.
    """
    p = np.atleast_2d(parameters)
    require_parameters(p)
    flight.require_spacing(every)

    def at_steps(nodes: Array) -> Array:
        return np.concatenate([nodes[:, 0], nodes[-1:, 2]])[::every]

    slow = oscillations(flight, errors)[:: 2 * every]

    def triad(start: int, measured: Array, bias: Array, matrix: Array) -> Array:
        part = p[:, start : start + GYROS]
        constant = part[:, MATRIX:SLOW_MATRIX].reshape(-1, 3, 3)
        slowly = part[:, SLOW_MATRIX:].reshape(-1, 3, 3)
        moving = part[:, None, SLOW_BIAS:MATRIX] * bias[:, None]
        moving = moving + np.einsum("cij,t,tj->cti", slowly, matrix, measured)
        return np.asarray(part[:, None, :SLOW_BIAS] + np.einsum("cij,tj->cti", constant, measured) + moving)

    return SensorHistory(
        time_s=flight.time_s[::every],
        specific_force_m_s2=triad(ACCELEROMETERS, at_steps(flight.specific_force_b), slow[:, 0], slow[:, 1]),
        angular_rate_rad_s=triad(GYROS, at_steps(flight.angular_rate_b), slow[:, 2], slow[:, 3]),
    )
