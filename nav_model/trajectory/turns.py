"""Turns between the legs of a plan, and the shortest way from one line to another."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from nav_model.base.constants import STANDARD_GRAVITY
from nav_model.base.errors import InputError
from nav_model.simulation.trajectory import cumulative, rise_and_fall
from nav_model.trajectory.waypoints import TIME_TO_ROLL, Plan, Waypoint, legs_between, places_along

FloatArray = NDArray[np.float64]
LARGEST_PART = math.radians(120.0)  # of a turn at one corner
_STRAIGHT = 1e-5  # rad: 10 cm over 10 km
_WIDER = (1.1, 1.2, 1.4, 1.7, 2.0, 3.0)  # circles of a turn that is rolled in and out, of those at its bank


@dataclass(frozen=True)
class Turn:
    """A turn by `angle` [rad, to the right]: time from entry to exit [s], and how far before its waypoint it begins
    [m]."""

    angle: float = 0.0
    plateau: float = 0.0
    time: float = 0.0
    before: float = 0.0


@lru_cache(maxsize=1024)
def turn_by(angle: float, speed: float, bank: float) -> Turn:
    """The coordinated turn by an angle [rad, to the right] at a speed [m/s]: rolled in and out in `TIME_TO_ROLL`, at
    the bank [rad] between, or at less where it is too small for that."""
    if abs(angle) < _STRAIGHT:
        return Turn()
    plateau = max(abs(angle) * speed / (STANDARD_GRAVITY * math.tan(bank)), TIME_TO_ROLL)
    time = plateau + TIME_TO_ROLL
    t = np.linspace(0.0, time, 401)
    course = cumulative(rise_and_fall(t, plateau, TIME_TO_ROLL) * angle / plateau, float(t[1]))
    chord = math.hypot(*(speed * float(np.trapezoid(wave(course), t)) for wave in (np.cos, np.sin)))
    return Turn(angle, plateau, time, chord / (2.0 * math.cos(0.5 * angle)))


def way_between(
    plan: Plan, begin: tuple[Waypoint, complex], end: tuple[Waypoint, complex], before: float
) -> tuple[Waypoint, ...]:
    """Corners of the shortest way from one place and direction to another, by two turns or three (Dubins 1957).

    Where two right angles do not fit between two lines, it swings out to the other side first. The turns are rolled
    in and out, so they need more room than circles; a wider circle leaves it.

    Parameters
    ----------
    plan : Plan
        Its bank and accelerations.
    begin, end : pair
        Waypoint, and direction: complex, of length one, north, and east as the imaginary part.
    before : float
        Speed at the beginning, m/s.

    Raises
    ------
    InputError
        Where no such way leads there.
    """
    (first, ahead), (last, onward) = begin, end
    speed = first.speed or plan.speed
    room, lead = plan.room(before, speed), TIME_TO_ROLL * speed  # for the roll of a small turn at either end
    radius = speed**2 / (STANDARD_GRAVITY * math.tan(plan.bank))
    first = places_along(first, [room * ahead])[1] if room else first
    across = complex(legs_between((first, last))[0])

    def ways(across: complex, wider: float) -> list[list[complex]]:
        """The corners' legs of every kind of way; none where it does not exist."""
        kinds = dubins(across - lead * (ahead + onward), ahead, onward, wider * radius)
        return [_corner_legs(arcs, straight, wider * radius, ahead, lead) if arcs else [] for arcs, straight in kinds]

    def straights(legs: list[complex]) -> FloatArray:
        """Straight part that the turns leave of each leg [m]."""
        angles = np.angle(np.array(legs[1:]) / np.array(legs[:-1]))
        turns = (turn_by(float(angle), speed, plan.bank) for angle in angles)
        before = np.array([0.0, *(turn.before for turn in turns), 0.0])
        return np.array(np.abs(legs) - before[:-1] - before[1:])

    known = [(wider, kind, legs) for wider in _WIDER for kind, legs in enumerate(ways(across, wider)) if legs]
    known.sort(key=lambda way: sum(map(abs, way[2])))
    best = next(((wider, kind) for wider, kind, legs in known if straights(legs).min() >= 0.0), None)
    if best is None:
        raise InputError("waypoints", "no turn leads from one line to the next")
    for _ in range(4):  # the legs lead over other latitudes than the straight way, where degrees have other lengths
        legs = ways(across, best[0])[best[1]]
        places = places_along(first, legs)
        across += complex(legs_between((places[-1], last))[0])
    length = np.cumsum(np.maximum(straights(legs), 0.0))
    heights = first.height + (last.height - first.height) * length / length[-1]
    return tuple(replace(place, height=float(up)) for place, up in zip(places[1:-1], heights, strict=False))


def dubins(way: complex, ahead: complex, onward: complex, radius: float) -> list[tuple[list[float], float]]:
    """The six kinds of ways of circles and straight lines from a place and direction to another.

    Their arcs [rad, to the right], and the straight part after the first [m]. No arcs: there is no such way. Places
    and directions are complex: north, and east as the imaginary part.

    Parameters
    ----------
    way : complex
        From the first place to the second, m.
    ahead, onward : complex
        Directions at the two places.
    radius : float
        Of the circles, m.

    Source: L. E. Dubins, *American Journal of Mathematics* 79 (1957) 497.
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
        parts = max(math.ceil(abs(arc) / LARGEST_PART), 1)
        if abs(arc) > _STRAIGHT:
            tangent = radius * math.tan(abs(arc) / parts / 2.0)
            for _ in range(parts):
                legs.append((length + tangent) * ahead)
                ahead, length = ahead * complex(np.exp(1j * arc / parts)), tangent
        length += straight if n == 0 else 0.0
    return [*legs, (length + lead) * ahead]
