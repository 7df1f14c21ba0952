"""Manoeuvres that would close a flight, and when: candidates are flown through the covariance of the design's plan.

A candidate is a change of the design: waypoints in front of a line or within it, an aid, another IMU. It is judged by
the flight of the changed design, so that an option that closes does so once it is taken.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import combinations
from operator import attrgetter
from typing import NamedTuple, cast

import numpy as np

from nav_model.base.constants import DEGREE
from nav_model.base.errors import InputError
from nav_model.budget.inputs import inputs_of
from nav_model.design import Design, Value
from nav_model.design.declaration import in_sentence
from nav_model.design.processing import REAL_TIME
from nav_model.design.trajectory import LINES, WAYPOINTS, lines_in_words
from nav_model.explore.levers import Lever, heading_levers, levers, velocity_levers
from nav_model.trajectory.covariance import lines_along
from nav_model.trajectory.design_study import along_flight, plan_of, planned, rows_of
from nav_model.trajectory.line_length import line_longer
from nav_model.trajectory.plan import PlannedFlight, before_line, in_parts
from nav_model.trajectory.result import LineResult
from nav_model.trajectory.waypoints import Plan

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
# Of each kind, what costs less comes first: of aids and IMUs the coarser. So the first that closes is the one to
# take, and where one buys nothing, those after it are not flown (`_best`).
_OF_THE_NOISE = (1 / 3, 1 / 10, 1 / 30)
"""Parts of the gyro noise that another IMU has at most."""
_NO_BETTER = 0.98  # of the excess over a limit
_BEFORE = "before"
_NO_PLAN = "No manoeuvre is among the options, as this flight has no waypoints: only lines and waypoints are a plan."
_LONGER = 600.0  # s that a line is flown on, to see when it fails
_PREFERRED = ("manoeuvre", "aid", "imu")
_MOST_PAIRED = 4  # options of which two are flown together
Way = Callable[[Plan, int], Plan]
"""A plan and the number of a waypoint where a line begins -> the plan with a manoeuvre there."""
Step = tuple[Sequence[Way], int]
"""Ways of which the shortest is flown, and the parts in which the line is then."""


class Limited(NamedTuple):
    """A figure on the line of several that is nearest to its limit, 1 sigma: the worst, the rms, the limit."""

    worst: float
    mean: float
    limit: float

    @property
    def ratio(self) -> float:
        """The worst over the limit."""
        return self.worst / self.limit


@dataclass(frozen=True)
class Option:
    """Effect of one change on the lines in question.

    kind: "manoeuvre", "aid" for further fixes, or "imu". lines: where it is flown, in words `where`: "before line 1",
    "of line 1" for turns within it; empty for what is not flown. before_s: how long before the end of such a line it
    is over [s], of the shortest that closes at the latest. costs_s: what it adds to the flight [s]. closes: whether
    the lines in question meet their limits, and all that did before. useless: without closing them, less than 2 %
    nearer to the limits. lost_s: time beyond the bank at which fixes are lost that it adds, below zero what it saves
    [s].
    changes, written: as `Design.replace` takes them.
    """

    name: str
    kind: str
    lines: tuple[str, ...]
    where: str
    before_s: float
    costs_s: float
    closes: bool
    useless: bool
    lost_s: float
    figures: Mapping[str, Limited]
    changes: Mapping[str, Value]
    written: Mapping[str, str]


@dataclass(frozen=True)
class Manoeuvres:
    """The answer for the lines of a flight that fail, `line` the first of them: whether all close as planned, their
    figures then, and the options. First are those that close: manoeuvres before aids and IMUs, the shortest first.
    note: why no manoeuvre is among them, where none can be."""

    line: str
    lines: tuple[str, ...]
    closes: bool
    figures: Mapping[str, Limited]
    options: tuple[Option, ...] = ()
    note: str = ""


class _Plan(NamedTuple):
    """A design and the flight of its plan."""

    design: Design
    flight: PlannedFlight


class _Candidate(NamedTuple):
    """A change to try at some lines; `apply` raises InputError where it cannot be flown."""

    name: str
    kind: str
    apply: Callable[[_Plan], _Plan]
    lines: tuple[str, ...] = ()
    where: str = ""
    written: Mapping[str, str] = {}


class _Question(NamedTuple):
    """A plan, its lines as flown, and the names of the lines that fail."""

    plan: _Plan
    lines: tuple[LineResult, ...]
    names: tuple[str, ...]

    @property
    def failing(self) -> list[int]:
        """Numbers of the lines that fail."""
        return [n for n, line in enumerate(self.lines) if line.name in self.names and not line.closes]


class _Flown(NamedTuple):
    """A candidate and what it does."""

    candidate: _Candidate
    option: Option


class _Answer(NamedTuple):
    """The best candidate of a kind, None where none can be flown, and lines at which a manoeuvre alone did nothing
    for the others in question."""

    flown: _Flown | None
    no_effect_elsewhere: frozenset[tuple[str, ...]]


def manoeuvres(
    design: Design,
    line: str = "",
    progress: Callable[[float, str], None] = lambda share, what: None,
    flight: PlannedFlight | None = None,
) -> Manoeuvres:
    """Options that would close the lines of a design's flight that fail: those named `line`, or all.

    Parameters
    ----------
    design : Design
        With its flight plan and at least one limit on a figure of a flight.
    line : str
        Name of a line; empty for all.
    progress : callable
        Called with the share done and what is flown.
    flight : PlannedFlight, optional
        What is flown in place of the design's plan, such as a recording; it cannot be changed.

    Raises
    ------
    InputError
        For a flight that cannot be flown, has no such line or no limit.

    Examples
    --------
    >>> from nav_model import manoeuvres, parse_design
    >>> design = parse_design('''
    ... requirements.heading = "2°"
    ... trajectory = { flight = "lines", lines = 1, length = "3 km" }
    ... ''')
    >>> manoeuvres(design).closes  # as planned
    True
    """
    progress(0.0, "The flight as planned")
    plan = _Plan(design, flight) if flight else _planned(design)
    note = _NO_PLAN if flight or design.trajectory.flight not in (LINES, WAYPOINTS) else ""
    lines = lines_along(along_flight(design, plan.flight))
    chosen = [result for result in lines if line in ("", result.name)]
    if not chosen:
        known = ", ".join(dict.fromkeys(result.name for result in lines))
        raise InputError("line", f"the flight has no line {line!r}; its lines: {known}", line)
    names = tuple(dict.fromkeys(result.name for result in chosen if not result.closes))
    figures = _figures(lines, names or [result.name for result in chosen])
    if not figures:
        raise InputError("requirements", "none limits a figure of the flight; give at least one, such as heading")
    if not names:
        return Manoeuvres(chosen[0].name, (), True, figures)
    question = _Question(plan, lines, names)
    kinds: list[Iterable[_Candidate]] = [] if note else [*_manoeuvres(question)]
    kinds += _equipment(design, processed=design.trajectory.planned or flight is not None)
    flown: list[_Flown] = []
    skipped = frozenset[tuple[str, ...]]()
    for n, kind in enumerate(kinds, 1):
        best = _best(question, kind, skipped, partial(progress, n / (len(kinds) + 2)))
        skipped |= best.no_effect_elsewhere
        flown += [best.flown] if best.flown else []
    share = 1.0 - 1.0 / (len(kinds) + 2)
    if not note and not any(each.option.closes and each.option.kind == "manoeuvre" for each in flown):
        best = _best(question, _in_parts(question, after_turn=True), skipped, partial(progress, share))
        flown += [best.flown] if best.flown else []
    options = [each.option for each in flown]
    if not any(option.closes for option in options):
        options += _two_at_a_time(question, flown, partial(progress, share))
    options.sort(key=lambda option: (not option.closes, _PREFERRED.index(option.kind), option.costs_s))
    if options and options[0].closes and options[0].where.startswith(_BEFORE):
        progress(1.0 - 0.5 / (len(kinds) + 2), f"{options[0].name}: how long before the line ends")
        options[0] = replace(options[0], before_s=_latest(question, options[0]))
    return Manoeuvres(names[0], names, False, figures, tuple(options), note)


def _latest(question: _Question, option: Option) -> float:
    """Time before the end of a line at which an option that closes may be over [s], the least of its lines.

    In real time when a longer line fails, which what follows does not change; post-processed as it is flown.
    """
    design = question.plan.design.replace(option.changes)
    flight = planned(design)
    spec = along_flight(design, flight)
    latest = [option.before_s]
    try:
        if spec.processing == REAL_TIME:
            numbers = [n for n, line in enumerate(flight.lines) if line.name in option.lines]
            longer = [line_longer(spec, design, number, _LONGER) for number in numbers]
            latest = [line.duration if line.fails_at_s is None else line.fails_at_s for line in longer]
    except InputError:  # a longer line, or what follows it, has no room
        pass
    return min(latest)


def _best(
    question: _Question,
    kind: Iterable[_Candidate],
    skipped: frozenset[tuple[str, ...]],
    progress: Callable[[str], None],
) -> _Answer:
    """The first candidate of a kind that closes, else the one nearest to it.

    Parameters
    ----------
    question : _Question
    kind : iterable of _Candidate
        Those that cost less first.
    skipped : frozenset
        Lines at which a manoeuvre alone is not tried, as `_Answer` has them of kinds before.
    progress : callable
        Called with the name of what is flown.
    """
    flown: list[_Flown] = []
    no_effect_elsewhere = set(skipped)
    least = _excess(_figures(question.lines, question.names))
    for candidate in kind:
        if candidate.lines in no_effect_elsewhere:
            continue
        progress(candidate.name)
        try:
            changed = candidate.apply(question.plan)
            lines = lines_along(along_flight(*changed))
        except InputError:  # there is no room for it, or no way to it
            continue
        option = _option(question, candidate, changed, lines)
        flown.append(_Flown(candidate, option))
        others = [name for name in question.names if name not in candidate.lines]
        if candidate.lines and others:
            here, elsewhere = (_gain(question, lines, names) for names in (candidate.lines, others))
            if here <= _NO_BETTER < elsewhere:
                no_effect_elsewhere.add(candidate.lines)
        gain, least = _excess(option.figures) / least, min(least, _excess(option.figures))
        # What follows costs more; where this is no better than what came before, that is not either.
        if option.closes or (gain > _NO_BETTER and set(candidate.lines) in (set(), set(question.names))):
            break
    best = min(flown, key=lambda each: (not each.option.closes, _excess(each.option.figures)), default=None)
    return _Answer(best, frozenset(no_effect_elsewhere))


def _two_at_a_time(question: _Question, flown: Iterable[_Flown], progress: Callable[[str], None]) -> Iterator[Option]:
    """Two options together where none closes alone: of the best pairs the first that closes, else the nearest."""
    good = sorted((each for each in flown if not each.option.useless), key=lambda each: _excess(each.option.figures))
    made: list[Option] = []
    for first, second in combinations(good[:_MOST_PAIRED], 2):
        turns, other = sorted((first.candidate, second.candidate), key=lambda each: _PREFERRED.index(each.kind))
        if other.kind == _PREFERRED[0]:  # two manoeuvres at the same lines
            continue
        apply = partial(_both, turns.apply, other.apply)
        name = f"{turns.name} and {in_sentence(other.name)}"
        pair = turns._replace(name=name, apply=apply, written={**turns.written, **other.written})
        if best := _best(question, [pair], frozenset(), progress).flown:
            made.append(best.option)
        if made and made[-1].closes:
            break
    if made:
        yield min(made, key=lambda option: (not option.closes, _excess(option.figures)))


def _both(first: Callable[[_Plan], _Plan], second: Callable[[_Plan], _Plan], plan: _Plan) -> _Plan:
    return second(first(plan))


def _planned(design: Design) -> _Plan:
    return _Plan(design, planned(design))


def _gain(question: _Question, lines: Iterable[LineResult], names: Iterable[str]) -> float:
    """The excess over a limit on lines of these names, over that of the plan as it is."""
    names = tuple(names)
    return _excess(_figures(lines, names)) / _excess(_figures(question.lines, names))


def _option(question: _Question, candidate: _Candidate, changed: _Plan, lines: Sequence[LineResult]) -> Option:
    """A candidate as it has been flown: the changed plan and its lines."""
    (design, flight), before, names = question.plan, question.lines, question.names
    closed = {line.name for line in before if line.closes} | set(names)
    closes = all(line.closes for line in lines if line.name in closed)
    limit, turns = changed.design.trajectory.bank_limit, candidate.kind == "manoeuvre"
    return Option(
        candidate.name,
        candidate.kind,
        candidate.lines,
        candidate.where,
        max((line.duration for line in lines if line.name in candidate.lines), default=0.0),
        changed.flight.duration - flight.duration,
        closes,
        not (closes or _gain(question, lines, names) <= _NO_BETTER),  # also where no line has a value
        changed.flight.banked(limit) - flight.banked(limit) if turns and limit is not None else 0.0,
        _figures(lines, names),
        {key: value for key, value in changed.design.items() if value != design[key]},
        candidate.written,
    )


def _figures(lines: Iterable[LineResult], names: Iterable[str]) -> Mapping[str, Limited]:
    """The limited figures of the lines of these names, each where it is nearest to its limit or farthest beyond."""
    by_name: dict[str, Limited] = {}
    for line in lines:
        for name, limit in line.limits.items() if line.name in names else ():
            here = Limited(line.worst.get(name, math.inf), line.mean.get(name, math.inf), limit)
            by_name[name] = max(by_name.get(name, here), here, key=attrgetter("ratio"))
    return by_name


def _excess(figures: Mapping[str, Limited]) -> float:
    return max((figure.ratio for figure in figures.values()), default=math.inf)


def _manoeuvres(question: _Question) -> Iterator[Iterable[_Candidate]]:
    """Changes of the plan by kind: within one, those that cost less come first."""
    trajectory, lines, failing = question.plan.design.trajectory, question.lines, question.failing
    places = [failing[:1], failing][: len(failing)]
    lossy = trajectory.bank_limit is not None and trajectory.bank > trajectory.bank_limit
    for bank in (trajectory.bank, _GENTLER * trajectory.bank_limit) if lossy else (trajectory.bank,):
        gentle = "" if bank == trajectory.bank else f" at {math.degrees(bank):.3g}° bank"
        if gentle:
            yield [_Candidate(f"All turns{gentle}", "manoeuvre", partial(_banked, bank))]
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
    yield _in_parts(question)


def _equipment(design: Design, *, processed: bool) -> Iterator[Iterable[_Candidate]]:
    """Aids and IMUs by kind, with which the same is flown: within one, the coarser come first.

    `processed`: whether a smoother of the same flight is an aid too; without lines it would be flown further.
    """
    for aids in (
        levers(design, ["processing"] if processed else []),
        heading_levers(design),
        velocity_levers(design),
    ):
        yield [
            _Candidate(each.name, "aid", partial(_equipped, each.changes))
            for each in aids
            if "gnss.velocity_interval" not in each.changes  # a flight of ten times the fixes
        ]
    yield _better_imus(design)


def _in_parts(question: _Question, *, after_turn: bool = False) -> Iterator[_Candidate]:
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


def _banked(bank: float, plan: _Plan) -> _Plan:
    return _planned(plan.design.replace({"trajectory.bank": bank}))


def _equipped(changes: Mapping[str, Value], plan: _Plan) -> _Plan:
    return _Plan(plan.design.replace(changes), plan.flight)


def _better_imus(design: Design) -> Iterator[_Candidate]:
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
        yield _Candidate(f"IMU {each.name}", "imu", partial(_equipped, each.changes), written=each.written)


def _number(lever: Lever, key: str) -> float:
    return float(cast("float", lever.changes[key]))


def _candidate(
    name: str, lines: Sequence[LineResult], place: Sequence[int], steps: Sequence[Step], bank: float
) -> _Candidate:
    """A change of the waypoints at the lines of these numbers, one step after another, each by its shortest way."""

    def apply(plan: _Plan) -> _Plan:
        if bank != plan.design.trajectory.bank:
            plan = _banked(bank, plan)
        for number in reversed(place):  # so that lines before keep their numbers
            for ways, parts in steps:
                plan = min(_inserted(plan, number, ways, parts), key=lambda changed: changed.flight.duration)
        return plan

    names = tuple(dict.fromkeys(lines[n].name for n in place))
    where = f"{'of' if any(parts > 1 for _, parts in steps) else _BEFORE} {lines_in_words(names)}"
    return _Candidate(name, "manoeuvre", apply, names, where)


def _inserted(plan: _Plan, number: int, ways: Sequence[Way], parts: int) -> list[_Plan]:
    """The plan with each of the ways at a line; raises InputError where none can be flown."""
    design, flown = plan.design, plan_of(plan.design)
    at = [n for n, point in enumerate(flown.waypoints[:-1]) if point.line][number]
    changed: list[_Plan] = []
    for way in ways:
        try:
            rows = rows_of(way(flown, at).waypoints)
            other = _planned(design.replace({"trajectory.flight": WAYPOINTS, "trajectory.waypoints": rows}))
        except InputError:
            if way is ways[-1] and not changed:
                raise
            continue
        outages = tuple(_later_outages(plan, other, number, parts))
        changed.append(_Plan(other.design.replace({"trajectory.outages": outages}), other.flight))
    return changed


def _later_outages(plan: _Plan, other: _Plan, number: int, parts: int) -> Iterator[tuple[float, float]]:
    """Outages where they were on the lines: later by what the other plan adds in front of a line, or between its
    parts."""
    line, adds = plan.flight.lines[number], other.flight.duration - plan.flight.duration
    places = line.start + np.arange(parts > 1, parts) / parts * (line.stop - line.start)
    for start, stop in plan.design.trajectory.outages:
        later = adds * float(np.mean(start >= places))
        yield start + later, stop + later
