"""The views of the Suborbital page: the charts and tables of each, and what a person chooses there."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.charts.kinds import Chart
from app.declared import declared
from app.document.pane import html_of
from app.subjects.suborbital.charts import Shown, attitude, errors, flight, sensors
from app.subjects.suborbital.charts.shown import CHANNELS
from app.subjects.suborbital.tables import (
    NumberTable,
    gap_table,
    gravity_table,
    method_table,
    noise_table,
    paper_tables,
    source_table,
    star_table,
)
from app.ui.chart_pane import ChartPane
from app.ui.downloads import download
from app.ui.first_screen import first_screen
from app.ui.folded import Folded
from app.ui.html_pane import html_pane
from app.ui.named_views import NamedViews
from app.ui.sortable_table import SortableTable
from app.ui.theme import FRAME, NARROW
from nav_model.suborbital.errors import CLASSES, SOURCES
from nav_model.suborbital.study import GRAVITY_ROW
from nav_model.suborbital.survey import STAR_FRAME_SPACING_S

Describe = Callable[[Shown], Chart]
_SQUARE = 400  # pixels of height of a chart whose two axes must be alike


@dataclass(frozen=True)
class View:
    """Charts, then tables in one column; chooses: names of the choosers above."""

    name: str
    charts: tuple[Describe, ...] = ()
    tables: tuple[Callable[[Shown], NumberTable], ...] = ()
    chooses: tuple[str, ...] = ()


_SPACING_S = round(STAR_FRAME_SPACING_S)


def _of(draw: Callable[[Shown, int], Chart]) -> Describe:
    """A chart of the channel looked at."""
    return lambda shown: draw(shown, shown.channel)


def _sensor(kind: int, shown: Shown, axis: int) -> Chart:
    return sensors.sensor_chart(shown, kind, axis)


def _paper(index: int) -> Callable[[Shown], NumberTable]:
    """One of the tables beside the published values."""
    return lambda shown: paper_tables(shown)[index]


VIEWS: tuple[View, ...] = (
    View("Errors", (_of(errors.aided_chart), _of(errors.source_chart)),
         chooses=("channel", "case", "aided_sources", "along_track")),
    View("Unstable height", (errors.growth_chart,), chooses=("case", "channel")),
    View("Sources", tables=(source_table, gap_table)),
    View("Published values", tables=tuple(map(_paper, range(4)))),
    View("Sensor errors", tuple(_of(partial(_sensor, kind)) for kind in (0, 1)), chooses=("axis",)),
    View("White noise", (_of(sensors.noise_chart),), (noise_table,), chooses=("channel", "noise")),
    View("Attitude", (attitude.inertial_attitude_chart, attitude.navigation_attitude_chart), (method_table,),
         ("case",)),
    View("Stars", (attitude.star_chart, attitude.star_count_chart), (star_table,), ("moment",)),
    View("Flight", (flight.map_chart, flight.height_chart, flight.force_chart, flight.rate_chart)),
    View("Gravity", (flight.gravity_chart,), (gravity_table,)),
)  # fmt: skip
"""In their order on the page."""

CAMERA_NOISE, INPUTS = "Camera noise", "Inputs"

_COMING = "<p>The charts and tables of this view appear here with the first study.</p>"
CASES = {"everything": "all"} | {name: name for name in (*CLASSES, *SOURCES, GRAVITY_ROW) if name != "all"}


class StudyViews(pn.viewable.Viewer):
    """A switch and the view chosen, made when it is first opened, then fed while it is in view.

    The parameters are what a person chooses to look at; ``more`` are the views that are not of charts and tables.
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

    def __init__(self, noise: pn.viewable.Viewer, camera: pn.viewable.Viewer, inputs: pn.viewable.Viewer) -> None:
        super().__init__()
        self._panes: dict[str, list[ChartPane[Shown]]] = {}
        self._tables: dict[str, list[tuple[SortableTable, Callable[[Shown], NumberTable]]]] = {}
        self._noise = noise
        first, *others = VIEWS
        makes: dict[str, Callable[[], Any]] = {first.name: partial(self._place, first), CAMERA_NOISE: lambda: camera}
        makes |= {view.name: partial(self._place, view) for view in others} | {INPUTS: lambda: inputs}
        self._places: dict[str, pn.Column] = {}
        self.views = NamedViews("What to see", makes)
        self.views.param.watch(lambda _: self._draw(), "chosen")

    def __panel__(self) -> NamedViews:
        return self.views

    @property
    def looks(self) -> dict[str, Any]:
        """The user's choice of views, as fields of `Shown`."""
        return {"star_index": self.moment // _SPACING_S} | {
            name: getattr(self, name) for name in ("case", "channel", "aided_sources", "along_track")
        }

    def last_moment(self, seconds: int) -> None:
        """How far the time slider of the star frames goes."""
        self.moment = min(self.moment, seconds)
        self.param.moment.bounds = (0, seconds)

    def _place(self, view: View) -> pn.Column:
        """The place of a view; it is filled with the first answer."""
        coming = pn.Column(
            html_pane(_COMING), sizing_mode="stretch_both", min_height=320, styles=FRAME, margin=(8, 10)
        )
        self._places[view.name] = pn.Column(coming, sizing_mode="stretch_both", stylesheets=[NARROW])
        return self._places[view.name]

    def say_coming(self, progress: str) -> None:
        """How far the first study is, in the views that wait for it."""
        for name, place in self._places.items():
            if name not in self._panes:
                place[0][0].object = f"{_COMING}<p class='quiet'>{escape(progress)}</p>"

    @param.depends("shown", watch=True)
    def _draw(self) -> None:
        """Update the chosen view; the others are updated when they are opened."""
        name, shown = self.views.chosen, self.shown
        if shown is None or name not in self._places:
            return
        if name not in self._panes:
            self._build(next(view for view in VIEWS if view.name == name), shown)
            return
        for pane in self._panes[name]:
            pane.show(shown)
        for place, build in self._tables[name]:
            place.html = _table_html(build(shown))

    def _build(self, view: View, shown: Shown) -> None:
        panes = [ChartPane(what, self.current, _SQUARE if what(shown).square else None) for what in view.charts]
        tables = [
            (SortableTable(html=_table_html(build(shown)), sizing_mode="stretch_width", margin=(4, 12)), build)
            for build in view.tables
        ]
        self._panes[view.name], self._tables[view.name] = panes, tables
        scrolls: dict[str, Any] = {
            "sizing_mode": "stretch_both",
            "styles": {"overflow": "auto"},
            "stylesheets": [NARROW],
        }
        parts: list[Any] = [
            pn.Column(pane.view, **scrolls) if what(shown).square else pane.view
            for what, pane in zip(view.charts, panes, strict=True)
        ]
        if tables:
            parts.append(pn.Column(*(table for table, _ in tables), **scrolls))
        half = len(parts) // 2 or 1
        takes = [take for pane in panes for take in pane.takes()]
        takes += [self._table_take(build, shown) for build in view.tables]
        self._places[view.name].objects = [
            first_screen(
                *([pn.FlexBox(*map(self._chooser, view.chooses))] if view.chooses else ()),
                left=parts[:half], right=parts[half:], height="100%",
            ),
            Folded([("Downloads of this view", lambda: pn.FlexBox(*takes))]),
        ]  # fmt: skip

    def _chooser(self, name: str) -> Any:
        if name == "noise":
            return self._noise
        if name == "moment":
            return pmui.IntSlider.from_param(self.param.moment, width=260, margin=(4, 16))
        parameter = self.param["channel" if name == "axis" else name]
        options = {"x": 0, "y": 1, "z": 2} if name == "axis" else None
        look: dict[str, Any] = {"width": 230, "margin": (8, 6, 0, 6), "size": "small"}
        if options is None:
            return pmui.Select.from_param(parameter, **look)
        axis = pmui.Select(label="Axis", options=options, value=self.channel, **look)
        axis.link(self, value="channel", bidirectional=True)
        return axis

    def _table_take(self, build: Callable[[Shown], NumberTable], shown: Shown) -> pn.viewable.Viewable:
        table = build(shown)
        return download(
            f"{table.caption.partition(' at ')[0]}: CSV",
            f"{table.key}.csv",
            lambda: io.BytesIO(build(self.current()).csv().encode("utf-8")),
        )

    def current(self) -> Shown:
        """The content of the page."""
        assert self.shown is not None
        return self.shown


def _table_html(table: NumberTable) -> str:
    return html_of(table.block(sortable=True))
