"""The tabs of the Suborbital page: the charts and tables of each, and what a person chooses there."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.charts.kinds import Chart
from app.declared import declared
from app.document.pane import html_of
from app.subjects.suborbital import tables
from app.subjects.suborbital.charts import Shown, attitude, errors, flight, sensors
from app.subjects.suborbital.charts.shown import CHANNELS
from app.subjects.suborbital.tables import NumberTable
from app.ui.chart_pane import ChartPane, chart_cells
from app.ui.downloads import download
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
    tables: tuple[Callable[[Shown], NumberTable], ...] = ()
    beside: int = 1536  # width of the window from which charts stand beside each other, pixels
    chooses: tuple[str, ...] = ()


_SPACING_S = round(STAR_FRAME_SPACING_S)
TABS: tuple[Tab, ...] = (
    Tab("Errors", tuple((partial(draw, channel=c), 300, 6) for c in (2, 1, 0)
                        for draw in (errors.source_chart, errors.aided_chart)),
        chooses=("case", "aided_sources", "along_track")),
    Tab("Unstable height", ((errors.growth_chart, 440, 12),), chooses=("case", "channel")),
    Tab("Tables", tables=(*(lambda shown, i=i: tables.paper_tables(shown)[i] for i in range(4)), tables.source_table,
                          tables.gap_table)),
    Tab("Sensor errors", tuple((partial(sensors.sensor_chart, sensor=s, axis=axis), 240, 6)
                               for axis in range(3) for s in (0, 1)), beside=900),
    Tab("White noise", tuple((partial(sensors.noise_chart, channel=c), 300, 6) for c in (2, 1, 0)),
        (tables.noise_table,), chooses=("noise",)),
    Tab("Attitude", ((attitude.inertial_attitude_chart, 340, 6), (attitude.navigation_attitude_chart, 340, 6)),
        (tables.method_table,), 900, ("case",)),
    Tab("Stars", ((attitude.star_chart, 460, 6), (attitude.star_count_chart, 340, 6)), (tables.star_table,),
        chooses=("moment",)),
    Tab("Flight", ((flight.map_chart, 320, 6), (flight.height_chart, 320, 6), (flight.force_chart, 280, 6),
                   (flight.rate_chart, 280, 6), (flight.gravity_chart, 320, 12)), (tables.gravity_table,)),
)  # fmt: skip
"""In their order on the page."""

CASES = {"everything": "all"} | {name: name for name in (*CLASSES, *SOURCES, GRAVITY_ROW) if name != "all"}


class StudyTabs(pn.viewable.Viewer):
    """A bar of tabs and the charts and tables under it; a tab is made when it is first opened, then fed.

    The parameters are what a person chooses to look at.
    """

    case: str = declared(param.Selector(objects=CASES, default="all", label="Error source"))
    channel: int = declared(
        param.Selector(objects={name: i for i, name in enumerate(CHANNELS)}, default=2, label="Channel")
    )
    aided_sources: bool = declared(
        param.Selector(
            objects={"INS alone": False, "INS with star tracker": True}, default=False, label="Errors by source of"
        )
    )
    along_track: bool = declared(
        param.Selector(
            objects={"north and east": False, "down-range and cross-range": True},
            default=False,
            label="Horizontal axes",
        )
    )
    moment: int = declared(param.Integer(default=100, bounds=(0, 1500), step=_SPACING_S, label="Star frame at [s]"))
    shown: Shown | None = declared(
        param.ClassSelector(class_=Shown, doc="What is on the page; None before the first answer.")
    )

    def __init__(self, noise: pn.viewable.Viewer) -> None:
        super().__init__()
        self._panes: dict[int, list[ChartPane[Shown]]] = {}
        self._tables: dict[int, list[tuple[SortableTable, Callable[[Shown], NumberTable]]]] = {}
        self._contents: dict[int, pn.viewable.Viewable] = {}
        # Only the tab in view is in the browser: every layout there asks every figure, seen or not.
        self.place = pn.Column()
        # Only the bar is Material, for keyboard and screen reader: figures must not be inside it.
        self.bar = pmui.Tabs(
            *((tab.name, pn.Spacer(height=0)) for tab in TABS), sizing_mode="stretch_width", margin=(0, 4)
        )
        self.bar.param.watch(self._turned, "active")
        self._choosers: dict[str, Any] = {
            name: pmui.Select.from_param(self.param[name], width=width, margin=(10, 6, 4, 6))
            for name, width in (("case", 300), ("channel", 140), ("aided_sources", 200), ("along_track", 220))
        }
        self._choosers["moment"] = pmui.IntSlider.from_param(self.param.moment, width=260, margin=(4, 16))
        self._choosers["noise"] = noise
        self._chooser = pn.FlexBox(*self._chosen(0))
        self._view = pn.Column(self.bar, self._chooser, self.place)

    def __panel__(self) -> pn.Column:
        return self._view

    @property
    def looks(self) -> dict[str, Any]:
        """What a person looks at, as fields of `Shown`."""
        return {"star_index": self.moment // _SPACING_S} | {
            name: getattr(self, name) for name in ("case", "channel", "aided_sources", "along_track")
        }

    def _chosen(self, index: int) -> list[Any]:
        return [self._choosers[name] for name in TABS[index].chooses]

    def last_moment(self, seconds: int) -> None:
        """How far the time slider of the star frames goes."""
        self.moment = min(self.moment, seconds)
        self.param.moment.bounds = (0, seconds)

    def _turned(self, event: Any) -> None:
        with pn.io.hold():
            self._chooser.objects = self._chosen(event.new)
            self._draw()

    @param.depends("shown", watch=True)
    def _draw(self) -> None:
        """Feed the tab in view; the others are fed when they are opened."""
        index, shown = self.bar.active, self.shown
        if shown is None:
            return
        if index not in self._contents:
            self._build(index, shown)
        else:
            for pane in self._panes[index]:
                pane.show(shown)
            for place, build in self._tables[index]:
                place.html = _table_html(build(shown))
        if self.place.objects != [self._contents[index]]:
            self.place.objects = [self._contents[index]]

    def _build(self, index: int, shown: Shown) -> None:
        tab = TABS[index]
        panes: list[ChartPane[Shown]] = []
        made = [
            (SortableTable(html=_table_html(build(shown)), sizing_mode="stretch_width", margin=(8, 12)), build)
            for build in tab.tables
        ]
        self._panes[index], self._tables[index] = panes, made
        cells = chart_cells(tab.charts, lambda what, high: ChartPane(what, self.current, high), panes)
        cells += [cell(12, self._table_view(place, build, shown)) for place, build in made]
        self._contents[index] = grid(*cells, beside=tab.beside, margin=(4, 0))

    def _table_view(self, place: SortableTable, build: Callable[[Shown], NumberTable], shown: Shown) -> pn.Column:
        table = build(shown)
        take = download(
            f"{table.caption.partition(' at ')[0]}: CSV",
            f"{table.key}.csv",
            lambda: io.BytesIO(build(self.current()).csv().encode("utf-8")),
        )
        return pn.Column(place, take, styles=FRAME)

    def current(self) -> Shown:
        """What is on the page."""
        assert self.shown is not None
        return self.shown


def _table_html(table: NumberTable) -> str:
    return html_of(table.block(sortable=True))
