"""The answer to "what must change?": the smallest sets of levers with which a design meets its requirements.

Sets grow: levers alone, pairs, then triples, one of a group, each level in a few passes through the formulas of the
budget. What contains a set that closes is not tried. So the answer is that of an exhaustive enumeration.
"""

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, product

from nav_model.base.errors import InputError, not_a_choice, quoted
from nav_model.budget import analyse
from nav_model.budget.refusals import imaged_inputs
from nav_model.design import Design, Value
from nav_model.design.catalogue import Entry
from nav_model.design.figures import figure_in_sentence
from nav_model.design.parts import all_keys
from nav_model.explore.levers import ASKED_FOR, GROUPS, OFFERED, Group, Lever, levers, one_currency
from nav_model.explore.margins import needed_limits, ratios_of_trials, value_of
from nav_model.explore.rank import SENSORS

MOST_LEVERS = 3
"""Levers of a set at most."""
LITTLE = 0.25
"""Part of a variance below which lowering its source buys little, and what little is."""
_GAIN = 1e-3  # of the worst ratio, below which a lever changes nothing
_MOST_TRIED = 300  # levers: some 15,000 sets
_BOUGHT: tuple[Group, ...] = ("receiver", "imu")


@dataclass(frozen=True)
class LeverSet:
    """Levers pulled together, one of a group.

    ``ratios`` is value over limit of each requirement then. ``greater`` are the sets with greater steps of the same
    levers that close too, in their order.
    """

    levers: tuple[Lever, ...]
    ratios: Mapping[str, float]
    greater: tuple["LeverSet", ...] = ()

    @property
    def groups(self) -> tuple[Group, ...]:
        """Groups of the levers, by effort."""
        return tuple(lever.group for lever in self.levers)

    @property
    def changes(self) -> Mapping[str, Value]:
        """Inputs (SI) that taking the set into the design sets."""
        return {key: value for lever in self.levers for key, value in lever.changes.items()}

    @property
    def written(self) -> Mapping[str, str]:
        """Units of the changes."""
        return {key: unit for lever in self.levers for key, unit in lever.written.items()}

    @property
    def worst_ratio(self) -> float:
        """The largest value over limit; NaN for a design that would be refused."""
        return math.nan if any(map(math.isnan, self.ratios.values())) else max(self.ratios.values())

    @property
    def margin(self) -> float:
        """Margin of the tightest requirement."""
        return 1 - self.worst_ratio

    @property
    def tightest(self) -> str:
        """Name of the tightest requirement."""
        return max(self.ratios, key=self.ratios.__getitem__)

    @property
    def failing(self) -> Mapping[str, float]:
        """Value over limit of the requirements that are not met."""
        return {name: ratio for name, ratio in self.ratios.items() if ratio > 1}

    @property
    def price(self) -> float | None:
        """Sum of the offers; None where a part to buy has none, or nothing is bought."""
        prices = [lever.offer.get("price") for lever in self.levers if lever.group in _BOUGHT]
        return None if not prices or None in prices else sum(filter(None, prices))

    @property
    def currency(self) -> str:
        """Of the price; empty without one."""
        return next((lever.currency for lever in self.levers if lever.currency), "") if self.price is not None else ""


@dataclass(frozen=True)
class Single:
    """One lever alone: what it makes of the requirements, and why that is not enough (empty where it is)."""

    set: LeverSet
    because: str

    @property
    def lever(self) -> Lever:
        """The lever."""
        return self.set.levers[0]


@dataclass(frozen=True)
class Closing:
    """The answer for a design.

    ``today`` is the design without a lever. ``reserve`` is the margin that counts as closing. ``sets`` are the
    smallest that close, ``alone`` every lever whose needs the design meets. Where nothing closes, ``nearest`` is the
    set that comes nearest, and ``helps`` what a lever of each group that is off would add to it.
    """

    today: LeverSet
    reserve: float
    sets: tuple[LeverSet, ...]
    alone: tuple[Single, ...]
    nearest: LeverSet | None
    helps: tuple[LeverSet, ...]

    @property
    def closes(self) -> bool:
        """True if the design meets its requirements on the straight leg as it is."""
        return self.today.worst_ratio <= 1 - self.reserve


def closing_sets(
    design: Design,
    *,
    allow: Iterable[str] = (),
    lock: Iterable[str] = (),
    at_most: int = MOST_LEVERS,
    reserve: float = 0.0,
    imus: Mapping[str, Entry] | None = None,
    receivers: Mapping[str, Entry] | None = None,
) -> Closing:
    """The smallest sets of levers with which a design closes, each lever alone, and the nearest where none does.

    A set is among the answer if it closes what the straight leg judges, and no other does that lacks one of its
    levers or has a lesser step of one. A lever that alone makes the worst ratio larger is in no set. Sets are in the
    order of the number of their levers, of effort, price and margin.

    Parameters
    ----------
    design : Design
    allow : iterable of str
        Groups allowed beside the usual ones: "flight", "radar".
    lock : iterable of str
        Groups, or dotted keys of inputs, that must stay.
    at_most : int
        Levers of a set, 1 to `MOST_LEVERS`.
    reserve : float
        Margin to keep, as part of each limit.
    imus, receivers : mapping, optional
        Name -> entry to choose from; by default the catalogue's.

    Raises
    ------
    InputError
        For a design without a requirement or that `analyse` refuses, for an unknown group or key, for prices in
        several currencies, and for more than 300 levers.

    Examples
    --------
    >>> from nav_model import closing_sets, parse_design
    >>> design = parse_design('''
    ... imu.preset = "STIM300"
    ... requirements.tilt = "0.012°"
    ... ''')
    >>> answer = closing_sets(design, lock=["imu"])
    >>> f"{answer.today.worst_ratio:.2f} of the limit"
    '1.09 of the limit'
    >>> [[lever.name for lever in each.levers] for each in answer.sets]
    [['Process after the flight'], ['Velocity fixes of 3 cm/s, Doppler'], ['DGNSS']]
    """
    imaged_inputs(design)
    needed_limits(design, "close")
    if not 1 <= at_most <= MOST_LEVERS:
        raise InputError("at_most", f"must be 1 to {MOST_LEVERS}", at_most)
    if not 0 <= reserve < 1:
        raise InputError("reserve", "must be at least 0 and less than 100 %", reserve)
    groups, keys = _choices(allow, lock)
    one_currency([*(imus or {}).values(), *(receivers or {}).values()])
    every = [lever for lever in levers(design, GROUPS, imus, receivers) if not keys & lever.changes_in(design).keys()]
    if len(every) > _MOST_TRIED:
        reason = f"{len(every)} changes to combine are too many, at most {_MOST_TRIED}; give fewer units or receivers"
        raise InputError("offers", reason)
    on, off = ([lever for lever in every if (lever.group in groups) == state] for state in (True, False))
    today = _judged(design, [()])[0]
    alone = _judged(design, [(lever,) for lever in on if _needs_met(design, (lever,))])
    reasons = _reasons(design, today, alone, 1 - reserve)
    singles = tuple(Single(each, because) for each, because in zip(alone, reasons, strict=True))
    answer = Closing(today, reserve, (), singles, None, ())
    if answer.closes:
        return answer
    tried = [*_grown(design, _useful(design, on, today, alone), at_most, 1 - reserve)]
    closing = [each for each in tried if each.worst_ratio <= 1 - reserve]
    if closing:
        return replace(answer, sets=tuple(_smallest(closing)))
    better = [each for each in tried if each.worst_ratio < today.worst_ratio]
    nearest = min(better, key=lambda each: each.worst_ratio, default=None)
    return replace(answer, nearest=nearest, helps=tuple(_helps(design, off, nearest or today)))


def _choices(allow: Iterable[str], lock: Iterable[str]) -> tuple[set[Group], set[str]]:
    """The groups that may be used, and the keys that must stay."""
    known = all_keys()
    for name in (allow := tuple(allow)):
        if name not in GROUPS:
            raise InputError("allow", not_a_choice(name, GROUPS), name)
    for name in (lock := tuple(lock)):
        if name not in GROUPS and name not in known:
            raise InputError(
                "lock", f"{quoted(name)} is neither a key of an input nor one of {', '.join(GROUPS)}.", name
            )
    return {name for name in GROUPS if (name not in ASKED_FOR or name in allow) and name not in lock}, set(lock)


def _needs_met(design: Design, chosen: Sequence[Lever]) -> bool:
    changes = {key: value for lever in chosen for key, value in lever.changes.items()}
    return all(changes.get(key, design[key]) == value for lever in chosen for key, value in lever.needs.items())


def _judged(design: Design, sets: Sequence[tuple[Lever, ...]]) -> list[LeverSet]:
    """Sets with their ratios."""
    made = [LeverSet(chosen, {}) for chosen in sets]
    by_limit = ratios_of_trials(design, [each.changes for each in made])
    return [
        replace(each, ratios={name: float(ratio[n]) for name, ratio in by_limit.items()})
        for n, each in enumerate(made)
    ]


def _useful(design: Design, on: Iterable[Lever], today: LeverSet, alone: Iterable[LeverSet]) -> list[Lever]:
    """Levers that alone do not make the worst ratio larger; offers before the catalogue, by price, else by margin.

    Where a lever needs what the design has not, its effect is that in the design with it.
    """
    worst_alone = {each.levers[0].name: (each.worst_ratio, today.worst_ratio) for each in alone}
    waiting = [lever for lever in on if lever.name not in worst_alone]
    needs = [Lever("", lever.group, "", 0, lever.needs) for lever in waiting]
    pairs = _judged(design, [(need, lever) for need, lever in zip(needs, waiting, strict=True)])
    for lever, without, with_it in zip(waiting, _judged(design, [(need,) for need in needs]), pairs, strict=True):
        worst_alone[lever.name] = with_it.worst_ratio, without.worst_ratio
    good = [lever for lever in on if worst_alone[lever.name][0] <= (1 + _GAIN) * worst_alone[lever.name][1]]
    units = sorted(
        (lever for lever in good if lever.group == "imu"),
        key=lambda lever: (
            lever.origin != OFFERED,
            lever.offer.get("price", math.inf),
            -worst_alone[lever.name][0],
        ),
    )
    others = [lever for lever in good if lever.group != "imu"]
    return others + [replace(lever, step=step) for step, lever in enumerate(units)]


def _grown(design: Design, useful: Sequence[Lever], at_most: int, most: float) -> Iterator[LeverSet]:
    """Sets of one lever of a group, the smaller first; those that contain a set that closes are left out."""
    members = {name: [n for n, lever in enumerate(useful) if lever.group == name] for name in GROUPS}
    closing: set[tuple[int, ...]] = set()
    for size in range(1, at_most + 1):
        chosen = [
            numbers
            for groups in combinations([name for name in GROUPS if members[name]], size)
            for numbers in product(*(members[name] for name in groups))
            if not any(part in closing for less in range(1, size) for part in combinations(numbers, less))
            and _needs_met(design, [useful[n] for n in numbers])
        ]
        for numbers, each in zip(
            chosen, _judged(design, [tuple(useful[n] for n in ns) for ns in chosen]), strict=True
        ):
            if each.worst_ratio <= most:
                closing.add(numbers)
            yield each


def _smallest(closing: Iterable[LeverSet]) -> list[LeverSet]:
    """Sets that close of which none that closes has fewer levers or lesser steps, in their order."""
    # What is below a set has fewer levers, or as many and a lesser sum of steps: it comes first.
    ordered = sorted(closing, key=lambda each: (len(each.levers), sum(lever.step for lever in each.levers)))
    smallest: dict[frozenset[str], list[LeverSet]] = {}
    greater: dict[int, list[LeverSet]] = {}
    for each in ordered:
        steps = _steps(each)
        below = [
            other
            for count in range(1, len(steps) + 1)
            for families in combinations(steps, count)
            for other in smallest.get(frozenset(families), ())
            if all(step <= steps[family] for family, step in _steps(other).items())
        ]
        if not below:
            smallest.setdefault(frozenset(steps), []).append(each)
        for other in below:
            if len(other.levers) == len(each.levers):
                greater.setdefault(id(other), []).append(each)
    minimal = [each for members in smallest.values() for each in members]
    return sorted(
        (replace(each, greater=tuple(sorted(greater.get(id(each), ()), key=_order))) for each in minimal), key=_order
    )


def _steps(each: LeverSet) -> dict[str, float]:
    return {lever.family: lever.step for lever in each.levers}


def _order(each: LeverSet) -> tuple[object, ...]:
    """Number of levers, effort (the hardest lever first), price, margin."""
    effort = sorted((GROUPS.index(name) for name in each.groups), reverse=True)
    return len(each.levers), effort, math.inf if each.price is None else each.price, each.worst_ratio


def _helps(design: Design, off: Sequence[Lever], nearest: LeverSet) -> Iterator[LeverSet]:
    """For each group that is off, the lever that would bring the nearest set furthest."""
    for name in GROUPS:
        added = [
            (*(each for each in nearest.levers if each.group != name), lever) for lever in off if lever.group == name
        ]
        sets = _judged(design, [chosen for chosen in added if _needs_met(design, chosen)])
        best = min(sets, key=lambda each: each.worst_ratio, default=None)
        if best is not None and best.worst_ratio < (1 - _GAIN) * nearest.worst_ratio:
            yield best


def _reasons(design: Design, today: LeverSet, alone: Iterable[LeverSet], most: float) -> Iterator[str]:
    """The reason why each lever alone is not enough."""
    tightest = analyse(design).straight_leg().tightest
    shares = tightest.shares if tightest else {}
    for each in alone:
        change, figure = each.worst_ratio / today.worst_ratio - 1, figure_in_sentence(each.tightest)
        lowered = {SENSORS[key] for key, value in each.changes.items() if _lower(design, key, value)} & shares.keys()
        share = sum(shares[source] for source in lowered)
        if each.worst_ratio <= most:
            yield ""
        elif change > _GAIN:
            yield f"worse than today for {figure}"
        elif lowered and share < LITTLE and change > -LITTLE:
            yield f"{' and '.join(sorted(lowered))}: {100 * share:.2g} % of the variance of {figure}"
        elif change > -_GAIN:
            yield f"does not lower {figure}"
        else:
            yield f"not enough for {figure}"


def _lower(design: Design, key: str, value: Value) -> bool:
    """True if a value of an error source is less than the design's."""
    had = value_of(design, key) if key in SENSORS else None
    return isinstance(had, float) and isinstance(value, float) and value < had
