"""The maps of winners about a design: aperture time against fix noise, and against angle random walk."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nav_model.aperture.geometry import aperture_time
from nav_model.base.arrays import Array
from nav_model.base.constants import SPEED_OF_LIGHT
from nav_model.budget import Budget
from nav_model.design.catalogue import catalogue
from nav_model.design.processing import POST_PROCESSED
from nav_model.sar.design_case import conditions
from nav_model.sar.winners import map_of_winners

POINTS = 80
_APERTURE_SPAN = (0.5, 100.0)  # s
_GNSS_SPAN = (0.003, 30.0)  # m
_ARW_SPAN = (math.radians(1e-3) / 60, math.radians(10.0) / 60)


@dataclass(frozen=True)
class DesignMap:
    """Winners on a grid about a design.

    ``aperture_time`` (n,) [s] across, ``other`` (m,) upwards: fix noise [m] or angle random walk [rad/√s];
    ``winner`` (m, n): index into ``strategies``; ``phase`` (m, n): detrended phase [rad] of the strategy named.
    ``here``: the design; ``names``, ``x``, ``y``: the catalogue.
    """

    strategies: tuple[str, ...]
    aperture_time: Array
    other: Array
    winner: NDArray[np.intp]
    phase: Array
    here: tuple[float, float]
    names: tuple[str, ...]
    x: Array
    y: Array


def gnss_map(budget: Budget, points: int = POINTS) -> DesignMap:
    """Aperture time against fix noise; the catalogue's radars with this design's fixes.

    Radars whose entry lacks range, resolution, frequency or speed are left out.
    """
    of_design = budget.design.gnss.position_noise
    noise = _axis(of_design, _GNSS_SPAN, points)
    names, spans = [], []
    for entry in catalogue("radar").values():
        known = {key: item.value for key, item in (*entry.values.items(), *entry.extra.items())}
        if {"frequency", "slant_range", "azimuth_resolution", "speed"} <= set(known):
            names.append(entry.name)
            spans.append(
                float(
                    aperture_time(
                        SPEED_OF_LIGHT / known["frequency"], known["slant_range"], known["speed"],
                        known["azimuth_resolution"], budget.sar.window, budget.design.radar.squint_angle,
                    )
                )
            )  # fmt: skip
    # The vertical fix noise, if it has one of its own, goes with the horizontal.
    vertical = (budget.design.gnss.vertical_position_noise or of_design) / of_design * noise
    changes = {"gnss.position_noise": noise, "gnss.vertical_position_noise": vertical}
    return _made(budget, changes, of_design, names, np.array(spans), np.full(len(spans), of_design))


def arw_map(budget: Budget, points: int = POINTS) -> DesignMap:
    """Aperture time against angle random walk; the catalogue's inertial units at this design's aperture."""
    of_design = budget.design.imu.angle_random_walk
    walk = _axis(of_design, _ARW_SPAN, points)
    known = [entry for entry in catalogue("imu").values() if "angle_random_walk" in entry.values]
    values = np.array([entry.values["angle_random_walk"].value for entry in known])
    names = [entry.name for entry in known]
    apertures = np.full(len(known), budget.sar.aperture_time)
    return _made(budget, {"imu.angle_random_walk": walk}, of_design, names, apertures, values)


def _made(
    budget: Budget, changes: dict[str, Array], of_design: float, names: list[str], x: Array, y: Array
) -> DesignMap:
    """The map over apertures and what the first of the changes changes; the whole-leg smoother is computed where it
    may win."""
    other = next(iter(changes.values()))
    span = _axis(budget.sar.aperture_time, _APERTURE_SPAN, len(other))
    grid = {key: values[:, None] for key, values in changes.items()} | {"radar.aperture_time": span[None, :]}
    smoothed = budget.design.processing.mode == POST_PROCESSED
    result = map_of_winners(conditions(budget, grid, smoothed=smoothed))
    inside = (x >= span[0]) & (x <= span[-1]) & (y >= other[0]) & (y <= other[-1])
    return DesignMap(
        strategies=result.strategies,
        aperture_time=span,
        other=other,
        winner=result.winner,
        phase=4 * np.pi / budget.sar.wavelength * result.best_sigma,
        here=(budget.sar.aperture_time, of_design),
        names=tuple(name for name, visible in zip(names, inside, strict=True) if visible),
        x=x[inside],
        y=y[inside],
    )


def _axis(of_design: float, span: tuple[float, float], points: int) -> Array:
    """A log axis over `span`, grown where the design lies outside it."""
    return np.geomspace(min(span[0], of_design / 2), max(span[1], of_design * 2), points)
