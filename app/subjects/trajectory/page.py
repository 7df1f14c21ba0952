"""The Trajectory page: the covariance along the flight that is planned, and the figures of its lines."""

from __future__ import annotations

import asyncio
import importlib
import json
import math
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.charts.csv_text import csv_text
from app.charts.screen.timelines import Timelines
from app.declared import chosen, held
from app.document.blocks import Answer
from app.document.pane import html_of
from app.session import Session
from app.subjects.trajectory.charts import map_chart, shares_chart, timelines
from app.subjects.trajectory.figures import FIGURES
from app.subjects.trajectory.run import Asked, File, Followed, Strip, follow
from app.subjects.trajectory.tables import line_table, verdict
from app.ui.answer_strip import AnswerStrip
from app.ui.chart_pane import ChartPane, described, head_html, takes
from app.ui.downloads import download
from app.ui.fields import number, outages_of, whole_number
from app.ui.first_screen import first_screen
from app.ui.folded import Folded
from app.ui.follower import Follower
from app.ui.html_pane import html_pane
from app.ui.run_bar import RunBar
from app.ui.study_settings import StudySettings
from app.ui.theme import PRINT_NOTHING, STACK_ON_A_PHONE
from app.ui.upload import upload
from app.ui.view import View
from app.work.kept import keep, kept
from app.work.pool import elsewhere
from app.work.run import Run
from nav_model.base.errors import InputError
from nav_model.budget import Budget
from nav_model.simulation.specification import FILTER_STATES

_FLIGHTS = {
    "Parallel lines": "strip",
    "Nearly straight": "wandering",
    "Exactly straight": "straight",
    "Turns, then a long leg": "turns",
    "A climb half way": "climb",
    "From a file": "file",
}
_KINDS = (".gpx", ".kml", ".csv", ".out")
_UPLOAD = 20_000_000  # bytes
_SETTLE_SECONDS = 0.3  # a slider has come to rest after this long
_LOOK: dict[str, Any] = {"margin": (6, 4, 2, 4), "size": "small"}  # above: room for the label, where fields wrap
_KEY = '<span class="quiet fine">solid: real time · dashed: post-processed · grey: no fixes</span>'
_COMING = '<span class="quiet fine">Appears with the first result.</span>'
_WAITING = Answer("Working", "open", ("The covariance along the flight follows.",))
_ASKED = ("flight", "count", "length", "spacing", "heading", "speed", "bank", "duration", "outages", "states")


class TrajectoryPage(View):
    """Everything below the tab. The flight is followed again whenever design or flight change."""

    run = held(Run)
    flight = chosen("strip", _FLIGHTS, "Flight")
    count = param.String(default="4", label="Lines")
    length = param.String(default="5000", label="Line length [m]")
    spacing = param.String(default="1000", label="Spacing [m]")
    heading = param.String(default="", label="Heading [°]")
    speed = param.String(default="", label="Speed [m/s]")
    bank = param.String(default="25", label="Bank [°]")
    duration = param.String(default="500", label="Length [s]")
    outages = param.String(default="", label="Outages [s]")
    states = chosen(9, {f"{count} states": count for count in FILTER_STATES}, "Filter")
    figure = chosen("detrended_phase", {one.label: name for name, one in FIGURES.items()}, "Quantity")

    def __init__(self, session: Session) -> None:
        super().__init__(run=session.new_run())
        self._session = session
        self._file: File | None = None
        self._details = details = Follower(lambda: self._result, _COMING)
        self._strip = AnswerStrip(_WAITING)
        self._bar = RunBar(self.run, self.start, "Compute", *self._fields())
        self._stack = Timelines(timelines(None, self.figure))
        self._head = html_pane("", margin=(6, 10, 0, 10))
        curves = pn.Column(
            self._head, *(pn.pane.Bokeh(plot, sizing_mode="stretch_both") for plot in self._stack.plots),
            sizing_mode="stretch_both", min_height=430, stylesheets=[STACK_ON_A_PHONE],
        )  # fmt: skip
        whole = {"sizing_mode": "stretch_both"}
        self._sources: tuple[str, ...] = ()  # of the chart of shares that is shown
        self._shares = pn.Column(html_pane(_COMING), **whole)
        above = details.later(lambda: details.chart(lambda found: map_chart(found, self.figure)), **whole)
        self._view = pn.Column(
            first_screen(self._strip, self._bar, left=[curves], right=[above, self._shares]),
            Folded(
                (
                    ("Table by line", lambda: details.text(lambda found: html_of(line_table(found, self.figure)))),
                    ("Exports", lambda: details.later(self._exports)),
                )
            ),
        )
        self._settings = StudySettings(session, "trajectory", self, (*_ASKED, "figure"), lambda: None)
        self._write()
        if pn.state.curdoc:
            self.start()

    def show(self, _: Budget) -> None:
        """Follow the budget's design."""
        if self._result is None or self._result.design != self._session.design:
            self.start(_SETTLE_SECONDS)

    def start(self, settle: float = 0.0) -> asyncio.Task[None]:
        """Follow the flight that the fields ask for, after `settle` seconds; one under way is cancelled."""

        async def work(run: Run) -> Followed:
            await asyncio.sleep(settle)
            design, asked, wanted = self._session.design, self._asked(), self._settings.asked
            known: Followed | None = None if isinstance(asked.flight, File) else kept(*wanted)
            if known is not None:
                return known
            run.tell("Following the covariance along the flight")
            # Imports Numba, which takes a second: in a thread, so that others' sliders move on.
            await asyncio.to_thread(importlib.import_module, "nav_model.trajectory.lines")
            found = await elsewhere(follow, design, asked)
            if not isinstance(asked.flight, File):
                keep(found, *wanted)
            return found

        return self.run.start(work)

    # --- the parts ------------------------------------------------------------------------------------

    def _fields(self) -> tuple[Any, ...]:
        choices, text = self.param, pmui.TextInput.from_param
        chosen = choices.flight.rx
        strip, file = chosen() == "strip", chosen() == "file"
        self._upload = upload(
            "GPX, KML, CSV or SBET file", ",".join(_KINDS), _UPLOAD, self._uploaded,
            lambda why: self._say(f"Not used. {why}"), visible=file,
        )  # fmt: skip
        own = {"placeholder": "design's"}
        return (
            pmui.Select.from_param(choices.figure, width=160, **_LOOK),
            pmui.Select.from_param(choices.flight, width=160, **_LOOK),
            self._upload,
            text(choices.count, width=60, visible=strip, **_LOOK),
            text(choices.length, width=105, visible=strip, **_LOOK),
            text(choices.spacing, width=90, visible=strip, **_LOOK),
            text(choices.heading, width=105, visible=strip, **own, **_LOOK),
            text(choices.speed, width=120, visible=strip, **own, **_LOOK),
            text(choices.bank, width=70, visible=strip, **_LOOK),
            text(choices.duration, width=90, visible=chosen().rx.pipe(_has_a_length), **_LOOK),
            text(choices.outages, placeholder="start,stop; ...", width=120, **_LOOK),
            pmui.Select.from_param(choices.states, width=105, **_LOOK),
        )

    @property
    def _result(self) -> Followed | None:
        result: Followed | None = self.run.result
        return result

    @param.depends("run.result", "run.running", "run.message", "figure", watch=True)
    def _show(self) -> None:
        with pn.io.hold():
            self._write()

    def _write(self) -> None:
        """Strip, charts and what was unfolded."""
        found, run = self._result, self.run
        self._strip.show(*self._answer())
        charts = timelines(found, self.figure)
        if found is not None:
            self._stack.feed(charts)
            self._show_shares(found)
        said, knowledge = "".join(map(described, charts)), charts[0].knowledge
        self._head.say(head_html("Along the flight", knowledge, said, _COMING if found is None else _KEY))
        if not run.running:
            self._details.follow()

    def _answer(self) -> tuple[Answer, str]:
        """The verdict, and whether it is one of what the fields and the design say now."""
        found, message = self._result, self.run.message
        if found is None:
            return (Answer("No result yet", "warn", (message,)) if message else _WAITING), ""
        stale = "This is the result before it." if message else ""
        return verdict(found, self.figure), stale and f"{message} {stale}"

    def _show_shares(self, found: Followed) -> None:
        """Stacked shares: a chart for each set of sources, as their names are its structure."""
        chart = shares_chart(found, self.figure)
        sources = (chart.title, *(band.label for band in chart.bands))
        if sources != self._sources:
            self._sources = sources
            self._pane: ChartPane[Followed] = ChartPane(self._drawn_shares, self._details.known)
            self._shares.objects = [self._pane.view]
        else:
            self._pane.show(found)

    def _drawn_shares(self, found: Followed) -> Any:
        return shares_chart(found, self.figure)

    def _exports(self) -> pn.FlexBox:
        known = self._details.known
        return pn.FlexBox(
            download("Everything (JSON)", "trajectory.json", lambda: as_json(known())),
            download("Figures (CSV)", "trajectory.csv", lambda: as_csv(known())),
            *takes(lambda found: map_chart(found, self.figure), known),
            *takes(self._drawn_shares, known),
            stylesheets=[PRINT_NOTHING],
        )

    # --- the flight -----------------------------------------------------------------------------------

    @param.depends(*_ASKED, watch=True)
    def _again(self) -> None:
        if self.flight == "file" and self._file is None:
            self._say("Open a file: GPX and KML are plans, flown at the design's speed; CSV and SBET were flown.")
        else:
            self.start(_SETTLE_SECONDS)

    def _asked(self) -> Asked:
        """What the fields ask for.

        Raises
        ------
        InputError
            Naming the field.
        """
        flight: str | Strip | File = self.flight
        if flight == "strip":
            flight = Strip(
                count=whole_number("Lines", self.count, 1, 100),
                length=number("Line length", self.length, 1.0, 1e6),
                spacing=number("Spacing", self.spacing, -1e6, 1e6),
                bank=math.radians(number("Bank", self.bank, 1.0, 80.0)),
                heading=math.radians(number("Heading", self.heading, -360.0, 360.0)) if self.heading else None,
                speed=number("Speed", self.speed, 1.0, 3000.0) if self.speed else None,
            )
        elif flight == "file":
            if self._file is None:
                raise InputError("Flight", "open a GPX, KML, CSV or SBET file first")
            flight = self._file
        return Asked(flight, number("Length", self.duration, 1.0, 1e6), outages_of(self.outages), self.states)

    def _say(self, text: str) -> None:
        self._bar.message = text

    def _uploaded(self, name: str, content: bytes) -> None:
        if not name.lower().endswith(_KINDS):
            self._say(f"Not used. {name} is not a GPX, KML, CSV or SBET (.out) file.")
            return
        self._file = File(name, content)
        self.start()


def _has_a_length(flight: str) -> bool:
    """Whether a flight is as long as the field says."""
    return flight not in {"strip", "file"}


def as_json(found: Followed) -> str:
    """The command's document."""
    from nav_model.trajectory.result import to_json

    return json.dumps(to_json(found.result), allow_nan=False)


def as_csv(found: Followed) -> str:
    """Every figure over time in SI, both processings; an empty cell where no aperture lies within the flight."""
    result = found.result
    parts = {"real time": result.real_time, "post-processed": result.post_processed}
    head = ["time_s", *(f"{name} ({processing})" for processing in parts for name in FIGURES)]
    columns = [part.figure(name) for part in parts.values() for name in FIGURES]
    rows = zip(result.time_s, *columns, strict=True)
    return csv_text([head, *([("" if math.isnan(x) else float(x)) for x in row] for row in rows)])
