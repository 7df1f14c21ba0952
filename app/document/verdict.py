"""Verdicts and their checks in words, for pages, reports, the command and the library."""

import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from typing import NamedTuple

from app.document.blocks import Answer, Cell
from app.document.display import AS_REQUIRED, SI, Display
from app.document.numbers import NONE, margin_in_sentence, margin_in_short, percent, show_in, signed_percent
from app.document.wording import MOMENTS, printable
from nav_model.base.errors import InputError
from nav_model.budget import Budget
from nav_model.budget.verdict import STRAIGHT_LEG, WHOLE_FLIGHT, Check, Verdict, flown_names
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
    """Basis of a verdict: "at 2σ in real time"."""
    return f"at {verdict.confidence:g}σ {SAID[verdict.processing]}"


def check_words(design: Design, check: Check) -> CheckWords:
    """A check of a design's budget in words."""
    value, limit = check_quantity(check, check.value), check_quantity(check, check.limit, given=True)
    figure = f"{_FIGURES.get(check.basis, check.basis)} {check.equation}".strip()
    if check.confidence not in (None, design.requirements.confidence):
        figure += f", at {check.confidence:g}σ"
    if not check.known:
        figure = check.reason
    elif check.judged != STRAIGHT_LEG:
        figure = f"on {printable(check.judged)}, {figure}" if check.judged != WHOLE_FLIGHT else figure
        if check.straight is not None:
            figure += f"; straight leg {check_quantity(check, check.straight)}"
    margin = signed_percent(check.margin) if check.known else NONE
    return CheckWords(value, limit, margin, percent(check.dominant_share) if check.shares else NONE, figure)


def displayed_check(design: Design, check: Check, display: Display) -> tuple[str, str, str, str]:
    """Value and limit of a check as they are shown: both at the spread of the display, the limit scaled to it; that
    spread, as in " at 95 %", empty for what has none; and the straight leg's value beside that of a flight, in words,
    empty without any. As required, all are those that are compared."""
    pair = "horizontal" in check.on
    factor = display.factor(pair=pair) / check.confidence if check.confidence and not display.required else 1.0

    def text_of(value: float, *, given: bool = False) -> str:
        if display.units == SI and check.dimension != "level":
            return display.in_si(value, check.dimension, given=given)
        return check_quantity(check, value, given=given)

    spread = f"{check.confidence:g}σ" if display.required and check.confidence else display.named(pair=pair)
    at = "" if check.confidence is None else f" at {spread}"
    beside = "" if check.straight is None else f"straight leg {text_of(factor * check.straight)}"
    return text_of(factor * check.value), text_of(factor * check.limit, given=True), at, beside


_MET: Mapping[str, Cell] = {
    "met": Cell("✓ met", tone="good"),
    "not met": Cell("✗ not met", tone="bad"),
    "open": Cell("open", tone="quiet"),
    "refused": Cell("refused", tone="warn"),
}


def met_cell(check: Check, verdict: Verdict) -> Cell:
    """The state of a requirement, as a cell of a table; green where nothing of the verdict fails or is open."""
    cell = _MET[check.state]
    return replace(cell, tone="") if check.met and not verdict.closes else cell


def closes_cell(verdict: Verdict) -> Cell:
    """The state of a verdict, as a cell of a table."""
    if verdict.state == "open":
        return Cell(_open_words(verdict), tone="quiet")
    return Cell("✓ closes", tone="good") if verdict.closes else Cell("✗ does not close", tone="bad")


def check_quantity(check: Check, value: float, *, given: bool = False) -> str:
    """A value [SI] of a check in the unit its requirement is written in; a dash for none."""
    if math.isnan(value):
        return NONE
    if check.dimension == "level" and value <= NOTHING:
        return "none"
    return show_in(value, check.unit, check.dimension, given=given)


def verdict_of(budget: Budget) -> Answer:
    """The verdict: closes or not, at which confidence, what is tightest and what dominates it."""
    verdict, design = budget.verdict, budget.design
    tightest = verdict.tightest
    if not verdict.checks:
        largest = max(budget.phase_lines(REAL_TIME), key=lambda line: line.share)
        return Answer(
            "Not checked",
            "open",
            (
                "The design has no requirement, so there is no verdict. Enter a limit under Requirements.",
                f"Main source of quadratic phase: {largest.source}, {percent(largest.share)} of the variance.",
            ),
        )
    sentences = [f"{judged(verdict).capitalize()}, {count_words(verdict)}."]
    if tightest is not None:
        words, name = check_words(design, tightest), figure_in_sentence(tightest.name)
        sentences += [
            f"Tightest: {name}{where_judged(tightest)}, {words.value} against {words.limit}, "
            f"{margin_in_sentence(tightest.margin)}.",
            f"Main error source: {tightest.dominant}, {words.share} of the variance.",
        ]
    return Answer(*_word_and_tone(verdict), tuple(sentences))


def count_words(verdict: Verdict) -> str:
    """Requirements in words, how many are met, and which fail, are open or refused: "6 of 7 requirements met; heading
    fails on L1 (0.105°, limit 0.05°)"."""
    count, met = len(verdict.checks), sum(check.met for check in verdict.checks)
    if met == count:
        return f"all {count} requirements are met" if count > 1 else "its one requirement is met"
    failing = sorted((check for check in verdict.checks if check.state == "not met"), key=lambda check: check.margin)
    texts = [
        f"{figure_in_sentence(check.name)} fails{where_judged(check)} ({check_quantity(check, check.value)}, limit "
        f"{check_quantity(check, check.limit, given=True)})"
        for check in failing
    ]
    refused = [check for check in verdict.checks if check.state == "refused"]
    texts += [f"{figure_in_sentence(check.name)} is refused: {printable(check.reason)}" for check in refused]
    if any(check.state == "open" for check in verdict.checks):
        texts.append(_open_words(verdict))
    return "; ".join((f"{met} of {count} requirement{'' if count == 1 else 's'} met", *texts))


def _count_open(verdict: Verdict) -> str:
    """Count of the requirements that are met, and those that are open: "1 of 7 requirements met; heading is open"."""
    count, met, names = len(verdict.checks), sum(check.met for check in verdict.checks), verdict.open
    rest = f"{figure_in_sentence(names[0])} is" if len(names) == 1 else f"{len(names)} are"
    return f"{met} of {count} requirement{'' if count == 1 else 's'} met; {rest} open"


def _open_words(verdict: Verdict) -> str:
    """Words on what is not known yet: "open: heading is judged along the flight"."""
    names = [figure_in_sentence(check.name) for check in verdict.checks if check.state == "open"]
    if not names:
        return f"refused: {', '.join(figure_in_sentence(name) for name in verdict.open)}"
    *others, last = names
    verb = f"{', '.join(others)} and {last} are" if others else f"{last} is"
    return f"open: {verb} judged along the flight"


def tightest_words(verdict: Verdict) -> str:
    """The least margin of what is known, after a semicolon; empty without any."""
    if (tightest := verdict.tightest) is None:
        return ""
    name = f"{figure_in_sentence(tightest.name)}{where_judged(tightest)}"
    return f"; tightest {name}, {margin_in_sentence(tightest.margin)}"


def open_words(verdict: Verdict) -> str:
    """Requirements that are open or refused, by name, after a semicolon; empty without any."""
    return f"; open: {', '.join(map(figure_in_sentence, verdict.open))}" if verdict.open else ""


def verdict_along(verdict: Verdict) -> Answer:
    """A verdict with what fails where: "6 of 7 requirements met; heading fails on L1 (0.105°, limit 0.05°)"."""
    if not verdict.checks:
        return Answer("Not checked", "open", ("The design has no requirement.",))
    return Answer(*_word_and_tone(verdict), (f"{judged(verdict).capitalize()}, {count_words(verdict)}.",))


def before_flight(design: Design) -> str:
    """Words after what a straight leg judges, where the flight decides too; else empty."""
    return ", before the flight" if flown_names(design) else ""


def where_judged(check: Check) -> str:
    """On which line a check was judged, after its name; empty on the straight leg."""
    if check.judged == STRAIGHT_LEG:
        return ""
    return " along the flight" if check.judged == WHOLE_FLIGHT else f" on {printable(check.judged)}"


def _word_and_tone(verdict: Verdict) -> tuple[str, str]:
    return {"closes": ("✓ Closes", "good"), "fails": ("✗ Does not close", "bad"), "open": ("Open", "open")}[
        verdict.state
    ]


def verdict_strip(budget: Budget, display: Display = AS_REQUIRED) -> Answer:
    """The verdict in one line: the tightest requirement, shown like the figures below it, and what dominates it."""
    tightest = budget.verdict.tightest
    if budget.verdict.state == "open":
        return Answer(*_word_and_tone(budget.verdict), (f"{_count_open(budget.verdict)}.",))
    if tightest is None:
        largest = max(budget.phase_lines(REAL_TIME), key=lambda line: line.share)
        why = f"Quadratic phase: {percent(largest.share)} from {largest.source}. Set a requirement to get a verdict."
        return Answer("Not checked", "open", (why,))
    value, limit, at, _ = displayed_check(budget.design, tightest, display.of(budget.design))
    share = percent(tightest.dominant_share)
    where = f"{where_judged(tightest)}:" if tightest.judged != STRAIGHT_LEG else ""
    return Answer(
        *_word_and_tone(budget.verdict),
        (f"{tightest.label}{where} {value}, limit {limit}{at}; {share} from {tightest.dominant}.",),
        "A design closes when every requirement is met.",
    )


def verdicts_in_short(budget: Budget, *, both: bool = True) -> dict[str, str]:
    """Real time and post-processed, each with its mark and its least margin, as a switch names them -> the mode.

    Without ``both`` the margin of the processing that is not the design's, which takes longer, is left open.
    """
    chosen = budget.verdict.processing
    margins = {chosen: _least(budget.verdict)}
    if both:
        with suppress(InputError):  # no figures come of it; the current design has some
            other = budget.other_verdict
            margins[other.processing] = _least(other)

    def label(mode: str) -> str:
        name, margin = mode[:1].upper() + mode[1:], margins.get(mode)
        if not both and mode != chosen:
            return f"{name} …"
        return name if margin is None else f"{name} {margin_in_short(margin)}"

    return {label(mode): mode for mode in (REAL_TIME, POST_PROCESSED)}


def _least(verdict: Verdict) -> float | None:
    """The least margin; None without one, and where it may be less once what is open is known."""
    return None if verdict.tightest is None or verdict.state == "open" else verdict.tightest.margin
