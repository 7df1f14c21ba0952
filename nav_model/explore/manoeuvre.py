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
from typing import NamedTuple

from nav_model.base.errors import InputError
from nav_model.design import Design, Value
from nav_model.design.processing import REAL_TIME
from nav_model.design.trajectory import LINES, WAYPOINTS
from nav_model.explore.plan_changes import (
    BEFORE,
    FailingLines,
    FlownDesign,
    PlanChange,
    both,
    equipment,
    flown_design,
    lines_in_parts,
    plan_changes,
)
from nav_model.trajectory.covariance import lines_along
from nav_model.trajectory.design_study import along_flight, planned
from nav_model.trajectory.line_length import line_longer
from nav_model.trajectory.plan import PlannedFlight
from nav_model.trajectory.result import LineResult

_NO_BETTER = 0.98  # of the excess over a limit
_NO_PLAN = "No manoeuvre is among the options, as this flight has no waypoints: only lines and waypoints are a plan."
_LONGER = 600.0  # s that a line is flown on, to see when it fails
_PREFERRED = ("manoeuvre", "aid", "imu")
_MOST_PAIRED = 4  # options of which two are flown together


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


class _Flown(NamedTuple):
    """A candidate and what it does."""

    candidate: PlanChange
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
    plan = FlownDesign(design, flight) if flight else flown_design(design)
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
    question = FailingLines(plan, lines, names)
    kinds: list[Iterable[PlanChange]] = [] if note else [*plan_changes(question)]
    kinds += equipment(design, processed=design.trajectory.planned or flight is not None)
    flown: list[_Flown] = []
    skipped = frozenset[tuple[str, ...]]()
    for n, kind in enumerate(kinds, 1):
        best = _best(question, kind, skipped, partial(progress, n / (len(kinds) + 2)))
        skipped |= best.no_effect_elsewhere
        flown += [best.flown] if best.flown else []
    share = 1.0 - 1.0 / (len(kinds) + 2)
    if not note and not any(each.option.closes and each.option.kind == "manoeuvre" for each in flown):
        best = _best(question, lines_in_parts(question, after_turn=True), skipped, partial(progress, share))
        flown += [best.flown] if best.flown else []
    options = [each.option for each in flown]
    if not any(option.closes for option in options):
        options += _two_at_a_time(question, flown, partial(progress, share))
    options.sort(key=lambda option: (not option.closes, _PREFERRED.index(option.kind), option.costs_s))
    if options and options[0].closes and options[0].where.startswith(BEFORE):
        progress(1.0 - 0.5 / (len(kinds) + 2), f"{options[0].name}: how long before the line ends")
        options[0] = replace(options[0], before_s=_latest(question, options[0]))
    return Manoeuvres(names[0], names, False, figures, tuple(options), note)


def _latest(question: FailingLines, option: Option) -> float:
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
    question: FailingLines,
    kind: Iterable[PlanChange],
    skipped: frozenset[tuple[str, ...]],
    progress: Callable[[str], None],
) -> _Answer:
    """The first candidate of a kind that closes, else the one nearest to it.

    Parameters
    ----------
    question : FailingLines
    kind : iterable of PlanChange
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


def _two_at_a_time(
    question: FailingLines, flown: Iterable[_Flown], progress: Callable[[str], None]
) -> Iterator[Option]:
    """Two options together where none closes alone: of the best pairs the first that closes, else the nearest."""
    good = sorted((each for each in flown if not each.option.useless), key=lambda each: _excess(each.option.figures))
    made: list[Option] = []
    for first, second in combinations(good[:_MOST_PAIRED], 2):
        turns, other = sorted((first.candidate, second.candidate), key=lambda each: _PREFERRED.index(each.kind))
        if other.kind == _PREFERRED[0]:  # two manoeuvres at the same lines
            continue
        pair = both(turns, other)
        if best := _best(question, [pair], frozenset(), progress).flown:
            made.append(best.option)
        if made and made[-1].closes:
            break
    if made:
        yield min(made, key=lambda option: (not option.closes, _excess(option.figures)))


def _gain(question: FailingLines, lines: Iterable[LineResult], names: Iterable[str]) -> float:
    """The excess over a limit on lines of these names, over that of the plan as it is."""
    names = tuple(names)
    return _excess(_figures(lines, names)) / _excess(_figures(question.lines, names))


def _option(
    question: FailingLines, candidate: PlanChange, changed: FlownDesign, lines: Sequence[LineResult]
) -> Option:
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
