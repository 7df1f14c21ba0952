"""The covariance along a flight as blocks: the verdict, and a table by line."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from app.document.blocks import Answer, Cell, Row, TableBlock, numbers, table
from app.document.numbers import NONE, percent
from app.document.verdict import SAID
from app.subjects.trajectory.figures import FIGURES, show_value
from app.subjects.trajectory.run import Followed
from nav_model.budget.verdict import STRAIGHT_LEG, Verdict
from nav_model.design.figures import figure_in_sentence

if TYPE_CHECKING:
    from nav_model.trajectory.result import LineResult, TrajectoryResult


_MOMENT = "An image's aperture lies within its line. Position, velocity, tilt and heading are"


def verdict(followed: Followed, name: str) -> Answer:
    """Whether the lines, or the flight as a whole, keep the limits; `name` is told where there is no limit."""
    result = followed.result
    processing = result.spec.processing
    others = _beside_flight(followed.verdict)
    if not any(line.limits for line in result.lines):
        values = result.chosen.figures[name]
        values = values[np.isfinite(values)]
        first = (
            f"{FIGURES[name].label} is at most {show_value(name, values.max())}, {processing}." if values.size else ""
        )
        none = "No requirement of the design limits a figure of the flight."
        return Answer("No limit", "bad" if followed.verdict.failing else "open", (first, none, *others))
    failing = [line for line in result.lines if not line.closes]
    lines = len(result.lines)
    if result.spec.lines:
        word = f"{lines - len(failing)} of {lines} line{'' if lines == 1 else 's'} within the limits"
    else:
        word = f"{percent(min(result.lines[0].within.values()))} of the flight within the limits"
    sentences: tuple[str, ...] = ()
    if failing:
        worst = max(failing, key=lambda line: (bool(line.reason), line.excess[1]))
        first = failure(worst)
        sentences = (f"{first[0].upper()}{first[1:]}.",)
    return Answer(
        f"{'✓' if followed.verdict.closes else '✗'} {word} {SAID[processing]}",
        "good" if followed.verdict.closes else "bad",
        (*sentences, *others),
    )


def _beside_flight(verdict: Verdict) -> tuple[str, ...]:
    """What does not depend on the flight, as a sentence: what is not met, else that all of it is."""
    checks = [check for check in verdict.checks if check.judged == STRAIGHT_LEG]
    if not checks:
        return ()
    failing = [check for check in checks if not check.met]
    names = ", ".join(figure_in_sentence(check.name) for check in failing or checks)
    return (f"Does not depend on the flight: {names}, {'not met' if failing else 'met'}.",)


def failure(line: LineResult) -> str:
    """Why a line fails: no image of it can be taken, or a figure passes its limit: when, by what, and at worst."""
    if line.reason:
        return f"{line.name} {line.reason}"
    worst = show_value(line.fails_by, line.worst[line.fails_by])
    return f"{line.name} fails: {line.because}; {worst} at worst"


def line_list(followed: Followed, name: str) -> TableBlock:
    """The verdict of each line: when and why it fails, or the figure that decides, `name` where no limit does; and
    how long it may be, once that is solved."""
    result = followed.result
    lengths = [_length(line) for line in result.lines]
    rows: list[Row] = []
    for place, (line, length) in enumerate(zip(result.lines, lengths, strict=True), 1):
        figure = FIGURES[line.fails_by or line.excess[0] or name]
        worst, limit = line.worst.get(figure.name), line.limits.get(figure.name)
        fails = "✗\u00a0fails", "bad"
        sign, tone = (("✓\u00a0keeps", "good") if limit else ("no limit", "")) if line.closes else fails
        label = line.name if not result.spec.lines or line.name == f"line {place}" else f"{place}  {line.name}"
        why = "; ".join(filter(None, (line.reason or line.because, line.remark)))
        texts = (
            f"{why[:1].upper()}{why[1:]}" or figure.label,
            NONE if worst is None else show_value(figure.name, worst, like=limit),
            NONE if limit is None else show_value(figure.name, limit, given=True),
        )
        rows.append((label, Cell(sign, tone=tone), *texts, *([length or NONE] if any(lengths) else [])))
    return table(
        "trajectory-verdicts",
        f"Verdict by line, {result.spec.processing}",
        ("Line", "Limits", ("Decides", 1.5), *numbers("Worst", "Limit (1σ)"), *(["Length"] if any(lengths) else [])),
        rows,
        f"{result.heading.text} {_swath(result)}".strip(),
    )


def _swath(result: TrajectoryResult) -> str:
    """Near and far range; empty where they are not solved."""
    from nav_model.trajectory.swath import swath_in_words

    return swath_in_words(result.swath)


def _length(line: LineResult) -> str:
    """Longest length of a line; empty where that is not solved."""
    from nav_model.trajectory.lines import length_in_words

    return length_in_words(line)


def line_table(followed: Followed, name: str) -> TableBlock:
    """Each line: the figure `name` and those with a limit, their rms, worst and share of the line within it."""
    result = followed.result
    having_one = [key for line in result.lines for key in line.limits]
    figures = [FIGURES[key] for key in dict.fromkeys([*having_one, name])]
    from nav_model.trajectory.result import beside_budget

    rows: list[Row] = []
    for line in result.lines:
        span = f"{line.name}: {line.start_s:.0f} s to {line.stop_s:.0f} s"
        rows.append(("; ".join(filter(None, (span, line.reason or line.because, line.remark, _length(line)))),))
        for figure in figures:
            within = line.within.get(figure.name)
            limited: tuple[str | Cell, ...] = (NONE, NONE)
            if within is not None:
                sign, tone = ("✗", "bad") if figure.name in line.failing else ("✓", "good")
                limit = show_value(figure.name, line.limits[figure.name], given=True)
                limited = limit, Cell(percent(within), sign, tone)
            values = (part.get(figure.name) for part in (line.first, line.mean, line.worst))
            like = line.limits.get(figure.name)
            texts = (NONE if value is None else show_value(figure.name, value, like=like) for value in values)
            rows.append((figure.label, *texts, *limited))
    return table(
        "trajectory-lines",
        f"Figures by line, {result.spec.processing}",
        ("Quantity", *numbers("At start", "Rms", "Worst", "Limit (scaled to 1σ)", "Within")),
        rows,
        " ".join((f"{_MOMENT} {result.moment}.", *beside_budget(result.spec), _swath(result))).strip(),
    )
