"""The SAR page: which way of navigating through the aperture, its price in the image, and the pictures."""

from __future__ import annotations

import asyncio
import io
import json
from collections.abc import Callable
from functools import partial
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.charts.kinds import AnyChart
from app.declared import declared, held
from app.document.pane import html_of
from app.session import Session
from app.subjects.sar.charts import RUN_CHARTS, STRATEGY_CHARTS, WINNER_CHARTS, point_picture, scene_picture
from app.subjects.sar.picture_panel import PicturePanel
from app.subjects.sar.run import SarResult, run_strategies
from app.subjects.sar.tables import answer, cautions, error_table, run_tables, runs_in_words, runs_said
from app.subjects.sar.upload import UploadedPicture
from app.ui.chart_pane import ChartPane, ChartView, chart_cells
from app.ui.downloads import download
from app.ui.fields import whole_number
from app.ui.grid import grid
from app.ui.html_pane import html_pane, stale_mark
from app.ui.run_bar import RunBar
from app.work.run import Run
from nav_model.budget import Budget
from nav_model.sar.design_case import Engine
from nav_model.sar.design_study import ClosedForms, SarStudy, closed_forms
from nav_model.sar.study_json import to_json

_RUNS = (100, 200, 500, 1000)
_ENGINES: dict[str, Engine] = {"Error model, per axis": "fast", "Full simulator": "simulator"}
_LOOK: dict[str, Any] = {"margin": (8, 6)}


class SarPage(pn.viewable.Viewer):
    """Everything below the tab. Closed forms and maps follow the sliders; the ensemble runs on demand."""

    run = held(Run)
    engine: Engine = declared(param.Selector(default="fast", objects=_ENGINES, label="Engine"))
    runs: int = declared(param.Selector(default=_RUNS[0], objects=list(_RUNS), label="Runs"))
    seed = param.String(default="0", label="Seed")

    def __init__(self, session: Session) -> None:
        super().__init__(run=session.new_run())
        self._session = session
        self._budget = session.budget
        self._closed: ClosedForms = closed_forms(session.budget)
        self._answer, self._found, self._errors = html_pane(""), html_pane(""), html_pane("")
        self._tables, self._cautions = html_pane(""), html_pane("")
        self._of_runs = ""  # the tables of the runs, which no slider changes
        self._bar = RunBar(
            self.run,
            self._begin,
            "Run the strategies",
            pmui.Select.from_param(self.param.engine, width=200, **_LOOK),
            pmui.Select.from_param(self.param.runs, width=100, **_LOOK),
            pmui.TextInput.from_param(self.param.seed, width=80, **_LOOK),
        )
        self._points = PicturePanel("Point target", "sar-point")
        self._scene = PicturePanel("Eight point targets", "sar-scene")
        self._upload = UploadedPicture(session, lambda: self._result)
        self._charts: list[ChartView] = []
        self._run_charts: list[ChartPane[SarStudy | None]] = []
        self._view = pn.Column(
            self._answer,
            self._bar,
            self._found,
            self._errors,
            self._tables,
            self._cautions,
            pn.FlexBox(
                download("All of the study (JSON)", "sar-study.json", self._json),
                visible=self.run.param.result.rx.is_not(None), margin=(0, 4),
            ),
            grid(*self._cells()),
            self._points,
            self._scene,
            self._upload,
        )  # fmt: skip
        self._write()
        if pn.state.curdoc:
            pn.state.onload(self._begin)

    def __panel__(self) -> pn.Column:
        return self._view

    def show(self, budget: Budget) -> None:
        """Follow the budget in force."""
        self._budget = budget
        self._closed = closed_forms(budget)
        self._write()
        for chart in self._charts:
            chart.show(budget)

    # --- the parts ------------------------------------------------------------------------------------

    def _cells(self) -> list[pn.Column]:
        """Every chart: those that follow the sliders around those of the runs, which do not."""

        def of_strategies(draw: Callable[..., AnyChart], budget: Budget) -> AnyChart:
            return draw(budget, self._closed, self._study)

        layout: list[tuple[Callable[[Budget], AnyChart], int, int]] = [
            *((partial(of_strategies, draw), 360, 6) for draw in STRATEGY_CHARTS),
            *((draw, 400, 6) for draw in WINNER_CHARTS),
        ]
        moving = chart_cells(layout, lambda what, high: ChartView(what, self._session, high), self._charts)
        still = chart_cells(
            [(draw, 320, 6) for draw in RUN_CHARTS],
            lambda what, high: ChartPane(what, lambda: self._study, high),
            self._run_charts,
        )
        first = len(STRATEGY_CHARTS)
        return [*moving[:first], *still, *moving[first:]]

    @property
    def _result(self) -> SarResult | None:
        result: SarResult | None = self.run.result
        return result

    @property
    def _study(self) -> SarStudy | None:
        return self._result.study if self._result else None

    def _write(self) -> None:
        """Words, tables and marks; a text that stays the same is not sent."""
        result, study = self._result, self._study
        mark = ""
        if result is None:
            self._bar.message = "Only the formulas so far: the strategies have not been run."
        else:
            matched = "The runs match the design."
            if result.stale(self._budget):
                matched = "The runs are of an earlier design: run again."
                mark = stale_mark("The runs are of an earlier design.")
            self._bar.message = f"{matched} {runs_in_words(result.study)}."
            self._found.object = mark + html_of(runs_said(result.study))
            self._tables.object = mark + self._of_runs
        self._points.stale = self._scene.stale = mark
        self._answer.object = html_of(*answer(self._budget, self._closed))
        self._errors.object = html_of(error_table(self._budget, self._closed, study, "page"))
        self._cautions.object = html_of(cautions(self._budget, study))

    # --- the run --------------------------------------------------------------------------------------

    def _begin(self) -> None:
        async def work(run: Run) -> SarResult:
            seed = whole_number("Seed", self.seed, 0, 2**31)
            return await run_strategies(run, self._session.budget, self.runs, seed, self.engine)

        self.run.start(work)

    @param.depends("run.result", watch=True)
    def _take(self) -> None:
        result: SarResult = self.run.result
        self._session.keep("sar", result)
        with pn.io.hold():
            self._of_runs = html_of(*run_tables(result.study, result.beside, "page"))
            self._write()
            self._points.chart, self._scene.chart = point_picture(result.points), scene_picture(result.scene)
            for chart in self._charts:
                chart.show(self._budget)
            for of_run in self._run_charts:
                of_run.show(result.study)
        if self._upload.file is not None:
            self._upload.form()

    async def _json(self) -> io.BytesIO:
        """The study as `navbudget sar` writes it, maps and all: made in a thread, so that sliders move on."""
        result: SarResult = self.run.result
        document = await asyncio.to_thread(to_json, result.study, result.beside)
        return io.BytesIO(json.dumps(document, ensure_ascii=False, allow_nan=False, indent=1).encode("utf-8"))
