"""Ways to close a design: values of one input, and units of the catalogue, each with a button."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from app.document.blocks import Block, Cell, Column, Table, Text
from app.document.numbers import number, show_in, signed_percent
from app.document.wording import preset_name
from nav_model.base.units import from_si, to_si
from nav_model.budget import Budget
from nav_model.design import Design, Value
from nav_model.design.catalogue import catalogue
from nav_model.design.parts import declaration_of
from nav_model.explore.margins import label_of, limits, quantity
from nav_model.explore.search import OWN_GNSS, search
from nav_model.explore.solve import round_down, solve

_MOST_UNITS = 8


class Way(NamedTuple):
    """One way to close a design: its changes [SI], their units, and its texts."""

    changes: Mapping[str, Value]
    written: Mapping[str, str]
    what: str
    value: str
    now: str
    why: str


def ways(design: Design) -> tuple[Way, ...]:
    """Largest values of one input that meet every requirement with the others held, then units that do with the
    design's own receiver, or with another where none does, the widest margin first. For a worker: some ten
    milliseconds."""
    if not limits(design):
        return ()
    return (*_values(design), *_units(design))


def _values(design: Design) -> tuple[Way, ...]:
    found = []
    for solution in solve(design, verify="together"):
        value, key = solution.together.value, solution.key
        if value is None:
            continue
        dimension = quantity(key).dimension
        unit = design.unit(key) if dimension else ""
        shown = round_down(from_si(value, unit, dimension) if dimension else value)
        taken = to_si(shown, unit, dimension) if dimension else shown
        said = [
            show_in(x, unit, dimension, given=given) if dimension else number(x, given=given)
            for x, given in ((taken, False), (solution.current, True))
        ]
        found.append(
            Way(
                {key: taken},
                {key: unit} if unit else {},
                str(declaration_of(key).label),
                f"at most {said[0]}",
                said[1],
                f"limited by {label_of(solution.together.binding).lower()}",
            )
        )
    return tuple(found)


def _units(design: Design) -> tuple[Way, ...]:
    rows = [row for row in search(design, catalogue("imu"), catalogue("gnss")) if row.closes]
    rows = [row for row in rows if row.gnss == OWN_GNSS] or rows
    return tuple(
        Way(
            row.changes,
            row.written,
            "IMU" if row.gnss == OWN_GNSS else "IMU and receiver",
            row.imu if row.gnss == OWN_GNSS else f"{row.imu} with {row.gnss}",
            preset_name(design, "imu"),
            f"margin {signed_percent(row.margin)}" + (f"; unverified: {row.doubts[0]}" if row.doubts else ""),
        )
        for row in rows[:_MOST_UNITS]
    )


def ways_block(budget: Budget, found: tuple[Way, ...]) -> Block:
    """The ways as a table with a button in each row."""
    if not budget.verdict.checks:
        return Text("Give a limit under Requirements. The values that meet it then appear here.")
    if not found:
        said = "Every requirement is met, whatever a single input is." if budget.verdict.closes else (
            "No single input and no unit of the catalogue closes the design. Change two inputs together: the map on "
            "the Explore page shows which."
        )  # fmt: skip
        return Text(said)
    what = (
        "The design closes, and would with each of these alone."
        if budget.verdict.closes
        else "Each of these alone closes the design."
    )
    return Table(
        "ways",
        f"{what} Press one to take it; Undo takes it back.",
        (Column("Change"), Column("From"), Column("Why")),
        tuple(
            (Cell(f"{way.what}: {way.value}", value=str(i)), Cell(way.now), Cell(way.why))
            for i, way in enumerate(found)
        ),
        choose="button",
    )
