"""A flight from a plan: waypoints, lines between some of them, speed and bank; turns are coordinated.

The flight passes each waypoint on the inside: it begins to turn before it, so that it leaves on the next leg. It ends
up as samples of a `TrajectorySpec`, which the simulator and the covariance fly alike.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from nav_model.base.constants import DEGREE, STANDARD_GRAVITY
from nav_model.base.errors import InputError
from nav_model.earth.wgs84 import metres_per_radian
from nav_model.simulation.specification import TrajectorySpec
from nav_model.simulation.trajectory import (
    coordinated,
    cumulative,
    flight_through,
    lay_on_earth,
    rise_and_fall,
    smooth_step,
)
from nav_model.trajectory.specification import FlightLine

FloatArray = NDArray[np.float64]
_ENTRY = 3.0  # s to roll in and out
_RUN_IN = 15.0  # s straight before a line
_STRAIGHT = 1e-5  # rad: 10 cm over 10 km
_LARGEST_PART = math.radians(120.0)  # of a turn at one corner
_STEP = 0.5  # s between samples
_NEAREST = 1.0  # m between waypoints
_WIDER = (1.1, 1.2, 1.4, 1.7, 2.0, 3.0)  # circles of a turn that is rolled in and out, of those at its bank
_APART = 0.5  # s between the turns of a manoeuvre
_LARGEST_TURN = math.radians(170.0)
_LONGEST = 100 * 3600.0  # s
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
        """How far it takes to fly one speed after the other [m]."""
        return sum(0.5 * (u + v) * float(_change(u, v, self.acceleration)) for u, v in pairwise(speeds))


@dataclass(frozen=True)
class PlannedFlight:
    """The flight of a plan, how long it takes [s], and its lines: each from the end of one turn to the next. note:
    what was read of a file."""

    trajectory: TrajectorySpec
    duration: float
    lines: tuple[FlightLine, ...]
    note: str = ""

    def banked(self, beyond: float) -> float:
        """Time beyond a bank [s]."""
        samples = np.frombuffer(self.trajectory.samples).reshape(-1, 7)
        return self.duration * float(np.mean(np.abs(samples[:, 4]) > beyond))


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
    first, or to the left for a negative spacing. `fly` makes their turns."""
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
    points, legs = plan.waypoints, _legs(plan.waypoints)
    leg = [n for n, point in enumerate(points[:-1]) if point.line][number]
    legs[leg] *= 1.0 + by * plan.speed_from(leg) / abs(legs[leg])
    places = zip(points, _places(points[0], legs.tolist()), strict=True)
    moved = (replace(point, latitude=place.latitude, longitude=place.longitude) for point, place in places)
    return replace(plan, waypoints=tuple(moved))


def fly(plan: Plan) -> PlannedFlight:
    """The flight of a plan.

    A line is flown at its speed from end to end: the flight changes to it before the line, and after the line to the
    next one, on the straight part of a leg; where two lines meet, on the second.

    Raises InputError naming the waypoint: two at one place, a leg that is too short for its turns at this bank and
    its changes of speed, or too steep, a turn back on the spot, a place below the ground or beyond the latitudes that
    can be flown.
    """
    points = plan.waypoints
    if len(points) < 2:
        raise InputError("waypoints", "a flight needs two waypoints or more")
    speeds = [plan.speed_from(number) for number in range(len(points))]
    steady = min(plan.climb_rate, plan.acceleration) > 0.0
    if not (min(speeds) >= 1.0 and max(speeds) <= 3000.0 and 0.0 < plan.bank <= 80 * DEGREE and steady):
        reason = "needs speeds from 1 to 3000 m/s, a bank of at most 80°, climb rate and acceleration above zero"
        raise InputError("plan", reason)
    for number, point in enumerate(points, 1):
        if not point.height > plan.ground:
            raise InputError("waypoints", f"{_named(number, point)} is not above the ground: {point.height:g} m")
    if max(abs(point.latitude) for point in points) > math.radians(84.9):
        raise InputError("waypoints", "must stay within 85° of the equator")
    for number, leg in enumerate(np.abs(_legs(points)), 1):
        if leg < _NEAREST:
            reason = f"{_named(number, points[number - 1])} and the next are at one place; remove one"
            raise InputError("waypoints", reason)
    points, numbers = _with_turns(plan)
    plan, legs = replace(plan, waypoints=points), _legs(points)
    heading = np.unwrap(np.angle(legs))
    turns = [_Turn()]
    for at, angle in enumerate(np.diff(heading).tolist(), 1):
        if abs(angle) > _LARGEST_TURN:
            reason = f"{_named(numbers[at], points[at])} needs a 180° turn. Add a waypoint to one side"
            raise InputError("waypoints", reason)
        turns.append(_turn(angle, _speed_at(plan, at), plan.bank))
    turns.append(turns[0])
    return _flown(plan, numbers, heading, np.abs(legs), turns)


def before_line(
    plan: Plan, number: int, arcs: Sequence[float] = (), run_in: float = _RUN_IN, faster: float = 1.0
) -> Plan:
    """The plan with turns in front of the line that begins at waypoint `number`, counted from 0, all at its speed.

    arcs: of the turns [rad, to the right], which begin and end in the line's direction; run_in: from the last to the
    line [s], `faster` than it by this factor: up and back to its speed. The way to the first turn is the shortest,
    and what comes before stays whole. Raises InputError where no way leads there.
    """
    points, speed = plan.waypoints, plan.speed_from(number)
    here = replace(points[number], line="")
    leg = complex(_legs(points[number : number + 2])[0])
    ahead = direction = leg / abs(leg)
    legs, length = [], _APART * speed
    for arc in arcs:
        parts = math.ceil(abs(arc) / _LARGEST_PART)
        room = _turn(arc / parts, speed, plan.bank).before
        for _ in range(parts):
            legs.append((length + room) * direction)
            direction, length = direction * complex(np.exp(1j * arc / parts)), room + _APART * speed
    if faster != 1.0:
        legs.append(length * ahead)
        length = plan.room(speed, faster * speed, speed)
    legs.append((length + run_in * faster * speed) * ahead)
    *turns, last = _places(here, [-leg for leg in reversed(legs)])[:0:-1]
    turns.append(last if faster == 1.0 else replace(last, speed=faster * speed))
    earlier = [*points[:number]]
    if not earlier:
        return replace(plan, waypoints=(*turns, *points))
    if earlier[-1].line:  # it ends where the other begins
        earlier.append(here)
    earlier[-1] = replace(earlier[-1], speed=here.speed)
    came = complex(_legs((*earlier, turns[0])[-3:])[0])  # the last leg, if there is one
    before = plan.speed_from(max(len(earlier) - 2, 0))
    way = _connection(plan, (earlier[-1], came / abs(came)), (turns[0], ahead), before)
    return replace(plan, waypoints=(*earlier, *way, *turns, *points[number:]))


def in_parts(plan: Plan, number: int, parts: int, overlap: float) -> Plan:
    """The plan with the line that begins at waypoint `number`, counted from 0, in `parts` of one length and of its
    name, each `overlap` [s] longer at the front than the rest: the flight turns off between them and comes back.

    Raises InputError where the line is too short.
    """
    first, last = plan.waypoints[number : number + 2]
    overlap *= plan.speed_from(number)
    leg = complex(_legs((first, last))[0])
    ahead, part = leg / abs(leg), (abs(leg) - overlap) / parts + overlap
    if part <= 2.0 * overlap:
        raise InputError("waypoints", f"{_named(number + 1, first)} is too short for {parts} parts")
    steps = np.tile([part, -overlap], parts)[: 2 * parts - 2]
    along = np.cumsum(steps) / abs(leg)
    places = _places(first, [step * ahead for step in steps])[1:]
    between = (
        replace(place, height=first.height + share * (last.height - first.height), line=first.line if n % 2 else "")
        for n, (place, share) in enumerate(zip(places, along.tolist(), strict=True))
    )
    points = plan.waypoints
    return replace(plan, waypoints=(*points[: number + 1], *between, *points[number + 1 :]))


def _with_turns(plan: Plan) -> tuple[tuple[Waypoint, ...], tuple[int, ...]]:
    """The waypoints with those of the turns between lines and of the run-ins, and of each the number of the waypoint
    of the plan that it is or follows.

    A line that follows another is flown whole, with a run-in. Elsewhere the flight keeps to the legs and turns at
    each waypoint on the inside, unless a leg that is no line has no room for its turns.
    """
    points, legs = plan.waypoints, _legs(plan.waypoints)
    ahead = legs / np.abs(legs)
    route: list[tuple[Waypoint, int]] = []
    replaced = -1  # the last leg in place of which there is another way
    for n, point in enumerate(points):
        place = point
        if point.line and n < len(legs) and (not n or not points[n - 1].line):
            speed = plan.speed_from(n)
            run_in = _RUN_IN * speed + plan.room(plan.speed_from(max(n - 1, 0)), speed)
            place = replace(_places(point, [-run_in * ahead[n]])[1], line="")
        if 1 < n < len(legs) and not points[n - 1].line and replaced != n - 2:
            lines = points[n - 2].line and point.line
            if lines or _needed(plan, legs, n - 1) > abs(legs[n - 1]):
                begin, before = (points[n - 1], ahead[n - 2]), plan.speed_from(n - 2)
                between = _connection(plan, begin, (place, ahead[n]), before)
                route += [(corner, n) for corner in between]
                replaced = n - 1
        if place is not point and (not n or replaced == n - 1):
            route.append((place, n or 1))
        route.append((point, n + 1))
    return tuple(point for point, _ in route), tuple(number for _, number in route)


def _speed_at(plan: Plan, number: int) -> float:
    """Ground speed at which the flight passes a waypoint, counted from 0 [m/s]: that of a line which begins there,
    else of the leg which ends there."""
    last = len(plan.waypoints) - 1
    begins = not number or (number < last and plan.waypoints[number].line and not plan.waypoints[number - 1].line)
    return plan.speed_from(number if begins else number - 1)


def _change(before: FloatArray | float, after: FloatArray | float, most: float) -> FloatArray:
    """Time to change from one speed to another [s], accelerating with `most` [m/s²] in its middle."""
    by = np.abs(np.subtract(after, before))
    return np.where(by > 0.0, np.maximum(_STEEPEST * by / most, _ENTRY), 0.0)


def _needed(plan: Plan, legs: NDArray[np.complex128], number: int) -> float:
    """Length that the turns at both ends of a leg need [m]."""
    angles = np.angle(legs[number : number + 2] / legs[number - 1 : number + 1])
    if np.abs(angles).max() > _LARGEST_TURN:
        return math.inf
    return sum(_turn(float(angle), _speed_at(plan, at), plan.bank).before for at, angle in enumerate(angles, number))


def _connection(
    plan: Plan, begin: tuple[Waypoint, complex], end: tuple[Waypoint, complex], before: float
) -> tuple[Waypoint, ...]:
    """Corners of the shortest way from one place and direction to another, by two turns or three (Dubins 1957).

    Where two right angles do not fit between two lines, it swings out to the other side first. The turns are rolled
    in and out, so they need more room than circles; a wider circle leaves it. before: speed with which it begins
    [m/s].
    """
    (first, ahead), (last, onward) = begin, end
    speed = first.speed or plan.speed
    room, lead = plan.room(before, speed), _ENTRY * speed  # for the roll of a small turn at either end
    radius = speed**2 / (STANDARD_GRAVITY * math.tan(plan.bank))
    first = _places(first, [room * ahead])[1] if room else first
    across = complex(_legs((first, last))[0])

    def ways(across: complex, wider: float) -> list[list[complex]]:
        """The corners' legs of every kind of way; none where it does not exist."""
        kinds = _dubins(across - lead * (ahead + onward), ahead, onward, wider * radius)
        return [_corner_legs(arcs, straight, wider * radius, ahead, lead) if arcs else [] for arcs, straight in kinds]

    def straights(legs: list[complex]) -> FloatArray:
        """What the turns leave of each leg [m]."""
        angles = np.angle(np.array(legs[1:]) / np.array(legs[:-1]))
        turns = (_turn(float(angle), speed, plan.bank) for angle in angles)
        before = np.array([0.0, *(turn.before for turn in turns), 0.0])
        return np.array(np.abs(legs) - before[:-1] - before[1:])

    known = [(wider, kind, legs) for wider in _WIDER for kind, legs in enumerate(ways(across, wider)) if legs]
    known.sort(key=lambda way: sum(map(abs, way[2])))
    best = next(((wider, kind) for wider, kind, legs in known if straights(legs).min() >= 0.0), None)
    if best is None:
        raise InputError("waypoints", "no turn leads from one line to the next")
    for _ in range(4):  # the legs lead over other latitudes than the straight way, where degrees have other lengths
        legs = ways(across, best[0])[best[1]]
        places = _places(first, legs)
        across += complex(_legs((places[-1], last))[0])
    length = np.cumsum(np.maximum(straights(legs), 0.0))
    heights = first.height + (last.height - first.height) * length / length[-1]
    return tuple(replace(place, height=float(up)) for place, up in zip(places[1:-1], heights, strict=False))


def _dubins(way: complex, ahead: complex, onward: complex, radius: float) -> list[tuple[list[float], float]]:
    """The six kinds of ways of circles and straight lines from a place and direction to another: their arcs [rad, to
    the right], and the straight part after the first [m]. No arcs: there is no such way.

    Places and directions are complex: metres north, and east as the imaginary part.
    """

    def arc(sense: int, start: complex, stop: complex) -> float:
        return sense * (float(np.angle(stop / start)) * sense % math.tau)

    ways: list[tuple[list[float], float]] = []
    for first, second in ((1, 1), (-1, -1), (1, -1), (-1, 1)):
        # From the centre of the first circle to that of the second.
        centres = way + 1j * radius * (second * onward - first * ahead)
        crossing = radius * (first - second)
        straight = math.sqrt(max(abs(centres) ** 2 - crossing**2, 0.0))
        if abs(centres) <= abs(crossing):
            ways.append(([], 0.0))
            continue
        tangent = (
            centres / abs(centres) * complex(straight, crossing) / abs(centres)
            if crossing
            else centres / abs(centres)
        )
        ways.append(([arc(first, ahead, tangent), arc(second, tangent, onward)], straight))
    for sense in (1, -1):
        centres = way + 1j * radius * sense * (onward - ahead)
        if not 0.0 < abs(centres) < 4.0 * radius:
            ways.append(([], 0.0))
            continue
        # The middle circle touches both, on the side where it is passed the longer way round.
        up = math.sqrt(4.0 * radius**2 - abs(centres) ** 2 / 4.0)
        middle = centres / 2.0 + 1j * sense * up * centres / abs(centres)
        there, back = 1j * sense * middle, 1j * sense * (middle - centres)
        ways.append(([arc(sense, ahead, there), arc(-sense, there, back), arc(sense, back, onward)], 0.0))
    return ways


def _corner_legs(arcs: Sequence[float], straight: float, radius: float, ahead: complex, lead: float) -> list[complex]:
    """The legs whose corners' turns are these arcs, `straight` [m] between the first two and `lead` at either end."""
    legs, length = [], lead
    for n, arc in enumerate(arcs):
        parts = max(math.ceil(abs(arc) / _LARGEST_PART), 1)
        if abs(arc) > _STRAIGHT:
            tangent = radius * math.tan(abs(arc) / parts / 2.0)
            for _ in range(parts):
                legs.append((length + tangent) * ahead)
                ahead, length = ahead * complex(np.exp(1j * arc / parts)), tangent
        length += straight if n == 0 else 0.0
    return [*legs, (length + lead) * ahead]


def _flown(
    plan: Plan, numbers: Sequence[int], heading: FloatArray, legs: FloatArray, turns: Sequence[_Turn]
) -> PlannedFlight:
    """The flight of legs [m] with their headings [rad], and the turns at the ends of each; the outer two are none."""
    before, time = np.array([(turn.before, turn.time) for turn in turns]).T
    needed = before[:-1] + before[1:]
    # On the straight part a leg changes from the speed of the turn before it to its own, and then to the next turn's.
    cruise = np.array([plan.speed_from(n) for n in range(len(legs))])
    passing = np.array([_speed_at(plan, n) for n in range(len(legs) + 1)])
    early, late = _change(passing[:-1], cruise, plan.acceleration), _change(cruise, passing[1:], plan.acceleration)
    changing = 0.5 * ((passing[:-1] + cruise) * early + (cruise + passing[1:]) * late)
    steady = (legs - needed - changing) / cruise
    straight = early + steady + late
    stops = np.cumsum(straight + time[:-1])
    starts, ramps = stops - straight, np.minimum(6.0, straight / 3.0)
    rises = np.diff([point.height for point in plan.waypoints])
    for n, point in enumerate(plan.waypoints[:-1]):
        problem, steepest = f"the leg from {_named(numbers[n], point)}", min(plan.climb_rate, cruise[n])
        if steady[n] < 0.0:
            problem += f" is {legs[n]:.0f} m long, and its turns need {needed[n]:.0f} m"
            named = "; remove its name to let the turn swing out" if point.line else ""
            change = f", its change of speed {changing[n]:.0f} m" if changing[n] else ""
            raise InputError("waypoints", f"{problem} at a bank of {math.degrees(plan.bank):.3g}°{change}{named}")
        if abs(rises[n]) > steepest * (straight[n] - ramps[n]):
            problem += f" has {straight[n]:.0f} s for {rises[n]:+.0f} m"
            raise InputError("waypoints", f"{problem}, at most {steepest:g} m/s")
    duration = float(stops[-1])
    if duration > _LONGEST:
        raise InputError("plan", f"the flight takes {duration / 3600.0:.0f} h; at most {_LONGEST / 3600.0:.0f} h")
    t = np.linspace(0.0, duration, max(math.ceil(duration / _STEP), 8) + 1)
    rate, climb, speed = np.zeros_like(t), np.zeros_like(t), np.full_like(t, passing[0])
    for begin, turn in zip(stops, turns[1:], strict=True):
        if turn.angle:
            rate += rise_and_fall(t - begin, turn.plateau, _ENTRY) * turn.angle / turn.plateau
    for start, time_of_leg, rise, ramp in zip(starts, straight, rises, ramps, strict=True):
        if rise:
            climb += rise_and_fall(t - start, time_of_leg - ramp, ramp) * rise / (time_of_leg - ramp)
    for begin, length, by in (
        *zip(starts, early, cruise - passing[:-1], strict=True),
        *zip(stops - late, late, passing[1:] - cruise, strict=True),
    ):
        if by:
            speed += by * smooth_step((t - begin) / length)
    course, ground, height, roll, pitch = coordinated(t, np.hypot(speed, climb), float(heading[0]), rate, climb)
    first, north, east = plan.waypoints[0], ground * np.cos(course), ground * np.sin(course)
    height += first.height
    place = lay_on_earth((first.latitude, first.longitude), t, north, east, height)
    samples = np.column_stack([t, *place, height, roll, pitch, course])
    lines = tuple(
        FlightLine(point.line, start, stop)
        for point, start, stop in zip(plan.waypoints[:-1], starts.tolist(), stops.tolist(), strict=True)
        if point.line and stop > start
    )
    return PlannedFlight(flight_through(samples, list(range(len(t))), "plan"), duration, lines)


@lru_cache(maxsize=1024)
def _turn(angle: float, speed: float, bank: float) -> _Turn:
    """The coordinated turn by this angle: rolled in and out in `_ENTRY`, at the bank between."""
    if abs(angle) < _STRAIGHT:
        return _Turn()
    plateau = max(abs(angle) * speed / (STANDARD_GRAVITY * math.tan(bank)), _ENTRY)
    time = plateau + _ENTRY
    t = np.linspace(0.0, time, 401)
    course = cumulative(rise_and_fall(t, plateau, _ENTRY) * angle / plateau, float(t[1]))
    chord = math.hypot(*(speed * float(np.trapezoid(wave(course), t)) for wave in (np.cos, np.sin)))
    return _Turn(angle, plateau, time, chord / (2.0 * math.cos(0.5 * angle)))


def _legs(points: Sequence[Waypoint]) -> NDArray[np.complex128]:
    """The legs between waypoints [m]: north, and east as the imaginary part."""
    latitude, longitude, height = np.array([(point.latitude, point.longitude, point.height) for point in points]).T
    scale = _scales(latitude, height)
    legs: NDArray[np.complex128] = np.diff(latitude) * scale[0] + 1j * np.diff(np.unwrap(longitude)) * scale[1]
    return legs


def _places(first: Waypoint, legs: Sequence[complex]) -> list[Waypoint]:
    """The places from `first` on, at its height, which `_legs` takes back into these legs."""
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


def _named(number: int, point: Waypoint) -> str:
    return f"waypoint {number}" + (f" ({point.line})" if point.line else "")
