"""How the report says things: quantities, shares, titles, the verdict."""

from __future__ import annotations

import unicodedata
from collections.abc import Mapping

from app.document.blocks import Answer
from app.document.numbers import percent, show_in, signed_percent
from nav_model.budget import Budget
from nav_model.design import Design
from nav_model.design.parts import declaration_of

AFTER_AUTOFOCUS = {1: "a line", 2: "a quadratic", 3: "a cubic"}
"""What is removed from the phase before its residual is measured, by the order of the autofocus."""


def requirement_key(check: str) -> str:
    """Dotted key of the requirement behind a check or figure."""
    return f"requirements.{'quadratic_phase' if check.startswith('along') else check}"


def requirement_quantity(design: Design, check: str, value: float) -> str:
    """A value [SI] in the unit its requirement is written in."""
    key = requirement_key(check)
    return show_in(value, design.unit(key), declaration_of(key).dimension)


def best_of(shares: Mapping[str, float]) -> tuple[str, float]:
    """The largest share and its source."""
    source = max(shares, key=lambda name: shares[name])
    return source, shares[source]


def title_of(design: Design) -> str:
    """What a design is called."""
    return printable(design.name).strip() or "Untitled design"


def printable(text: str) -> str:
    """A text without control characters and byte-order marks, which no face can show; line breaks stay."""
    kept = (" " if unicodedata.category(sign) == "Cc" and sign != "\n" else sign for sign in text)
    return "".join(kept).replace("\ufeff", "")


def shortened(name: str, length: int = 70) -> str:
    """A name that fits the head of a page."""
    return name if len(name) <= length else f"{name[: length - 1].rstrip()}…"


def labelled(label: str, name: str) -> str:
    """A name with its label in a comparison."""
    return f"{label}: {name}" if label else name


def design_labels(count: int) -> list[str]:
    """What designs are called beside one another; one alone has no label."""
    return [""] if count == 1 else [f"D{i}" for i in range(1, count + 1)]


def chapter_key(label: str) -> str:
    """What the keys of a design's sections begin with; its label is empty for one design alone."""
    return label.lower() or "d"


def verdict_of(budget: Budget) -> Answer:
    """The verdict: closes or not, at which confidence, what is tightest and what dominates it."""
    verdict, design = budget.verdict, budget.design
    tightest = verdict.tightest
    if tightest is None:
        return Answer("Not checked", "open", ("The design states no requirement, so there is nothing to check.",))
    failed = sum(not check.met for check in verdict.checks)
    count = len(verdict.checks)
    if failed:
        met = f"{failed} of {count} requirements {'is' if failed == 1 else 'are'} not met"
    else:
        met = f"all {count} requirements are met" if count > 1 else "its one requirement is met"
    value, limit = (requirement_quantity(design, tightest.name, x) for x in (tightest.value, tightest.limit))
    through = "" if tightest.dominant == tightest.sensor else f", mostly through {tightest.dominant}"
    return Answer(
        "✓ Closes" if verdict.closes else "✗ Does not close",
        "good" if verdict.closes else "bad",
        (
            f"At {verdict.confidence:g}σ {met}.",
            f"Tightest: {tightest.label.lower()}, {value} against {limit}, margin {signed_percent(tightest.margin)}.",
            f"Dominated by {tightest.sensor}: {percent(tightest.sensor_share)} of the variance{through}.",
        ),
    )
