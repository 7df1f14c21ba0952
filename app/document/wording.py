"""How the report says things: quantities, shares, titles, the verdict."""

from __future__ import annotations

import math
import unicodedata
from collections.abc import Mapping

from nav_model.budget import Budget
from nav_model.design import Design
from nav_model.design.parts import declaration_of
from nav_model.sar.geometry import phase_to_metres
from nav_model.units import format_quantity, plain_number

DIGITS = 4


def number(value: float, digits: int = DIGITS) -> str:
    """A number to `digits` significant digits, with a minus sign."""
    return plain_number(float(value), digits).replace("-", "−")


def percent(share: float) -> str:
    """A share in percent, to a tenth below ten."""
    value = 100 * share
    if 0 < value < 0.05:
        return "< 0.1 %"
    return f"{value:.1f} %" if 0 < value < 9.95 else f"{value:.0f} %"


def signed_percent(margin: float) -> str:
    """A margin in percent with its sign."""
    value = 100 * margin
    return f"{value:+.1f} %".replace("-", "−") if abs(value) < 1e5 else f"{number(value, 3)} %"


def degrees(phase: float) -> str:
    """A phase [rad] as a number of degrees."""
    return number(math.degrees(phase))


def millimetres(phase: float, wavelength: float) -> str:
    """A phase [rad] as a number of millimetres along the line of sight."""
    return number(1000 * float(phase_to_metres(phase, wavelength)))


def requirement_key(check: str) -> str:
    """Dotted key of the requirement behind a check or figure."""
    return f"requirements.{'quadratic_phase' if check.startswith('along') else check}"


def requirement_quantity(design: Design, check: str, value: float) -> str:
    """A value [SI] in the unit its requirement is written in."""
    key = requirement_key(check)
    return format_quantity(value, design.unit(key), declaration_of(key).dimension, DIGITS)


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


def verdict_of(budget: Budget) -> tuple[str, str, str]:
    """The verdict in a word, how it is set, and in a sentence."""
    verdict, design = budget.verdict, budget.design
    tightest = verdict.tightest
    if tightest is None:
        return "Not checked", "warn", "The design states no requirement, so there is nothing it could fail."
    failed = [check for check in verdict.checks if not check.met]
    count = len(verdict.checks)
    of_all = (
        (f"all {count} requirements are met" if count > 1 else "its one requirement is met")
        if not failed
        else f"{len(failed)} of {count} requirements {'is' if len(failed) == 1 else 'are'} not met"
    )
    value, limit = (requirement_quantity(design, tightest.name, x) for x in (tightest.value, tightest.limit))
    sentence = (
        f"At {verdict.confidence:g}σ {of_all}. Tightest: {tightest.label.lower()}, {value} against {limit}, "
        f"margin {signed_percent(tightest.margin)}; {tightest.sensor} makes {percent(tightest.sensor_share)} "
        "of its variance."
    )
    return ("✓ Closes", "good", sentence) if verdict.closes else ("✗ Does not close", "bad", sentence)
