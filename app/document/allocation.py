"""Allowances of the sources in a limit, as blocks for page and report."""

from collections.abc import Sequence
from contextlib import suppress

from app.document.blocks import TableBlock, Text, numbers, table
from app.document.numbers import NONE, number, percent, signed_percent
from app.document.verdict import check_quantity
from app.document.wording import printable
from nav_model.base.errors import InputError
from nav_model.budget import Budget
from nav_model.budget.allocation import Allocation, allocate
from nav_model.budget.verdict import Check
from nav_model.design import Design
from nav_model.design.user_entries import Allotment

SPLIT_WORDS = {
    "shares": "by today's shares",
    "equal": "equal values",
    "cheapest": "smallest relative changes",
}


def entry_texts(design: Design, check: Check, allocation: Allocation) -> list[dict[str, str]]:
    """Each entry as texts, the largest of today first."""
    return [
        {
            "source": printable(entry.source),
            "allocated": check_quantity(check, entry.allocated),
            "estimated": check_quantity(check, entry.estimated),
            "margin": NONE
            if entry.margin is None
            else signed_percent(entry.margin).replace("the limit", "allocated"),
            "owner": printable(entry.owner) or NONE,
        }
        for entry in sorted(allocation.entries, key=lambda entry: -entry.estimated)
    ]


def outcome(design: Design, check: Check, allocation: Allocation) -> str:
    """A sentence on whether the entries fit, and how they were split."""
    limit = check_quantity(check, allocation.limit, given=True)
    split = check_quantity(check, allocation.limit * (1 - allocation.reserve))
    whole = f"{check.label}: limit {limit}, reserve {percent(allocation.reserve)}, allocated {split} in all"
    if allocation.closes:
        plan = design.allocation or Allotment()
        value = check_quantity(check, check.value)
        excess = ", within the limit" if check.met else f", {number(check.value / allocation.limit)} × the limit"
        return f"{whole}. Split: {SPLIT_WORDS[plan.split]}. Estimated {value}{excess}."
    return f"{whole}. Does not fit: {', '.join(allocation.blocked_by)} locked too high."


def allocation_table(budget: Budget, check: Check, key: str) -> TableBlock | Text:
    """The allocation of one requirement, as the design says."""
    try:
        split = allocate(budget, check.name)
    except InputError as error:
        return Text(f"Allocation of {printable(check.label)}: {error.reason}")
    locked = {printable(entry.source) for entry in split.entries if entry.locked}
    return table(
        f"{key}-allocation-{budget.straight_leg().checks.index(check)}",
        f"Allocation of {printable(check.label)}",
        (("Source", 1.5), *numbers("Allocated", "Estimated", "Margin"), ("Owner", 1)),
        (
            (f"{source}, locked" if source in locked else source, *rest)
            for source, *rest in (row.values() for row in entry_texts(budget.design, check, split))
        ),
        f"{outcome(budget.design, check, split)} Random entries combine in quadrature, systematic ones linearly.",
    )


def owners_table(budgets: Sequence[Budget], labels: Sequence[str]) -> TableBlock | Text:
    """Who answers for each source of each requirement, and what it may take in each design."""
    cells: dict[tuple[str, str], dict[int, str]] = {}
    owners: dict[tuple[str, str], dict[str, None]] = {}
    for place, budget in enumerate(budgets):
        for check in budget.straight_leg().checks:
            with suppress(InputError):  # a lock of a source that is gone, which the report says
                for row in entry_texts(budget.design, check, allocate(budget, check.name)):
                    key = printable(check.label), row["source"]
                    cells.setdefault(key, {})[place] = f"{row['allocated']} ({row['estimated']})"
                    owners.setdefault(key, {})[row["owner"]] = None
    if not cells:
        return Text("No requirement has an allocation.")
    return table(
        "review-owners",
        "What each source may take, and its estimate in brackets",
        (("Requirement", 1.4), ("Source", 1.4), ("Owner", 1), *numbers(*labels)),
        (
            (*key, ", ".join(owners[key]), *(texts.get(place, NONE) for place in range(len(budgets))))
            for key, texts in cells.items()
        ),
        "Several owners: the designs name different ones.",
    )
