"""The Theory page: every equation, what each result was compared with, and where others state another figure."""

from collections import Counter
from functools import cache
from html import escape
from pathlib import Path

import panel as pn

from app.declared import required
from app.document.blocks import Answer, Bullets, Cell, Row, TableBlock, Text, numbers, table
from app.document.html import mathml
from app.document.numbers import number
from app.document.pane import html_of, prose
from app.session import Session
from app.subjects.theory.record import INDEPENDENT, Comparison, Difference, record
from app.ui.anchored_text import AnchoredText
from app.ui.answer_strip import AnswerStrip
from app.ui.view import View
from nav_model.budget import Budget
from nav_model.equations import ALL_EQUATIONS, ALL_SYMBOLS
from nav_model.equations.literature import METHODS, WORKS, source_of

_PARTS = {"T": "Navigation", "S": "Radar", "P": "Processing", "B": "Suborbital flight and star tracker"}
# The tests' folders, in the order of the table.
_FIELDS = {
    "acceptance": "The worked design",
    "analytic": "Navigation formulas",
    "aperture": "Radar",
    "sar": "Radar navigation strategies",
    "budget": "Budget",
    "processing": "Processing",
    "simulation": "Simulator",
    "earth": "Gravity",
    "suborbital": "Suborbital flight and star tracker",
    "explore": "Explore",
    "allan": "Sensor logs",
}
_MATH = "\N{INVISIBLE TIMES}"  # before a text that is Typst's mathematics
_STYLE = f"<style>{Path(__file__).with_suffix('.css').read_text('utf-8')}</style>"


class TheoryPage(View):
    """Everything below the tab; the same for every design."""

    text = required(AnchoredText)

    def __init__(self, session: Session) -> None:
        super().__init__(text=AnchoredText(html=_STYLE + theory(), sizing_mode="stretch_width", margin=(4, 14)))
        self._view = pn.Column(AnswerStrip(validation_answer()), self.text)

    def show(self, budget: Budget) -> None:
        """Nothing here depends on the design."""

    def go_to(self, place: str) -> None:
        """Bring an equation, by its mark, or a chapter into view."""
        self.text.go_to(place)


@cache
def theory() -> str:
    """The page's text."""
    items = [(equation.math, True) for equation in ALL_EQUATIONS] + [(symbol.math, False) for symbol in ALL_SYMBOLS]
    set_ = mathml(tuple(items))
    parts = []
    for letter, title in _PARTS.items():
        equations = [e for e in ALL_EQUATIONS if e.mark.startswith(letter)]
        body = "".join(
            f'<section class="equation" id="{e.mark}"><h3><span class="nw">[{e.mark}]</span> '
            f'<span>{escape(e.title)}</span></h3><div class="math" tabindex="0" role="region" '
            f'aria-label="Equation {e.mark}">{set_[e.math, True]}</div><p>{prose(e.says)}</p>'
            f'<p class="quiet">Source: {prose(source_of(e.mark))}</p></section>'
            for e in equations
        )
        parts.append(_folded(f"part-{letter}", title, f"{len(equations)} equations", body, opened=letter == "T"))
    table = html_of(_symbols(), html=lambda text: set_[text[1:], False] if text.startswith(_MATH) else prose(text))
    parts.append(_folded("symbols", "Symbols", f"{len(ALL_SYMBOLS)} symbols with their units", table))
    works = html_of(Bullets(tuple(WORKS.values())))
    methods = html_of(Bullets(tuple(f"{what}: {work}" for what, work in METHODS), "Methods"))
    parts.append(_folded("literature", "Literature", f"{len(WORKS)} works and what each provides", works + methods))
    return validation() + differences() + "".join(parts)


def _symbols() -> TableBlock:
    rows = ((s.meaning, f"{_MATH}{s.math}", s.unit) for s in ALL_SYMBOLS)  # a row's heading is text
    return table("all-symbols", "Symbols", ("Meaning", "Symbol", "Unit"), rows)


def _folded(place: str, title: str, note: str, body: str, *, opened: bool = False) -> str:
    """A chapter that unfolds when it is pressed, or when a link leads into it."""
    head = f'<summary><h2>{title}</h2> <span class="quiet">{note}</span></summary>'
    return f'<details id="{place}"{" open" * opened}>{head}{body}</details>'


def validation_answer() -> Answer:
    """Count of the comparisons that are independent of this product, and with what."""
    rows = record().rows
    kinds = Counter(row.kind for row in rows)
    counts = [f"{kinds[kind]} against {name}" for kind, name in INDEPENDENT.items() if kinds[kind]]
    independent = sum(kinds[kind] for kind in INDEPENDENT)
    return Answer(
        f"{independent} of {len(rows)} results are checked against independent references",
        "open",
        (f"{', '.join(counts[:-1])} and {counts[-1]}.",),
    )


def validation() -> str:
    """Table of what each result was compared with."""
    rows = record().rows
    ours = sum(row.kind not in INDEPENDENT for row in rows)
    text = (
        "A solver written by others counts as independent if its equations were set up without the product's code. "
        f"{ours} results are compared with our own derivations only: two parts of the product with each other, or a "
        "second derivation written in the test."
    )
    origin = f"Generated by the test suite: version {record().version}, commit {record().commit}, {record().date}."
    body: list[Row] = []
    for folder, title in _FIELDS.items():
        body.append((title,))
        body += [_comparison(row) for row in rows if row.test.split("/")[-2] == folder]
    compared = table(
        "comparisons",
        "Results and what each was compared with",
        ("Result", "Kind of check", "Compared with", *numbers("Largest deviation", "Allowed"), "Measure"),
        body,
        origin,
    )
    return _folded("validation", "Validation", "what each result was compared with", html_of(Text(text), compared))


def _comparison(row: Comparison) -> Row:
    kind = f"✓ {row.kind}" if row.kind in INDEPENDENT else Cell(f"– {row.kind}", tone="quiet")
    figure, allowed = (number(value, 2, given=True) for value in (row.figure, row.limit))
    return _marked(row.result, row.equation), kind, row.oracle, figure, allowed, row.measure


def _marked(result: str, mark: str) -> str:
    return f"{result} [{mark}]" if mark else result


def differences() -> str:
    """Published figures that differ from ours, and which one is right."""
    columns = ("Result", "Stated elsewhere", "Here", "Which is right", "Why")
    rows = tuple(map(_difference, record().differences))
    stated = table("other-figures", "Values from elsewhere that differ from ours", columns, rows)
    text = (
        "A paper, another program, a design note or a simpler method gives a different value. A test shows each case."
    )
    return _folded(
        "differences", "Where values differ", f"{len(rows)} values stated elsewhere", html_of(Text(text), stated)
    )


def _difference(row: Difference) -> Row:
    why = f"{row.why[:1].upper()}{row.why[1:]}."
    return _marked(row.result, row.equation), row.printed, row.ours, row.holds, why
