"""Changes of a flight's plan that are tried where lines fail: turns, run-ins and lines in parts, aids, better IMUs.

Within a kind those that cost less come first: of aids and IMUs the coarser. So the first that closes is the one to
take, and where one buys nothing, those after it need not be flown.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from typing import NamedTuple, cast

import numpy as np

from nav_model.base.constants import DEGREE
from nav_model.base.errors import InputError
from nav_model.budget.inputs import inputs_of
from nav_model.design import Design, Value
from nav_model.design.declaration import in_sentence
from nav_model.design.trajectory import WAYPOINTS, lines_in_words
from nav_model.explore.levers import Lever, heading_levers, levers, velocity_levers
from nav_model.trajectory.design_study import plan_of, planned, rows_of
from nav_model.trajectory.plan import PlannedFlight, before_line, in_parts
from nav_model.trajectory.result import LineResult
from nav_model.trajectory.waypoints import Plan

BEFORE = "before"
"""First word of a place in front of a line."""

_TURNS: Mapping[str, tuple[float, ...]] = {
    "S-turn": (45 * DEGREE, -90 * DEGREE, 45 * DEGREE),
    "90° turn": (90 * DEGREE, -90 * DEGREE),
    "Figure of eight": (360 * DEGREE, -360 * DEGREE),
}
"""Manoeuvre -> its turns [rad], to one side and the other; it ends in the direction in which it began."""
_RUN_INS = (120.0, 300.0)  # s
_FASTER, _HOLD = (1.1, 1.2, 1.4), 10.0  # parts of a line's speed, and s at it
_PARTS = {2: "Turn in the middle", 3: "Turns between three parts", 5: "Turns between five parts"}
_SHORTEST_PART = 60.0  # s
_BEYOND = 2.0  # s by which parts of a line overlap beyond an aperture
_GENTLER = 0.95  # of the bank at which fixes are lost
_OF_THE_NOISE = (1 / 3, 1 / 10, 1 / 30)
"""Parts of the gyro noise that another IMU has at most."""

Way = Callable[[Plan, int], Plan]
"""A plan and the number of a waypoint where a line begins -> the plan with a manoeuvre there."""
Step = tuple[Sequence[Way], int]
"""Ways of which the shortest is flown, and the parts in which the line is then."""


class FlownDesign(NamedTuple):
    """A design and the flight of its plan."""

    design: Design
    flight: PlannedFlight


class PlanChange(NamedTuple):
    """A change to try at some lines; `apply` raises InputError where it cannot be flown."""

    name: str
    kind: str
    apply: Callable[[FlownDesign], FlownDesign]
    lines: tuple[str, ...] = ()
    where: str = ""
    written: Mapping[str, str] = {}


class FailingLines(NamedTuple):
    """A plan, its lines as flown, and the names of the lines that fail."""

    plan: FlownDesign
    lines: tuple[LineResult, ...]
    names: tuple[str, ...]

    @property
    def failing(self) -> list[int]:
        """Numbers of the lines that fail."""
        return [n for n, line in enumerate(self.lines) if line.name in self.names and not line.closes]


def flown_design(design: Design) -> FlownDesign:
    """A design with the flight of its plan; raises InputError where it cannot be flown."""
    return FlownDesign(design, planned(design))


def both(first: PlanChange, second: PlanChange) -> PlanChange:
    """Two changes together, at the place of the first."""

    def apply(plan: FlownDesign) -> FlownDesign:
        return second.apply(first.apply(plan))

    name = f"{first.name} and {in_sentence(second.name)}"
    return first._replace(name=name, apply=apply, written={**first.written, **second.written})


def plan_changes(question: FailingLines) -> Iterator[Iterable[PlanChange]]:
    """Changes of the plan by kind: within one, those that cost less come first."""
    trajectory, lines, failing = question.plan.design.trajectory, question.lines, question.failing
    places = [failing[:1], failing][: len(failing)]
    lossy = trajectory.bank_limit is not None and trajectory.bank > trajectory.bank_limit
    for bank in (trajectory.bank, _GENTLER * trajectory.bank_limit) if lossy else (trajectory.bank,):
        gentle = "" if bank == trajectory.bank else f" at {math.degrees(bank):.3g}° bank"
        if gentle:
            yield [PlanChange(f"All turns{gentle}", "manoeuvre", partial(_banked, bank))]
        for name, arcs in _TURNS.items():
            yield [_candidate(name + gentle, lines, place, [(_both_sides(arcs), 1)], bank) for place in places]
    run_ins: tuple[Mapping[str, Way], ...] = (
        {f"Run-in of {time / 60:.0f} min": partial(before_line, run_in=time) for time in _RUN_INS},
        {
            f"Speed up by {faster - 1:.0%} and back": partial(before_line, run_in=_HOLD, faster=faster)
            for faster in _FASTER
        },
    )
    for ways in run_ins:
        yield [
            _candidate(name, lines, place, [([way], 1)], trajectory.bank)
            for name, way in ways.items()
            for place in places
        ]
    yield lines_in_parts(question)


def equipment(design: Design, *, processed: bool) -> Iterator[Iterable[PlanChange]]:
    """Aids and IMUs by kind, with which the same is flown: within one, the coarser come first.

    `processed`: whether a smoother of the same flight is an aid too; without lines it would be flown further.
    """
    for aids in (
        levers(design, ["processing"] if processed else []),
        heading_levers(design),
        velocity_levers(design),
    ):
        yield [
            PlanChange(each.name, "aid", partial(_equipped, each.changes))
            for each in aids
            if "gnss.velocity_interval" not in each.changes  # a flight of ten times the fixes
        ]
    yield _better_imus(design)


def lines_in_parts(question: FailingLines, *, after_turn: bool = False) -> Iterator[PlanChange]:
    """Lines flown in parts, with turns between them, and with one in front of each line too."""
    design, failing, lines = question.plan.design, question.failing, question.lines
    longest = min(lines[n].stop_s - lines[n].start_s for n in failing) / _SHORTEST_PART
    overlap = float(inputs_of(design).aperture) + _BEYOND
    for parts, name in _PARTS.items():
        if parts <= longest:
            steps: list[Step] = [([partial(in_parts, parts=parts, overlap=overlap)], parts)]
            if after_turn:
                name, arcs = f"S-turn and {in_sentence(name)}", _TURNS["S-turn"]
                steps.append((_both_sides(arcs), 1))
            yield _candidate(name, lines, failing, steps, design.trajectory.bank)


def _both_sides(arcs: Sequence[float]) -> list[Way]:
    return [partial(before_line, arcs=[side * arc for arc in arcs]) for side in (1.0, -1.0)]


def _banked(bank: float, plan: FlownDesign) -> FlownDesign:
    return flown_design(plan.design.replace({"trajectory.bank": bank}))


def _equipped(changes: Mapping[str, Value], plan: FlownDesign) -> FlownDesign:
    return FlownDesign(plan.design.replace(changes), plan.flight)


def _better_imus(design: Design) -> Iterator[PlanChange]:
    """IMUs of the catalogue with less noise: the noisiest of which the gyro has at most a part of the design's."""
    gyro = {
        each.name: (_number(each, "imu.angle_random_walk"), each)
        for each in levers(design, ["imu"])
        if _number(each, "imu.velocity_random_walk") <= design.imu.velocity_random_walk
    }
    names: dict[str, Lever] = {}
    for part in _OF_THE_NOISE:
        below = [(noise, name) for name, (noise, _) in gyro.items() if noise <= part * design.imu.angle_random_walk]
        if below:
            noisiest = max(below)[1]
            names[noisiest] = gyro[noisiest][1]
    for each in names.values():
        yield PlanChange(f"IMU {each.name}", "imu", partial(_equipped, each.changes), written=each.written)


def _number(lever: Lever, key: str) -> float:
    return float(cast("float", lever.changes[key]))


def _candidate(
    name: str, lines: Sequence[LineResult], place: Sequence[int], steps: Sequence[Step], bank: float
) -> PlanChange:
    """A change of the waypoints at the lines of these numbers, one step after another, each by its shortest way."""

    def apply(plan: FlownDesign) -> FlownDesign:
        if bank != plan.design.trajectory.bank:
            plan = _banked(bank, plan)
        for number in reversed(place):  # so that lines before keep their numbers
            for ways, parts in steps:
                plan = min(_inserted(plan, number, ways, parts), key=lambda changed: changed.flight.duration)
        return plan

    names = tuple(dict.fromkeys(lines[n].name for n in place))
    where = f"{'of' if any(parts > 1 for _, parts in steps) else BEFORE} {lines_in_words(names)}"
    return PlanChange(name, "manoeuvre", apply, names, where)


def _inserted(plan: FlownDesign, number: int, ways: Sequence[Way], parts: int) -> list[FlownDesign]:
    """The plan with each of the ways at a line; raises InputError where none can be flown."""
    design, flown = plan.design, plan_of(plan.design)
    at = [n for n, point in enumerate(flown.waypoints[:-1]) if point.line][number]
    changed: list[FlownDesign] = []
    for way in ways:
        try:
            rows = rows_of(way(flown, at).waypoints)
            other = flown_design(design.replace({"trajectory.flight": WAYPOINTS, "trajectory.waypoints": rows}))
        except InputError:
            if way is ways[-1] and not changed:
                raise
            continue
        outages = tuple(_later_outages(plan, other, number, parts))
        changed.append(FlownDesign(other.design.replace({"trajectory.outages": outages}), other.flight))
    return changed


def _later_outages(plan: FlownDesign, other: FlownDesign, number: int, parts: int) -> Iterator[tuple[float, float]]:
    """Outages where they were on the lines: later by what the other plan adds in front of a line, or between its
    parts."""
    line, adds = plan.flight.lines[number], other.flight.duration - plan.flight.duration
    places = line.start + np.arange(parts > 1, parts) / parts * (line.stop - line.start)
    for start, stop in plan.design.trajectory.outages:
        later = adds * float(np.mean(start >= places))
        yield start + later, stop + later
