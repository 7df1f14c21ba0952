"""The Theory page: every equation the numbers rest on, and what stands behind the results."""

from __future__ import annotations

import json
from functools import cache
from html import escape
from importlib.resources import files

import panel as pn

from app.chart_view import html_pane, prose
from app.report.equations import ALL_EQUATIONS, ALL_SYMBOLS, REFERENCES, source_of
from app.report.html import mathml
from app.state import Session
from nav_model.budget import Budget
from nav_model.sar.disagreements import disagreements

_PARTS = {"T": "Navigation", "S": "Radar", "B": "Suborbital flight and star tracker"}
_STYLE = """<style>
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
        self.view = pn.Column(html_pane(_STYLE + theory()), sizing_mode="stretch_width")

    def show(self, budget: Budget) -> None:
        """Nothing here depends on the design."""


@cache
def theory() -> str:
    """The page's text."""
    items = [(equation.math, True) for equation in ALL_EQUATIONS] + [(symbol.math, False) for symbol in ALL_SYMBOLS]
    set_ = dict(zip(items, mathml(tuple(items)), strict=True))
    parts = []
    for letter, title in _PARTS.items():
        parts.append(f"<h2>{title}</h2>")
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
        "<h2>Symbols</h2>" + _table("Symbols", ("Symbol", "Meaning", "Unit"), rows) + "<h2>Literature</h2><ul>"
        + "".join(f"<li>{prose(text)}</li>" for text in REFERENCES) + "</ul>"
    )  # fmt: skip
    return validation() + "".join(parts)


def validation() -> str:
    """What each result was compared with, as the tests recorded it."""
    record = json.loads(files("app").joinpath("validation.json").read_text(encoding="utf-8"))
    rows = "".join(
        f"<tr><th scope='row'>{escape(r['result'])} {prose('[' + r['equation'] + ']')}</th>"
        f"<td><span class='mark'>{'✓ validated' if r['outside'] else 'cross-checked'}</span></td>"
        f"<td>{prose(r['oracle'])}</td><td class='num'>{r['figure']:.2g}</td><td class='num'>{r['limit']:.2g}</td>"
        f"<td>{escape(r['measure'])}</td></tr>"
        for r in record["rows"]
    )
    head = ("Result", "Status", "Compared with", "Found", "Limit", "Measure")
    return (
        "<h2>Validation</h2><p>Written by the tests themselves: version "
        f"{escape(record['version'])}, commit {escape(record['commit'])}, {escape(record['date'])}. "
        "“Validated” stands only where the comparison comes from outside this product.</p>"
        + _table("Validation", head, rows)
        + parted()
    )


def parted() -> str:
    """Where printed figures and the derivation disagree: both, and which holds."""
    rows = "".join(
        f"<tr><th scope='row'>{prose(d.what)}</th>"
        f"<td>{prose(d.printed)}<br><span class='quiet'>{prose(d.source)}</span></td>"
        f"<td>{prose(d.ours)}</td><td>{prose(d.holds)}</td></tr>"
        for d in disagreements()
    )
    head = ("What", "Printed", "Here", "Which holds, and why")
    return "<h2>Where printed figures and ours part</h2>" + _table("Disagreements", head, rows)


def _table(name: str, head: tuple[str, ...], rows: str) -> str:
    cells = "".join(f'<th scope="col">{title}</th>' for title in head)
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="{name}"><table class="checks">'
        f"<thead><tr>{cells}</tr></thead><tbody>{rows}</tbody></table></div>"
    )
