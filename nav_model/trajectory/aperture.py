"""The aperture as weights on the position and velocity errors at the nodes of a flight.

Between two nodes the position error is the cubic that has both positions and velocities: what the noise does inside a
step is left out, 0.4 % of a detrended phase with six nodes in the aperture and far less with more.
"""

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from nav_model.base.errors import InputError
from nav_model.budget.inputs import Inputs
from nav_model.processing.geolocation import Shifts, circular_error, ground_covariance
from nav_model.trajectory.errors import ErrorModel

FloatArray = NDArray[np.float64]
ORDERS = 6
"""Legendre coefficients along the line of sight."""
COLUMNS = ORDERS + 2
"""Sums of an aperture: these coefficients, the image's shift in azimuth, and that in range and azimuth together."""
_POINTS, _WEIGHTS = legendre.leggauss(5)
_ROUNDING = 1e-6  # s
_MOST_WEIGHTS = 5_000_000  # nodes of all apertures: a few minutes, and some 4 GB
_SLOWEST = 0.1  # m/s, as of a design: what stands has no synthetic aperture
# Mean square that polynomials up to ORDERS - 1 leave of white noise integrated twice, over its density times T³: with
# M = ORDERS - 1 it is (M + 1)/(8 (2M - 1)(2M + 1)(2M + 3)(2M + 5)), 1/420 for M = 1. [S-6], [P-15]
_BEYOND = 1 / 25740


class Apertures(NamedTuple):
    """Apertures of a flight, one a row: the output it belongs to, its first and last node, and weights on position
    and velocity errors from the first node on (apertures, nodes, COLUMNS, 6)."""

    output: NDArray[np.int64]
    first: NDArray[np.int64]
    last: NDArray[np.int64]
    weights: FloatArray


def apertures_of(model: ErrorModel, x: Inputs, interval: float) -> Apertures:
    """The apertures centred at the outputs of a flight that lie within it, where the aircraft moves.

    One begins at the last fix before where it would begin, as in the budget, and so is up to a fix interval early;
    without a fix there, it begins where it would. Raises InputError where they are too many and too long.
    """
    time_s, half = model.time_s, 0.5 * x.aperture
    begin = time_s[model.outputs] - half
    fixes = np.concatenate([[-np.inf], time_s[model.is_fix]])
    last_fix = fixes[np.searchsorted(fixes, begin + _ROUNDING, side="right") - 1]
    begin = np.where(begin - last_fix < interval * (1.0 + 1e-9), last_fix, begin)
    middle = np.minimum(np.searchsorted(time_s, begin + half), len(time_s) - 1)
    speed = np.linalg.norm(model.truth.velocity[middle, :2], axis=1)
    inside = (begin >= 0.0) & (begin + x.aperture <= time_s[-1]) & (speed > _SLOWEST)
    output, begin = np.flatnonzero(inside), begin[inside]
    first = np.searchsorted(time_s, begin + _ROUNDING, side="right") - 1
    last = np.searchsorted(time_s, begin + x.aperture - _ROUNDING)
    nodes = int(np.max(last - first, initial=0)) + 1
    if len(output) * nodes > _MOST_WEIGHTS:
        said = f"{len(output)} apertures of {nodes} steps are too many. Give fewer results or a shorter aperture."
        raise InputError("every", said)
    weights = np.zeros((len(output), nodes, COLUMNS, 6))
    sight, across = directions(model.truth.velocity[middle[inside]], x)
    # Shift in azimuth by the slope of the error, its Legendre coefficient of order 1. [P-7]
    slope = (2 * x.slant_range / (speed[inside] * math.cos(x.squint) * x.aperture))[:, None]
    for step in range(weights.shape[1] - 1):
        on = np.flatnonzero(first + step < last)
        left, right, start = time_s[first[on] + step], time_s[first[on] + step + 1], begin[on]
        length = right - left
        low, high = np.maximum(left, start), np.minimum(right, start + x.aperture)
        times = 0.5 * (low + high)[:, None] + 0.5 * (high - low)[:, None] * _POINTS
        s = (times - left[:, None]) / length[:, None]
        u = (times - start[:, None]) / half - 1.0
        polynomials = legendre.legvander(u, ORDERS - 1) * (np.arange(ORDERS) + 0.5)  # (apertures, points, orders)
        measure = 0.5 * (high - low)[:, None] * _WEIGHTS / half
        h = length[:, None]
        position, velocity = slice(3), slice(3, 6)
        for offset, states, function in (
            (0, position, 1 - 3 * s**2 + 2 * s**3),
            (0, velocity, h * (s - 2 * s**2 + s**3)),
            (1, position, 3 * s**2 - 2 * s**3),
            (1, velocity, h * (s**3 - s**2)),
        ):
            each = np.einsum("ap,apm->am", measure * function, polynomials)
            weights[on, step + offset, :ORDERS, states] += each[:, :, None] * sight[on, None]
            moved = each[:, :1] * across[on] - slope[on] * each[:, 1:2] * sight[on]
            weights[on, step + offset, ORDERS, states] += moved
    weights[:, :, -1] = weights[:, :, 0] + weights[:, :, ORDERS]
    return Apertures(output, first, last, weights)


def directions(velocity: FloatArray, x: Inputs) -> tuple[FloatArray, FloatArray]:
    """Line of sight, and the direction across it in the slant plane, for velocities (n, 3), all NED. [P-7]"""
    level = velocity[:, :2] / np.maximum(np.linalg.norm(velocity[:, :2], axis=1), 1e-9)[:, None]
    zero = np.zeros(len(level))
    along = np.column_stack([level, zero])
    right = np.column_stack([-level[:, 1], level[:, 0], zero])
    s, psi = math.sin(x.squint), x.grazing_angle
    sight = s * along + math.sqrt(max(math.cos(psi) ** 2 - s**2, 0.0)) * right
    sight[:, 2] = math.sin(psi)
    return sight, (along - s * sight) / math.cos(x.squint)


def figures(variances: FloatArray, x: Inputs, white: FloatArray) -> Mapping[str, FloatArray]:
    """Variances of the image figures by name, of those of the sums (sources, apertures, COLUMNS); [rad²], [m²].

    white: density of the accelerometers' noise by source [m²/s³] (sources), which the coefficients do not exhaust.
    `ce90` is the sum of both variances on the ground: `circular` makes the radius of the whole.
    """
    phase = x.to_phase**2
    left = sum(variances[..., n] / (2 * n + 1) for n in range(x.autofocus_order + 1, ORDERS))
    moved = _shifts(variances)
    along, across, _ = ground_covariance(moved, x.grazing_angle, 0.0, x.squint)
    return {
        "quadratic_phase": 9 / 4 * phase * variances[..., 2],
        "cubic_phase": 25 / 4 * phase * variances[..., 3],
        "detrended_phase": phase * (left + _BEYOND * x.aperture**3 * white[:, None]),
        "azimuth_shift": moved.azimuth,
        "range_shift": moved.range,
        "ce90": along + across,
    }


def circular(variances: FloatArray, x: Inputs) -> FloatArray:
    """CE90 [m] of variances of the sums (apertures, COLUMNS), with the error of the scene's height. [P-7]"""
    on_ground = ground_covariance(_shifts(variances), x.grazing_angle, x.scene_height_error, x.squint)
    return np.asarray(circular_error(*on_ground))


def _shifts(variances: FloatArray) -> Shifts:
    mean, azimuth, together = variances[..., 0], variances[..., ORDERS], variances[..., -1]
    return Shifts(mean, azimuth, 0.5 * (together - mean - azimuth), mean)
