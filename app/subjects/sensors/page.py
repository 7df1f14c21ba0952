"""The Sensors page: where the design's noise comes from, what a log says of it, and the catalogue."""

from __future__ import annotations

import panel as pn
import panel_material_ui as pmui

from app.declared import held
from app.document.pane import html_of
from app.session import Session
from app.subjects.sensors.catalogue import catalogue_table
from app.subjects.sensors.log_panel import LogPanel
from app.subjects.sensors.tables import origin_table
from app.ui.html_pane import block_pane
from app.ui.sortable_table import SortableTable
from nav_model.budget import Budget
from nav_model.catalogue import Kind
from nav_model.design.presets import preset_of

_KINDS: tuple[Kind, ...] = ("imu", "radar")


class SensorsPage(pn.viewable.Viewer):
    """Everything below the tab."""

    session = held(Session)

    def __init__(self, session: Session) -> None:
        super().__init__(session=session)
        self._origins = block_pane(origin_table(session.design), margin=(4, 14))
        self.log = LogPanel(session)
        self.tables = {kind: SortableTable(sizing_mode="stretch_width", margin=(0, 14)) for kind in _KINDS}
        self._shown: dict[Kind, str | None] = {}
        self._mark()

    def __panel__(self) -> pn.Column:
        return pn.Column(_sheet(self._origins), self.log, *(_sheet(table) for table in self.tables.values()))

    def show(self, budget: Budget) -> None:
        """Follow the budget in force."""
        self._origins.object = html_of(origin_table(budget.design))
        self._mark()

    def _mark(self) -> None:
        """Mark the entries of the catalogue that the design has; a table is made again only when that changes."""
        for kind, table in self.tables.items():
            chosen = preset_of(self.session.design, kind) or ""
            if self._shown.get(kind) != chosen:
                self._shown[kind] = chosen
                table.html = html_of(catalogue_table(kind, chosen))


def _sheet(content: pn.viewable.Viewable) -> pmui.Paper:
    return pmui.Paper(content, variant="outlined", elevation=0, sizing_mode="stretch_width", margin=(6, 10))
