"""A plan: waypoints with lines between some of them, speed and bank; and the legs between waypoints."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from nav_model.base.constants import DEGREE
from nav_model.base.errors import InputError
from nav_model.earth.wgs84 import metres_per_radian

FloatArray = NDArray[np.float64]
TIME_TO_ROLL = 3.0  # s in and out of a bank, and at least so long for a change of speed
_STEEPEST = 1.875  # of a smooth step: its largest slope


@dataclass(frozen=True)
class Waypoint:
    """A place of a plan: latitude, longitude [rad], height above the ellipsoid [m]. line: name of the line that
    begins here and ends at the next waypoint; empty where none does. speed: over ground, of the leg that begins here
    [m/s]; None: the plan's."""

    latitude: float
    longitude: float
    height: float
    line: str = ""
    speed: float | None = None


@dataclass(frozen=True)
class Plan:
    """Waypoints in their order, ground speed [m/s], bank of turns [rad], fastest climb and descent [m/s], the height
    of the ground [m], and the largest acceleration along the track [m/s²]."""

    waypoints: tuple[Waypoint, ...]
    speed: float
    bank: float = 25 * DEGREE
    climb_rate: float = 5.0
    ground: float = 0.0
    acceleration: float = 1.0

    def speed_from(self, number: int) -> float:
        """Ground speed of the leg that begins at a waypoint, counted from 0 [m/s]."""
        return self.waypoints[number].speed or self.speed

    def room(self, *speeds: float) -> float:
        """Distance that it takes to fly one speed after the other [m]."""
        return sum(0.5 * (u + v) * float(time_to_change(u, v, self.acceleration)) for u, v in pairwise(speeds))


def strip(like: Plan, first: Waypoint, heading: float, length: float, spacing: float, count: int) -> Plan:
    """Parallel lines, flown to and fro. `fly` makes their turns.

    Parameters
    ----------
    like : Plan
        Speed, bank and the other values of the plan.
    first : Waypoint
        Begin of the first line.
    heading : float
        Of the first line, rad.
    length, spacing : float
        m; the lines are to the right of the first, or to the left for a negative spacing.
    count : int
        Number of lines.
    """
    if count < 1 or not length > 0.0 or (count > 1 and not abs(spacing) > 0.0):
        raise InputError("lines", f"{count} lines of {length:g} m, {spacing:g} m apart, cannot be laid out")
    number = np.arange(2 * count)
    along, right = np.diff(length * ((number + 1) // 2 % 2)), np.diff(spacing * (number // 2))
    c, s = math.cos(heading), math.sin(heading)
    corners = zip(*_corners(first, c * along - s * right, s * along + c * right), number.tolist(), strict=True)
    points = (
        Waypoint(float(north), float(east), first.height, "" if n % 2 else f"line {n // 2 + 1}")
        for north, east, n in corners
    )
    return replace(like, waypoints=tuple(points))


def lengthened(plan: Plan, number: int, by: float) -> Plan:
    """The plan with its line `number` (from 0) longer by `by` [s], or shorter; all that follows it moves along."""
    points, legs = plan.waypoints, legs_between(plan.waypoints)
    leg = [n for n, point in enumerate(points[:-1]) if point.line][number]
    legs[leg] *= 1.0 + by * plan.speed_from(leg) / abs(legs[leg])
    places = zip(points, places_along(points[0], legs.tolist()), strict=True)
    moved = (replace(point, latitude=place.latitude, longitude=place.longitude) for point, place in places)
    return replace(plan, waypoints=tuple(moved))


def time_to_change(before: FloatArray | float, after: FloatArray | float, most: float) -> FloatArray:
    """Time to change from one speed to another [m/s] as a smooth step [s], at most `most` [m/s²] in its middle;
    of the shape of the speeds, zero where they are the same."""
    by = np.abs(np.subtract(after, before))
    return np.where(by > 0.0, np.maximum(_STEEPEST * by / most, TIME_TO_ROLL), 0.0)


def legs_between(points: Sequence[Waypoint]) -> NDArray[np.complex128]:
    """The legs between n waypoints, (n - 1,) [m]: north, and east as the imaginary part, by the mean radii of WGS 84
    along each."""
    latitude, longitude, height = np.array([(point.latitude, point.longitude, point.height) for point in points]).T
    scale = _scales(latitude, height)
    legs: NDArray[np.complex128] = np.diff(latitude) * scale[0] + 1j * np.diff(np.unwrap(longitude)) * scale[1]
    return legs


def places_along(first: Waypoint, legs: Sequence[complex]) -> list[Waypoint]:
    """Both ends of all legs [m] from `first` on, at its height: `legs_between` takes them back into these legs."""
    north, east = _corners(first, np.real(legs), np.imag(legs))
    return [replace(first, latitude=float(up), longitude=float(right)) for up, right in zip(north, east, strict=True)]


def _scales(latitude: FloatArray, height: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Metres north and east of a radian of latitude and of longitude, on each leg between places: means along the
    leg by Simpson's rule, as it is flown on one heading."""
    north, east = metres_per_radian(latitude, height)
    middle = metres_per_radian(0.5 * (latitude[1:] + latitude[:-1]), 0.5 * (height[1:] + height[:-1]))
    east = 6.0 / (1.0 / east[:-1] + 4.0 / middle[1] + 1.0 / east[1:])
    return (north[:-1] + 4.0 * middle[0] + north[1:]) / 6.0, east


def _corners(first: Waypoint, north: FloatArray, east: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Latitude and longitude of both ends of all legs [m] from `first` on, which `fly` takes back into these legs."""
    latitude = np.full(len(north) + 1, first.latitude)
    height = np.full_like(latitude, first.height)
    for _ in range(3):  # each gains two digits or more, as a radian of latitude is nearly the same everywhere
        scale = _scales(latitude, height)
        latitude = np.cumsum(np.insert(north / scale[0], 0, first.latitude))
    return latitude, np.cumsum(np.insert(east / scale[1], 0, first.longitude))


def named(number: int, point: Waypoint) -> str:
    """Name of a waypoint in messages, counted from 1."""
    return f"waypoint {number}" + (f" ({point.line})" if point.line else "")
