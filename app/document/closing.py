"""Changes that would close a design, one at a time: a table with a button in each row."""

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from app.document.blocks import Cell, TableBlock, table
from app.document.numbers import number
from app.document.verdict import check_quantity
from app.document.wording import input_in_words
from nav_model.budget import Budget
from nav_model.budget.verdict import flown_names
from nav_model.design import Design, Value
from nav_model.design.declaration import in_sentence
from nav_model.design.figures import figure_in_sentence
from nav_model.design.parts import declaration_of
from nav_model.explore.solve import SOLVED, Offer, Solution, offer, resolution_for
from nav_model.explore.trade_map import closing_pairs

_PAIRS = 3  # that are named


class Way(NamedTuple):
    """One way to close a design: its changes [SI], their units, and its texts."""

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


def _image(design: Design, offered: Offer, now: float) -> str:
    """A sentence on what a shorter aperture makes of the image."""
    if offered.key != "radar.aperture_time" or offered.value >= now:
        return ""
    return f"; coarser image, {number(resolution_for(design, offered.value))} m"


def beyond_one(budget: Budget) -> str:
    """Advice where no single input of `SOLVED` closes a design: two of which the map has a place that does;
    where there is no such pair, the contributors that exceed a limit without the model, by name."""
    design = budget.design
    keys = [key for key in SOLVED if key == "radar.aperture_time" or design[key] is not None]
    if pairs := closing_pairs(design, keys)[:_PAIRS]:
        names = "; ".join(" and ".join(in_sentence(declaration_of(key).label) for key in pair) for pair in pairs)
        return f"Change two inputs together, on “Trade-off map”: {names}."
    sentences = ["No two of these inputs together close it either."]
    for check in budget.straight_leg().checks:
        figure = budget.figure(check.on)
        alone = (check.confidence or 1.0) * figure.around(0.0).sigma
        if alone > check.limit:
            value, limit = (check_quantity(check, size) for size in (alone, check.limit))
            names = " and ".join(part.name for part in figure.parts)
            sentences.append(f"{names} alone: {value} of {limit} for {figure_in_sentence(check.name)}.")
    return " ".join(sentences)


def ways_table(budget: Budget, ways: Sequence[Way]) -> TableBlock:
    """The ways to close a design, or the largest values that leave it closing; the value of a row is its text."""
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
