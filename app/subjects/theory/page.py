"""The Theory page: every equation, what each result was compared with, and where others state another figure."""

from __future__ import annotations

from collections import Counter
from functools import cache
from html import escape

import panel as pn
import param

from app.document.blocks import Cell, Column, Table, Text
from app.document.html import mathml
from app.document.pane import html_of
from app.document.prose import prose
from app.session import Session
from app.subjects.theory.record import INDEPENDENT, Comparison, Difference, record
from app.ui.anchored_text import AnchoredText
from nav_model.budget import Budget
from nav_model.equations import ALL_EQUATIONS, ALL_SYMBOLS, REFERENCES, source_of

_PARTS = {"T": "Navigation", "S": "Radar", "B": "Suborbital flight and star tracker"}
_CONTENTS = {
    "validation": "Validation",
    "differences": "Where figures differ",
    **{f"part-{letter}": title for letter, title in _PARTS.items()},
    "symbols": "Symbols",
    "literature": "Literature",
}
# The tests' folders, in the order of the table.
_FIELDS = {
    "acceptance": "The worked design",
    "analytic": "Navigation formulas",
    "sar": "Radar",
    "simulation": "Simulator",
    "earth": "Gravity",
    "suborbital": "Suborbital flight and star tracker",
    "explore": "Explore",
    "allan": "Sensor logs",
}
_POWERS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_STYLE = """<style>
.contents { display: flex; flex-wrap: wrap; gap: 2px 18px; list-style: none; padding: 0; margin: 8px 0 0; }
.here { outline: 2px solid; outline-offset: 4px; border-radius: 2px; }
section, h2 { scroll-margin-top: 72px; }
.equation:target, .here { background: color-mix(in srgb, currentColor 6%, transparent); }
h2 { font-size: 20px; font-weight: 600; margin: 18px 0 4px; }
.equation { border-top: 1px solid color-mix(in srgb, currentColor 15%, transparent); padding: 10px 0; }
.equation h3 { display: flex; gap: 10px; }
.equation p { margin: 4px 0 0; max-width: 90ch; }
.math { overflow-x: auto; padding: 8px 0; }
math { font-size: 17px; }
.math math { display: block math; text-align: left; width: max-content; }
th math { font-size: 15px; }
</style>"""


class TheoryPage(pn.viewable.Viewer):
    """Everything below the tab; the same for every design."""

    text: AnchoredText = param.ClassSelector(class_=AnchoredText, allow_None=False, constant=True)

    def __init__(self, session: Session) -> None:
        super().__init__(text=AnchoredText(html=_STYLE + theory(), sizing_mode="stretch_width", margin=(4, 14)))
        self.view = pn.Column(self.text, sizing_mode="stretch_width")

    def __panel__(self) -> pn.Column:
        return self.view

    def show(self, budget: Budget) -> None:
        """Nothing here depends on the design."""

    def go_to(self, place: str) -> None:
        """Bring an equation, by its mark, or a chapter into view."""
        self.text.go_to(place)


@cache
def theory() -> str:
    """The page's text."""
    items = [(equation.math, True) for equation in ALL_EQUATIONS] + [(symbol.math, False) for symbol in ALL_SYMBOLS]
    set_ = dict(zip(items, mathml(tuple(items)), strict=True))
    parts = []
    for letter, title in _PARTS.items():
        parts.append(f'<h2 id="part-{letter}">{title}</h2>')
        for e in ALL_EQUATIONS:
            if e.mark.startswith(letter):
                parts.append(
                    f'<section class="equation" id="{e.mark}"><h3><span class="nw">[{e.mark}]</span> '
                    f'<span>{escape(e.title)}</span></h3><div class="math" tabindex="0" role="region" '
                    f'aria-label="Equation {e.mark}">{set_[e.math, True]}</div><p>{prose(e.says)}</p>'
                    f'<p class="quiet">Source: {prose(source_of(e.mark))}</p></section>'
                )
    rows = "".join(
        f"<tr><th scope='row'>{set_[s.math, False]}</th><td>{prose(s.meaning)}</td><td>{escape(s.unit)}</td></tr>"
        for s in ALL_SYMBOLS
    )
    parts.append(
        '<h2 id="symbols">Symbols</h2><div class="scroll" tabindex="0" role="region" aria-label="Symbols">'
        '<table class="checks"><thead><tr><th scope="col">Symbol</th><th scope="col">Meaning</th>'
        f'<th scope="col">Unit</th></tr></thead><tbody>{rows}</tbody></table></div>'
        '<h2 id="literature">Literature</h2><ul>'
        + "".join(f"<li>{prose(text)}</li>" for text in REFERENCES) + "</ul>"
    )  # fmt: skip
    return _contents() + validation() + differences() + "".join(parts)


def _contents() -> str:
    items = "".join(f'<li><a href="#theory-{place}">{title}</a></li>' for place, title in _CONTENTS.items())
    return f'<nav aria-label="On this page"><ul class="contents">{items}</ul></nav>'


def validation() -> str:
    """What each result was compared with, and how many of the comparisons are independent of this product."""
    rows = record().rows
    kinds = Counter(row.kind for row in rows)
    counts = [f"{kinds[kind]} against {name}" for kind, name in INDEPENDENT.items() if kinds[kind]]
    independent = sum(kinds[kind] for kind in INDEPENDENT)
    said = (
        f"{independent} of {len(rows)} results are checked against independent references: {', '.join(counts[:-1])} "
        f"and {counts[-1]}. A solver counts where its equations were set up without the product's code. The other "
        f"{len(rows) - independent} are compared with our own derivations only: two parts of the product with each "
        "other, or a second derivation written in the test."
    )
    origin = f"Generated by the test suite: version {record().version}, commit {record().commit}, {record().date}."
    body: list[tuple[Cell, ...]] = []
    for folder, title in _FIELDS.items():
        body.append((Cell(title),))
        body += [_comparison(row) for row in rows if row.test.split("/")[-2] == folder]
    columns = (
        Column("Result"), Column("Kind of check"), Column("Compared with"), Column("Largest deviation", numeric=True),
        Column("Allowed", numeric=True), Column("Measure"),
    )  # fmt: skip
    table = Table("comparisons", "Results and what each was compared with", columns, tuple(body), origin)
    return '<h2 id="validation">Validation</h2>' + html_of(Text(said), table)


def _comparison(row: Comparison) -> tuple[Cell, ...]:
    kind = Cell(f"✓ {row.kind}") if row.kind in INDEPENDENT else Cell(f"– {row.kind}", tone="quiet")
    found, allowed = Cell(_figure(row.figure)), Cell(_figure(row.limit))
    return Cell(_marked(row.result, row.equation)), kind, Cell(row.oracle), found, allowed, Cell(row.measure)


def _marked(result: str, mark: str) -> str:
    return f"{result} [{mark}]" if mark else result


def _figure(value: float) -> str:
    """Two digits, powers of ten as such."""
    digits, _, power = f"{value:.2g}".partition("e")
    return f"{digits}·10{str(int(power)).translate(_POWERS)}" if power else digits


def differences() -> str:
    """Where somebody states another figure, and which holds."""
    columns = tuple(map(Column, ("Result", "Stated elsewhere", "Here", "Holds", "Why")))
    rows = tuple(_difference(row) for row in record().differences)
    table = Table("other-figures", "Figures stated elsewhere, beside ours", columns, rows)
    said = "Papers, another program, our design notes and simpler methods that say something else. A test shows each."
    return '<h2 id="differences">Where figures differ</h2>' + html_of(Text(said), table)


def _difference(row: Difference) -> tuple[Cell, ...]:
    why = f"{row.why[:1].upper()}{row.why[1:]}."
    return Cell(_marked(row.result, row.equation)), Cell(row.printed), Cell(row.ours), Cell(row.holds), Cell(why)
