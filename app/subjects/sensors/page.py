"""The Sensors page: log analysis and the catalogue, one view at a time, under the origins of the design's noise."""

from dataclasses import replace
from typing import Any

import panel as pn

from app.declared import required
from app.document.blocks import Answer
from app.document.pane import html_of
from app.document.verdict import verdict_strip
from app.session import Session
from app.subjects.sensors.catalogue import catalogue_table
from app.subjects.sensors.data_sheet import DataSheetBox
from app.subjects.sensors.log_panel import LogPanel, paper
from app.subjects.sensors.tables import origin_answer
from app.ui.answer_strip import AnswerStrip
from app.ui.first_screen import screen_of_views
from app.ui.named_views import NamedViews
from app.ui.sortable_table import WHOLE, SortableTable
from app.ui.view import View
from nav_model.budget import Budget
from nav_model.design.catalogue import Kind
from nav_model.design.presets import preset_of

_SCROLLED = """
:host { overflow: auto; }
@media (max-width: 1000px), print { :host { overflow: visible; height: auto !important; flex: none !important; } }
"""
_KINDS: tuple[Kind, ...] = ("imu", "radar")


class SensorsPage(View):
    """Everything below the tab."""

    session = required(Session)

    def __init__(self, session: Session) -> None:
        super().__init__(session=session)
        self.log = LogPanel(session)
        self.sheet = DataSheetBox(session)
        self.tables = {kind: SortableTable(margin=(0, 14), stylesheets=[WHOLE]) for kind in _KINDS}
        self._chosen: dict[Kind, str | None] = {}
        self._mark()

        self._strip = AnswerStrip(_answer(session.budget))
        self._views = NamedViews(
            "What to see",
            {
                "My log": lambda: _scrolled(self.log),
                "IMUs": lambda: _scrolled(paper(self.sheet), self.tables["imu"]),
                "Radars": lambda: _scrolled(self.tables["radar"]),
            },
        )
        self._view = screen_of_views(self._strip, self._views)

    def go_to(self, place: str) -> None:
        """Show the view of this name, such as "log" of "#sensors-log"."""
        views = {"log": "My log", "imus": "IMUs", "radars": "Radars"}
        self._views.chosen = views.get(place.lower(), self._views.chosen)

    def show(self, budget: Budget) -> None:
        """Follow the current budget."""
        self.show_verdict(budget)
        self.log.moving.follow()
        self.log.static.follow()
        self._mark()

    def show_verdict(self, budget: Budget) -> None:
        """Follow the verdict alone, which the design's flight has changed."""
        self._strip.show(_answer(budget))

    def _mark(self) -> None:
        """Mark the entries of the catalogue that the design has; a table is made again only when that changes."""
        for kind, table in self.tables.items():
            chosen = preset_of(self.session.design, kind) or ""
            if self._chosen.get(kind) != chosen:
                self._chosen[kind] = chosen
                table.html = html_of(catalogue_table(kind, chosen))


def _answer(budget: Budget) -> Answer:
    """The verdict, and where the noise comes from."""
    verdict = verdict_strip(budget)
    return replace(verdict, sentences=(*verdict.sentences, *origin_answer(budget.design).sentences))


def _scrolled(*content: Any) -> pn.Column:
    """A view that scrolls in its place: the answer above it stays."""
    return pn.Column(*content, sizing_mode="stretch_both", stylesheets=[_SCROLLED])
