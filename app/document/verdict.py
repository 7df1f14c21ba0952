"""Verdicts and their checks in words, for pages, reports, the command and the library."""

from contextlib import suppress
from typing import NamedTuple

from app.document.blocks import Answer, Cell
from app.document.display import AS_REQUIRED, SI, Display
from app.document.numbers import margin_in_sentence, margin_in_short, percent, show_in, signed_percent
from app.document.wording import MOMENTS
from nav_model.base.errors import InputError
from nav_model.budget import Budget
from nav_model.budget.verdict import Check, Verdict, required
from nav_model.design import Design
from nav_model.design.figures import figure_in_sentence
from nav_model.design.processing import POST_PROCESSED, REAL_TIME
from nav_model.processing.paired_echo import NOTHING

SAID = {REAL_TIME: "in real time", POST_PROCESSED: "post-processed"}
"""A processing as a sentence says it."""


class CheckWords(NamedTuple):
    """A check in words: value and limit in the unit the limit is written in, margin, share of its dominant sensor,
    and which of the model's figures is checked, with its equation."""

    value: str
    limit: str
    margin: str
    share: str
    figure: str


_FIGURES = MOMENTS | {"refined": "with Schuler and Coriolis terms"}


def judged(verdict: Verdict) -> str:
    """How a verdict is reached: "at 2σ in real time"."""
    return f"at {verdict.confidence:g}σ {SAID[verdict.processing]}"


def check_words(design: Design, check: Check) -> CheckWords:
    """A check of a design's budget in words."""
    value, limit = check_quantity(design, check, check.value), check_quantity(design, check, check.limit, given=True)
    figure = f"{_FIGURES.get(check.basis, check.basis)} {check.equation}".strip()
    if check.confidence not in (None, design.requirements.confidence):
        figure += f", at {check.confidence:g}σ"
    return CheckWords(value, limit, signed_percent(check.margin), percent(check.sensor_share), figure)


def displayed_check(design: Design, check: Check, display: Display) -> tuple[str, str, str]:
    """Value and limit of a check as they are shown: both at the spread of the display, the limit scaled to it; and
    that spread, as in " at 95 %", empty for what has none. As required, both are those that are compared."""
    pair = "horizontal" in check.on
    factor = display.factor(pair=pair) / check.confidence if check.confidence and not display.required else 1.0

    def text_of(value: float, *, given: bool = False) -> str:
        if display.units == SI and check.dimension != "level":
            return display.in_si(value, check.dimension, given=given)
        return check_quantity(design, check, value, given=given)

    spread = f"{check.confidence:g}σ" if display.required and check.confidence else display.named(pair=pair)
    at = "" if check.confidence is None else f" at {spread}"
    return text_of(factor * check.value), text_of(factor * check.limit, given=True), at


def met_cell(check: Check) -> Cell:
    """Whether a requirement is met, as a cell of a table."""
    return Cell("✓ met", tone="good") if check.met else Cell("✗ not met", tone="bad")


def check_quantity(design: Design, check: Check, value: float, *, given: bool = False) -> str:
    """A value [SI] of a check in the unit its requirement is written in.

    The along-track phase has the unit of the quadratic phase, whose limit applies to it.
    """
    if check.dimension == "level" and value <= NOTHING:
        return "none"
    return show_in(value, required(design)[check.name].unit, check.dimension, given=given)


def verdict_of(budget: Budget) -> Answer:
    """The verdict: closes or not, at which confidence, what is tightest and what dominates it."""
    verdict, design = budget.verdict, budget.design
    tightest = verdict.tightest
    if tightest is None and verdict.elsewhere:
        return Answer(*_word_and_tone(verdict), judged_elsewhere(verdict))
    if tightest is None:
        largest = max(budget.phase_lines(REAL_TIME), key=lambda line: line.share)
        return Answer(
            "Not checked",
            "open",
            (
                "The design has no requirement, so there is no verdict. Enter a limit under Requirements.",
                f"Main source of quadratic phase: {largest.source}, {percent(largest.share)} of the variance.",
            ),
        )
    failed = sum(not check.met for check in verdict.checks)
    count = len(verdict.checks)
    if failed:
        met = f"{failed} of {count} requirements {'is' if failed == 1 else 'are'} not met"
    else:
        met = f"all {count} requirements are met" if count > 1 else "its one requirement is met"
    words, name = check_words(design, tightest), figure_in_sentence(tightest.name)
    return Answer(
        *_word_and_tone(verdict),
        (
            f"{judged(verdict).capitalize()}, {met}.",
            f"Tightest: {name}, {words.value} against {words.limit}, {margin_in_sentence(tightest.margin)}.",
            f"Main error source: {tightest.sensor}, {words.share} of the variance{_through(tightest)}.",
            *judged_elsewhere(verdict),
        ),
    )


def judged_elsewhere(verdict: Verdict) -> tuple[str, ...]:
    """Which requirements are judged along a flight alone, in a sentence if there are any."""
    names = ", ".join(map(figure_in_sentence, verdict.elsewhere))
    return (f"Judged along a flight only, on the Flight page: {names}.",) if names else ()


def _through(check: Check) -> str:
    """Where the main sensor's error enters, if that is a source with a name of its own, such as the initial tilt."""
    return "" if check.dominant == check.sensor else f", mostly through {check.dominant}"


def _word_and_tone(verdict: Verdict) -> tuple[str, str]:
    if verdict.elsewhere and verdict.met:
        return "Judged on Flight", "open"
    return ("✓ Closes", "good") if verdict.closes else ("✗ Does not close", "bad")


def verdict_strip(budget: Budget, display: Display = AS_REQUIRED) -> Answer:
    """The verdict in one line: the tightest requirement, shown like the figures below it, and what dominates it."""
    tightest = budget.verdict.tightest
    if budget.verdict.elsewhere and budget.verdict.met:
        return Answer(*_word_and_tone(budget.verdict), judged_elsewhere(budget.verdict))
    if tightest is None:
        largest = max(budget.phase_lines(REAL_TIME), key=lambda line: line.share)
        why = f"Quadratic phase: {percent(largest.share)} from {largest.source}. Set a requirement to get a verdict."
        return Answer("Not checked", "open", (why,))
    value, limit, at = displayed_check(budget.design, tightest, display.of(budget.design))
    share = percent(tightest.sensor_share)
    return Answer(
        *_word_and_tone(budget.verdict),
        (f"{tightest.label} {value}, limit {limit}{at}; {share} from {tightest.sensor}{_through(tightest)}.",),
        "A design closes when every requirement is met.",
    )


def verdicts_in_short(budget: Budget, *, both: bool = True) -> dict[str, str]:
    """Real time and post-processed, each with its mark and its least margin, as a switch names them -> the mode.

    Without ``both`` the margin of the processing that is not the design's, which takes longer, is left open.
    """
    tightest, chosen = budget.verdict.tightest, budget.verdict.processing
    margins = {chosen: None if tightest is None else tightest.margin}
    if both:
        with suppress(InputError):  # no figures come of it; the current design has some
            other = budget.other_verdict
            margins[other.processing] = None if other.tightest is None else other.tightest.margin

    def label(mode: str) -> str:
        name, margin = mode[:1].upper() + mode[1:], margins.get(mode)
        if not both and mode != chosen:
            return f"{name} …"
        return name if margin is None else f"{name} {margin_in_short(margin)}"

    return {label(mode): mode for mode in (REAL_TIME, POST_PROCESSED)}
