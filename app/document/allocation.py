"""What each source may take of a limit, as blocks for page and report."""

import math
from collections.abc import Sequence
from contextlib import suppress

from app.document.blocks import Table, Text, numbers, table
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
    try:
        found = allocate(budget, check.name)
    except InputError as error:
        return Text(f"Allocation of {check.label}: {error}")
    said = outcome(found, check, budget.design.allocation or Allotment())
    locked = {printable(entry.source) for entry in found.entries if entry.locked}
    return table(
        f"{key}-allocation-{budget.verdict.checks.index(check)}",
        f"Allocation of {printable(check.label)}",
        (("Source", 1.5), *numbers("Allocated", "Estimated", "Margin"), "Owner"),
        (
            (f"{source}, locked" if source in locked else source, *rest)
            for source, *rest in (row.values() for row in entry_texts(found, check.dimension))
        ),
        f"{said} Random entries combine in quadrature, systematic ones linearly.",
    )


def owners_table(budgets: Sequence[Budget], labels: Sequence[str]) -> Table | Text:
    """Who answers for each source of each requirement, and what it may take in each design."""
    cells: dict[tuple[str, str], dict[int, str]] = {}
    owners: dict[tuple[str, str], dict[str, None]] = {}
    for place, budget in enumerate(budgets):
        for check in budget.verdict.checks:
            with suppress(InputError):  # a lock of a source that is gone, which the report says
                for row in entry_texts(allocate(budget, check.name), check.dimension):
                    key = printable(check.label), row["source"]
                    cells.setdefault(key, {})[place] = f"{row['allocated']} ({row['estimated']})"
                    owners.setdefault(key, {})[row["owner"]] = None
    if not cells:
        return Text(NOTHING)
    return table(
        "review-owners",
        "What each source may take, and its estimate in brackets",
        (("Requirement", 1.4), ("Source", 1.4), "Owner", *numbers(*labels)),
        (
            (*key, ", ".join(owners[key]), *(texts.get(place, NONE) for place in range(len(budgets))))
            for key, texts in cells.items()
        ),
        "Several owners: the designs name different ones.",
    )
