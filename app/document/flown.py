"""A flown flight in words: its verdict in a sentence."""

import math
import re
from collections.abc import Sequence

from app.document.blocks import Answer
from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.units import format_quantity
from nav_model.design.figures import FIGURES, figure_in_sentence
from nav_model.flown.relation import MEANINGS
from nav_model.flown.result import ALL, FlownLine, FlownResult, Measured, deciding

_STATES = ("not met", "cannot be told", "open", "met")
_SIGNS = {"met": ("✓ ", "good"), "not met": ("✗ ", "bad")}


def value_of(name: str, value: float) -> str:
    """A value of a figure in its usual unit."""
    figure = FIGURES[name]
    return format_quantity(value, DIMENSIONS[figure.dimension].default_unit, figure.dimension, 3)


def range_of(name: str, low: float, high: float) -> str:
    """A range of a figure, its unit once: "0.02 to 0.05 m/s"; "∞" where it has no end."""
    first, last = value_of(name, low), value_of(name, high) if math.isfinite(high) else "∞"
    unit = last.partition(" ")[2]
    return f"{first.removesuffix(f' {unit}') if unit else first} to {last}"


def sentence(result: FlownResult) -> str:
    """The verdict in a sentence: each limited figure, the lines that meet it and those that do not."""
    parts = _figures(result)
    if not parts:
        return whole(f"{result.verdict}: {result.reason}")
    return f"{result.verdict.capitalize()} ({MEANINGS[result.relation]}). {whole('; '.join(parts))}"


def answer(result: FlownResult) -> Answer:
    """The sentence as an answer: the verdict as its word, and a sentence of each limited figure."""
    sign, tone = _SIGNS.get(result.verdict, ("", "open"))
    parts = _figures(result) or [result.reason]
    taken = MEANINGS[result.relation]
    if result.guessed and result.compared is not None:
        taken += "; the files tell nothing else" if result.relation == "independent" else ", as the files tell"
    return Answer(f"{sign}{result.verdict.capitalize()}", tone, tuple(whole(one) for one in (*parts, taken)))


def whole(text: str) -> str:
    """The text as a sentence: its capital and its point."""
    return f"{text[:1].upper()}{text[1:]}."


def _figures(result: FlownResult) -> list[str]:
    """Each limited figure, its limit, and its states by line; none where no difference shows any."""
    lines = [line for line in result.lines if line.name != ALL] or list(result.lines)
    figures = dict.fromkeys(name for line in lines for name, one in line.figures.items() if one.limit is not None)
    if result.compared is None:
        return []
    parts = []
    for name in figures:
        by_state = {
            state: [line for line in deciding(result.lines, name) if line.figures[name].verdict == state]
            for state in _STATES
        }
        limits = {one.limit for line in lines if (one := line.figures.get(name)) and one.limit is not None}
        level = " to ".join(value_of(name, limit) for limit in sorted({min(limits), max(limits)}))
        states = [_of_state(name, state, there) for state, there in by_state.items() if there]
        parts.append(f"{figure_in_sentence(name)} of {level}: {', '.join(states)}")
    return parts


def _of_state(name: str, state: str, lines: Sequence[FlownLine]) -> str:
    """A state, where, and the band there."""
    known = [one for line in lines if (one := line.figures[name]).freedom > 0.0]
    band = f" ({_band(name, known)})" if known and state != "cannot be told" else ""
    reason = lines[0].figures[name].reason
    why = f": {reason}" if state in ("cannot be told", "open") and reason else ""
    return f"{state} on {_names(lines)}{band}{why}"


def _band(name: str, known: Sequence[Measured]) -> str:
    low, high = min(one.low_95 for one in known), max(one.high_95 for one in known)
    return f"{range_of(name, low, high)}, 95 %"


def _names(lines: Sequence[FlownLine]) -> str:
    names = [line.name for line in lines]
    for noun, nouns in (("line ", "lines"), ("stretch ", "stretches")):
        numbers = [int(name.removeprefix(noun)) for name in names if re.fullmatch(rf"{noun}\d+", name)]
        if len(numbers) == len(names) > 2 and numbers == list(range(numbers[0], numbers[-1] + 1)):
            return f"{nouns} {numbers[0]} to {numbers[-1]}"
    return names[0] if len(names) == 1 else f"{', '.join(names[:-1])} and {names[-1]}"
