"""What each source may take of a limit, as blocks for page and report."""

from __future__ import annotations

import math

from app.document.blocks import Cell, Column, Table, Text
from app.document.numbers import NONE, decibels, percent, show, signed_percent
from app.document.wording import printable
from nav_model.base.errors import InputError
from nav_model.budget import Budget
from nav_model.budget.allocation import Allocation, allocate
from nav_model.budget.result import Check
from nav_model.design.own import Allotment

NOTHING = "The design has no requirement, so there is nothing to allocate."
SPLIT_WORDS = {
    "shares": "in proportion to today's shares",
    "equal": "equal values",
    "cheapest": "smallest relative changes",
}


def told(value: float, dimension: str) -> str:
    """A value of a figure; a level in decibels."""
    if dimension == "level":
        return decibels(20 * math.log10(value)) if value else NONE
    return show(value, dimension)


def entry_texts(found: Allocation, dimension: str) -> list[dict[str, str]]:
    """Each entry as texts, the largest of today first."""
    return [
        {
            "source": printable(entry.source),
            "allocated": told(entry.allocated, dimension),
            "estimated": told(entry.estimated, dimension),
            "margin": NONE if entry.margin is None else signed_percent(entry.margin),
            "owner": printable(entry.owner) or NONE,
        }
        for entry in sorted(found.entries, key=lambda entry: -entry.estimated)
    ]


def outcome(found: Allocation, check: Check, plan: Allotment) -> str:
    """Whether the entries fit, and how they were split."""
    whole = f"{check.label}: limit {told(found.limit, check.dimension)}, reserve {percent(found.reserve)}"
    if found.closes:
        return f"{whole}. The allocation closes: {SPLIT_WORDS[plan.split]}."
    return f"{whole}. The allocation does not close: {', '.join(found.blocked_by)} locked too high."


def allocation_table(budget: Budget, check: Check, key: str) -> Table | Text:
    """The allocation of one requirement, as the design says."""
    plan = budget.design.allocation or Allotment()
    try:
        found = allocate(budget, check.name)
    except InputError as error:
        return Text(f"Allocation of {check.label}: {error}")
    locked = {entry.source for entry in found.entries if entry.locked}
    return Table(
        f"{key}-allocation-{budget.verdict.checks.index(check)}",
        f"Allocation of {check.label}",
        (
            Column("Source", width=1.5),
            Column("Allocated", numeric=True),
            Column("Estimated", numeric=True),
            Column("Margin", numeric=True),
            Column("Owner"),
        ),
        tuple(
            (Cell(f"{row['source']}, locked" if row["source"] in locked else row["source"]),
             *(Cell(row[name]) for name in ("allocated", "estimated", "margin", "owner")))
            for row in entry_texts(found, check.dimension)
        ),
        f"{outcome(found, check, plan)} Random entries combine in quadrature, systematic ones linearly.",
    )  # fmt: skip
