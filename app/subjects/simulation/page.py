"""The Simulate page: Monte Carlo of the design, and whether the formulas hold."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.charts.kinds import Chart
from app.charts.legend import key_html, legend_html
from app.charts.screen.timelines import Timelines
from app.declared import chosen
from app.document.blocks import Answer, Block
from app.document.numbers import number as text_of
from app.document.pane import html_of
from app.session import Session
from app.subjects.simulation.charts import (
    CONSISTENCY,
    TIMELINES,
    designed_attitude_chart,
    empty_charts,
    ensemble_chart,
    outage_chart,
    path_chart,
)
from app.subjects.simulation.files import FILES
from app.subjects.simulation.run import Flown, fly, subject
from app.subjects.simulation.tables import conditions_list, departures, run_table, sigma_table, verdict
from app.ui.chart_pane import described, head_html
from app.ui.downloads import download
from app.ui.fields import TextInput, number, whole_number
from app.ui.first_screen import first_screen
from app.ui.folded import Folded
from app.ui.html_pane import html_pane
from app.ui.run_bar import RunBar
from app.ui.study_page import StudyPage
from app.ui.theme import PRINT_NOTHING, STACK_ON_A_PHONE
from app.ui.upload import upload
from app.work.pool import read_in_pool, run_in_pool
from app.work.run import Run
from app.work.simulator import prepare
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.parts import declaration_of
from nav_model.design.trajectory import FLIGHT_FILES
from nav_model.simulation.design_study import SimulationStudy, specification
from nav_model.simulation.specification import SimulationSpec, TrajectorySpec
from nav_model.trajectory.design_study import plan_like, planned
from nav_model.trajectory.files.reader import parse_file

_PLAN = "plan"
_FLIGHTS = {
    "Nearly straight": "wandering",
    "Exactly straight": "straight",
    "Turns, then a long leg": "turns",
    "A climb half way": "climb",
    "The design's plan": _PLAN,
    "From a file": "file",
}
_FIELDS = {"duration": "Length", "outage": "Outages"}  # what a specification names -> its field here
_AXES = ["north", "east", "down"]
_MOST_RUNS = 2000
_MOST_SAMPLES = 1e9  # of the instrument, over all runs: ten minutes and more of one processor
_LONGEST_RUN = 2e6  # samples of one run: what a worker holds in memory
_POINTS = 600  # results kept along a run
_UPLOAD = 20_000_000  # bytes
_MOST_KEPT = 16_000_000  # bytes of a flight, for as long as the page is open
_LOOK: dict[str, Any] = {"margin": (2, 4), "size": "small"}
_HEAD = (6, 10, 0, 10)  # margin of the line above a chart
_KEY = key_html(solid="simulated", dashed="filter", dotted="formula", span="outage")
_EMPTY = ("position", "velocity", "attitude"), ("consistency", "nees")
_STACKS = {"Errors and sigmas": TIMELINES, "Consistency and NEES": CONSISTENCY}


class SimulatePage(StudyPage[Flown]):
    """Everything below the tab. The page flies its first settings by itself: an example of what it answers."""

    kind = "simulation"
    settings = ("trajectory", "runs", "length", "outages", "seed")
    moving = ("trajectory", "length", "outages")
    waiting = Answer(
        "Not run yet", "open", ("Press Start to compare simulated errors with the filter and the formulas.",)
    )
    trajectory = chosen("wandering", _FLIGHTS, "Trajectory")
    runs = param.String(default="50", label="Runs")
    length = param.String(default="300", label="Length [s]")
    outages = param.String(default="200,300", label="Outages [s]")
    seed = param.String(default="1", label="Seed")
    axis = chosen("north", _AXES, "Axis of the ensemble")

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self._file: TrajectorySpec | None = None
        self._bar = RunBar(self.run, self.begin, "Start", *self._fields(), strip=True)
        self._stacks: list[Timelines] = []  # made with the first result
        coming = f'<span class="quiet fine">{self.coming}</span>'
        self._heads = [html_pane(head_html(title, self.coming, coming), margin=_HEAD) for title in _STACKS]
        self._halves = [
            pn.Column(head, *_figures(Timelines(empty_charts(*names))), sizing_mode="stretch_both", min_height=430,
                      stylesheets=[STACK_ON_A_PHONE])
            for head, names in zip(self._heads, _EMPTY, strict=True)
        ]  # fmt: skip
        details = self._of_result
        self._view = pn.Column(
            self._strip,
            first_screen(
                self._bar, left=self._halves[:1], right=self._halves[1:],
            ),
            Folded(
                (
                    (
                        "Where formula and simulation differ, and why",
                        lambda: details.text(_html(departures, conditions_list)),
                    ),
                    ("Sigmas: simulated, filter, formula", lambda: details.text(_html(sigma_table))),
                    ("Simulation set-up", self._flown),
                    ("Outage growth and spread of the runs", self._spread),
                    ("Exports", lambda: details.later(self._exports)),
                )
            ),
        )  # fmt: skip
        self._open()
        if pn.state.curdoc:
            prepare()

    # --- the parts ------------------------------------------------------------------------------------

    def _fields(self) -> tuple[Any, ...]:
        choices, names = self.param, TextInput.from_param
        self._upload = upload(
            "Trajectory file", ",".join(FLIGHT_FILES), _UPLOAD, self._uploaded, self._refuse,
            visible=choices.trajectory.rx() == "file",
        )  # fmt: skip
        from_box = choices.trajectory.rx() != _PLAN  # a plan has its length and outages
        return (
            pmui.Select.from_param(choices.trajectory, width=180, **_LOOK),
            self._upload,
            names(choices.runs, width=70, placeholder=f"1 to {_MOST_RUNS}", **_LOOK),
            names(choices.length, width=90, visible=from_box, **_LOOK),
            names(choices.outages, placeholder="start,stop; start,stop", width=140, visible=from_box),
            names(choices.seed, width=65, **_LOOK),
        )  # fmt: skip

    def _write(self) -> None:
        super()._write()
        if self._result:
            drawn = [[draw(self._result.study) for draw in draws] for draws in _STACKS.values()]
            if not self._stacks:
                self._stack(drawn)
            for stack, charts in zip(self._stacks, drawn, strict=True):
                stack.feed(charts)
            for head, charts, title, key in zip(
                self._heads, drawn, _STACKS, (_KEY, _names(drawn[1][0])), strict=True
            ):
                knowledge = " ".join(chart.knowledge for chart in charts)
                head.say(head_html(title, knowledge, "".join(map(described, charts)), key))
        self._of_result.follow()

    def _stack(self, drawn: list[list[Chart]]) -> None:
        """Make the figures, all on one time axis."""
        for charts, half in zip(drawn, self._halves, strict=True):
            self._stacks.append(Timelines(charts, next(iter(self._stacks), None)))
            half.objects = [half.objects[0], *_figures(self._stacks[-1])]

    def _verdict(self, flown: Flown) -> Answer:
        answer = verdict(flown.study)
        if not flown.partial:
            return answer
        done = flown.study.result.spec.runs
        rest = (
            () if self.run.running else (f"{flown.wanted - done} runs remain. Press Start for all {flown.wanted}.",)
        )
        word = "Running" if self.run.running else f"Partial: {done} of {flown.wanted} runs"
        return Answer(word, "open", (*rest, f"{answer.word} after {done} runs.", *answer.sentences))

    def _subject(self, design: Design) -> object:
        return subject(design, plan=self.trajectory == _PLAN)

    def _flown(self) -> pn.Column:
        details = self._of_result
        charts = details.charts(_of_study(path_chart), _of_study(designed_attitude_chart), height=300)
        return pn.Column(details.text(_html(run_table)), charts)

    def _spread(self) -> pn.Column:
        axis = pmui.RadioButtonGroup.from_param(self.param.axis, margin=(4, 10))
        charts = (_of_study(outage_chart), lambda flown: ensemble_chart(flown.study, self.axis))
        return self._of_result.later(lambda: pn.Column(axis, self._of_result.charts(*charts, height=300)))

    @param.depends("axis", watch=True)
    def _look(self) -> None:
        with pn.io.hold():
            self._write()

    def _exports(self) -> pn.FlexBox:
        study = self._of_result.known
        names = {".json": "Everything (JSON)", ".npz": "Statistics (NPZ)", ".csv": "Sigmas (CSV)"}

        def file(kind: str) -> Any:
            return download(names[kind], f"simulation{kind}", lambda: FILES[kind](study().study))

        return pn.FlexBox(*map(file, names), stylesheets=[PRINT_NOTHING])

    # --- the run --------------------------------------------------------------------------------------

    async def _study(self, run: Run) -> Flown:
        try:
            return await fly(run, self._session.design, await self._specification())
        except InputError as error:
            raise error.under(_FIELDS.get(error.key, error.key)) from error

    @property
    def _key(self) -> tuple[str, ...] | None:
        return None if self.trajectory == "file" else super()._key

    def _begin_by_itself(self) -> None:
        if not self._settings.text:  # a link's thousand runs are for a person to start
            super()._begin_by_itself()

    def _finding(self, flown: Flown) -> SimulationStudy | None:
        return None if flown.partial else flown.study

    def _receive(self, flown: Flown) -> None:
        super()._receive(flown)
        done, wall_s = flown.study.result.spec, text_of(flown.study.result.wall_s)
        if not (self._by_itself and self._bar.message):  # what is there is of a file that was opened meanwhile
            self._say(f"{done.runs} × {done.duration:g} s in {wall_s} s, seed {done.seed}.")

    async def _specification(self) -> SimulationSpec:
        """Specification that the fields ask for.

        Raises
        ------
        InputError
            Naming the field, the option or the key of the design.
        """
        runs, seed = whole_number("Runs", self.runs, 1, _MOST_RUNS), whole_number("Seed", self.seed, 0, 2**53)
        length = number("Length", self.length, 1.0, 1e6)
        outages: Any = declaration_of("trajectory.outages").read(self.outages)
        flight: str | TrajectorySpec = self.trajectory
        if flight == "file":
            if self._file is None:
                raise InputError("Trajectory file", "open a file first")
            flight = self._file
        elif flight == _PLAN:
            plan = await run_in_pool(planned, self._session.design)
            flight, length, outages = plan.trajectory, plan.duration, self._session.design.trajectory.outages
        spec = specification(
            self._session.design,
            trajectory=flight,
            runs=runs,
            seed=seed,
            duration=length,
            outages=outages,
            every=max(1.0, round(length / _POINTS)),
        )
        if spec.steps > _LONGEST_RUN or spec.steps * spec.runs > _MOST_SAMPLES:
            raise InputError(
                "Length",
                f"{runs} runs of {length:g} s at {spec.imu.rate:g} Hz are more than the server simulates for one "
                "person. "
                "Enter fewer or shorter runs, or use the command `navbudget simulate`",
            )
        return spec

    async def _uploaded(self, name: str, content: bytes) -> None:
        try:
            design = self._session.design
            heights = design.flight.altitude, design.trajectory.ground or None
            file = await read_in_pool(parse_file, content, name, *heights)
            flight = await run_in_pool(file.flown, plan_like(design))
            if (size := len(flight.trajectory.samples)) > _MOST_KEPT:
                message = f"takes {size / 1e6:.0f} MB, at most {_MOST_KEPT // 10**6} here. Give fewer rows"
                raise InputError(name, f"{message}, or use the command `navbudget simulate`")
        except InputError as error:
            self._refuse(error)
        else:
            self._file = flight.trajectory
            self._say(f"{name}: a flight of {text_of(flight.duration, 4, given=True)} s; {flight.note}.")
            self.length = f"{math.floor(10 * flight.duration) / 10:.1f}"


def _figures(stack: Timelines) -> list[pn.pane.Bokeh]:
    return [pn.pane.Bokeh(plot, sizing_mode="stretch_both") for plot in stack.plots]


def _html(*tell: Callable[[SimulationStudy, str], Block]) -> Callable[[Flown], str]:
    """Blocks of a study as HTML."""
    return lambda flown: html_of(*(block(flown.study, "page") for block in tell))


def _of_study(draw: Callable[[SimulationStudy], Chart]) -> Callable[[Flown], Chart]:
    return lambda flown: draw(flown.study)


def _names(chart: Chart) -> str:
    """The legend of curves that are too near to one another for names at their ends."""
    return legend_html(replace(chart, lines=tuple(line for line in chart.lines if line.style != "reference")))
