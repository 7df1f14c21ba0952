"""Which sensor rules the horizontal channel: regime number of designs and of the catalogue. [T-6], [T-7]"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic.steady_state import Array, fix_density, gyro_dominance, position_ratio
from nav_model.catalogue import catalogue
from nav_model.design import Design


def curves(low: float, high: float, count: int) -> tuple[Array, Array, Array]:
    """Gyro dominance from `low` to `high`, the exact ratio u and its asymptote, each of `count` points."""
    kappa: Array = np.geomspace(low, high, count)
    return kappa, position_ratio(kappa), np.cbrt(kappa)


def asymptote_error(kappa: ArrayLike) -> Array:
    """Relative error of the gyro-dominated asymptote of the position variance, cbrt(kappa)/u - 1. [T-7]"""
    error: Array = np.cbrt(np.asarray(kappa, float)) / position_ratio(kappa) - 1
    return error


def design_point(design: Design) -> tuple[float, float]:
    """Gyro dominance of a design and its ratio of horizontal to vertical position variance.

    The ratio is that for equal fixes on both axes; a vertical fix noise of its own does not enter.
    """
    kappa = _dominance(design, design.imu.velocity_random_walk, design.imu.angle_random_walk)
    return float(kappa), float(position_ratio(kappa))


def catalogue_points(design: Design) -> tuple[tuple[str, ...], Array, Array]:
    """Names, gyro dominance and variance ratio of every catalogue unit with this design's GNSS and vibration.

    Units whose sheet lacks a random walk are left out.
    """
    known = [
        entry
        for entry in catalogue("imu").values()
        if {"velocity_random_walk", "angle_random_walk"} <= set(entry.values)
    ]
    kappa = _dominance(
        design,
        [entry.values["velocity_random_walk"].value for entry in known],
        [entry.values["angle_random_walk"].value for entry in known],
    )
    return tuple(entry.name for entry in known), kappa, position_ratio(kappa)


def _dominance(design: Design, sigma_a: ArrayLike, sigma_w: ArrayLike) -> Array:
    factor = design.imu.vibration_factor
    s = fix_density(design.gnss.position_noise, design.gnss.interval)
    return gyro_dominance(
        factor * np.asarray(sigma_a, float), factor * np.asarray(sigma_w, float), s, design.flight.gravity
    )
