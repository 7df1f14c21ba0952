"""What would close a design, one change at a time: a table with a button in each row."""

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

from app.document.blocks import Cell, Table, table
from app.document.wording import input_in_words
from nav_model.design import Design, Value
from nav_model.design.figures import figure_in_sentence
from nav_model.design.parts import declaration_of
from nav_model.explore.solve import Solution, offer


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
    found = ((solution, offer(design, solution)) for solution in solutions)
    return tuple(
        Way(
            offered.changes,
            offered.written,
            str(declaration_of(offered.key).label),
            f"at most {input_in_words(design, offered.key, offered.value, given=False)}",
            input_in_words(design, offered.key, solution.current),
            f"limited by {figure_in_sentence(solution.together.binding)}",
        )
        for solution, offered in found
        if offered is not None
    )


def ways_table(found: Sequence[Way], *, closes: bool) -> Table:
    """The ways, for a design that ``closes`` already or does not; the value of a row is its text."""
    what = "Largest values that still close, one at a time" if closes else "Each of these alone closes the design"
    return table(
        "ways",
        f"{what}. Click one to apply it; you can undo.",
        ("Change", "From", "Why"),
        ((Cell(way.text, value=way.text), way.now, way.why) for way in found),
        "Values are solved with the other inputs fixed, rounded down to three digits, and checked by running the "
        "budget again.",
    )
