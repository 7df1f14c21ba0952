"""Exact line-of-sight geometry of a straight aperture: rotating direction, squint and grazing angle.

Axes as everywhere: x along track, y toward the scene, z down, origin at the platform in mid-aperture. With
squint 0 (broadside) the target is abeam in mid-aperture; a positive squint looks forward.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from nav_model.base.arrays import Array


@dataclass(frozen=True)
class ApertureGeometry:
    """Straight flight past a point target. SI: slant range [m], speed [m/s], angles [rad].

    ``slant_range`` and ``grazing_angle`` are those of mid-aperture; ``squint`` is measured in the slant
    plane, from broadside.
    """

    slant_range: float
    speed: float
    grazing_angle: float = 0.0
    squint: float = 0.0

    def __post_init__(self) -> None:
        for name in ("slant_range", "speed"):
            value = getattr(self, name)
            if not (np.isfinite(value) and value > 0):
                raise ValueError(f"{name}: {value}; a positive, finite number is needed")
        if not 0 <= self.grazing_angle < np.pi / 2:
            raise ValueError(f"grazing_angle: {self.grazing_angle} rad; from 0 to below pi/2 is needed")
        if not np.cos(self.squint) > np.sin(self.grazing_angle):
            raise ValueError(
                f"squint: {self.squint} rad; at a grazing angle of {self.grazing_angle:.4g} rad the target "
                "would lie behind the horizon of the flight line (cos squint must exceed sin grazing)"
            )

    @property
    def target(self) -> Array:
        """Target position (3,) [m] from the platform in mid-aperture."""
        along, down = np.sin(self.squint), np.sin(self.grazing_angle)
        across = np.sqrt(1 - along**2 - down**2)
        return np.asarray(self.slant_range * np.array([along, across, down]))


def ranges_to_target(geometry: ApertureGeometry, time: ArrayLike) -> Array:
    """Vectors (n, 3) [m] from the platform to the target; time (n,) [s] from 0 to T, mid-aperture at T/2."""
    time = np.asarray(time, float)
    middle = (time[0] + time[-1]) / 2
    vectors = np.broadcast_to(geometry.target, (len(time), 3)).copy()
    vectors[:, 0] -= geometry.speed * (time - middle)
    return vectors


def range_error(
    geometry: ApertureGeometry,
    time: ArrayLike,
    along: ArrayLike = 0.0,
    across: ArrayLike = 0.0,
    down: ArrayLike = 0.0,
) -> Array:
    """Line-of-sight error dr(t) [m] of position errors (..., n) per axis: the exact difference of ranges.

    |r - dp| - |r| written without cancellation; to first order it is -u(t) . dp(t) [S-1], but an INS that is
    tens of metres off has a second-order part of millimetres. Detrend after this, never before: the
    direction rotates, so an along-track velocity error bends the phase [S-2].

    Parameters
    ----------
    geometry : ApertureGeometry
        Of the aperture.
    time : array_like (n,)
        Seconds, from end to end of the aperture.
    along, across, down : array_like (..., n), optional
        Position errors, m.
    """
    vectors = ranges_to_target(geometry, time)
    distance = np.linalg.norm(vectors, axis=1)
    grown: Array = np.zeros(1)
    for error, component in zip((along, across, down), vectors.T, strict=True):
        error = np.asarray(error, float)
        grown = grown + error * (error - 2 * component)
    return np.asarray(grown / (np.sqrt(distance**2 + grown) + distance))
