"""Options that would close a flight, as blocks: the answer in a sentence, and a table of what each buys and costs."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from app.document.blocks import Answer, Cell, Row, TableBlock, numbers, table
from app.document.numbers import NONE, percent
from app.subjects.trajectory.figures import FIGURES, show_value, spread_of
from nav_model.base.units import time_in_words
from nav_model.design.declaration import in_sentence
from nav_model.design.figures import figure_in_sentence
from nav_model.design.trajectory import lines_in_words

_SAME, _NOTHING = 0.005, "no change"

if TYPE_CHECKING:
    from nav_model.design import Design
    from nav_model.explore.manoeuvre import Limited, Manoeuvres, Option


def options_answer(answer: Manoeuvres) -> Answer:
    """The options that close, or that none does."""
    if answer.closes:
        return Answer("✓ Every line keeps its limits", "good", ("No manoeuvre is needed.",))
    closing, note = [option for option in answer.options if option.closes], filter(None, [answer.note])
    if not closing:
        word = f"✗ No single option is enough for {lines_in_words(answer.lines)}"
        return Answer(word, "bad", ("The table has what each changes.", *note))
    shortest, bought = closing[0], [option for option in closing[1:] if option.kind != "manoeuvre"]
    ways = "; or ".join(map(_in_words, (shortest, *bought)))
    word = f"{len(closing)} option{'' if len(closing) == 1 else 's'} for {lines_in_words(answer.lines)}"
    return Answer(word, "open", (f"{ways[:1].upper()}{ways[1:]}.", *note))


def options_table(answer: Manoeuvres, design: Design, key: str = "trajectory-options") -> TableBlock:
    """Each option, at the confidence of the design, the shortest that closes first; a row's value is its name."""
    rows: list[Row] = []
    name = max(answer.figures, key=lambda figure: answer.figures[figure].ratio)
    for option in answer.options:
        decides = max(option.figures, key=lambda figure: option.figures[figure].ratio)
        value = option.figures[decides]
        sign, tone = ("✓ closes", "good") if option.closes else ("✗ fails", "bad")
        change = _change(value, answer.figures[name])
        rows.append(
            (
                Cell(option_label(option), value=option.name),
                Cell(sign, tone=tone),
                FIGURES[decides].label,
                NONE if math.isinf(value.worst) else show_value(design, decides, value.worst),
                show_value(design, decides, value.limit, given=True),
                change,
                _longer(option.costs_s),
                _note(option, buys=not option.useless and change != _NOTHING),
            )
        )
    planned = answer.figures[name].worst
    worst = "no value" if math.isinf(planned) else show_value(design, name, planned)
    return table(
        key,
        f"Options for {lines_in_words(answer.lines)}, {spread_of(design)}; as planned {figure_in_sentence(name)} is "
        f"{worst} at worst",
        (
            ("Option", 1.6),
            "Limits",
            "Decides",
            *numbers("Worst", "Limit", "Change", "Flight"),
            ("Note", 1.6),
        ),
        rows,
        "Each option is computed along the whole plan. An IMU keeps the design's residual "
        "biases and vibration factor.",
    )  # fmt: skip


def option_label(option: Option) -> str:
    """An option with where it is flown: "90° turn before line 3"."""
    return f"{option.name} {option.where}".rstrip()


def _in_words(option: Option) -> str:
    label = in_sentence(option_label(option))
    if not option.lines:
        return label
    if option.where.startswith("before"):
        ends = "the line ends" if len(option.lines) == 1 else "a line ends"
        label += f", over not more than {time_in_words(option.before_s)} before {ends}"
    return f"{label} ({_longer(option.costs_s)})"


def _longer(seconds: float) -> str:
    if abs(seconds) < 0.5:
        return "+0 s"
    return f"{time_in_words(abs(seconds))} {'longer' if seconds > 0.0 else 'shorter'}"


def _note(option: Option, *, buys: bool) -> str:
    notes = []
    if option.lost_s >= 1.0:
        notes.append(f"its bank loses fixes for {time_in_words(option.lost_s)}")
    elif option.lost_s <= -1.0:
        notes.append(f"keeps fixes for {time_in_words(-option.lost_s)} more")
    if not buys:
        notes.append("no gain")
    note = ", and ".join(notes)
    return f"{note[:1].upper()}{note[1:]}"


def _change(figure: Limited, planned: Limited) -> str:
    """Change of a figure towards its limit against what decided as planned."""
    change = figure.ratio / planned.ratio - 1.0
    if not math.isfinite(change):
        return NONE
    return _NOTHING if abs(change) < _SAME else f"{percent(abs(change))} {'more' if change > 0.0 else 'less'}"
