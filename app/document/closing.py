"""Answers to "what must change?" in words and tables: sets of levers, each lever alone, largest values of inputs."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple
from urllib.parse import parse_qsl

from app.document.blocks import Answer, Block, Cell, Column, Row, TableBlock, Text, table
from app.document.numbers import margin_in_sentence, margin_in_short, number, signed_percent
from app.document.verdict import before_flight, check_quantity
from app.document.wording import input_in_words
from nav_model.budget import Budget
from nav_model.budget.verdict import flown_names
from nav_model.design import Design, Value
from nav_model.design.catalogue import catalogue
from nav_model.design.declaration import in_sentence
from nav_model.design.figures import figure_in_sentence
from nav_model.design.offers import Offers
from nav_model.design.parts import declaration_of
from nav_model.explore.closing import Closing, LeverSet
from nav_model.explore.levers import ASKED_FOR, GROUPS, Group, Lever
from nav_model.explore.margins import label_of
from nav_model.explore.solve import Offer, Solution, offer, resolution_for, solve

GROUP_WORDS: Mapping[Group, str] = {
    "processing": "Processing",
    "velocity": "Velocity fixes",
    "autofocus": "Autofocus",
    "receiver": "Receiver",
    "imu": "IMU",
    "flight": "Flight",
    "radar": "Resolution",
}
"""Group of levers -> its name on the page."""
ON_FLIGHT = "What would close it is on Flight, below the charts."
"""Advice for a design that a flight alone judges."""
SHORT = 3  # sets beside a verdict
_SLIM = 0.05  # of a limit


class Way(NamedTuple):
    """One way to close a design by a single value: its changes [SI], their units, and its texts."""

    changes: Mapping[str, Value]
    written: Mapping[str, str]
    what: str
    value: str
    now: str
    why: str

    @property
    def text(self) -> str:
        """The change, such as "Fix interval: at most 0.500 s"."""
        return f"{self.what}: {self.value}"


def lever_in_words(lever: Lever) -> str:
    """A lever with its kind where its name is that of a part: "IMU LN-100"."""
    kind = {"imu": "IMU ", "receiver": "receiver "}.get(lever.group, "")
    return f"{kind}{lever.name}" if kind else in_sentence(lever.name)


def set_in_words(levers: Iterable[Lever]) -> str:
    """Levers of a set, as "closes" takes them: "post-processed with receiver DGNSS", "with IMU LN-100"."""
    levers = tuple(levers)
    processed = "post-processed" if any(lever.group == "processing" for lever in levers) else ""
    others = " and ".join(lever_in_words(lever) for lever in levers if lever.group != "processing")
    return " ".join(filter(None, (processed, f"with {others}" if others else "")))


def set_name(each: LeverSet) -> str:
    """A set as the head of a row: "Process after the flight + receiver DGNSS"."""
    words = " + ".join(map(lever_in_words, each.levers))
    return _sentence(words)


def closing_in_short(answer: Closing, most: int = SHORT) -> str:
    """The first sets in a sentence without its end, or how near the nearest comes; empty for a design that closes."""
    if answer.closes:
        return ""
    if answer.sets:
        ways = (f"{set_in_words(each.levers)} ({margin_in_sentence(each.margin)})" for each in answer.sets[:most])
        return f"closes {', or '.join(ways)}"
    if answer.nearest is None:
        return "no lever brings it nearer"
    nearest = answer.nearest
    return (
        f"no set of {len(nearest.levers)} levers or fewer closes it; nearest: {set_in_words(nearest.levers)}, "
        f"{margin_in_sentence(nearest.margin)}"
    )


def closing_answer(budget: Budget, answer: Closing) -> Answer:
    """The first set, or the nearest and what would help; grey where the flight decides too."""
    open_tone = bool(flown_names(budget.design))
    if answer.sets:
        first, *others = answer.sets
        more = (f"Or {'; or '.join(set_in_words(each.levers) for each in others[: SHORT - 1])}.",) if others else ()
        slim = ("A margin below 5 % is slim.",) if first.margin < _SLIM else ()
        word = f"Closes {set_in_words(first.levers)}"
        return Answer(word, "open", (f"{_sentence(margin_in_sentence(first.margin))}.", *more, *slim))
    word = "No lever brings it nearer" if answer.nearest is None else "No set of these levers closes it"
    return Answer(word if open_tone else f"✗ {word}", "open" if open_tone else "bad", tuple(_nearest(budget, answer)))


def _nearest(budget: Budget, answer: Closing) -> Iterator[str]:
    if answer.nearest is not None:
        nearest = answer.nearest
        over = ", ".join(f"{figure_in_sentence(name)} {number(ratio)} ×" for name, ratio in nearest.failing.items())
        what = f"still over its limit: {over}" if over else margin_in_sentence(nearest.margin)  # short of the reserve
        yield f"Nearest: {set_in_words(nearest.levers)}; {what}."
    for each in answer.helps:
        added = each.levers[-1]
        effect = (
            "closes it" if each.worst_ratio <= 1 - answer.reserve else f"brings that to {number(each.worst_ratio)} ×"
        )
        yield f"With {GROUP_WORDS[added.group].lower()} allowed, {lever_in_words(added)} {effect}."
    yield from contributors_alone(budget)


def contributors_alone(budget: Budget) -> Iterator[str]:
    """Contributors of the user's own that exceed a limit without the model, by name: no lever moves them."""
    for check in budget.straight_leg().checks:
        figure = budget.figure(check.on)
        alone = (check.confidence or 1.0) * figure.around(0.0).sigma
        if alone > check.limit:
            value, limit = (check_quantity(check, size) for size in (alone, check.limit))
            names = " and ".join(part.name for part in figure.parts)
            yield f"{names} alone: {value} of {limit} for {figure_in_sentence(check.name)}."


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}"


def sets_table(design: Design, sets: Sequence[LeverSet], key: str = "sets", *, buttons: bool = True) -> TableBlock:
    """Sets of levers that close a design; the value of a row is its `set_name`.

    Parameters
    ----------
    design : Design
    sets : sequence of LeverSet
    key : str
        Of the table.
    buttons : bool
        Whether a set can be pressed.
    """
    priced = any(each.price is not None for each in sets)
    doubted = any(_doubts(each) for each in sets)
    decides = {each.tightest for each in sets}
    limit = f"; {figure_in_sentence(*decides)} decides" if len(decides) == 1 else ""
    press = " Click one to apply it; you can undo." if buttons else ""
    columns = (
        Column("Change", width=2),
        Column("Margin", numeric=True),
        *(("Decides",) if not limit else ()),
        Column("Greater steps", width=1.5),
        *((Column("Price", numeric=True),) if priced else ()),
        *(("Unverified",) if doubted else ()),
    )
    rows: list[Row] = []
    for each in sets:
        greater = each.greater if len(each.greater) < 2 else (each.greater[-1], each.greater[0])
        price = "not given" if each.price is None else f"{number(each.price, 4, given=True)} {each.currency}"
        rows.append(
            (
                Cell(set_name(each), value=set_name(each) if buttons else ""),
                margin_in_short(each.margin),
                *((label_of(each.tightest),) if not limit else ()),
                "; ".join(f"{_difference(each, more)} {signed_percent(more.margin)}" for more in greater),
                *((price,) if priced else ()),
                *((_doubts(each),) if doubted else ()),
            )
        )
    return table(
        key,
        f"Each of these sets closes the design{before_flight(design)}{limit}.{press}",
        columns,
        rows,
        "Sets have three levers at most, one of a group. None of them can be left out, and no lesser step of one is "
        "enough. Receivers and IMUs have the values of the catalogue, velocity fixes typical ones.",
    )


def _doubts(each: LeverSet) -> str:
    """Values of a unit that its source does not confirm."""
    return ", ".join(doubt for lever in each.levers if lever.group == "imu" for doubt in lever.doubts)


def _difference(each: LeverSet, more: LeverSet) -> str:
    """The levers of a greater set that are not those of the lesser."""
    had = {lever.name for lever in each.levers}
    return " and ".join(lever.name for lever in more.levers if lever.name not in had)


def alone_table(design: Design, answer: Closing, key: str = "alone") -> TableBlock:
    """Each lever by itself: what it makes of the worst requirement, and why that is not enough."""
    today = number(answer.today.worst_ratio)
    rows: list[Row] = []
    for group in GROUPS:
        members = [each for each in answer.alone if each.lever.group == group]
        if members:
            rows.append((GROUP_WORDS[group],))
        rows += (
            (each.lever.name, f"{today} → {number(each.set.worst_ratio)} ×", _sentence(each.because) or "✓ closes")
            for each in sorted(members, key=lambda each: each.set.worst_ratio)
        )
    return table(
        key,
        f"Each lever alone{before_flight(design)}: the worst requirement, value over limit",
        (Column("Lever", width=1.2), Column("Today → with it", numeric=True), Column("Why not enough", width=1.6)),
        rows,
    )


def value_ways(design: Design, solutions: Iterable[Solution]) -> tuple[Way, ...]:
    """The inputs of which a value closes the design, each at its largest."""
    offers = ((solution, offer(design, solution)) for solution in solutions)
    return tuple(
        Way(
            offered.changes,
            offered.written,
            str(declaration_of(offered.key).label),
            f"at most {input_in_words(design, offered.key, offered.value, given=False)}",
            input_in_words(design, offered.key, solution.current),
            f"limited by {figure_in_sentence(solution.together.binding)}{_image(design, offered, solution.current)}",
        )
        for solution, offered in offers
        if offered is not None
    )


def largest_values(design: Design) -> tuple[Way, ...]:
    """`value_ways` of a design with requirements, for a worker: some hundred milliseconds."""
    return value_ways(design, solve(design, verify=False))


def _image(design: Design, offered: Offer, now: float) -> str:
    """A sentence on what a shorter aperture makes of the image."""
    if offered.key != "radar.aperture_time" or offered.value >= now:
        return ""
    return f"; coarser image, {number(resolution_for(design, offered.value))} m"


def ways_table(budget: Budget, ways: Sequence[Way]) -> TableBlock:
    """The values that close a design, or the largest that leave it closing; the value of a row is its text."""
    if flown_names(budget.design):
        what = "Each of these alone meets what a straight leg judges; the flight is computed once it is applied"
    elif budget.verdict.closes:
        what = "Largest values that still close, one at a time"
    else:
        what = "Each of these alone closes the design"
    return table(
        "ways",
        f"{what}. Click one to apply it; you can undo.",
        ("Change", "From", "Why"),
        ((Cell(way.text, value=way.text), way.now, way.why) for way in ways),
        "Values are solved with the other inputs fixed, rounded down to three digits, and checked by running the "
        "budget again.",
    )


def closing_options(choice: str, offers: Offers) -> dict[str, Any]:
    """Arguments of `closing_sets` for a choice of what may change, as a link has it: "close.changes=velocity,imu".

    Groups that a choice does not name stay. Offers are beside the catalogue's units and receivers.
    """
    texts = dict(parse_qsl(choice))
    options: dict[str, Any] = {}
    if any(offers.values()):
        options |= {
            "imus": {**catalogue("imu"), **offers["imu"]},
            "receivers": {**catalogue("gnss"), **offers["gnss"]},
        }
    if changes := texts.get("close.changes"):
        chosen = set(changes.split(","))
        options["allow"] = [*chosen & set(ASKED_FOR)]
        options["lock"] = [name for name in GROUPS if name not in chosen]
    if (reserve := texts.get("close.reserve", "")).isdecimal():
        options["reserve"] = min(int(reserve), 90) / 100
    return options


def closing_block(budget: Budget, answer: Closing, *, buttons: bool = True) -> Block:
    """The first sets, with a button each, or the nearest in words.

    Parameters
    ----------
    budget : Budget
    answer : Closing
        Of its design.
    buttons : bool
        Whether a set can be pressed.
    """
    if answer.sets:
        return sets_table(budget.design, answer.sets[:SHORT], buttons=buttons)
    return Text(" ".join((f"{closing_answer(budget, answer).word.lstrip('✗ ')}.", *_nearest(budget, answer))))
