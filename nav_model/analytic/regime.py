"""The sensor that limits the horizontal channel: gyro dominance of designs and of the catalogue. [T-6], [T-7]"""

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic.steady_state import (
    fix_density,
    gyro_dominance,
    horizontal,
    position_ratio,
    vertical,
)
from nav_model.base.arrays import Array
from nav_model.design import Design
from nav_model.design.catalogue import catalogue


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

    The ratio is that for equal fixes on both axes; a separate vertical fix noise does not enter. With velocity
    fixes it is off the curve: gyro dominance alone does not determine it. [P-6]
    """
    kappa, ratio = _points(design, design.imu.velocity_random_walk, design.imu.angle_random_walk)
    return float(kappa), float(ratio)


def catalogue_points(design: Design) -> tuple[tuple[str, ...], Array, Array]:
    """Names, gyro dominance and variance ratio of every catalogue unit with this design's GNSS and vibration.

    Units whose sheet lacks a random walk are left out.
    """
    known = [
        entry
        for entry in catalogue("imu").values()
        if {"velocity_random_walk", "angle_random_walk"} <= set(entry.values)
    ]
    kappa, ratio = _points(
        design,
        [entry.values["velocity_random_walk"].value for entry in known],
        [entry.values["angle_random_walk"].value for entry in known],
    )
    return tuple(entry.name for entry in known), kappa, ratio


def _points(design: Design, sigma_a: ArrayLike, sigma_w: ArrayLike) -> tuple[Array, Array]:
    gnss, factor, g = design.gnss, design.imu.vibration_factor, design.flight.gravity
    a, w = factor * np.asarray(sigma_a, float), factor * np.asarray(sigma_w, float)
    s = fix_density(gnss.position_noise, gnss.interval)
    kappa = gyro_dominance(a, w, s, g)
    if gnss.velocity_noise is None:
        return kappa, position_ratio(kappa)
    s_v = fix_density(gnss.velocity_noise, gnss.velocity_interval or gnss.interval)
    return kappa, horizontal(a, w, s, g, s_v).p11 / vertical(a, s, s_v).v11
