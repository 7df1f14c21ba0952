"""Contributors of the user's own on the Budget page: what they are, a box for them, and what each source may take."""

from __future__ import annotations

import math
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.declared import held
from app.document.blocks import Cell, Column, Table, Text
from app.document.numbers import NONE, decibels, show, signed_percent
from app.document.pane import html_of
from app.session import Session
from app.subjects.budget.tables import contributor_table
from app.ui.html_pane import html_pane
from app.ui.theme import PRINT_NOTHING
from app.ui.view import View
from nav_model.base.errors import InputError
from nav_model.budget import Budget
from nav_model.budget.allocation import allocate
from nav_model.budget.verdict import label_of, limit_on
from nav_model.design.file import format_contributors, parse_contributors

_EXAMPLE = '[[contributors]]\nname = "lever arm"\nvalue = "1 mm"\nenters = "detrended_phase"'


class Contributors(View):
    """The part that opens below the first screen; what is entered in the box becomes part of the design."""

    session = held(Session)

    def __init__(self, session: Session) -> None:
        super().__init__(session=session)
        self._tables = html_pane("", margin=(4, 10))
        self._said = html_pane("", margin=(0, 10))
        self._box = pmui.TextAreaInput(
            label="Contributors, as in a design file",
            placeholder=_EXAMPLE,
            rows=8,
            max_length=50_000,
            margin=(4, 10),
            sizing_mode="stretch_width",
        )
        self._box.param.watch(self._enter, "value")
        self._shown: Any = None
        self._view = pn.Column(self._tables, pn.Column(self._box, self._said, stylesheets=[PRINT_NOTHING]))

    def show(self, budget: Budget) -> None:
        """Follow the current budget; the box changes only with the design's contributors."""
        self._tables.say(contributors_html(budget))
        if budget.design.contributors != self._shown:
            self._shown = budget.design.contributors
            self._said.say("")
            self._box.value = format_contributors(self._shown)

    def _enter(self, event: Any) -> None:
        try:
            contributors = parse_contributors(event.new)
            refused = self.session.change({}, contributors=contributors)
        except InputError as error:
            refused = error
        self._said.say(f"<p role='alert'>{escape(str(refused))}</p>" if refused else "")


def contributors_html(budget: Budget) -> str:
    """The design's contributors, and the allocation of its tightest requirement."""
    none = Text("The design has no contributors. Enter them below, or in its file.")
    own = contributor_table(budget, "d") if budget.design.contributors else none
    return html_of(own, allocation_table(budget))


def allocation_table(budget: Budget) -> Table | Text:
    """What each source may take of the tightest limit, less 20 %, in proportion to today's shares."""
    if budget.verdict.tightest is None:
        return Text("The design has no requirement, so there is nothing to allocate.")
    found = allocate(budget)
    dimension = limit_on(found.requirement).dimension

    def told(value: float) -> str:
        return decibels(20 * math.log10(value)) if dimension == "level" else show(value, dimension)

    rows = tuple(
        (
            Cell(entry.source),
            Cell(told(entry.allocated)),
            Cell(told(entry.estimated)),
            Cell(NONE if entry.margin is None else signed_percent(entry.margin)),
            Cell(entry.owner or NONE),
        )
        for entry in sorted(found.entries, key=lambda entry: -entry.estimated)
    )
    return Table(
        "d-allocation",
        f"Allocation of {label_of(found.requirement)}: {told(found.limit)}, less a reserve of 20 %",
        (
            Column("Source", width=1.5),
            Column("Allocated", numeric=True),
            Column("Estimated", numeric=True),
            Column("Margin", numeric=True),
            Column("Owner"),
        ),
        rows,
        "In proportion to today's shares. Random entries combine in quadrature, systematic ones linearly. The "
        "command allocate has other splits and locked entries.",
    )
