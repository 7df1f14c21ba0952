"""The views of the Suborbital page: the charts and tables of each, and what a person chooses there."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.charts.kinds import Chart
from app.declared import chosen, declared, optional
from app.document.blocks import TableBlock
from app.document.pane import html_of
from app.subjects.suborbital.charts import attitude, errors, flight
from app.subjects.suborbital.charts.content import CHANNELS, SUM, Content
from app.subjects.suborbital.tables import (
    gap_table,
    gravity_table,
    method_table,
    paper_tables,
    source_table,
    star_table,
)
from app.ui.first_screen import first_screen
from app.ui.follower import Follower
from app.ui.html_pane import html_pane
from app.ui.named_views import NamedViews
from app.ui.sortable_table import SortableTable
from app.ui.theme import FRAME, NARROW
from app.ui.view import View
from nav_model.suborbital.errors import CLASSES, SOURCES
from nav_model.suborbital.study import GRAVITY_ROW
from nav_model.suborbital.survey import STAR_FRAME_SPACING_S

Describe = Callable[[Content], Chart]
_SQUARE = 400  # pixels of height of a chart whose two axes must be alike


@dataclass(frozen=True)
class Charts:
    """Charts, then tables in one column; chooses: names of the choosers above."""

    name: str
    charts: tuple[Describe, ...] = ()
    tables: tuple[Callable[[Content], TableBlock], ...] = ()
    chooses: tuple[str, ...] = ()


_SPACING_S = round(STAR_FRAME_SPACING_S)


def _of(draw: Callable[[Content, int], Chart]) -> Describe:
    """A chart of the channel looked at."""
    return lambda page: draw(page, page.channel)


def _paper(index: int) -> Callable[[Content], TableBlock]:
    """One of the tables beside the published values."""
    return lambda page: paper_tables(page)[index]


VIEWS: tuple[Charts, ...] = (
    Charts("Errors", (_of(errors.aided_chart), _of(errors.source_chart)),
         chooses=("channel", "case", "aided_sources", "along_track")),
    Charts("Vertical-channel instability", (errors.growth_chart,), chooses=("case", "channel")),
    Charts("Error sources", tables=(source_table, gap_table)),
    Charts("Published values", tables=tuple(map(_paper, range(4)))),
    Charts("White noise", (_of(errors.noise_chart),), chooses=("channel",)),
    Charts("Attitude errors", (attitude.inertial_attitude_chart, attitude.navigation_attitude_chart), (method_table,),
         ("case",)),
    Charts("Stars", (attitude.star_chart,), (star_table,), ("moment",)),
    Charts("Flight path", (flight.map_chart, flight.height_chart, flight.force_chart, flight.rate_chart)),
    Charts("Gravity", (flight.gravity_chart,), (gravity_table,)),
)  # fmt: skip
"""In their order on the page."""

CAMERA_NOISE, INPUTS = "Camera noise", "Inputs"
_GROUPS = {
    "Position": ("Errors", "Vertical-channel instability"),
    "Sources": ("Error sources", "Published values"),
    "Noise": ("White noise", CAMERA_NOISE),
    "Attitude": ("Attitude errors", "Stars"),
    "Flight": ("Flight path", "Gravity"),
    INPUTS: (INPUTS,),
}

_COMING = "<p>The charts and tables of this view appear here with the first study.</p>"
CASES = {SUM: "all"} | {name: name for name in (*CLASSES, *SOURCES, GRAVITY_ROW) if name != "all"}


class StudyViews(View):
    """A switch and the view chosen, made when it is first opened, then fed while it is in view.

    The parameters are what a person chooses to look at; ``more`` are the views that are not of charts and tables.
    """

    case = chosen("all", CASES, "Error source")
    channel = chosen(2, {name: i for i, name in enumerate(CHANNELS)}, "Channel")
    aided_sources = chosen(False, {"INS alone": False, "INS with star tracker": True}, "Error sources of")
    along_track = chosen(False, {"north and east": False, "down-range and cross-range": True}, "Horizontal axes")
    moment: int = declared(param.Integer(default=100, bounds=(0, 1500), step=_SPACING_S, label="Star frame at [s]"))
    page = optional(Content, "What is on the page; None before the first answer.")

    def __init__(self, camera: pn.viewable.Viewer, inputs: pn.viewable.Viewer) -> None:
        super().__init__()
        self._parts: dict[str, Follower[Content]] = {}  # of the views opened so far
        self._coming = html_pane(_COMING)
        makes: dict[str, Callable[[], Any]] = {view.name: partial(self._place, view) for view in VIEWS}
        makes |= {CAMERA_NOISE: lambda: camera, INPUTS: lambda: inputs}
        self._view = self.views = NamedViews("What to see", makes, _GROUPS)
        self.views.param.watch(lambda _: self._draw(), "chosen")

    @property
    def looks(self) -> dict[str, Any]:
        """The user's choice of views, as fields of `Content`."""
        return {"star_index": self.moment // _SPACING_S} | {
            name: getattr(self, name) for name in ("case", "channel", "aided_sources", "along_track")
        }

    def last_moment(self, seconds: int) -> None:
        """Set the end of the time slider of the star frames."""
        self.moment = min(self.moment, seconds)
        self.param.moment.bounds = (0, seconds)

    def _place(self, view: Charts) -> pn.Column:
        """The place of a view; it is filled with the first answer."""
        parts = self._parts[view.name] = Follower(lambda: self.page)
        waiting = pn.Column(self._coming, sizing_mode="stretch_both", min_height=320, styles=FRAME, margin=(8, 10))
        return parts.later(
            partial(self._build, view, parts), waiting, sizing_mode="stretch_both", stylesheets=[NARROW]
        )

    def say_coming(self, progress: str) -> None:
        """Show the progress of the first study in the views that wait for it."""
        self._coming.object = f"{_COMING}<p class='quiet'>{escape(progress)}</p>"

    @param.depends("page", watch=True)
    def _draw(self) -> None:
        """Update the chosen view; the others are updated when they are opened."""
        if parts := self._parts.get(self.views.chosen):
            parts.follow()

    def _build(self, view: Charts, parts: Follower[Content]) -> pn.Column:
        fills: dict[str, Any] = {"sizing_mode": "stretch_both", "stylesheets": [NARROW]}
        scrolls = {**fills, "styles": {"overflow": "auto"}}
        made: list[Any] = []
        for draw in view.charts:
            square = draw(parts.known()).square
            chart = parts.chart(draw, _SQUARE if square else None)
            made.append(pn.Column(chart, **scrolls) if square else chart)
        if view.tables:
            made.append(pn.Column(*(_table(parts, build) for build in view.tables), **scrolls))
        half = len(made) // 2 or 1
        choosers = [pn.FlexBox(*map(self._chooser, view.chooses))] if view.chooses else []

        return pn.Column(first_screen(*choosers, left=made[:half], right=made[half:], height="100%"), **fills)

    def _chooser(self, name: str) -> Any:
        if name == "moment":
            return pmui.IntSlider.from_param(self.param.moment, width=260, margin=(4, 16))
        return pmui.Select.from_param(self.param[name], width=215, margin=(8, 6, 0, 6), size="small")


def _table(parts: Follower[Content], build: Callable[[Content], TableBlock]) -> SortableTable:
    table = SortableTable(margin=(4, 12))
    parts.add(lambda page: setattr(table, "html", html_of(build(page))))
    return table
