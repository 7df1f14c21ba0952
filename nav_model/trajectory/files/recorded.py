"""Flights from recorded places: smoothed by how noisy they are, attitude from coordinated turns, pauses cut."""

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice, pairwise
from typing import Any

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.constants import STANDARD_GRAVITY
from nav_model.earth.trajectory_file import check_samples
from nav_model.earth.wgs84 import metres_per_radian
from nav_model.simulation.specification import HIGHEST_LATITUDE
from nav_model.simulation.trajectory import FILE_BOUNDS, flight_through
from nav_model.trajectory.files.heights import Heights, counted
from nav_model.trajectory.files.jumps import without_jumps
from nav_model.trajectory.plan import PlannedFlight
from nav_model.trajectory.specification import FlightLine

_STEP = 0.5  # s between samples of the flight, where knots are not closer
_LONGEST = 100 * 3600.0  # s
_KNOT_EVERY = (2, 4, 8, 16, 32, 64)  # samples
_FEWEST_SMOOTHED = 16  # samples; a spline through fewer is not fitted but goes through them
_MOST_SEGMENTS = 500
_LARGEST = (1e13, 360.0, 1e4, 1e7)  # s, °, °, m; their squares and products are finite
_CLOSEST = 1 / 300  # s between places that are flown: the smoothing of attitude takes as many at a time as are closer
_PAUSE = 10.0  # median intervals, and seconds: a longer gap ends a segment
_GENTLE = 0.25 * STANDARD_GRAVITY  # across a pause
_SLOWEST = 1.0  # m/s with a course
_SETTLE = 1.0  # s, sigma of the smoothing of attitude
_FAST_ENOUGH = 0.2  # s between rows with an attitude that can be flown
_ATTITUDE = slice(4, 7)
USUAL_SHARE = 0.8
"""Of all rows, from which a kind of fix is the usual one, and others are pauses."""


@dataclass(frozen=True, eq=False)
class RecordedSegment:
    """Rows of time [s], latitude, longitude [°], height above the ellipsoid [m], and roll, pitch, yaw [°] where they
    were recorded: shape (n, 4) or (n, 7)."""

    name: str
    rows: Array


def as_flown(samples: Array, heights: Heights, noun: str, lines: tuple[FlightLine, ...] = ()) -> PlannedFlight:
    """The flight through recorded samples.

    Parameters
    ----------
    samples : array (n, 7)
        In the order of `COLUMNS` [s, rad, m].
    heights : Heights
        Sentences on how the file was read.
    noun : str
        Of one sample, in messages.
    lines : tuple of FlightLine, optional
        Lines of the flight.

    Raises
    ------
    InputError
        For what `check_samples` and `flight_through` refuse.
    """
    numbers = [*range(1, len(samples) + 1)]
    check_samples(samples, numbers, heights.file_name, FILE_BOUNDS, noun)
    flight = flight_through(samples, numbers, heights.file_name)
    return PlannedFlight(flight, float(samples[-1, 0]), lines)


def fly_recorded(segments: Sequence[RecordedSegment], heights: Heights) -> PlannedFlight:
    """The flight through recorded segments, each of which is a line.

    Raises InputError under the file's name: time that runs backwards, nothing that moves in time, and what
    `flight_through` refuses of a motion.
    """
    from scipy.ndimage import gaussian_filter1d

    if any((np.abs(part.rows[:, :4]) > _LARGEST).any() for part in segments):
        raise heights.refuse("has times or heights beyond those of any flight. Check the units of its columns.")
    pieces = [*islice((piece for part in segments for piece in _pieces(part, heights)), _MOST_SEGMENTS + 1)]
    if not pieces:
        raise heights.refuse("holds no two recorded places at different times")
    if len(pieces) > _MOST_SEGMENTS:
        raise heights.refuse(f"has more than {_MOST_SEGMENTS} segments, which are too many to be flown. Cut it.")
    if (north := max(float(np.abs(piece.rows[:, 1]).max()) for piece in pieces)) > math.degrees(HIGHEST_LATITUDE):
        raise heights.refuse(f"reaches {north:g}° of latitude; must stay within 85° of the equator")
    for piece, following in pairwise(pieces):
        if following.rows[0, 0] <= piece.rows[-1, 0]:
            raise heights.refuse(f"time runs backwards from {piece.name!r} to {following.name!r}")
    # All in metres about one place, where the noise of the three axes can be compared.
    latitude, height = math.radians(pieces[0].rows[0, 1]), pieces[0].rows[0, 3]
    north, east = metres_per_radian(latitude, height)
    scale = np.array([math.radians(north), math.radians(east), 1.0])
    origin = pieces[0].rows[0, 1:4]
    times, places, lines, cuts = [], [], list[FlightLine](), list[float]()
    count = Counter(piece.name for piece in pieces)
    curve: Any = None
    clock = before = 0.0
    for number, piece in enumerate(pieces, 1):
        name = piece.name if count[piece.name] == 1 else f"{piece.name} {number}"
        start, stop = piece.rows[[0, -1], 0].tolist()
        last, curve = curve, _smoothed(piece.rows[:, 0], (piece.rows[:, 1:4] - origin) * scale)
        bridge = None if last is None else _bridge(last, before, curve, start)
        way = float(bridge.x[-1]) if bridge else 0.0
        if clock + way + stop - start > _LONGEST:
            most = f"at most {_LONGEST / 3600.0:.0f} h"
            raise heights.refuse(f"is with {name!r} too long to be flown, {most}. Give it in parts.")
        if bridge:  # across the pause before it, in the time that a gentle flight needs
            cuts += [start - before - way] if start - before > way else []
            t = np.linspace(0.0, way, math.ceil(way / _STEP) + 1)[1:-1]
            times.append(clock + t)
            places.append(bridge(t))
            clock += way
        step = min(_STEP, 0.5 * float(np.diff(np.unique(curve.t)).min()))
        steps = max(math.ceil((stop - start) / step), 8)
        t = np.linspace(start, stop, min(steps, 2 * len(piece.rows) + math.ceil((stop - start) / _STEP)) + 1)
        times.append(clock + t - start)
        places.append(curve(t))
        lines.append(FlightLine(name, clock, clock + stop - start))
        clock, before = lines[-1].stop, stop
    time = np.concatenate(times)
    place = np.vstack(places) / scale + origin
    place[:, :2] = np.radians(place[:, :2])
    recorded = [piece.rows[:, _ATTITUDE] for piece in pieces if piece.rows.shape[1] > 4]
    stamps = pieces[0].rows[:, 0]
    if recorded and len(pieces) == 1 and float(np.median(np.diff(stamps))) <= _FAST_ENOUGH:
        roll, pitch, yaw = _smoothed(stamps, np.unwrap(np.radians(recorded[0]), axis=0))(time + stamps[0]).T
        heights.note("attitude as recorded")
    else:
        roll, pitch, yaw = _coordinated(time, place)
        step = float(np.median(np.diff(time)))
        roll, pitch, yaw = (gaussian_filter1d(angle, _SETTLE / step) for angle in (roll, pitch, yaw))
        heights.note("attitude from coordinated turns" + (", not as recorded" if recorded else ""))
    if cuts:
        heights.note(f"{counted(len(cuts), 'pause')} cut, {sum(cuts):.0f} s")
    return as_flown(np.column_stack([time, place, roll, pitch, yaw]), heights, "sample", tuple(lines))


def unrolled(time: Array, heights: Heights) -> Array:
    """Times [s] without the jump back at the end of a week or a day."""
    for length, name in ((604_800.0, "week"), (86_400.0, "day")):
        steps = np.diff(time)
        ends = (steps < 0.0) & (steps + length > 0.0) & (steps + length < 60.0)
        if ends.any():
            time = time + length * np.concatenate([[0], np.cumsum(ends)])
            heights.note(f"time goes on over the end of the {name}")
    return time


def _pieces(segment: RecordedSegment, heights: Heights) -> list[RecordedSegment]:
    """A segment without repeated times, cut at its pauses."""
    rows = segment.rows.copy()
    steps = np.diff(rows[:, 0])
    if (back := np.flatnonzero(steps < 0.0)).size:
        where = f"{segment.name or 'track'}, place {back[0] + 2}"
        raise heights.refuse(f"{where}: time runs backwards by {-steps[back[0]]:g} s")
    if again := int(np.sum(steps == 0.0)):
        heights.note(f"{counted(again, 'place')} left out, as their time is that of the one before")
        rows = rows[np.concatenate([[True], steps > 0.0])]
    count = len(rows)
    # One of each interval at most; of two on either side of its end the first: no three of these are as close.
    rows = rows[np.diff(np.floor((rows[:, 0] - rows[0, 0]) / _CLOSEST), prepend=-1.0) > 0.0] if count else rows
    rows = rows[np.diff(rows[:, 0], prepend=-np.inf) >= 0.5 * _CLOSEST]
    if count > len(rows):
        heights.note(f"{counted(count - len(rows), 'place')} left out that are closer than {1e3 * _CLOSEST:.1f} ms")
    if len(rows) < 2:
        return []
    rows[:, 2] = np.unwrap(rows[:, 2], period=360.0)
    steps = np.diff(rows[:, 0])
    ends = np.flatnonzero(steps > max(_PAUSE, _PAUSE * float(np.median(steps)))) + 1
    parts = [part for part in np.split(rows, ends) if len(part) > 1]
    parts = [without_jumps(part, segment.name or "the recording", heights) for part in parts]
    return [RecordedSegment(segment.name or "segment", part) for part in parts]


def _smoothed(time: Array, values: Array) -> Any:
    """The cubic spline whose knots are as close as the noise allows, by generalised cross-validation (Craven and
    Wahba 1979); through the values where they are few."""
    from scipy.interpolate import BSpline, make_interp_spline
    from scipy.sparse.linalg import spsolve

    if len(time) < _FEWEST_SMOOTHED:
        degree = 3 if len(time) > 2 else 1
        ends = ([(2, np.zeros(values.shape[1]))],) * 2 if degree == 3 else None
        return make_interp_spline(time, values, k=degree, bc_type=ends)
    fits = []
    for every in _KNOT_EVERY:
        inner = time[every : len(time) - every // 2 - 1 : every]
        if every > 2 and not len(inner):
            break
        knots = np.concatenate([[time[0]] * 4, inner, [time[-1]] * 4])
        # Normal equations are banded: the time grows with the samples alone, where make_lsq_spline's square does.
        design = BSpline.design_matrix(time, knots, 3)
        spline = BSpline(knots, spsolve((design.T @ design).tocsc(), design.T @ values), 3)
        free = len(time) - len(inner) - 4
        fits.append((len(time) * float(np.sum((spline(time) - values) ** 2)) / free**2, spline))
    return min(fits, key=lambda fit: fit[0])[1]


def _bridge(curve: Any, stop: float, following: Any, start: float) -> Any:
    """The cubic from the end of one segment to the start of the next: as short as is gentle, not longer than the
    pause."""
    from scipy.interpolate import CubicHermiteSpline

    places, speeds = (np.array([curve(stop, nu), following(start, nu)]) for nu in (0, 1))
    way, fastest, pause = np.linalg.norm(places[1] - places[0]), np.linalg.norm(speeds, axis=1).max(), start - stop
    time = min(pause, max(way / max(fastest, 1.0), 1.0))
    while True:
        bridge = CubicHermiteSpline([0.0, time], places, speeds)
        if time >= pause or np.linalg.norm(bridge([0.0, time], 2), axis=1).max() <= _GENTLE:
            return bridge
        time = min(1.1 * time, pause)


def _coordinated(time: Array, place: Array) -> tuple[Array, Array, Array]:
    """Roll, pitch and yaw [rad] of a path without slip; the course is kept where it is too slow to have one."""
    from scipy.interpolate import make_interp_spline

    rates = make_interp_spline(time, place, k=3).derivative()(time)
    north, east = metres_per_radian(place[:, 0], place[:, 2])
    velocity = np.column_stack([rates[:, 0] * north, rates[:, 1] * east])
    speed = np.linalg.norm(velocity, axis=1)
    moving = speed > _SLOWEST
    if not moving.any():
        return (np.zeros_like(time),) * 3
    course = np.unwrap(np.arctan2(velocity[moving, 1], velocity[moving, 0]))
    yaw = np.interp(time, time[moving], course)
    roll = np.arctan(speed * np.gradient(yaw, time) / STANDARD_GRAVITY)
    return np.where(moving, roll, 0.0), np.where(moving, np.arctan2(rates[:, 2], speed), 0.0), yaw
