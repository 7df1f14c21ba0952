"""The Sensors page: where the design's noise comes from, what a log says of it, and the catalogue."""

from __future__ import annotations

import panel as pn
import panel_material_ui as pmui

from app.session import Session
from app.subjects.sensors.catalogue import catalogue_table
from app.subjects.sensors.log_panel import LogPanel
from app.subjects.sensors.tables import origin_table
from app.ui.html_pane import html_pane
from app.ui.sortable_table import SortableTable
from nav_model.budget import Budget
from nav_model.catalogue import Kind
from nav_model.design.file import preset_of

_STATUS_NOTE = (
    '<p class="know quiet"><b>How do we know:</b> every value was read in the source named beside it. '
    "<b>⚠ secondary</b>: read where another quotes the maker; <b>⚠ assumed</b>: a typical value chosen here; "
    "<b>⚠ unconfirmed</b>: from memory, no source reached. Press a heading to sort.</p>"
)
_CATALOGUE: tuple[tuple[Kind, str], ...] = (
    ("imu", "Inertial units of the catalogue"),
    ("radar", "Radars of the catalogue"),
)


class SensorsPage:
    """Everything below the tab."""

    def __init__(self, session: Session) -> None:
        self._origins = html_pane(origin_table(session.design))
        self.log = LogPanel(session)
        self._chosen = {kind: preset_of(session.design, kind) or "" for kind, _ in _CATALOGUE}
        self.tables = {
            kind: SortableTable(
                html=catalogue_table(kind, self._chosen[kind]), sizing_mode="stretch_width", margin=(0, 14)
            )
            for kind, _ in _CATALOGUE
        }
        self.view = pn.Column(
            _sheet("Where the design's noise comes from", self._origins),
            self.log.view,
            *(
                _sheet(title, self.tables[kind], html_pane(_STATUS_NOTE, margin=(4, 14, 10, 14)))
                for kind, title in _CATALOGUE
            ),
            sizing_mode="stretch_width",
        )

    def show(self, budget: Budget) -> None:
        """Follow the budget in force."""
        design = budget.design
        self._origins.object = origin_table(design)
        for kind, table in self.tables.items():
            chosen = preset_of(design, kind) or ""
            if chosen != self._chosen[kind]:
                self._chosen[kind] = chosen
                table.html = catalogue_table(kind, chosen)


def _sheet(title: str, *content: pn.viewable.Viewable) -> pmui.Paper:
    return pmui.Paper(
        html_pane(f"<h3>{title}</h3>", margin=(10, 14, 2, 14)),
        *content,
        variant="outlined",
        elevation=0,
        sizing_mode="stretch_width",
        margin=(6, 10),
    )
