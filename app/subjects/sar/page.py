"""The Image page: the best navigation strategy, its image quality, and the pictures."""

import asyncio
import json
from collections.abc import Callable
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.charts.kinds import Chart, DotChart, PictureChart
from app.charts.legend import legend_html
from app.charts.screen.pictures import picture_gallery
from app.declared import chosen
from app.document.blocks import Answer
from app.document.pane import html_of
from app.document.ranks_html import ranks_html
from app.session import Session
from app.subjects.sar.charts import (
    POINT_TITLE,
    RUN_CHARTS,
    point_pictures_of,
    quadratic_chart,
    residual_chart,
    to_npz,
    winner_chart,
)
from app.subjects.sar.run import SarResult, run_strategies, subject
from app.subjects.sar.tables import (
    answer,
    cautions,
    error_table,
    reasons,
    recommended,
    run_tables,
    runs_in_words,
    strategies_of,
)
from app.subjects.sar.upload import UploadedPicture
from app.ui.chart_pane import described, head_html
from app.ui.downloads import download
from app.ui.fields import TextInput, whole_number
from app.ui.first_screen import first_screen
from app.ui.folded import Folded
from app.ui.follower import Follower
from app.ui.html_pane import html_pane, stale_mark
from app.ui.run_bar import RunBar
from app.ui.study_page import StudyPage
from app.ui.theme import PRINT_NOTHING
from app.work.run import Run
from nav_model.budget import Budget
from nav_model.design import Design
from nav_model.sar.design_case import Engine
from nav_model.sar.design_study import ClosedForms, SarStudy, closed_forms
from nav_model.sar.strategies import NAMES
from nav_model.sar.study_json import to_json

_RUNS = (50, 100, 200, 500, 1000)
_ENGINES: dict[str, Engine] = {"Error model, per axis": "fast", "Full simulator": "simulator"}
_LOOK: dict[str, Any] = {"margin": (2, 4), "size": "small"}
_HEAD = (6, 10, 0, 10)  # margin of the line above a chart
_AS_HIGH_AS_IT_IS = "@media (max-width: 1000px) { :host { flex: none !important; height: auto !important; } }"
"""Sheet of the ranked strategies, whose names take more lines on a narrow window."""


class SarPage(StudyPage[SarResult]):
    """Everything below the bar.

    The first screen is made at once: formulas and the map follow the design, and a few runs are made for it. What is
    folded below is made when it is opened.
    """

    kind = "sar"
    settings = ("engine", "runs", "seed")
    moving = ("engine",)
    waiting = Answer("Formulas only so far", "open", ())
    coming = "Appears when the strategies have been run."
    engine: Engine = chosen("fast", _ENGINES, "Engine")
    runs = chosen(_RUNS[0], _RUNS, "Runs")
    seed = param.String(default="0", label="Seed")

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self._closed: ClosedForms = closed_forms(session.budget)
        self._of_design = Follower(lambda: session.budget)
        self._bar = RunBar(
            self.run,
            self.begin,
            "Run the strategies",
            pmui.Select.from_param(self.param.engine, width=190, **_LOOK),
            pmui.Select.from_param(self.param.runs, width=80, **_LOOK),
            TextInput.from_param(self.param.seed, width=70, **_LOOK),
        )
        self._rank_head, self._ranks = html_pane("", margin=_HEAD), html_pane("", margin=(0, 10, 6, 10))
        self._ranks.param.update(
            sizing_mode="stretch_both", min_height=260, stylesheets=[*self._ranks.stylesheets, _AS_HIGH_AS_IT_IS]
        )
        self._image_head, self._images = (
            html_pane("", margin=_HEAD),
            html_pane(_blank(session.budget), margin=(2, 10, 6, 10)),
        )
        self._points: PictureChart | None = None
        self._upload = UploadedPicture(session, lambda: self._result)
        design, runs = self._of_design, self._of_result
        self._details = Folded(
            (
                ("Why, and what would change it", lambda: design.text(self._reasons)),
                ("Errors by strategy", lambda: design.text(self._errors)),
                (
                    "Error histories and impulse responses",
                    lambda: runs.charts(*(_of_study(draw) for draw in RUN_CHARTS), height=320),
                ),
                ("Parts of the error, impulse response in numbers", lambda: runs.text(self._tables)),
                ("Quadratic phase before autofocus", lambda: design.text(self._quadratic)),
                ("Point target before autofocus", lambda: runs.text(self._unfocused)),
                ("Your phase history", lambda: self._upload),
                ("Exports", lambda: runs.later(self._exports)),
            )
        )
        self._view = pn.Column(
            self._strip,
            first_screen(
                self._bar,
                left=[pn.Column(self._rank_head, self._ranks, sizing_mode="stretch_both")],
                right=[self._of_design.chart(winner_chart)],
                bottom=pn.Column(self._image_head, self._images),
            ),
            self._details,
        )
        self._open()

    def show(self, budget: Budget) -> None:
        """Follow the current budget: the formulas at once, the runs as every study."""
        self._closed = closed_forms(budget)
        super().show(budget)

    # --- what the page says -----------------------------------------------------------------------------

    @property
    def _runs(self) -> SarStudy | None:
        return self._result.study if self._result else None

    @property
    def _current(self) -> SarStudy | None:
        """The runs, where they are of the current inputs."""
        return None if self._outdated else self._runs

    @property
    def _mark(self) -> str:
        return stale_mark(self._outdated) if self._outdated else ""

    def _write(self) -> None:
        super()._write()
        budget, study = self._session.budget, self._current
        if self._runs is None:
            self._bar.message = "Formulas only so far."
        else:
            self._bar.message = self._outdated or f"The runs match the design. {runs_in_words(self._runs)}."
        chart = residual_chart(budget, self._closed, self._runs)
        best = NAMES[recommended(budget, self._closed, study).strategy]
        coming = "The images appear after the runs: one point target, all images on one scale."
        head = head_html(chart.title, chart.knowledge, self._mark, legend_html(chart), described(chart))
        self._rank_head.say(head)
        self._ranks.say(ranks_html(chart, best))
        self._image_head.say(
            head_html(
                *(self._points.title, self._points.knowledge) if self._points else (POINT_TITLE, coming), self._mark
            )
        )
        self._of_design.follow()
        self._of_result.follow()

    def _answer(self) -> tuple[Answer, str]:
        """The formulas answer at once; runs only confirm them, so that the strip never waits for any."""
        whole = answer(self._session.budget, self._closed, self._current)
        return whole.more(self._session.flight_words), self._invalid or self._outdated

    def _reasons(self, budget: Budget) -> str:
        return html_of(*reasons(self._closed, self._current), cautions(budget, self._runs))

    def _errors(self, budget: Budget) -> str:
        return self._mark + html_of(error_table(budget, self._closed, self._runs, "page"))

    def _tables(self, result: SarResult) -> str:
        return self._mark + html_of(*run_tables(result.study, result.beside, "page"))

    def _unfocused(self, result: SarResult) -> str:
        before, *focused = point_pictures_of(result.study, result.points, result.unfocused)
        if not focused:
            return "<p>Shown above: the design has no autofocus with limits of its own.</p>"
        return f'{self._mark}<p class="quiet">{escape(before.knowledge)}</p>{picture_gallery(before, row=True)}'

    def _quadratic(self, budget: Budget) -> str:
        chart: DotChart = quadratic_chart(budget, self._closed, self._runs)
        return head_html(chart.title, chart.knowledge, self._mark, legend_html(chart)) + ranks_html(chart)

    def _exports(self) -> pn.FlexBox:
        return pn.FlexBox(
            download("All of the study (JSON)", "sar-study.json", self._json),
            download("Point target (NPZ)", "sar-point.npz", self._npz),
            stylesheets=[PRINT_NOTHING],
        )

    def _npz(self) -> bytes:
        assert self._points is not None  # exports come with a result
        return to_npz(self._points)

    # --- the run ----------------------------------------------------------------------------------------

    async def _study(self, run: Run) -> SarResult:
        seed = whole_number("Seed", self.seed, 0, 2**31)
        return await run_strategies(run, self._session.budget, self.runs, seed, self.engine)

    def _subject(self, design: Design) -> object:
        return subject(design, self.engine)

    def _receive(self, result: SarResult) -> None:
        super()._receive(result)
        self._points = point_pictures_of(result.study, result.points, result.unfocused)[-1]
        self._images.object = picture_gallery(self._points, row=True)
        if self._upload.file is not None:
            self._upload.form()

    async def _json(self) -> str:
        """The study as `navbudget sar` writes it, maps and all: made in a thread, so that sliders move on."""
        result: SarResult = self.run.result
        document = await asyncio.to_thread(to_json, result.study, result.beside)
        return json.dumps(document, ensure_ascii=False, allow_nan=False, indent=1)


def _of_study(draw: Callable[[SarStudy], Chart]) -> Callable[[SarResult], Chart]:
    return lambda result: draw(result.study)


def _blank(budget: Budget) -> str:
    """Empty frames, named, in the places of the images."""
    figures = "".join(
        f'<figure class="pic"><div class="blank"></div><figcaption><b>{escape(name)}</b><br>…</figcaption></figure>'
        for name in (strategy.name for _, strategy in strategies_of(budget))
    )
    caption = "Azimuth by range, all images on one scale; they appear after the runs."
    return f'<div class="scale"><span class="quiet">{caption}</span></div><div class="pics row">{figures}</div>'
