"""A flight from a plan: waypoints, lines between some of them, speed and bank; turns are coordinated.

The flight passes each waypoint on the inside: it begins to turn before it, so that it leaves on the next leg. It ends
up as samples of a `TrajectorySpec`, which the simulator and the covariance fly alike.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from nav_model.base.constants import DEGREE
from nav_model.base.errors import InputError
from nav_model.simulation.specification import TrajectorySpec
from nav_model.simulation.trajectory import (
    coordinated,
    flight_through,
    lay_on_earth,
    rise_and_fall,
    smooth_step,
)
from nav_model.trajectory.specification import FlightLine
from nav_model.trajectory.turns import LARGEST_PART, Turn, turn_by, way_between
from nav_model.trajectory.waypoints import (
    TIME_TO_ROLL,
    Plan,
    Waypoint,
    legs_between,
    named,
    places_along,
    time_to_change,
)

FloatArray = NDArray[np.float64]
_RUN_IN = 15.0  # s straight before a line
_STEP = 0.5  # s between samples
_NEAREST = 1.0  # m between waypoints
_APART = 0.5  # s between the turns of a manoeuvre
_LARGEST_TURN = math.radians(170.0)
_LONGEST = 100 * 3600.0  # s


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
            raise InputError("waypoints", f"{named(number, point)} is not above the ground: {point.height:g} m")
    if max(abs(point.latitude) for point in points) > math.radians(84.9):
        raise InputError("waypoints", "must stay within 85° of the equator")
    for number, leg in enumerate(np.abs(legs_between(points)), 1):
        if leg < _NEAREST:
            reason = f"{named(number, points[number - 1])} and the next are at one place; remove one"
            raise InputError("waypoints", reason)
    points, numbers = _with_turns(plan)
    plan, legs = replace(plan, waypoints=points), legs_between(points)
    heading = np.unwrap(np.angle(legs))
    turns = [Turn()]
    for at, angle in enumerate(np.diff(heading).tolist(), 1):
        if abs(angle) > _LARGEST_TURN:
            reason = f"{named(numbers[at], points[at])} needs a 180° turn. Add a waypoint to one side"
            raise InputError("waypoints", reason)
        turns.append(turn_by(angle, _speed_at(plan, at), plan.bank))
    turns.append(turns[0])
    return _flown(plan, numbers, heading, np.abs(legs), turns)


def before_line(
    plan: Plan, number: int, arcs: Sequence[float] = (), run_in: float = _RUN_IN, faster: float = 1.0
) -> Plan:
    """The plan with turns in front of a line, all at its speed.

    The way to the first turn is the shortest, and what comes before stays whole.

    Parameters
    ----------
    plan : Plan
        Waypoints.
    number : int
        Waypoint at which the line begins, counted from 0.
    arcs : sequence of float, optional
        Of the turns [rad, to the right], which begin and end in the line's direction.
    run_in : float, optional
        From the last turn to the line, s.
    faster : float, optional
        Factor on the speed of the run-in: up and back to the line's speed.

    Raises
    ------
    InputError
        Where no way leads there.
    """
    points, speed = plan.waypoints, plan.speed_from(number)
    here = replace(points[number], line="")
    leg = complex(legs_between(points[number : number + 2])[0])
    ahead = direction = leg / abs(leg)
    legs, length = [], _APART * speed
    for arc in arcs:
        parts = math.ceil(abs(arc) / LARGEST_PART)
        room = turn_by(arc / parts, speed, plan.bank).before
        for _ in range(parts):
            legs.append((length + room) * direction)
            direction, length = direction * complex(np.exp(1j * arc / parts)), room + _APART * speed
    if faster != 1.0:
        legs.append(length * ahead)
        length = plan.room(speed, faster * speed, speed)
    legs.append((length + run_in * faster * speed) * ahead)
    *turns, last = places_along(here, [-leg for leg in reversed(legs)])[:0:-1]
    turns.append(last if faster == 1.0 else replace(last, speed=faster * speed))
    earlier = [*points[:number]]
    if not earlier:
        return replace(plan, waypoints=(*turns, *points))
    if earlier[-1].line:  # it ends where the other begins
        earlier.append(here)
    earlier[-1] = replace(earlier[-1], speed=here.speed)
    came = complex(legs_between((*earlier, turns[0])[-3:])[0])  # the last leg, if there is one
    before = plan.speed_from(max(len(earlier) - 2, 0))
    way = way_between(plan, (earlier[-1], came / abs(came)), (turns[0], ahead), before)
    return replace(plan, waypoints=(*earlier, *way, *turns, *points[number:]))


def in_parts(plan: Plan, number: int, parts: int, overlap: float) -> Plan:
    """The plan with a line in parts of its name: the flight turns off between them and comes back.

    Parameters
    ----------
    plan : Plan
        Waypoints.
    number : int
        Waypoint at which the line begins, counted from 0.
    parts : int
        Number of parts, of one length.
    overlap : float
        By which each but the first is longer at the front, s.

    Raises
    ------
    InputError
        Where the line is too short.
    """
    first, last = plan.waypoints[number : number + 2]
    overlap *= plan.speed_from(number)
    leg = complex(legs_between((first, last))[0])
    ahead, part = leg / abs(leg), (abs(leg) - overlap) / parts + overlap
    if part <= 2.0 * overlap:
        raise InputError("waypoints", f"{named(number + 1, first)} is too short for {parts} parts")
    steps = np.tile([part, -overlap], parts)[: 2 * parts - 2]
    along = np.cumsum(steps) / abs(leg)
    places = places_along(first, [step * ahead for step in steps])[1:]
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
    points, legs = plan.waypoints, legs_between(plan.waypoints)
    ahead = legs / np.abs(legs)
    route: list[tuple[Waypoint, int]] = []
    replaced = -1  # the last leg in place of which there is another way
    for n, point in enumerate(points):
        place = point
        if point.line and n < len(legs) and (not n or not points[n - 1].line):
            speed = plan.speed_from(n)
            run_in = _RUN_IN * speed + plan.room(plan.speed_from(max(n - 1, 0)), speed)
            place = replace(places_along(point, [-run_in * ahead[n]])[1], line="")
        if 1 < n < len(legs) and not points[n - 1].line and replaced != n - 2:
            lines = points[n - 2].line and point.line
            if lines or _needed(plan, legs, n - 1) > abs(legs[n - 1]):
                begin, before = (points[n - 1], ahead[n - 2]), plan.speed_from(n - 2)
                between = way_between(plan, begin, (place, ahead[n]), before)
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


def _needed(plan: Plan, legs: NDArray[np.complex128], number: int) -> float:
    """Length that the turns at both ends of a leg need [m]."""
    angles = np.angle(legs[number : number + 2] / legs[number - 1 : number + 1])
    if np.abs(angles).max() > _LARGEST_TURN:
        return math.inf
    return sum(
        turn_by(float(angle), _speed_at(plan, at), plan.bank).before for at, angle in enumerate(angles, number)
    )


def _flown(
    plan: Plan, numbers: Sequence[int], heading: FloatArray, legs: FloatArray, turns: Sequence[Turn]
) -> PlannedFlight:
    """The flight of legs [m] with their headings [rad], and the turns at the ends of each; the outer two are none."""
    before, time = np.array([(turn.before, turn.time) for turn in turns]).T
    needed = before[:-1] + before[1:]
    # On the straight part a leg changes from the speed of the turn before it to its own, and then to the next turn's.
    cruise = np.array([plan.speed_from(n) for n in range(len(legs))])
    passing = np.array([_speed_at(plan, n) for n in range(len(legs) + 1)])
    early, late = (
        time_to_change(passing[:-1], cruise, plan.acceleration),
        time_to_change(cruise, passing[1:], plan.acceleration),
    )
    changing = 0.5 * ((passing[:-1] + cruise) * early + (cruise + passing[1:]) * late)
    steady = (legs - needed - changing) / cruise
    straight = early + steady + late
    stops = np.cumsum(straight + time[:-1])
    starts, ramps = stops - straight, np.minimum(6.0, straight / 3.0)
    rises = np.diff([point.height for point in plan.waypoints])
    for n, point in enumerate(plan.waypoints[:-1]):
        problem, steepest = f"the leg from {named(numbers[n], point)}", min(plan.climb_rate, cruise[n])
        if steady[n] < 0.0:
            problem += f" is {legs[n]:.0f} m long, and its turns need {needed[n]:.0f} m"
            advice = "; remove its name to let the turn swing out" if point.line else ""
            change = f", its change of speed {changing[n]:.0f} m" if changing[n] else ""
            raise InputError("waypoints", f"{problem} at a bank of {math.degrees(plan.bank):.3g}°{change}{advice}")
        if abs(rises[n]) > steepest * (straight[n] - ramps[n]):
            problem += f" has {straight[n]:.0f} s for {rises[n]:+.0f} m"
            raise InputError("waypoints", f"{problem}, at most {steepest:g} m/s")
    duration = float(stops[-1])
    if duration > _LONGEST:
        raise InputError("plan", f"the flight takes {duration / 3600.0:.0f} h; at most {_LONGEST / 3600.0:.0f} h")
    t = np.linspace(0.0, duration, max(math.ceil(duration / _STEP), 8) + 1)
    rate, climb, speed = np.zeros_like(t), np.zeros_like(t), np.full_like(t, passing[0])

    def during(begin: float, length: float) -> slice:
        """Samples of a part of the flight: a long plan has too many parts for each to go over the whole flight."""
        return slice(*np.searchsorted(t, (begin, begin + length)))

    for begin, turn in zip(stops, turns[1:], strict=True):
        if turn.angle:
            part = during(begin, turn.plateau + TIME_TO_ROLL)
            rate[part] += rise_and_fall(t[part] - begin, turn.plateau, TIME_TO_ROLL) * turn.angle / turn.plateau
    for start, time_of_leg, rise, ramp in zip(starts, straight, rises, ramps, strict=True):
        if rise:
            part, plateau = during(start, time_of_leg), time_of_leg - ramp
            climb[part] += rise_and_fall(t[part] - start, plateau, ramp) * rise / plateau
    for begin, length, by in (
        *zip(starts, early, cruise - passing[:-1], strict=True),
        *zip(stops - late, late, passing[1:] - cruise, strict=True),
    ):
        if by:
            part = during(begin, length)
            speed[part] += by * smooth_step((t[part] - begin) / length)
            speed[part.stop :] += by
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
