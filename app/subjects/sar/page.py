"""The SAR page: which way of navigating through the aperture, its price in the image, and the pictures."""

from __future__ import annotations

import asyncio
import io
import json
from collections.abc import Callable
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.charts.kinds import AnyChart
from app.charts.screen.pictures import picture_gallery
from app.session import Session
from app.subjects.sar.charts import (
    FILTERED,
    INERTIAL,
    POINT_TITLE,
    SCENE_TITLE,
    arw_winner_chart,
    gnss_winner_chart,
    navigation_chart,
    point_picture,
    quadratic_chart,
    residual_chart,
    responses_chart,
    scene_picture,
)
from app.subjects.sar.picture_downloads import PictureDownloads
from app.subjects.sar.run import Progress, SarResult, SarRun
from app.subjects.sar.upload import UploadedPicture
from app.subjects.sar.words import agreement_table, answer, caution_list, error_table, response_table
from app.ui.chart_pane import ChartView, chart_cells
from app.ui.fields import whole_number
from app.ui.grid import grid
from app.ui.html_pane import html_pane
from nav_model.budget import Budget
from nav_model.errors import InputError
from nav_model.sar.design_case import Engine
from nav_model.sar.design_study import ClosedForms, SarStudy, closed_forms
from nav_model.sar.study_json import to_json

_RUNS = (100, 200, 500, 1000)
_ENGINES: dict[str, Engine] = {"Error model, per axis": "fast", "Full simulator": "simulator"}


class SarPage:
    """Everything below the tab. Closed forms and maps follow the sliders; the ensemble runs on demand."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self._budget = session.budget
        self._closed: ClosedForms = closed_forms(session.budget)
        self._result: SarResult | None = None
        self._run = SarRun(self._told)
        self._answer = html_pane("")
        self._tables = html_pane("")
        self._state = html_pane("", margin=(2, 10))
        # Heading and pictures apart: the mark of a stale study must not send the pictures again.
        self._headings = [html_pane("", margin=(8, 10, 0, 10)) for _ in _PICTURES]
        self._pictures = [html_pane("<p class='quiet'>Appears with the first run.</p>") for _ in _PICTURES]
        self._downloads = [PictureDownloads(short, key) for key, short, *_ in _PICTURES]
        self._whole = pmui.FileDownload(
            callback=self._json, filename="sar-study.json", label="All of the study (JSON)", icon="download",
            variant="text", size="small", description="", margin=(0, 8), visible=False,
        )  # fmt: skip
        self._charts: list[ChartView] = []
        self._upload = UploadedPicture(session, lambda: self._result)
        self.view = pn.Column(
            self._answer,
            self._controls(),
            self._tables,
            self._whole,
            grid(*chart_cells(self._layout(), lambda what, high: ChartView(what, session, high), self._charts)),
            *(
                part
                for parts in zip(self._headings, self._pictures, (d.view for d in self._downloads), strict=True)
                for part in parts
            ),
            self._upload.view,
            sizing_mode="stretch_width",
        )
        self._write()
        if pn.state.curdoc:
            pn.state.on_session_destroyed(lambda _: self._run.cancel())
            pn.state.onload(self._begin)

    def show(self, budget: Budget) -> None:
        """Follow the budget in force."""
        self._budget = budget
        self._closed = closed_forms(budget)
        self._write()
        for chart in self._charts:
            chart.show(budget)

    # --- the parts ------------------------------------------------------------------------------------

    def _layout(self) -> tuple[tuple[Callable[[Budget], AnyChart], int, int], ...]:
        """Chart, height in pixels, columns of twelve on a wide screen."""

        def of_study(make: Callable[..., AnyChart], *rest: Any) -> Callable[[Budget], AnyChart]:
            return lambda _: make(self._study, *rest)

        def of_both(make: Callable[..., AnyChart]) -> Callable[[Budget], AnyChart]:
            return lambda budget: make(budget, self._closed, self._study)

        inertial, filtered = "INS and corrected INS", "filters and smoother"
        return (
            (of_both(residual_chart), 360, 6),
            (of_both(quadratic_chart), 360, 6),
            (of_study(navigation_chart, INERTIAL, inertial, "sar-error-ins"), 320, 6),
            (of_study(navigation_chart, FILTERED, filtered, "sar-error-filter"), 320, 6),
            (of_study(responses_chart, INERTIAL, inertial, "sar-response-ins"), 320, 6),
            (of_study(responses_chart, FILTERED, filtered, "sar-response-filter"), 320, 6),
            (gnss_winner_chart, 400, 6),
            (arw_winner_chart, 400, 6),
        )

    def _controls(self) -> pn.FlexBox:
        look: dict[str, Any] = {"description": "", "size": "small", "margin": (8, 6)}
        self._engine = pmui.Select(label="Engine", options=_ENGINES, value="fast", width=200, **look)
        self._runs = pmui.Select(label="Runs", options=list(_RUNS), value=_RUNS[0], width=100, **look)
        self._seed = pmui.TextInput(label="Seed", value="0", width=80, **look)
        self._start = pmui.Button(label="Run the strategies", icon="play_arrow", variant="contained", **look)
        self._stop = pmui.Button(label="Cancel", icon="stop", variant="outlined", disabled=True, **look)
        self._start.on_click(self._begin)
        self._stop.on_click(lambda _: self._run.cancel())
        return pn.FlexBox(
            self._engine,
            self._runs,
            self._seed,
            self._start,
            self._stop,
            pn.Column(self._state, width=340),
            align_items="center",
            sizing_mode="stretch_width",
            margin=(0, 4),
        )

    @property
    def _study(self) -> SarStudy | None:
        return self._result.study if self._result else None

    def _write(self) -> None:
        stale = self._result is not None and self._result.stale(self._budget)
        study = self._study
        self._answer.object = answer(self._budget, self._closed, study, stale)
        self._tables.object = (
            error_table(self._budget, self._closed, study, stale)
            + "<br>"
            + response_table(study, stale)
            + agreement_table(study, self._result.beside if self._result else None, stale)
            + caution_list(self._budget, study)
        )
        if not self._run.running:
            self._state.object = _standing(study, stale)
        mark = " <span class='stale'>stale: of an earlier design</span>" if stale else ""
        for pane, (*_, title, _) in zip(self._headings, _PICTURES, strict=True):
            pane.object = f"<h3>{title}{mark}</h3>"

    # --- the run --------------------------------------------------------------------------------------

    async def _begin(self, _: Any = None) -> None:
        try:
            seed = whole_number("Seed", self._seed.value or "", 0, 2**31)
        except InputError as error:
            self._state.object = f'<p role="status">Not run. {escape(str(error))}</p>'
            return
        self._run.start(self._session.budget, self._runs.value, seed, self._engine.value)
        self._busy(True)

    def _told(self, news: Progress | SarResult | str) -> None:
        with pn.io.hold():
            if isinstance(news, Progress):
                self._state.object = _under_way(news, self._engine.value)
                return
            self._busy(False)
            if isinstance(news, str):
                self._state.object = f'<p role="status">{escape(news)}</p>'
                return
            self._result = news
            self._session.keep("sar", news)
            self._write()
            for pane, take, pictures, (*_, draw) in zip(
                self._pictures, self._downloads, (news.points, news.scene), _PICTURES, strict=True
            ):
                chart = draw(pictures)
                pane.object = picture_gallery(chart)
                take.show(chart)
            self._whole.visible = True
            stale = news.stale(self._budget)
            self._state.object = _standing(news.study, stale)
            for chart in self._charts:
                chart.show(self._budget)
            self._upload.refresh()

    async def _json(self) -> io.BytesIO:
        """The study as `navbudget sar` writes it, maps and all: made in a thread, so that sliders move on."""
        assert self._result is not None
        document = await asyncio.to_thread(to_json, self._result.study, self._result.beside)
        return io.BytesIO(json.dumps(document, ensure_ascii=False, allow_nan=False, indent=1).encode("utf-8"))

    def _busy(self, running: bool) -> None:
        self._session.running = running
        self._stop.disabled = not running


_PICTURES = (
    ("sar-point", "Point target", POINT_TITLE, point_picture),
    ("sar-scene", "Eight point targets", SCENE_TITLE, scene_picture),
)


def _standing(study: SarStudy | None, stale: bool) -> str:
    if study is None:
        return "<p class='quiet'>Closed forms only: the strategies have not been run.</p>"
    mark = (
        "<span class='stale'>stale</span> The runs are of an earlier design: run again."
        if stale
        else "The runs match the design."
    )
    what = "flights of the simulator" if study.engine == "simulator" else "runs of the error model"
    runs = f"{study.runs} {what}, seed {study.seed}, {study.fixes} fixes in the aperture"
    return f"<p>{mark} <span class='quiet'>{runs}</span></p>"


def _under_way(news: Progress, engine: Engine) -> str:
    left = "" if news.left is None else f", about {news.left:.0f} s left"
    if news.left is None and engine == "simulator":
        left = "; the first use on a machine compiles the simulator, half a minute"
    return (
        f'<p><progress aria-label="Runs done" max="{news.runs}" value="{news.done}"></progress> '
        f"{news.done} of {news.runs} runs{left}</p>"
    )
