"""The page Flight: the covariance along the flight that is planned, and the figures of its lines."""

import asyncio
import importlib
import json
import math
from dataclasses import replace
from html import escape
from typing import TYPE_CHECKING, Any

import panel as pn
import panel_material_ui as pmui
import param
from bokeh.events import DoubleTap

from app.charts.legend import key_html
from app.charts.screen.marker import PathMarker
from app.charts.screen.timelines import Timelines
from app.declared import chosen
from app.document.blocks import Answer
from app.document.pane import html_of
from app.session import Session
from app.subjects.trajectory.charts import map_chart, shares_chart, simulated, timelines
from app.subjects.trajectory.fields import PlanFields
from app.subjects.trajectory.figures import FIGURES, main_figure
from app.subjects.trajectory.kml import as_kml
from app.subjects.trajectory.manoeuvres import ManoeuvreBlock
from app.subjects.trajectory.plan_file import as_plan
from app.subjects.trajectory.run import waypoints_in, waypoints_of_lines
from app.subjects.trajectory.tables import line_list, line_table, verdict
from app.ui.chart_pane import ChartPane, described, head_html
from app.ui.downloads import download
from app.ui.drawer import Drawer
from app.ui.first_screen import first_screen
from app.ui.folded import Folded
from app.ui.html_pane import html_pane
from app.ui.run_bar import RunBar
from app.ui.study_page import StudyPage
from app.ui.theme import NARROW, PRINT_NOTHING, STACK_ON_A_PHONE
from app.ui.upload import UploadedFile, upload
from app.work.flight import OF_DESIGN, File, Followed, followed
from app.work.pool import read_in_pool, run_in_pool
from app.work.run import Run
from nav_model.base.errors import InputError
from nav_model.base.text.csv_text import csv_text
from nav_model.budget import Budget
from nav_model.design import Design
from nav_model.design.parts import Trajectory
from nav_model.design.trajectory import AIDING, FLIGHT_FILES, LINES, MOST_WAYPOINTS, WAYPOINTS, Rows, row_of

if TYPE_CHECKING:
    from nav_model.explore.manoeuvre import Manoeuvres
    from nav_model.trajectory.result import TrajectoryResult

_FILE = "file"
_NAMED = {f"{label[:1].upper()}{label[1:]}": name for name, label in Trajectory.param["flight"].options.items()}
_FLIGHTS = {**_NAMED, "From a file": _FILE}
_UPLOAD = 20_000_000  # bytes
_HAVE_A_LENGTH = tuple(name for name in _NAMED.values() if name not in (LINES, WAYPOINTS))
_SETTLE_SECONDS = 0.05  # a slider has come to rest after this long
_HEIGHT = "max(100dvh - 104px, 612px)"  # room for four charts above each other
_LOOK: dict[str, Any] = {"margin": (6, 4, 2, 4), "size": "small"}  # above: room for the label, where fields wrap
_RARE: dict[str, Any] = {"sizing_mode": "stretch_width", "size": "small", "explained": True}
_NUMBERS = ("climb_rate", "acceleration", "ground", *AIDING)
_KEY = {"solid": "real time", "dashed": "post-processed", "span": "no fixes"}
_RUNS = {"dotted": "simulated on this flight"}
_COMING = '<span class="quiet fine">Appears with the first result.</span>'
_ADDED = " A double click on the map adds one at the end."
_NOT_ADDED = "A double click adds a waypoint where the flight is one of waypoints: choose that first."
_LENGTHS = "Longest lines, near and far range"
_UNSOLVED = "Not solved: lines of another length cannot be flown here, or their flights together take too long."
_NO_FILE = "Open a file: plans (KML, KMZ, GPX, .plan) are flown at the design's speed, recordings as they were."


class TrajectoryPage(StudyPage[Followed]):
    """Everything below the tab. The flight is followed again whenever design or flight change."""

    kind = "trajectory"
    settings = ("figure",)
    moving = ("flight",)
    outdated = "Outdated: computed before the change of {moved}. The new result follows."
    waiting = Answer("Working", "open", ("The covariance along the flight follows.",))
    refusal = "Plan not flown"
    flight = chosen("wandering", _FLIGHTS, "Flight")
    figure = chosen("", {"What decides": "", **{of.label: name for name, of in FIGURES.items()}}, "Quantity")

    def __init__(self, session: Session) -> None:
        super().__init__(session, flight=session.design.trajectory.flight)
        self._file: File | None = None
        self._on_disk = UploadedFile()
        self._manoeuvres: ManoeuvreBlock | None = None
        self._plan = PlanFields(session, self._typed)
        of_flight = self._of_result
        # The flight is followed whenever something changes; how long lines may be takes many flights.
        self._bar = RunBar(self.run, lambda: self.begin(by_itself=False, lengths=True), _LENGTHS, strip=True)
        self._bar.start.param.update(icon="straighten", variant="outlined", size="small")
        self._drawer = Drawer("Plan", "route", *self._plan_parts())
        quantity = pmui.Select.from_param(self.param.figure, width=170, **_LOOK)
        self._stack = Timelines(timelines(None, self._shown))
        self._marker = PathMarker(self._stack.plots)
        self._head = html_pane("", margin=(6, 10, 0, 10))
        figures = [pn.pane.Bokeh(plot, sizing_mode="stretch_both") for plot in self._stack.plots]
        for figure, share in zip(figures, ("1", "1", "1", "1.5"), strict=True):  # the last has the axis
            figure.styles = {"flex": f"{share} 1 0"}
        # The drawer lies over the curves: map and verdicts follow beside it as the plan changes.
        curves = pn.Column(
            self._head, *figures, self._drawer, sizing_mode="stretch_both", min_height=430,
            styles={"position": "relative"}, stylesheets=[STACK_ON_A_PHONE],
        )  # fmt: skip
        whole: dict[str, Any] = {"sizing_mode": "stretch_both", "stylesheets": [NARROW]}
        self._sources: tuple[str, ...] = ()  # of the chart of shares that is shown
        self._shares = pn.Column(html_pane(_COMING))
        above = of_flight.later(self._map, **whole)
        verdicts = of_flight.text(lambda flown: html_of(line_list(flown, self._shown)))
        run = pn.Column(self._bar, styles={"flex": "1 1 240px", "min-width": "0"})
        tools = pn.FlexBox(
            quantity, self._drawer.button, run, align_items="center", margin=(0, 4), stylesheets=[PRINT_NOTHING]
        )
        self._body = first_screen(tools, left=[curves], right=[verdicts, above], height=_HEIGHT, fitted=True)
        self._view = pn.Column(
            self._strip,
            self._body,
            Folded(
                (
                    ("What would close it", self._what_would_close),
                    ("Shares by source", lambda: of_flight.later(self._share_chart)),
                    ("Table by line", lambda: of_flight.text(lambda flown: html_of(line_table(flown, self._shown)))),
                    ("Exports", lambda: of_flight.later(self._exports)),
                )
            ),
        )
        session.param.watch(self._flown, "findings")
        self._follow_plan()
        self._open()

    def show(self, _: Budget) -> None:
        """Follow the budget's design, also back from one that was refused."""
        self._follow_plan()
        if self._manoeuvres is not None:
            self._manoeuvres.follow()
        if (self._result is None or self._outdated or self.run.message) and not self._recall():
            self.begin(_SETTLE_SECONDS)

    def go_to(self, place: str) -> None:
        """Open the plan, for "#flight-plan"."""
        if place == "plan":
            self._drawer.open()

    def _follow_plan(self) -> None:
        self._plan.show()
        if self.flight != _FILE:
            self.flight = self._session.design.trajectory.flight
        self._places.visible = self.flight == WAYPOINTS

    def begin(self, settle: float = 0.0, *, by_itself: bool = True, lengths: bool = False) -> asyncio.Task[None]:
        """Follow the flight of the design, or of the file, after `settle` seconds; one under way is cancelled.

        ``lengths``: solve how long its lines may be too.
        """
        self._lengths = lengths
        if self._manoeuvres is not None:
            self._manoeuvres.follow()
        if self._bar.message == _UNSOLVED:  # of the design before
            self._say("")
        return super().begin(settle, by_itself=by_itself)

    async def _study(self, run: Run) -> Followed:
        session, lengths = self._session, self._lengths
        if self.flight == WAYPOINTS and not session.design.trajectory.waypoints:
            self._take(await run_in_pool(waypoints_of_lines, session.design))
            self._ask()
        asked = session.design, self._flown_file
        if self._of_design and not lengths:
            try:
                return await session.flight.of(session.design, lambda progress: run.param.update(progress=progress))
            except asyncio.CancelledError:
                if run.mine:  # somebody has pressed Cancel: nobody waits for it any more
                    session.flight.run.cancel()
                raise
        flown = await followed(*asked, lengths, progress=lambda share, what: run.tell(what, share or None))
        if lengths and not _solved(flown.result):
            self._say(_UNSOLVED)
        return flown

    @property
    def _of_design(self) -> bool:
        """True if the flight is that of the design, which its verdict has, and no study beside it."""
        return self.flight != _FILE

    @property
    def _shown(self) -> str:
        """The quantity that is shown."""
        return self.figure or (main_figure(self._result) if self._result else "detrended_phase")

    @property
    def _flown_file(self) -> File | None:
        return self._file if self.flight == _FILE else None

    @property
    def _key(self) -> tuple[str, ...] | None:
        if self._of_design:
            return OF_DESIGN, self._session.design.content_hash
        return None if self.flight == _FILE else super()._key

    @property
    def _refused(self) -> str:
        return self._plan.refused or (_NO_FILE if self.flight == _FILE and self._file is None else "")

    def _verdict(self, followed: Followed) -> Answer:
        return verdict(followed)

    def _typed(self) -> None:
        """Follow what was typed; what is refused changes nothing, and the strip says why."""
        if self._plan.refused:
            self._redraw()
        else:
            self.begin()

    def _say(self, text: str) -> None:
        """On the page and in the drawer, which lies over it."""
        super()._say(text)
        self._drawer.note.say(f'<p role="status">{escape(text)}</p>' if text else "")

    # --- the parts ------------------------------------------------------------------------------------

    def _plan_parts(self) -> tuple[Any, ...]:
        """Parts of the drawer: the flight and its inputs, numbered waypoints, aiding, limits of single lines."""
        choices, box, flies = self.param, self._plan.box, self.param.flight.rx
        file = upload("Plan or recording", ",".join(FLIGHT_FILES), _UPLOAD, self._uploaded, self._refuse)
        lines, turns, named = (flies.in_(those) for those in ((LINES,), (LINES, WAYPOINTS), _HAVE_A_LENGTH))
        rare = pn.Column(
            box("bank", visible=turns, **_RARE), *(box(name, **_RARE) for name in ("outages", *_NUMBERS))
        )
        self._places = pn.Column(self._plan.table("waypoints", "waypoint", _ADDED), visible=False)
        return (
            pn.FlexBox(
                pmui.Select.from_param(choices.flight, width=190, **_LOOK),
                file,
                box("lines", width=90, visible=lines, **_LOOK),
                box("length", width=130, visible=lines, **_LOOK),
                box("spacing", width=150, visible=lines, **_LOOK),
                box("duration", width=190, visible=named, **_LOOK),
                align_items="center",
                margin=(0, 10),
            ),
            self._places,
            self._plan.limits(),
            Folded(
                (
                    (
                        "More: turns, outages, aiding",
                        lambda: rare,
                    ),
                )
            ),
        )

    def _map(self) -> pn.Column:
        """The map; a double click on it adds a waypoint."""
        pane: ChartPane[Followed] = ChartPane(map_chart, self._of_result.known)
        self._marker.join(pane.figure.plot)

        def show(flown: Followed) -> None:
            pane.show(flown)
            self._marker.feed(flown.result.time_s, flown.east / 1000, flown.north / 1000)

        self._of_result.add(show)
        pane.figure.plot.on_event(DoubleTap, self._placed)
        return pane.view

    def _placed(self, event: DoubleTap) -> None:
        waypoints = self._session.design.trajectory.waypoints
        if event.x is None or event.y is None:
            return
        if self.flight != WAYPOINTS or not waypoints:
            self._say(_NOT_ADDED)
            return
        place = self._of_result.known().place(1000.0 * event.y, 1000.0 * event.x)
        self._take((*waypoints, row_of(*place, waypoints[-1][2])))

    def _flown(self, event: Any) -> None:
        """Lay the runs of a new simulation over the curves."""
        if event.new.get("simulation") is not event.old.get("simulation"):
            self._redraw()

    @param.depends("figure", watch=True)
    def _redraw(self) -> None:
        with pn.io.hold():
            self._write()

    def _write(self) -> None:
        super()._write()
        result = self._result
        study = self._session.findings.get("simulation")
        flown = study and study.result
        charts = timelines(result, self._shown, flown)
        if result is not None:
            self._stack.feed(charts)
        description, knowledge = "".join(map(described, charts)), charts[0].knowledge
        key = _COMING if result is None else key_html(**_KEY, **(_RUNS if simulated(result, flown) else {}))
        self._head.say(head_html("Along the flight", knowledge, description, key))
        faint = self._refused or self.run.message or (result and self._outdated)
        self._body.styles = {"opacity": "0.5" if faint else "1"}  # an empty one would leave it as it was
        lines = result.result.lines if result and not result.file else ()
        self._bar.start.visible = any(line.limits for line in lines) and not (result and _solved(result.result))
        if not self.run.running:
            self._of_result.follow()

    def _what_would_close(self) -> ManoeuvreBlock:
        """The options of the plan or file, flown when this is first opened."""

        def share(design: Design, file: File | None, options: "Manoeuvres") -> None:
            result, name = self._result, file.name if file else ""
            if result is not None and (result.design, result.file) == (design, name):
                self._session.keep(self.kind, replace(result, options=options))

        self._manoeuvres = ManoeuvreBlock(self._session, lambda: self._flown_file, share)
        self._manoeuvres.begin()
        return self._manoeuvres

    def _share_chart(self) -> pn.Column:
        """Stacked shares: a chart for each set of sources, as their names are its structure."""

        def show(flown: Followed) -> None:
            chart = shares_chart(flown, self._shown)
            sources = (chart.title, *(band.label for band in chart.bands))
            if sources != self._sources:
                self._sources = sources
                self._pane: ChartPane[Followed] = ChartPane(self._drawn_shares, self._of_result.known, 320)
                self._shares.objects = [self._pane.view]
            else:
                self._pane.show(flown)

        self._of_result.add(show)
        return self._shares

    def _drawn_shares(self, result: Followed) -> Any:
        return shares_chart(result, self._shown)

    def _exports(self) -> pn.FlexBox:
        known = self._of_result.known
        return pn.FlexBox(
            download("Everything (JSON)", "trajectory.json", lambda: as_json(known())),
            download("Figures (CSV)", "trajectory.csv", lambda: as_csv(known())),
            download("Lines with their verdict (KML)", "trajectory.kml", lambda: as_kml(known())),
            download("Plan with lines (QGroundControl)", "trajectory.plan", lambda: as_plan(known())),
            stylesheets=[PRINT_NOTHING],
        )

    # --- the flight -----------------------------------------------------------------------------------

    @param.depends("flight", watch=True)
    def _again(self) -> None:
        self._places.visible = self.flight == WAYPOINTS
        if self.flight == _FILE and self._file is None:
            self._redraw()
            return
        if self.flight != _FILE:
            self._session.change({"trajectory.flight": self.flight})
        self._say("")
        self.begin(_SETTLE_SECONDS)

    def _take(self, waypoints: Rows) -> None:
        """Put a plan into the design."""
        problem = self._session.change({"trajectory.flight": WAYPOINTS, "trajectory.waypoints": waypoints})
        if problem is not None:
            self._refuse(problem)

    async def _uploaded(self, name: str, content: bytes) -> None:
        await asyncio.to_thread(importlib.import_module, "nav_model.trajectory.files.reader")
        try:
            places, note = await read_in_pool(waypoints_in, content, name, self._session.design)
            if not 0 < len(places) <= MOST_WAYPOINTS:
                self._file = File(name, await self._on_disk.put(content))
                self.flight = _FILE
        except InputError as error:
            self._refuse(error)
            return
        if 0 < len(places) <= MOST_WAYPOINTS:
            self._take(places)
            self.flight = WAYPOINTS
            self._say(f"Loaded {name}: {note}.")
        else:
            self._say(f"{name}: {note}.")
            self.begin()


def _solved(result: "TrajectoryResult") -> bool:
    """True if lengths of lines, or near and far range, are known."""
    return bool(result.swath) or any(line.longest_s is not None for line in result.lines)


def as_json(followed: Followed) -> str:
    """The result as JSON, as `navbudget trajectory` prints it."""
    from nav_model.trajectory.result import to_json

    return json.dumps(to_json(followed.result, followed.budget.verdict), allow_nan=False)


def as_csv(followed: Followed) -> str:
    """Every figure over time in SI, both processings; an empty cell where no aperture lies within the flight."""
    result = followed.result
    parts = {"real time": result.real_time, "post-processed": result.post_processed}
    head = ["time_s", *(f"{name} ({processing})" for processing in parts for name in FIGURES)]
    columns = [part.figures[name] for part in parts.values() for name in FIGURES]
    rows = zip(result.time_s, *columns, strict=True)
    return csv_text([head, *([("" if math.isnan(x) else x) for x in row] for row in rows)])
