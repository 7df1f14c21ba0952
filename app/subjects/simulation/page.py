"""The Simulate page: the design flown many times, and whether the closed forms hold."""

from __future__ import annotations

import asyncio
import importlib
import io
import json
import math
from collections.abc import Callable
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np
import panel as pn
import panel_material_ui as pmui

from app.charts.kinds import Chart
from app.session import Session
from app.subjects.simulation.controls import StudyControls
from app.subjects.simulation.run import (
    Compiling,
    News,
    Progress,
    Result,
    SimulationRun,
    outages_of,
    prepare,
    same_subject,
)
from app.ui.chart_pane import ChartView, chart_cells
from app.ui.grid import grid
from app.ui.html_pane import html_pane
from app.upstream.file_input import LimitedFileInput
from app.work.pool import elsewhere
from nav_model.budget import Budget
from nav_model.errors import InputError
from nav_model.simulation.design_study import specification, to_document
from nav_model.simulation.specification import FILTER_STATES, SimulationSpec, TrajectorySpec

if TYPE_CHECKING:
    from nav_model.simulation.design_study import SimulationStudy

_FLIGHTS = {
    "wandering": "Nearly straight",
    "straight": "Exactly straight",
    "turns": "Turns, then a long leg",
    "climb": "A climb half way",
    "file": "From a file (CSV)",
}
_MOST_RUNS = 2000
_MOST_SAMPLES = 1e9  # of the instrument, over all runs: ten minutes and more of one processor
_LONGEST_RUN = 2e6  # samples of one run: what a worker holds in memory
_POINTS = 600  # results kept along a run
_UPLOAD = 20_000_000  # bytes
_LOOK: dict[str, Any] = {"description": "", "size": "small", "margin": (8, 6)}
_START = (
    "<p>Flies this design as a strapdown INS with a Kalman filter, many times over, each run with errors of its own, "
    "and holds the errors against the filter's own covariance and against the closed forms.</p>"
    "<p>Press <b>Start</b>; how far it has come stands here meanwhile. You will see:</p><ul>"
    "<li>rms of the runs beside the filter's sigma and the closed form, steady and through the outage;</li>"
    "<li>whether the filter is consistent: the mean NEES inside its 95 % band, or optimistic;</li>"
    "<li>where a closed form departs from the runs, and why.</li></ul>"
    "<p class='quiet'>Outages are start,stop in seconds, several parted by semicolons. Fifteen states estimate the "
    "biases as well. The same seed gives the same errors again.</p>"
)


class SimulatePage:
    """Everything below the tab."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._result: Result | None = None
        self._file: TrajectorySpec | None = None
        self._charts: list[ChartView] = []
        self._run = SimulationRun(self._told)
        self._more = StudyControls()
        self._state = html_pane(_START, margin=(4, 12))
        self._answer = html_pane("")
        self._place = pn.Column(sizing_mode="stretch_width", margin=0)
        self._downloads = pn.FlexBox(visible=False, sizing_mode="stretch_width", margin=(0, 4))
        self.view = pn.Column(
            self._controls(),
            self._more.view,
            self._state,
            self._answer,
            self._downloads,
            self._place,
            sizing_mode="stretch_width",
        )
        for label, suffix, make in (
            ("Statistics (NPZ)", "npz", self._npz),
            ("Sigmas (CSV)", "csv", self._csv),
            ("Everything (JSON)", "json", self._json),
        ):
            self._downloads.append(
                pmui.FileDownload(
                    callback=make,
                    filename=f"simulation.{suffix}",
                    label=label,
                    icon="download",
                    variant="text",
                    **_LOOK,
                )
            )
        if pn.state.curdoc:
            pn.state.on_session_destroyed(lambda _: self._run.cancel())
            prepare()

    def show(self, budget: Budget) -> None:
        """Follow the budget in force: a result of other instruments or another flight is marked stale."""
        if self._result is not None:
            self._write(self._result)

    # --- the parts ------------------------------------------------------------------------------------

    def _controls(self) -> pn.FlexBox:
        self._flight = pmui.Select(
            label="Trajectory",
            options={name: key for key, name in _FLIGHTS.items()},
            value="wandering",
            width=250,
            **_LOOK,
        )
        self._upload = LimitedFileInput(
            lambda why: self._say(f"Not used. {why}"),
            label="Trajectory file", accept=".csv", icon="upload_file", max_file_size=_UPLOAD, visible=False,
            variant="outlined", **_LOOK,
        )  # fmt: skip
        self._runs = pmui.TextInput(label="Runs", value="50", width=70, **_LOOK)
        self._length = pmui.TextInput(label="Length [s]", value="300", width=90, **_LOOK)
        self._outages = pmui.TextInput(
            label="Outages [s]", value="200,300", placeholder="start,stop; start,stop", width=150, **_LOOK
        )
        self._seed = pmui.TextInput(label="Seed", value="1", width=70, **_LOOK)
        self._states = pmui.Select(
            label="Filter", options={f"{n} states": n for n in FILTER_STATES}, value=9, width=120, **_LOOK
        )
        self._start = pmui.Button(label="Start", icon="play_arrow", variant="contained", **_LOOK)
        self._stop = pmui.Button(label="Cancel", icon="stop", variant="outlined", disabled=True, **_LOOK)
        self._start.on_click(self._begin)
        self._stop.on_click(lambda _: self._run.cancel())
        self._flight.param.watch(lambda event: setattr(self._upload, "visible", event.new == "file"), "value")
        self._upload.param.watch(self._uploaded, "value")
        return pn.FlexBox(
            self._flight, self._upload, self._runs, self._length, self._outages, self._seed, self._states,
            pn.Row(self._start, self._stop, margin=0),
            align_items="center", sizing_mode="stretch_width", margin=(6, 4, 0, 4),
        )  # fmt: skip

    def _layout(self) -> tuple[tuple[Callable[[SimulationStudy], Chart], int, int], ...]:
        """Chart, height in pixels, columns of twelve on a wide screen."""
        from app.subjects.simulation import charts

        return (
            (charts.horizontal_position_chart, 340, 6),
            (charts.vertical_position_chart, 340, 6),
            (charts.horizontal_velocity_chart, 300, 6),
            (charts.vertical_velocity_chart, 300, 6),
            (charts.tilt_chart, 300, 6),
            (charts.yaw_chart, 300, 6),
            (charts.outage_chart, 340, 6),
            (self._ensemble, 340, 6),
            (charts.nees_chart, 300, 12),
            (charts.path_chart, 280, 6),
            (charts.designed_attitude_chart, 280, 6),
        )

    def _ensemble(self, study: SimulationStudy) -> Chart:
        from app.subjects.simulation.charts import ensemble_chart

        return ensemble_chart(study, self._axis.value)

    def _draw(self) -> None:
        """Make the figures: once, with the first result."""
        self._axis = pmui.RadioButtonGroup(
            label="Axis of the ensemble", options=["north", "east", "down"], value="north", **_LOOK
        )
        self._axis.param.watch(lambda _: self._feed(), "value")
        layout = self._layout()
        cells = chart_cells(
            layout, lambda what, high: ChartView(lambda _: what(self._study), self._session, high), self._charts
        )
        cells[[describe for describe, *_ in layout].index(self._ensemble)].append(self._axis)
        self._place.append(grid(*cells))

    @property
    def _study(self) -> SimulationStudy:
        assert self._result is not None
        return self._result.study

    def _feed(self) -> None:
        with pn.io.hold():
            for chart in self._charts:
                chart.show(self._session.budget)

    def _write(self, result: Result) -> None:
        from app.subjects.simulation.tables import answer

        self._answer.object = answer(result, not same_subject(result.design, self._session.design))

    # --- the run --------------------------------------------------------------------------------------

    async def _begin(self, _: Any = None) -> None:
        try:
            spec = self._specification()
        except InputError as error:
            self._say(f"Not flown. {error}")
            return
        self._busy(True)
        self._run.start(self._session.design, spec)

    def _specification(self) -> SimulationSpec:
        runs, seed = _whole("Runs", self._runs.value, 1, _MOST_RUNS), _whole("Seed", self._seed.value, 0, 2**53)
        length = _seconds(self._length.value)
        flight: str | TrajectorySpec = self._flight.value
        if flight == "file":
            if self._file is None:
                raise InputError("Trajectory file", "none given yet")
            flight = self._file
        spec = specification(
            self._session.design,
            trajectory=flight,
            runs=runs,
            seed=seed,
            duration=length,
            outages=outages_of(self._outages.value or ""),
            every=max(1.0, round(length / _POINTS)),
            states=self._states.value,
            more=self._more.inputs,
        )
        if spec.steps > _LONGEST_RUN or spec.steps * spec.runs > _MOST_SAMPLES:
            raise InputError(
                "Length",
                f"{runs} runs of {length:g} s at {spec.imu.rate:g} Hz are more than a server flies for one; fewer, "
                "or `navbudget simulate`",
            )
        return spec

    def _told(self, news: News) -> None:
        with pn.io.hold():
            if isinstance(news, Compiling | Progress):
                from app.subjects.simulation.tables import under_way

                self._state.object = under_way(news)
                return
            if isinstance(news, Result):
                self._result = news
                if not news.partial:
                    self._session.keep("simulation", news.study)
                if not self._place.objects:
                    self._draw()
                self._write(news)
                self._feed()
                self._downloads.visible = True
            if isinstance(news, str):
                self._say(news)
            if not self._run.running:
                self._busy(False)
                if isinstance(news, Result):
                    self._state.object = ""

    def _say(self, text: str) -> None:
        self._state.object = f'<p role="status">{escape(text)}</p>'

    def _busy(self, running: bool) -> None:
        self._session.running = running
        self._start.disabled = running
        self._stop.disabled = not running

    async def _uploaded(self, event: Any) -> None:
        if not event.new:
            return
        name = str(self._upload.filename or "file")
        # Imports Numba, which takes a second: in a thread, so that others' sliders move on.
        files = await asyncio.to_thread(importlib.import_module, "nav_model.simulation.trajectory")
        try:
            flight = await elsewhere(files.parse_trajectory, event.new, name)
        except InputError as error:
            self._say(f"Not used. {error}")
        else:
            self._file = flight
            length = files.file_duration(flight)
            self._say(f"{name}: a flight of {length:.4g} s.")
            self._length.value = f"{math.floor(10 * length) / 10:.1f}"

    # --- to take away ---------------------------------------------------------------------------------

    def _npz(self) -> io.BytesIO:
        from nav_model.simulation.result import to_arrays

        packed = io.BytesIO()
        np.savez_compressed(
            packed, **to_arrays(self._study.result), refined_position_sigma_m=self._study.refined_sigma
        )
        packed.seek(0)
        return packed

    def _csv(self) -> io.BytesIO:
        from nav_model.simulation.result import to_csv

        return io.BytesIO(to_csv(self._study.result).encode("utf-8"))

    def _json(self) -> io.BytesIO:
        return io.BytesIO(json.dumps(to_document(self._study), ensure_ascii=False, indent=1).encode("utf-8"))


def _whole(name: str, text: str, low: int, high: int) -> int:
    if not (text.strip().isdecimal() and low <= int(text) <= high):
        raise InputError(name, f"{text[:30]!r} is not a whole number from {low} to {high}")
    return int(text)


def _seconds(text: str) -> float:
    try:
        length = float(text)
    except ValueError:
        length = math.nan
    if not 1.0 <= length <= 1e6:
        raise InputError("Length", f"{text[:30]!r} is not a number of seconds, 1 or more, such as 300")
    return length
