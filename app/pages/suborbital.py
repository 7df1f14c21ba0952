"""The Suborbital page: what a star tracker repairs of an INS over a suborbital flight, and what it does not."""

from __future__ import annotations

import asyncio
import io
import json
import time
from collections.abc import Callable
from dataclasses import dataclass
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.chart_view import ChartPane, html_pane, prose
from app.charts import suborbital as charts
from app.charts.description import Chart
from app.charts.suborbital import CHANNELS, Shown
from app.long_run import RunLost, run_alone
from app.sortable_table import SortableTable
from app.state import Session
from app.suborbital.answer import answer, waiting
from app.suborbital.controls import SettingControl, setting_controls
from app.suborbital.tables import (
    Table,
    gravity_table,
    method_table,
    paper_tables,
    source_table,
    star_table,
)
from app.theme import FRAME
from app.upload import LimitedFileInput
from app.workers import elsewhere
from nav_model.budget import Budget
from nav_model.inputs import DesignError
from nav_model.suborbital.settings import DEFAULTS, GROUPS, Settings, Value, from_design
from nav_model.suborbital.study import Gap, position_gap
from nav_model.suborbital.survey import Renewed, Survey, moved, needs_other_matrices, needs_run, renewed, run_survey
from nav_model.suborbital.survey_json import gap_json, survey_json
from nav_model.suborbital.trajectory_file import MAX_BYTES

_SETTLE_SECONDS = 0.6  # a slider that needs a new run has come to rest after this long
_GROUP_OPEN = 1  # gyros: what the tracker replaces

Describe = Callable[[Shown], Chart]


@dataclass(frozen=True)
class _Tab:
    """A tab of the page: charts as (description, height, columns of twelve), then tables as (builder, columns)."""

    name: str
    charts: tuple[tuple[Describe, int, int], ...]
    beside: str = "xl"  # width of the screen from which charts stand beside each other
    tables: tuple[Callable[[Shown], Table], ...] = ()


_TABS: tuple[_Tab, ...] = (
    _Tab("Errors", tuple((make(c), 300, 6) for c in (2, 1, 0) for make in (charts.source_chart, charts.aided_chart))),
    _Tab("Unstable height", ((charts.growth_chart, 440, 12),)),
    _Tab("Tables", (), "xl", (*(lambda shown, i=i: paper_tables(shown)[i] for i in range(4)), source_table)),
    _Tab("Attitude", ((charts.inertial_attitude_chart, 340, 6), (charts.navigation_attitude_chart, 340, 6)),
         "md", (method_table,)),
    _Tab("Stars", ((charts.star_chart, 460, 6), (charts.star_count_chart, 340, 6)), "xl",
         (star_table,)),
    _Tab("Flight", ((charts.map_chart, 320, 6), (charts.height_chart, 320, 6), (charts.force_chart, 280, 6),
                    (charts.rate_chart, 280, 6), (charts.gravity_chart, 320, 12)), "xl", (gravity_table,)),
)  # fmt: skip
_CASES = {"everything": "all"} | {
    name: name
    for name in (*charts.SHOWN_SOURCES[:-1], "accelerometer total", "gyro total", "initial position",
                 "initial velocity", "star tracker misalignment", "star tracker latency", "gravity model")
}  # fmt: skip


class SuborbitalPage:
    """Everything below the tab. The first run starts when the page is opened."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self.settings: Settings = DEFAULTS
        self.trajectory: tuple[str, bytes] | None = None
        self.survey: Survey | None = None
        self.shown: Shown | None = None
        self.gap: Gap | None = None
        self._flown: tuple[str, bytes] | None = None  # the trajectory of `survey`
        self._looks: dict[str, Any] = {"case": "all", "channel": 2, "aided_sources": False, "star_index": 50}
        self._running: asyncio.Task[None] | None = None
        self._renewing: asyncio.Task[None] | None = None
        self._started = 0.0
        self._controls: list[SettingControl] = []
        self._panes: dict[int, list[ChartPane[Shown]]] = {}
        self._tables: dict[int, list[tuple[SortableTable, Callable[[Shown], Table]]]] = {}
        self._answer = html_pane(waiting())
        self.view = self._layout()
        if pn.state.curdoc:
            pn.state.on_session_destroyed(lambda _: self._stop())
            self.run()

    def show(self, budget: Budget) -> None:
        """The design enters by the button only; the study has its own inputs."""

    # --- layout ----------------------------------------------------------------------------------------

    def _layout(self) -> pn.viewable.Viewable:
        self._places = [pn.Column(sizing_mode="stretch_width", margin=0) for _ in _TABS]
        self._tabs = pn.Tabs(
            *((tab.name, place) for tab, place in zip(_TABS, self._places, strict=True)),
            dynamic=True,
            sizing_mode="stretch_width",
            margin=(0, 0, 0, 4),
        )
        self._tabs.param.watch(lambda _: self._draw(), "active")
        return pn.Column(
            self._answer,
            self._run_bar(),
            pmui.Grid(
                pmui.Grid(self._inputs(), size={"xs": 12, "lg": 3}),
                pmui.Grid(pn.Column(self._look_bar(), self._tabs, sizing_mode="stretch_width"),
                          size={"xs": 12, "lg": 9}),
                container=True,
                spacing=1,
                sizing_mode="stretch_width",
                margin=(4, 6),
            ),
            sizing_mode="stretch_width",
        )  # fmt: skip

    def _run_bar(self) -> pn.viewable.Viewable:
        self._state = html_pane("", margin=(2, 14))
        self.recompute = pmui.Button(label="Recompute exactly", icon="calculate", variant="outlined", **_LOOK)
        self.cancel = pmui.Button(label="Cancel", icon="close", variant="outlined", visible=False, **_LOOK)
        self._progress = pmui.LinearProgress(
            value=0, variant="determinate", visible=False, sizing_mode="stretch_width", margin=(2, 14)
        )
        self.recompute.on_click(lambda _: self.run())
        self.cancel.on_click(lambda _: self._stop())
        export = pmui.FileDownload(
            callback=self._json, filename="suborbital.json", label="Study (JSON)", variant="text", description="",
            **_LOOK,
        )  # fmt: skip
        bar = pn.FlexBox(self.recompute, self.cancel, export, sizing_mode="stretch_width", margin=(2, 8))
        return pn.Column(bar, self._progress, self._state, sizing_mode="stretch_width", margin=0)

    def _look_bar(self) -> pn.viewable.Viewable:
        case = pmui.Select(label="Error source", options=_CASES, value="all", width=250, **_LOOK_SELECT)
        channel = pmui.Select(
            label="Channel", options={name: i for i, name in enumerate(CHANNELS)}, value=2, width=190, **_LOOK_SELECT,
        )  # fmt: skip
        aided = pmui.Select(
            label="Errors by source of", options={"INS alone": False, "INS with star tracker": True}, value=False,
            width=200, **_LOOK_SELECT,
        )  # fmt: skip
        self._moment = pmui.IntSlider(
            label="Star frame at [s]", description="", start=0, end=1500, step=2, value=100, size="small", width=260,
            margin=(4, 16),
        )  # fmt: skip
        for name, widget in (("case", case), ("channel", channel), ("aided_sources", aided)):
            widget.param.watch(lambda event, name=name: self._look(name, event.new), "value")
        self._moment.param.watch(lambda event: self._look("star_index", event.new // 2), "value")
        self._choosers = {
            "Errors": [case, aided],
            "Unstable height": [case, channel],
            "Tables": [],
            "Attitude": [case],
            "Stars": [self._moment],
            "Flight": [],
        }
        self._chooser = pn.FlexBox(*self._choosers["Errors"], sizing_mode="stretch_width", margin=0)
        return self._chooser

    def _inputs(self) -> pn.viewable.Viewable:
        sections = [pn.Column(margin=0, sizing_mode="stretch_width") for _ in GROUPS]
        self._sections = sections
        narrow = "Mobi" in (pn.state.headers or {}).get("User-Agent", "")
        opened = [] if narrow else [_GROUP_OPEN]  # on a phone the inputs stand above the charts
        accordion = pmui.Accordion(
            *zip(GROUPS, sections, strict=True),
            active=opened,
            title_variant="subtitle1",
            sizing_mode="stretch_width",
            margin=0,
        )
        accordion.param.watch(lambda event: [self._fill(index) for index in event.new], "active")
        for index in opened:
            self._fill(index)
        take = pmui.Button(label="Take the design's IMU", icon="input", variant="text", **_LOOK)
        back = pmui.Button(label="GP-1 again", icon="restart_alt", variant="text", **_LOOK)
        take.on_click(lambda _: self._adopt(lambda: from_design(self.settings, self._session.design)))
        back.on_click(lambda _: self._adopt(lambda: DEFAULTS))
        self._file = LimitedFileInput(
            lambda why: self._file_said.param.update(object=_said(f"Not flown. {why}")),
            label="Trajectory from a file", accept=".csv", icon="upload_file", max_file_size=MAX_BYTES,
            variant="text", description="", **_LOOK,
        )  # fmt: skip
        self._file.param.watch(self._opened, "value")
        self._golden = pmui.Button(label="Golden flight again", variant="text", visible=False, **_LOOK)
        self._golden.on_click(lambda _: self._fly(None))
        self._file_said = html_pane(FILE_HELP, margin=(0, 12))
        return pn.Column(
            html_pane("<h3>Inputs of the study</h3>", margin=(6, 12, 0, 12)),
            pn.FlexBox(take, back, margin=(0, 4), sizing_mode="stretch_width"),
            accordion,
            pn.FlexBox(self._file, self._golden, margin=(4, 4, 0, 4), sizing_mode="stretch_width"),
            self._file_said,
            styles=FRAME,
            sizing_mode="stretch_width",
            margin=0,
        )

    def _fill(self, index: int) -> None:
        if self._sections[index].objects:
            return
        keys = [setting.key for setting in list(GROUPS.values())[index]]
        controls = setting_controls(keys, self.settings, self.put)
        self._controls += controls
        self._sections[index].objects = [control.view for control in controls]

    # --- what a person does ------------------------------------------------------------------------------

    def put(self, key: str, value: Value) -> DesignError | None:
        """Put one input in force; returns what is wrong with it, if anything."""
        return self._adopt(lambda: self.settings.change({key: value}, "you"))

    def _adopt(self, make: Callable[[], Settings]) -> DesignError | None:
        try:
            settings = make()
        except DesignError as error:
            return error
        self.settings = settings
        with pn.io.hold():
            for control in self._controls:
                control.show(settings)
            self._follow()
        return None

    def _opened(self, event: Any) -> None:
        if event.new:
            self._fly((str(self._file.filename or "file"), event.new))

    def _fly(self, trajectory: tuple[str, bytes] | None) -> None:
        self._take(trajectory)
        self.run()

    def _take(self, trajectory: tuple[str, bytes] | None) -> None:
        self.trajectory = trajectory
        self._golden.visible = trajectory is not None
        self._file_said.object = FILE_HELP if trajectory is None else _said(f"Flown: {trajectory[0]}")

    def _look(self, name: str, value: Any) -> None:
        self._looks[name] = value
        if self.shown is not None and self.survey is not None:
            self._put_on_screen(self.shown.study)

    # --- following the inputs ----------------------------------------------------------------------------

    def _follow(self) -> None:
        """Move the curves to the settings in force, or start what they need first."""
        if self.survey is None:
            self.run()
        elif needs_run(self.survey, self.settings) or self.trajectory != self._flown:
            self.run(_SETTLE_SECONDS)
        elif needs_other_matrices(self.survey, self.settings):
            if self._renewing is None:
                self._renewing = asyncio.get_running_loop().create_task(self._renew())
        else:
            self._show_moved(None)

    def _show_moved(self, renewal: Renewed | None) -> None:
        assert self.survey is not None
        same = dict(self.settings.values) == dict(self.survey.settings.values)
        self.gap = self.gap if same else None
        self._put_on_screen(self.survey.study if same else moved(self.survey, self.settings, renewal))

    async def _renew(self) -> None:
        """Matrices for other frames or periods, in a worker; only the last settings count."""
        try:
            while True:
                assert self.survey is not None
                survey, settings = self.survey, self.settings
                renewal = await elsewhere(renewed, survey.study, settings)
                if settings is self.settings:
                    break
            if survey is self.survey:
                with pn.io.hold():
                    self._show_moved(renewal)
        finally:
            self._renewing = None

    def run(self, settle: float = 0.0) -> None:
        """Start an exact run at the settings in force; one under way is ended."""
        self._stop()
        self._running = asyncio.get_running_loop().create_task(self.run_exactly(settle))

    def _stop(self) -> None:
        if self._running is not None:
            self._running.cancel()

    async def run_exactly(self, settle: float = 0.0) -> None:
        """Run the survey in a process of its own and show it; progress and cancel are on the page."""
        task = asyncio.current_task()
        await asyncio.sleep(settle)
        settings, trajectory, before = self.settings, self.trajectory, self.shown
        self._started = time.monotonic()
        self._session.running = True
        self._busy(True)
        self._progressed(0.0, "starting")
        try:
            survey: Survey = await run_alone(run_survey, settings, trajectory, progress=self._progressed)
        except (ValueError, RunLost) as error:
            if trajectory is not None and trajectory != self._flown:  # the file is refused, not kept
                self._take(self._flown)
            self._finish(task, f'<span class="mark">✗ Not computed.</span> {prose(str(error))}')
            return
        except asyncio.CancelledError:
            self._finish(task, "Cancelled; what is shown is the last answer.")
            raise
        comparable = before is not None and not before.exact and self.survey is not None
        if comparable and before is not None and not needs_run(before.survey, settings) and trajectory == self._flown:
            self.gap = position_gap(before.study.pure.position_m, before.study.aided.position_m, survey.study)
        else:
            self.gap = None
        self.survey, self._flown = survey, trajectory
        last = int(survey.star_frames[-1].time_s)
        with pn.io.hold():
            self._moment.end = last
            self._looks["star_index"] = min(self._looks["star_index"], len(survey.star_frames) - 1)
            self._finish(task, "")
            self._follow()

    def _finish(self, task: asyncio.Task[None] | None, said: str) -> None:
        """The run is over; a run that was replaced leaves the bar to the one that replaced it."""
        if self._running is not None and self._running is not task:
            return
        self._running = None
        self._session.running = False
        self._busy(False)
        self._state.object = _said_html(said) if said else ""

    def _busy(self, busy: bool) -> None:
        self.cancel.visible = self._progress.visible = busy

    def _progressed(self, share: float, what: str) -> None:
        spent = time.monotonic() - self._started
        left = f", about {spent / share * (1 - share):.0f} s left" if share > 0.1 else ""
        self._progress.value = round(100 * share)
        self._state.object = _said(f"Computing: {what}, {100 * share:.0f} %{left}")

    # --- on screen ---------------------------------------------------------------------------------------

    def _put_on_screen(self, study: Any) -> None:
        assert self.survey is not None
        self.shown = Shown(self.survey, study, **self._looks)
        with pn.io.hold():
            self._answer.object = answer(self.shown, self.settings, self.gap)
            self._draw()

    def _draw(self) -> None:
        """Feed the tab in view, made when first opened."""
        index = self._tabs.active
        tab = _TABS[index]
        wanted = self._choosers[tab.name]
        if self._chooser.objects != wanted:
            self._chooser.objects = wanted
        shown = self.shown
        if shown is None:
            return
        if index not in self._panes:
            self._build(index, shown)
            return
        for pane in self._panes[index]:
            pane.show(shown)
        for place, build in self._tables[index]:
            place.html = build(shown).html

    def _build(self, index: int, shown: Shown) -> None:
        tab = _TABS[index]
        panes = [ChartPane(describe, self._current, height) for describe, height, _ in tab.charts]
        tables = [
            (SortableTable(html=build(shown).html, sizing_mode="stretch_width", margin=(8, 12)), build)
            for build in tab.tables
        ]
        self._panes[index], self._tables[index] = panes, tables
        cells = [
            pmui.Grid(pane.view, size={"xs": 12, tab.beside: columns})
            for pane, (_, _, columns) in zip(panes, tab.charts, strict=True)
        ]
        cells += [pmui.Grid(self._table_view(place, build, shown), size={"xs": 12}) for place, build in tables]
        self._places[index].objects = [
            pmui.Grid(*cells, container=True, spacing=1, sizing_mode="stretch_width", margin=(4, 0))
        ]

    def _table_view(self, place: SortableTable, build: Callable[[Shown], Table], shown: Shown) -> pn.Column:
        table = build(shown)
        download = pmui.FileDownload(
            callback=lambda: io.BytesIO(build(self._current()).csv().encode("utf-8")),
            filename=f"{table.key}.csv", label=f"{table.title.partition(' at ')[0]}: data (CSV)", variant="text",
            description="", **_LOOK,
        )  # fmt: skip
        return pn.Column(place, download, styles=FRAME, sizing_mode="stretch_width", margin=0)

    def _current(self) -> Shown:
        assert self.shown is not None
        return self.shown

    def _json(self) -> io.BytesIO:
        if self.shown is None or self.survey is None:
            return io.BytesIO(b"{}")
        content = survey_json(self.survey, self.shown.study, self.settings)
        if self.gap is not None:
            content["linear_gap"] = gap_json(self.gap)
        return io.BytesIO(json.dumps(content, ensure_ascii=False, allow_nan=False, indent=1).encode("utf-8"))


_LOOK: dict[str, Any] = {"size": "small", "margin": 2}
_LOOK_SELECT: dict[str, Any] = {"description": "", "size": "small", "margin": (10, 6, 4, 6)}
FILE_HELP = (
    '<p class="know quiet">CSV with time_s, latitude_deg, longitude_deg, height_m, roll_deg, pitch_deg, yaw_deg; '
    f"at most {MAX_BYTES // 1_000_000} MB, rows a second apart or less during thrust.</p>"
)


def _said(text: str) -> str:
    return _said_html(escape(text))


def _said_html(text: str) -> str:
    return f'<p class="know" role="note">{text}</p>'
