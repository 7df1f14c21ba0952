"""The Simulate page: the design flown many times, and whether the formulas hold."""

from __future__ import annotations

import asyncio
import importlib
import io
import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import panel as pn
import panel_material_ui as pmui
import param

from app.charts.kinds import Chart
from app.declared import declared, held
from app.document.blocks import Bullets, Text
from app.document.numbers import number as shown
from app.document.pane import html_of
from app.document.wording import title_of
from app.session import Session
from app.subjects.simulation.controls import StudyControls
from app.subjects.simulation.files import as_csv, as_json, as_npz
from app.subjects.simulation.run import Flown, fly, same_subject
from app.ui.chart_pane import ChartPane, chart_cells
from app.ui.downloads import download
from app.ui.fields import number, whole_number
from app.ui.grid import grid
from app.ui.html_pane import block_pane, html_pane, stale_mark
from app.ui.run_bar import RunBar
from app.upstream.file_input import LimitedFileInput
from app.work.pool import elsewhere
from app.work.run import Run
from app.work.simulator import prepare
from nav_model.budget import Budget
from nav_model.errors import InputError
from nav_model.simulation.design_study import specification
from nav_model.simulation.specification import FILTER_STATES, SimulationSpec, TrajectorySpec

if TYPE_CHECKING:
    from nav_model.simulation.design_study import SimulationStudy

_FLIGHTS = {
    "Nearly straight": "wandering",
    "Exactly straight": "straight",
    "Turns, then a long leg": "turns",
    "A climb half way": "climb",
    "From a file (CSV)": "file",
}
_AXES = ["north", "east", "down"]
_MOST_RUNS = 2000
_MOST_SAMPLES = 1e9  # of the instrument, over all runs: ten minutes and more of one processor
_LONGEST_RUN = 2e6  # samples of one run: what a worker holds in memory
_POINTS = 600  # results kept along a run
_UPLOAD = 20_000_000  # bytes
_LOOK: dict[str, Any] = {"margin": (8, 6)}
_HEIGHTS = (340, 340, 300, 300, 300, 300, 340, 340, 300, 280, 280)  # pixels, of the charts in their order
_START = (
    Text(
        "Runs a Monte Carlo of this design, a strapdown INS with a Kalman filter, and compares the errors with the "
        "filter covariance and the formulas. Press Start. Progress appears beside the button, then you will see:"
    ),
    Bullets((
        "the rms of the runs beside the filter's sigma and the formula, steady and through the outage;",
        "whether the filter is consistent (the mean NEES lies inside its 95 % band), optimistic or pessimistic;",
        "where a formula departs from the runs, and why.",
    )),
    Text(
        "Enter outages as start,stop in seconds; separate several with semicolons. Fifteen states estimate the "
        "biases as well. The same seed gives the same errors again."
    ),
)  # fmt: skip


class SimulatePage(pn.viewable.Viewer):
    """Everything below the tab."""

    run = held(Run)
    trajectory: str = declared(param.Selector(default="wandering", objects=_FLIGHTS))
    runs = param.String(default="50", label="Runs")
    length = param.String(default="300", label="Length [s]")
    outages = param.String(default="200,300", label="Outages [s]")
    seed = param.String(default="1", label="Seed")
    states: int = declared(
        param.Selector(default=9, objects={f"{count} states": count for count in FILTER_STATES}, label="Filter")
    )
    axis: str = declared(param.Selector(default="north", objects=_AXES, label="Axis of the ensemble"))

    def __init__(self, session: Session) -> None:
        super().__init__(run=session.new_run())
        self._session = session
        self._file: TrajectorySpec | None = None
        self._charts: list[ChartPane[SimulationStudy]] = []
        self._more = StudyControls()
        self._bar = RunBar(self.run, self._begin, "Start", *self._fields())
        self._start = block_pane(*_START, margin=(4, 12))
        self._note, self._answer = html_pane("", margin=(2, 10)), html_pane("")
        self._place = pn.Column()
        self._view = pn.Column(
            self._bar,
            self._more,
            self._start,
            self._note,
            self._answer,
            pn.FlexBox(
                download("Statistics (NPZ)", "simulation.npz", lambda: io.BytesIO(as_npz(self._study))),
                download("Sigmas (CSV)", "simulation.csv", lambda: io.BytesIO(as_csv(self._study).encode())),
                download("Everything (JSON)", "simulation.json", lambda: io.BytesIO(as_json(self._study).encode())),
                visible=self.run.param.result.rx.is_not(None), margin=(0, 4),
            ),
            self._place,
        )  # fmt: skip
        if pn.state.curdoc:
            prepare()

    def __panel__(self) -> pn.Column:
        return self._view

    def show(self, _: Budget) -> None:
        """Follow the budget in force: a result of other instruments or another flight is marked stale."""
        if self.run.result is not None:
            self._note.object = self._said(self.run.result)

    # --- the parts ------------------------------------------------------------------------------------

    def _fields(self) -> tuple[Any, ...]:
        choices, names = self.param, pmui.TextInput.from_param
        self._upload = LimitedFileInput(
            lambda why: self._say(f"Not used. {why}"),
            label="Trajectory file", accept=".csv", icon="upload_file", max_file_size=_UPLOAD, variant="outlined",
            visible=choices.trajectory.rx() == "file", **_LOOK,
        )  # fmt: skip
        self._upload.param.watch(self._uploaded, "value")
        return (
            pmui.Select.from_param(choices.trajectory, width=250, **_LOOK),
            self._upload,
            names(choices.runs, width=70, **_LOOK),
            names(choices.length, width=90, **_LOOK),
            names(choices.outages, placeholder="start,stop; start,stop", width=150, **_LOOK),
            names(choices.seed, width=70, **_LOOK),
            pmui.Select.from_param(choices.states, width=120, **_LOOK),
        )

    def _draw(self) -> None:
        """Make the figures: once, with the first result."""
        from app.subjects.simulation.charts import CHARTS, ensemble_chart, nees_chart

        def ensemble(study: SimulationStudy) -> Chart:
            return ensemble_chart(study, self.axis)

        layout = [
            (ensemble if draw is ensemble_chart else draw, height, 12 if draw is nees_chart else 6)
            for draw, height in zip(CHARTS, _HEIGHTS, strict=True)
        ]
        cells = chart_cells(layout, lambda what, high: ChartPane(what, lambda: self._study, high), self._charts)
        cells[CHARTS.index(ensemble_chart)].append(pmui.RadioButtonGroup.from_param(self.param.axis, **_LOOK))
        self._place.append(grid(*cells))

    @property
    def _study(self) -> SimulationStudy:
        flown: Flown = self.run.result
        return flown.study

    @param.depends("axis", watch=True)
    def _feed(self) -> None:
        with pn.io.hold():
            for chart in self._charts:
                chart.show(self._study)

    # --- the run --------------------------------------------------------------------------------------

    def _begin(self) -> None:
        async def work(run: Run) -> Flown:
            return await fly(run, self._session.design, self._specification())

        self.run.start(work)

    @param.depends("run.result", watch=True)
    def _found(self) -> None:
        from app.subjects.simulation.tables import findings, verdict

        flown: Flown = self.run.result
        if not flown.partial:
            self._session.keep("simulation", flown.study)
        with pn.io.hold():
            self._start.visible = False
            self._note.object = self._said(flown)
            said = verdict(flown.study)
            said = replace(said, tone="open") if flown.partial else said
            self._answer.object = html_of(said, *findings(flown.study, "page"))
            if not self._place.objects:
                self._draw()
            self._feed()

    def _said(self, flown: Flown) -> str:
        """Of what the result is: of all runs or some, of this design or an earlier one."""
        done = flown.study.result.spec
        partial = f"Partial: {done.runs} of {flown.wanted} runs. " if flown.partial else ""
        wall_s = shown(flown.study.result.wall_s)
        design = flown.study.design
        said = f"{partial}{title_of(design)}: {done.runs} × {done.duration:g} s in {wall_s} s, seed {done.seed}."
        if same_subject(design, self._session.design):
            return html_of(Text(said))
        return html_of(Text(said)) + stale_mark("The instruments or the flight have changed since.")

    def _specification(self) -> SimulationSpec:
        """What the fields ask for.

        Raises
        ------
        InputError
            Naming the field, the option or the key of the design.
        """
        runs, seed = whole_number("Runs", self.runs, 1, _MOST_RUNS), whole_number("Seed", self.seed, 0, 2**53)
        length = number("Length", self.length, 1.0, 1e6)
        flight: str | TrajectorySpec = self.trajectory
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
            outages=outages_of(self.outages),
            every=max(1.0, round(length / _POINTS)),
            states=self.states,
            more=self._more.inputs,
        )
        if spec.steps > _LONGEST_RUN or spec.steps * spec.runs > _MOST_SAMPLES:
            raise InputError(
                "Length",
                f"{runs} runs of {length:g} s at {spec.imu.rate:g} Hz are more than a server flies for one person. "
                "Ask for fewer or shorter ones, or use `navbudget simulate`",
            )
        return spec

    def _say(self, text: str) -> None:
        self._bar.message = text

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
            self._say(f"{name}: a flight of {shown(length, 4)} s.")
            self.length = f"{math.floor(10 * length) / 10:.1f}"


def outages_of(text: str) -> tuple[tuple[float, float], ...]:
    """Outages as people write them: ``200,300`` or ``100,150; 200,300``, seconds; none for an empty text.

    Raises
    ------
    InputError
        Under "outages".
    """
    try:
        pairs = [tuple(float(part) for part in piece.split(",")) for piece in text.split(";") if piece.strip()]
    except ValueError:
        pairs = [()]
    if any(len(pair) != 2 for pair in pairs):
        raise InputError("outages", f"{text[:60]!r} is not start,stop in seconds, such as 200,300 or 50,80; 200,300")
    return tuple((pair[0], pair[1]) for pair in pairs)
