"""The tabs of the Suborbital page: which charts and tables stand on each, and what a person chooses there."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.charts.kinds import Chart
from app.subjects.suborbital import charts
from app.subjects.suborbital.charts import CHANNELS, Shown
from app.subjects.suborbital.tables import (
    Table,
    gap_table,
    gravity_table,
    method_table,
    noise_table,
    paper_tables,
    source_table,
    star_table,
)
from app.ui.chart_pane import ChartPane, chart_cells
from app.ui.grid import cell, grid
from app.ui.sortable_table import SortableTable
from app.ui.theme import FRAME
from nav_model.suborbital.errors import CLASSES, SOURCES
from nav_model.suborbital.study import GRAVITY_ROW
from nav_model.suborbital.survey import STAR_FRAME_SPACING_S

Describe = Callable[[Shown], Chart]


@dataclass(frozen=True)
class Tab:
    """Charts as (description, height, columns of twelve), then tables; chooses: names of the choosers above."""

    name: str
    charts: tuple[tuple[Describe, int, int], ...] = ()
    tables: tuple[Callable[[Shown], Table], ...] = ()
    beside: int = 1536  # width of the window from which charts stand beside each other, pixels
    chooses: tuple[str, ...] = ()


_AXES = range(3)
TABS: tuple[Tab, ...] = (
    Tab("Errors",
        tuple((make(c), 300, 6) for c in (2, 1, 0) for make in (charts.source_chart, charts.aided_chart)),
        chooses=("case", "aided_sources", "along_track")),
    Tab("Unstable height", ((charts.growth_chart, 440, 12),), chooses=("case", "channel")),
    Tab("Tables", tables=(*(lambda shown, i=i: paper_tables(shown)[i] for i in range(4)), source_table, gap_table)),
    Tab("Sensor errors", tuple((charts.sensor_chart(s, a), 240, 6) for a in _AXES for s in (0, 1)), beside=900),
    Tab("White noise", tuple((charts.noise_chart(c), 300, 6) for c in (2, 1, 0)), (noise_table,), chooses=("noise",)),
    Tab("Attitude", ((charts.inertial_attitude_chart, 340, 6), (charts.navigation_attitude_chart, 340, 6)),
        (method_table,), 900, ("case",)),
    Tab("Stars", ((charts.star_chart, 460, 6), (charts.star_count_chart, 340, 6)), (star_table,),
        chooses=("moment",)),
    Tab("Flight", ((charts.map_chart, 320, 6), (charts.height_chart, 320, 6), (charts.force_chart, 280, 6),
                   (charts.rate_chart, 280, 6), (charts.gravity_chart, 320, 12)), (gravity_table,)),
)  # fmt: skip
"""In the order they stand."""

CASES = {"everything": "all"} | {name: name for name in (*CLASSES, *SOURCES, GRAVITY_ROW) if name != "all"}


class StudyTabs:
    """A bar of tabs and the charts and tables under it; a tab is made when it is first opened, then fed.

    looked: called when a person chooses another view; `looks` are the choices, fields of `Shown`.
    """

    def __init__(self, looked: Callable[[], None], noise: pn.viewable.Viewable) -> None:
        self._looked = looked
        self.looks: dict[str, Any] = {
            "case": "all", "channel": 2, "aided_sources": False, "along_track": False, "star_index": 50,
        }  # fmt: skip
        self._shown: Shown | None = None
        self._panes: dict[int, list[ChartPane[Shown]]] = {}
        self._tables: dict[int, list[tuple[SortableTable, Callable[[Shown], Table]]]] = {}
        self._contents: dict[int, pn.viewable.Viewable] = {}
        # The tab in view alone stands in the browser: every layout there asks every figure, seen or not.
        self.place = pn.Column(sizing_mode="stretch_width", margin=0)
        # Only the bar is Material, for keyboard and screen reader: figures must not stand inside it.
        self.bar = pmui.Tabs(
            *((tab.name, pn.Spacer(height=0)) for tab in TABS), sizing_mode="stretch_width", margin=(0, 4)
        )
        self.bar.param.watch(self._turned, "active")
        self._choosers = self._make_choosers() | {"noise": noise}
        self._chooser = pn.FlexBox(*self._chosen(0), sizing_mode="stretch_width", margin=0)
        self.view = pn.Column(self.bar, self._chooser, self.place, sizing_mode="stretch_width")

    def _make_choosers(self) -> dict[str, pn.viewable.Viewable]:
        def select(name: str, label: str, options: dict[str, Any], width: int) -> pmui.Select:
            box = pmui.Select(
                label=label, options=options, value=self.looks[name], width=width, description="", size="small",
                margin=(10, 6, 4, 6),
            )  # fmt: skip
            box.param.watch(lambda event: self._look(name, event.new), "value")
            return box

        self.moment = pmui.IntSlider(
            label="Star frame at [s]", description="", start=0, end=1500, step=round(STAR_FRAME_SPACING_S),
            value=100, size="small", width=260, margin=(4, 16),
        )  # fmt: skip
        self.moment.param.watch(
            lambda event: self._look("star_index", event.new // round(STAR_FRAME_SPACING_S)), "value"
        )
        return {
            "case": select("case", "Error source", CASES, 300),
            "channel": select("channel", "Channel", {name: i for i, name in enumerate(CHANNELS)}, 140),
            "aided_sources": select(
                "aided_sources", "Errors by source of", {"INS alone": False, "INS with star tracker": True}, 200
            ),
            "along_track": select(
                "along_track", "Horizontal axes", {"north and east": False, "down-range and cross-range": True}, 220
            ),
            "moment": self.moment,
        }

    def _chosen(self, index: int) -> list[pn.viewable.Viewable]:
        return [self._choosers[name] for name in TABS[index].chooses]

    def _look(self, name: str, value: Any) -> None:
        self.looks[name] = value
        self._looked()

    def last_moment(self, seconds: int, frames: int) -> None:
        """How far the time slider of the star frames goes."""
        self.moment.end = seconds
        self.looks["star_index"] = min(self.looks["star_index"], frames - 1)

    def _turned(self, event: Any) -> None:
        with pn.io.hold():
            self._chooser.objects = self._chosen(event.new)
            self._draw()

    def show(self, shown: Shown) -> None:
        """Feed the tab in view; the others are fed when they are opened."""
        self._shown = shown
        self._draw()

    def _draw(self) -> None:
        index, shown = self.bar.active, self._shown
        if shown is None:
            return
        if index not in self._contents:
            self._build(index, shown)
        else:
            self._feed(index, shown)
        if self.place.objects != [self._contents[index]]:
            self.place.objects = [self._contents[index]]

    def _feed(self, index: int, shown: Shown) -> None:
        for pane in self._panes[index]:
            pane.show(shown)
        for place, build in self._tables[index]:
            place.html = build(shown).html

    def _build(self, index: int, shown: Shown) -> None:
        tab = TABS[index]
        panes: list[ChartPane[Shown]] = []
        tables = [
            (SortableTable(html=build(shown).html, sizing_mode="stretch_width", margin=(8, 12)), build)
            for build in tab.tables
        ]
        self._panes[index], self._tables[index] = panes, tables
        cells = chart_cells(tab.charts, lambda what, high: ChartPane(what, self.current, high), panes)
        cells += [cell(12, self._table_view(place, build, shown)) for place, build in tables]
        self._contents[index] = grid(*cells, beside=tab.beside, margin=(4, 0))

    def _table_view(self, place: SortableTable, build: Callable[[Shown], Table], shown: Shown) -> pn.Column:
        table = build(shown)
        download = pmui.FileDownload(
            callback=lambda: io.BytesIO(build(self.current()).csv().encode("utf-8")),
            filename=f"{table.key}.csv", label=f"{table.title.partition(' at ')[0]}: CSV", variant="text",
            description="", size="small", margin=2,
        )  # fmt: skip
        return pn.Column(place, download, styles=FRAME, sizing_mode="stretch_width", margin=0)

    def current(self) -> Shown:
        """What is on the page."""
        assert self._shown is not None
        return self._shown
