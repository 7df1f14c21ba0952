"""The Theory page: every equation the numbers rest on, and what stands behind the results."""

from __future__ import annotations

import json
from functools import cache
from html import escape
from importlib.resources import files
from typing import Any

import panel as pn

from app.document.html import mathml
from app.document.prose import prose
from app.session import Session
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
    "analytic": "Closed forms of navigation",
    "sar": "Radar",
    "simulation": "Simulator",
    "suborbital": "Suborbital flight and star tracker",
    "allan": "Sensor logs",
}
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


class TheoryPage:
    """Everything below the tab; the same for every design."""

    def __init__(self, session: Session) -> None:
        self._text = AnchoredText(html=_STYLE + theory(), sizing_mode="stretch_width", margin=(4, 14))
        self.view = pn.Column(self._text, sizing_mode="stretch_width")

    def show(self, budget: Budget) -> None:
        """Nothing here depends on the design."""

    def go_to(self, place: str) -> None:
        """Bring an equation, by its mark, or a chapter into view."""
        self._text.go_to(place)


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
        '<h2 id="symbols">Symbols</h2>' + _table("Symbols", ("Symbol", "Meaning", "Unit"), rows)
        + '<h2 id="literature">Literature</h2><ul>'
        + "".join(f"<li>{prose(text)}</li>" for text in REFERENCES) + "</ul>"
    )  # fmt: skip
    return _contents() + validation() + differences() + "".join(parts)


def _contents() -> str:
    items = "".join(f'<li><a href="#theory-{place}">{title}</a></li>' for place, title in _CONTENTS.items())
    return f'<nav aria-label="On this page"><ul class="contents">{items}</ul></nav>'


@cache
def _record() -> dict[str, Any]:
    """What the tests recorded of themselves."""
    record: dict[str, Any] = json.loads(
        files("app.subjects.theory").joinpath("validation.json").read_text(encoding="utf-8")
    )
    return record


def validation() -> str:
    """What each result was compared with, as the tests recorded it."""
    record = _record()
    outside = sum(row["outside"] for row in record["rows"])
    groups = "".join(
        f'<tr><th scope="rowgroup" colspan="6"><b>{title}</b></th></tr>'
        + "".join(_row(row) for row in record["rows"] if row["test"].split("/")[-2] == folder)
        for folder, title in _FIELDS.items()
    )
    head = ("Result", "Status", "Compared with", "Found", "Limit", "Measure")
    return (
        f'<h2 id="validation">Validation</h2><p>{outside} of {len(record["rows"])} comparisons have an oracle from '
        "outside this product: a solver written by others, a published figure, a measurement. Only those say "
        "“validated”; the rest are cross-checks of our own parts against each other. Written by the tests "
        f"themselves: version {escape(record['version'])}, commit {escape(record['commit'])}, "
        f"{escape(record['date'])}.</p>" + _table("Validation", head, groups)
    )


def _row(row: dict[str, Any]) -> str:
    mark = prose(f" [{row['equation']}]") if row["equation"] else ""
    return (
        f"<tr><th scope='row'>{escape(row['result'])}{mark}</th>"
        f"<td><span class='mark'>{'✓ validated' if row['outside'] else '– cross-checked'}</span></td>"
        f"<td>{prose(row['oracle'])}</td><td class='num'>{_figure(row['figure'])}</td>"
        f"<td class='num'>{_figure(row['limit'])}</td><td>{escape(row['measure'])}</td></tr>"
    )


def _figure(value: float) -> str:
    """Two digits, powers of ten as such."""
    text = f"{value:.2g}"
    digits, _, power = text.partition("e")
    return f"{digits}·10<sup>{int(power)}</sup>".replace("-", "−") if power else digits


def differences() -> str:
    """Where somebody prints another figure, and which holds."""
    rows = "".join(
        f"<tr><th scope='row'>{escape(r['result'])} {prose('[' + r['equation'] + ']')}</th>"
        f"<td>{prose(r['printed'])}</td><td>{prose(r['ours'])}</td><td><b>{escape(r['holds'])}</b></td>"
        f"<td>{prose(r['why'][:1].upper() + r['why'][1:])}.</td></tr>"
        for r in _record()["differences"]
    )
    head = ("Result", "Stated elsewhere", "Here", "Holds", "Why")
    return (
        '<h2 id="differences">Where figures differ</h2><p>Papers, design notes and simpler methods that say '
        "something else. Each row is shown by a test.</p>" + _table("Where figures differ", head, rows)
    )


def _table(name: str, head: tuple[str, ...], rows: str) -> str:
    cells = "".join(f'<th scope="col">{title}</th>' for title in head)
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="{name}"><table class="checks">'
        f"<thead><tr>{cells}</tr></thead><tbody>{rows}</tbody></table></div>"
    )
