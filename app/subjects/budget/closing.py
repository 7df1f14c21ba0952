"""Ways to close a design: values of one input, and units of the catalogue."""

from app.document.blocks import Block, Text
from app.document.closing import Way, beyond_one, value_ways, ways_table
from app.document.numbers import margin_in_sentence
from app.document.wording import preset_name
from nav_model.budget import Budget
from nav_model.budget.verdict import flown_names
from nav_model.design import Design
from nav_model.design.catalogue import catalogue
from nav_model.explore.margins import limits
from nav_model.explore.search import OWN_GNSS, search
from nav_model.explore.solve import solve

_MOST_UNITS = 8


def ways(design: Design) -> tuple[Way, ...]:
    """Largest values of one input that meet every requirement with the others held, then units that do with the
    design's own receiver, or with another where none does, the widest margin first. For a worker: some hundred
    milliseconds."""
    if not limits(design):
        return ()
    return (*value_ways(design, solve(design, verify=False)), *_units(design))


def _units(design: Design) -> tuple[Way, ...]:
    rows = [row for row in search(design, catalogue("imu"), catalogue("gnss")) if row.closes]
    rows = [row for row in rows if row.gnss == OWN_GNSS] or rows
    return tuple(
        Way(
            row.changes,
            row.written,
            "IMU" if row.gnss == OWN_GNSS else "IMU and receiver",
            row.imu if row.gnss == OWN_GNSS else row.pair,
            preset_name(design, "imu"),
            margin_in_sentence(row.margin) + (f"; unverified: {row.doubts[0]}" if row.doubts else ""),
        )
        for row in rows[:_MOST_UNITS]
    )


def ways_block(budget: Budget, single_ways: tuple[Way, ...]) -> Block:
    """The ways as a table with a button in each row."""
    if not budget.straight_leg().checks:
        return Text("Give a limit under Requirements. The values that meet it then appear here.")
    if not single_ways:
        if budget.straight_leg().closes:
            where = " on a straight leg" if flown_names(budget.design) else ""
            return Text(f"Every requirement is met{where}, whatever a single input is.")
        return Text(f"No single input and no unit of the catalogue closes the design. {beyond_one(budget)}")
    return ways_table(budget, single_ways)
