"""A flight from a plan: waypoints, lines between some of them, speed and bank; turns are coordinated.

The flight passes each waypoint on the inside: it begins to turn before it, so that it leaves on the next leg. It ends
up as samples of a `TrajectorySpec`, which the simulator and the covariance fly alike.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from nav_model.base.constants import DEGREE, STANDARD_GRAVITY
from nav_model.base.errors import InputError
from nav_model.earth.wgs84 import metres_per_radian
from nav_model.simulation.specification import TrajectorySpec
from nav_model.simulation.trajectory import coordinated, cumulative, flight_through, lay_on_earth, rise_and_fall
from nav_model.trajectory.specification import Line

FloatArray = NDArray[np.float64]
_ENTRY = 3.0  # s to roll in and out
_STEP = 0.5  # s between samples
_NEAREST = 1.0  # m between waypoints
_LARGEST_TURN = math.radians(170.0)
_LONGEST = 100 * 3600.0  # s


@dataclass(frozen=True)
class Waypoint:
    """A place of a plan: latitude, longitude [rad], height above the ellipsoid [m]. line: name of the line that
    begins here and ends at the next waypoint; empty where none does."""

    latitude: float
    longitude: float
    height: float
    line: str = ""


@dataclass(frozen=True)
class Plan:
    """Waypoints in their order, ground speed [m/s], bank of turns [rad], fastest climb and descent [m/s], and the
    height of the ground [m]."""

    waypoints: tuple[Waypoint, ...]
    speed: float
    bank: float = 25 * DEGREE
    climb_rate: float = 5.0
    ground: float = 0.0


@dataclass(frozen=True)
class PlannedFlight:
    """The flight of a plan, how long it takes [s], and its lines: each from the end of one turn to the next. note:
    what was read of a file."""

    trajectory: TrajectorySpec
    duration: float
    lines: tuple[Line, ...]
    note: str = ""


@dataclass(frozen=True)
class _Turn:
    """A turn by `angle` [rad, to the right]: time from entry to exit [s], and how far before its waypoint it begins
    [m]."""

    angle: float = 0.0
    plateau: float = 0.0
    time: float = 0.0
    before: float = 0.0


def strip(like: Plan, first: Waypoint, heading: float, length: float, spacing: float, count: int) -> Plan:
    """Parallel lines, flown to and fro as `like`: `count` of them, `length` and `spacing` [m], to the right of the
    first.

    They lie to the left for a negative spacing. Before and after each there is a run-in as long as a turn needs.
    Where two turns of a right angle do not fit between two lines, the flight swings out to the other side first.
    """
    if count < 1 or not length > 0.0 or (count > 1 and not abs(spacing) > 0.0):
        raise InputError("lines", f"{count} lines of {length:g} m, {spacing:g} m apart, cannot be laid out")
    corner = 1.01 * _turn(math.pi / 2, like.speed, like.bank).before
    places: list[tuple[float, float, str]] = []  # along, to the right, line that begins
    for n in range(count):
        side, ends = n * spacing, (-corner, length + corner)
        near, far = ends if n % 2 == 0 else ends[::-1]
        if n and abs(spacing) < 2.0 * corner:
            out = side - spacing - math.copysign(2.0 * corner, spacing)
            beyond = near + math.copysign(2.0 * corner, near - far)
            places += [(near, side - spacing, ""), (near, out, ""), (beyond, out, ""), (beyond, side, "")]
        elif n:
            places += [(near, side - spacing, ""), (near, side, "")]
        places += [(0.0 if near < far else length, side, f"line {n + 1}"), (length if near < far else 0.0, side, "")]
    along, right = np.diff([place[:2] for place in places], axis=0).T
    c, s = math.cos(heading), math.sin(heading)
    corners = zip(*_corners(first, c * along - s * right, s * along + c * right), places, strict=True)
    points = (Waypoint(float(north), float(east), first.height, line) for north, east, (_, _, line) in corners)
    return replace(like, waypoints=tuple(points))


def fly(plan: Plan) -> PlannedFlight:
    """The flight of a plan.

    Raises InputError naming the waypoint: two at one place, a leg that is too short for its turns at this bank or too
    steep, a turn back on the spot, a place below the ground or beyond the latitudes that can be flown.
    """
    points = plan.waypoints
    if len(points) < 2:
        raise InputError("waypoints", "a flight needs two waypoints or more")
    if not (1.0 <= plan.speed <= 3000.0 and 0.0 < plan.bank <= 80 * DEGREE and plan.climb_rate > 0.0):
        said = "needs a speed from 1 to 3000 m/s, a bank of at most 80°, and a climb rate above zero"
        raise InputError("plan", said)
    for number, point in enumerate(points, 1):
        if not point.height > plan.ground:
            raise InputError("waypoints", f"{_named(number, point)} is not above the ground: {point.height:g} m")
    latitude, longitude, height = np.array([(point.latitude, point.longitude, point.height) for point in points]).T
    if np.abs(latitude).max() > math.radians(84.9):
        raise InputError("waypoints", "must stay within 85° of the equator")
    scale = _scales(latitude, height)
    north, east = np.diff(latitude) * scale[0], np.diff(np.unwrap(longitude)) * scale[1]
    legs = np.hypot(north, east)
    for number, leg in enumerate(legs, 1):
        if leg < _NEAREST:
            said = f"{_named(number, points[number - 1])} and the next are at one place; remove one"
            raise InputError("waypoints", said)
    heading = np.unwrap(np.arctan2(east, north))
    turns = [_Turn()]
    for number, angle in enumerate(np.diff(heading), 2):
        if abs(angle) > _LARGEST_TURN:
            said = f"at {_named(number, points[number - 1])} the flight turns back; add one beside it"
            raise InputError("waypoints", said)
        turns.append(_turn(float(angle), plan.speed, plan.bank))
    turns.append(turns[0])
    return _flown(plan, heading, legs, turns)


def _flown(plan: Plan, heading: FloatArray, legs: FloatArray, turns: Sequence[_Turn]) -> PlannedFlight:
    """The flight of legs [m] with their headings [rad], and the turns at the ends of each; the outer two are none."""
    before, time = np.array([(turn.before, turn.time) for turn in turns]).T
    needed = before[:-1] + before[1:]
    straight = (legs - needed) / plan.speed
    stops = np.cumsum(straight + time[:-1])
    starts, ramps = stops - straight, np.minimum(6.0, straight / 3.0)
    rises, steepest = np.diff([point.height for point in plan.waypoints]), min(plan.climb_rate, plan.speed)
    for n, point in enumerate(plan.waypoints[:-1]):
        said = f"the leg from {_named(n + 1, point)}"
        if straight[n] < 0.0:
            said += f" is {legs[n]:.0f} m long, and its turns need {needed[n]:.0f} m"
            raise InputError("waypoints", f"{said} at a bank of {math.degrees(plan.bank):.3g}°")
        if abs(rises[n]) > steepest * (straight[n] - ramps[n]):
            said += f" has {straight[n]:.0f} s for {rises[n]:+.0f} m"
            raise InputError("waypoints", f"{said}, at most {steepest:g} m/s")
    duration = float(stops[-1])
    if duration > _LONGEST:
        raise InputError("plan", f"the flight takes {duration / 3600.0:.0f} h; at most {_LONGEST / 3600.0:.0f} h")
    t = np.linspace(0.0, duration, max(math.ceil(duration / _STEP), 8) + 1)
    rate, climb = np.zeros_like(t), np.zeros_like(t)
    for begin, turn in zip(stops, turns[1:], strict=True):
        if turn.angle:
            rate += rise_and_fall(t - begin, turn.plateau, _ENTRY) * turn.angle / turn.plateau
    for start, time_of_leg, rise, ramp in zip(starts, straight, rises, ramps, strict=True):
        if rise:
            climb += rise_and_fall(t - start, time_of_leg - ramp, ramp) * rise / (time_of_leg - ramp)
    course, ground, height, roll, pitch = coordinated(t, np.hypot(plan.speed, climb), float(heading[0]), rate, climb)
    first, north, east = plan.waypoints[0], ground * np.cos(course), ground * np.sin(course)
    height += first.height
    place = lay_on_earth((first.latitude, first.longitude), t, north, east, height)
    samples = np.column_stack([t, *place, height, roll, pitch, course])
    lines = tuple(
        Line(point.line, start, stop)
        for point, start, stop in zip(plan.waypoints[:-1], starts.tolist(), stops.tolist(), strict=True)
        if point.line and stop > start
    )
    return PlannedFlight(flight_through(samples, list(range(len(t))), "plan"), duration, lines)


def _turn(angle: float, speed: float, bank: float) -> _Turn:
    """The coordinated turn by this angle: rolled in and out in `_ENTRY`, at the bank between."""
    if abs(angle) < 1e-9:
        return _Turn()
    plateau = max(abs(angle) * speed / (STANDARD_GRAVITY * math.tan(bank)), _ENTRY)
    time = plateau + _ENTRY
    t = np.linspace(0.0, time, 401)
    course = cumulative(rise_and_fall(t, plateau, _ENTRY) * angle / plateau, float(t[1]))
    chord = math.hypot(*(speed * float(np.trapezoid(wave(course), t)) for wave in (np.cos, np.sin)))
    return _Turn(angle, plateau, time, chord / (2.0 * math.cos(0.5 * angle)))


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


def _named(number: int, point: Waypoint) -> str:
    return f"waypoint {number}" + (f" ({point.line})" if point.line else "")
