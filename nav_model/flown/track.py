"""The flight that was flown, as the covariance takes it: along the recorded track, with the fixes that there were."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import interpolated
from nav_model.budget.inputs import inputs_of
from nav_model.design import Design
from nav_model.design.trajectory import lines_in_words
from nav_model.earth.wgs84 import metres_per_radian
from nav_model.flown.solution import Solution, wrapped
from nav_model.simulation.design_study import specification
from nav_model.simulation.trajectory import plan_trajectory
from nav_model.simulation.truth import true_states
from nav_model.trajectory.design_study import MOST_RESULTS, covariance_specification, planned
from nav_model.trajectory.files.heights import Heights
from nav_model.trajectory.files.recorded import RecordedSegment, fly_recorded
from nav_model.trajectory.specification import CovarianceSpec, FlightLine

FloatArray = NDArray[np.float64]
_FLOWN_EVERY = 0.1  # s between places that are flown
_PAUSE = 10.0  # s and median steps: a longer gap ends a segment, as of any recording
_STRAIGHT = math.radians(1.0)  # per second
_SMOOTHED = 5.0  # s over which a rate of turn is taken
_SLOWEST = 3.0  # m/s
_COURSE, _ACROSS, _LEAST_ACROSS = math.radians(15.0), 0.05, 100.0  # of a line that is matched: rad, part of it, m
_NO_FIX = frozenset({"none", "no fix", "dead reckoning", "ins only"})


@dataclass(frozen=True)
class Stretch:
    """A straight part of a flight, by the solution's clock [s]: a line of the plan, or found in the track."""

    name: str
    start: float
    stop: float


@dataclass(frozen=True, eq=False)
class Clock:
    """When each part of a flight begins, by the solution's clock and in the flight: (parts, 2) [s]."""

    starts: FloatArray

    def in_flight(self, time: FloatArray) -> FloatArray:
        """Times of the flight, of those of the solution's clock."""
        part = np.maximum(np.searchsorted(self.starts[:, 0], time + 1e-9, side="right") - 1, 0)
        return np.asarray(time - self.starts[part, 0] + self.starts[part, 1])

    def of_solution(self, time: FloatArray) -> FloatArray:
        """Times of the solution's clock, of those of the flight."""
        part = np.maximum(np.searchsorted(self.starts[:, 1], time + 1e-9, side="right") - 1, 0)
        return np.asarray(time - self.starts[part, 1] + self.starts[part, 0])


@dataclass(frozen=True, eq=False)
class Track:
    """A flown flight: the question to its covariance, whose lines are the stretches, and its clock."""

    spec: CovarianceSpec
    stretches: tuple[Stretch, ...]
    clock: Clock
    notes: tuple[str, ...]


def track_of(design: Design, solution: Solution, begin: float, end: float, *, at_fixes: bool) -> Track:
    """The flown flight of a solution between two times of its clock.

    Parameters
    ----------
    design : Design
        Instruments, radar and limits; its plan names the lines.
    solution : Solution
        Whose places are flown.
    begin, end : float
        Seconds of its clock.
    at_fixes : bool
        True where what is compared has a place at each fix alone, False where it has places between fixes too.

    Raises
    ------
    InputError
        Under "solution": what cannot be flown.
    """
    heights = Heights("solution")
    segments = _segments(solution, begin, end)
    flight = fly_recorded(segments, heights)
    if len(flight.lines) != len(segments):
        raise heights.refuse(f"{len(segments)} recorded parts make {len(flight.lines)} that can be flown. Cut it.")
    clock = Clock(np.array([(one.rows[0, 0], line.start) for one, line in zip(segments, flight.lines, strict=True)]))
    stretches, note = stretches_of(design, solution, begin, end)
    lines = tuple(
        FlightLine(one.name, *clock.in_flight(np.array([one.start, one.stop])).tolist()) for one in stretches
    )
    notes = [note, *heights.notes]
    names = {line.name for line in lines}
    limits = tuple(row for row in design.trajectory.limits if row[0] in names)
    if others := [name for name, *_ in design.trajectory.limits if name not in names]:
        design = design.replace({"trajectory.limits": limits})
        notes.append(f"without the limits of {lines_in_words([*dict.fromkeys(others)])}, not flown")
    # The results lie at the fixes, or at four moments between them in turn.
    spacing = design.gnss.interval * (1.0 if at_fixes else 1.25)
    study = specification(
        design,
        trajectory=flight.trajectory,
        runs=1,
        duration=flight.duration,
        outages=_losses(solution, clock),
        every=spacing * max(1.0, math.ceil(flight.duration / MOST_RESULTS / spacing)),
    )
    return Track(covariance_specification(design, study, lines), stretches, clock, tuple(notes))


def _segments(solution: Solution, begin: float, end: float) -> list[RecordedSegment]:
    """The places of a solution that are flown, in parts without a pause."""
    time = solution.time_s
    thin = max(1, round(_FLOWN_EVERY * solution.rate_hz))
    inside = np.flatnonzero((time >= begin) & (time <= end))[::thin]
    columns = [time[inside, None], np.degrees(solution.place[inside, :2]), solution.place[inside, 2:]]
    if solution.attitude is not None:
        columns.append(np.degrees(solution.attitude[inside]))
    rows = np.hstack(columns)
    steps = np.diff(rows[:, 0])
    ends = np.flatnonzero(steps > max(_PAUSE, _PAUSE * float(np.median(steps)))) + 1
    parts = [part for part in np.split(rows, ends) if len(part) > 1]
    return [RecordedSegment(f"part {number}", part) for number, part in enumerate(parts, 1)]


def _losses(solution: Solution, clock: Clock) -> tuple[tuple[float, float], ...]:
    """Times of the flight without fixes, as the solution has their kinds."""
    lost = [n for n, name in enumerate(solution.fix_names) if name in _NO_FIX]
    if solution.fix is None or not lost:
        return ()
    gone = np.isin(solution.fix, lost)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], gone, [False]]).astype(np.int8)))
    times = solution.time_s[np.minimum(edges, len(gone) - 1)].reshape(-1, 2)
    return tuple((a, b) for a, b in clock.in_flight(times).tolist() if b > a)


def stretches_of(design: Design, solution: Solution, begin: float, end: float) -> tuple[tuple[Stretch, ...], str]:
    """The lines of the design's plan that were flown, matched by place; else the straight parts that are as long as
    an aperture; and a remark on which.

    Parameters
    ----------
    design : Design
    solution : Solution
    begin, end : float
        Between which times of its clock [s].
    """
    time = np.arange(begin, end, 1.0)
    place = interpolated(time, solution.time_s, solution.place)
    north, east = metres_per_radian(place[:, 0], place[:, 2])
    velocity = np.gradient(place[:, :2], time, axis=0) * np.column_stack([north, east])
    if design.trajectory.planned and (lines := _matched(design, time, place, velocity)):
        return lines, f"{len(lines)} of the plan's lines were flown, by place"
    speed = np.linalg.norm(velocity, axis=1)
    course = np.unwrap(np.arctan2(velocity[:, 1], velocity[:, 0]))
    width = max(1, round(_SMOOTHED))
    rate = np.abs(np.convolve(np.gradient(course, time), np.ones(width) / width, mode="same"))
    straight = (rate < _STRAIGHT) & (speed > _SLOWEST)
    aperture = float(inputs_of(design).aperture)
    ends = [(float(time[a]), float(time[b - 1])) for a, b in _runs(straight) if time[b - 1] - time[a] >= aperture]
    stretches = tuple(Stretch(f"stretch {n}", a, b) for n, (a, b) in enumerate(ends, 1))
    remark = "no line of the plan was flown; " if design.trajectory.planned else ""
    return stretches, f"{remark}straight stretches are those of the track"


def _matched(design: Design, time: FloatArray, place: FloatArray, velocity: FloatArray) -> tuple[Stretch, ...]:
    """The plan's lines that were flown: near the line between its ends, in its direction or against it."""
    flight = planned(design)
    trajectory = plan_trajectory(flight.trajectory, flight.duration)
    stretches = []
    for line in flight.lines:
        ends = true_states(trajectory, np.array([line.start, min(line.stop, flight.duration)])).position
        north, east = metres_per_radian(*ends[0, [0, 2]])
        scale = np.array([north, east])
        way = wrapped(ends[1, :2] - ends[0, :2]) * scale
        length = float(np.linalg.norm(way))
        if length < 1.0:
            continue
        along_it = way / length
        steps = wrapped(place[:, :2] - ends[0, :2]) * scale
        along, across = steps @ along_it, np.abs(steps @ [-along_it[1], along_it[0]])
        speed = np.maximum(np.linalg.norm(velocity, axis=1), 1e-9)
        near = across < max(_LEAST_ACROSS, _ACROSS * length)
        on = (along >= 0.0) & (along <= length) & near & (np.abs(velocity @ along_it) / speed > math.cos(_COURSE))
        longest = max(_runs(on), key=lambda run: run[1] - run[0], default=None)
        if longest is not None and longest[1] - longest[0] > 1:
            stretches.append(Stretch(line.name, float(time[longest[0]]), float(time[longest[1] - 1])))
    return tuple(sorted(stretches, key=lambda stretch: stretch.start))


def _runs(mask: NDArray[np.bool_]) -> Sequence[tuple[int, int]]:
    """First and past-the-last index of each run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return [(int(a), int(b)) for a, b in edges.reshape(-1, 2)]
