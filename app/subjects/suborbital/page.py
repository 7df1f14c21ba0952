"""The Suborbital page: what a star tracker repairs of an INS over a suborbital flight, and what it does not."""

from __future__ import annotations

import asyncio
import io
import json
import time
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.document.prose import prose
from app.session import Session
from app.subjects.suborbital.answer import answer, waiting
from app.subjects.suborbital.charts import Shown
from app.subjects.suborbital.finding import Finding
from app.subjects.suborbital.inputs import InputPanel, Trajectory
from app.subjects.suborbital.noise import NoiseRun
from app.subjects.suborbital.tabs import StudyTabs
from app.ui.grid import cell, grid
from app.ui.html_pane import html_pane
from app.work.alone import RunLost, run_alone
from app.work.pool import elsewhere
from nav_model.budget import Budget
from nav_model.suborbital.study import Gap, Study, position_gap
from nav_model.suborbital.survey import Renewed, Survey, moved, needs_other_matrices, needs_run, renewed, run_survey
from nav_model.suborbital.survey_json import gap_json, noise_json, survey_json

_SETTLE_SECONDS = 0.6  # a slider that needs a new run has come to rest after this long
_LOOK: dict[str, Any] = {"size": "small", "margin": 2}


class SuborbitalPage:
    """Everything below the tab. The first run starts when the page is opened."""

    def __init__(self, session: Session) -> None:
        self._session = session
        self.survey: Survey | None = None
        self.shown: Shown | None = None
        self.gap: Gap | None = None
        self._flown: Trajectory = None  # the trajectory of `survey`
        self._running: asyncio.Task[None] | None = None
        self._renewing: asyncio.Task[None] | None = None
        self._started = 0.0
        self._answer = html_pane(waiting())
        self.inputs = InputPanel(session, self.follow, self.run)
        self.noise = NoiseRun(lambda: self.shown, self._look)
        self.tabs = StudyTabs(self._look, self.noise.view)
        self.view = pn.Column(
            self._answer,
            self._run_bar(),
            self.inputs.notice,
            grid(cell(3, self.inputs.view), cell(9, self.tabs.view), margin=(4, 6)),
            sizing_mode="stretch_width",
        )
        if pn.state.curdoc:
            pn.state.on_session_destroyed(lambda _: self._close())
            self.run()

    def show(self, budget: Budget) -> None:
        """The design enters by the button only; the study has its own inputs."""

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

    # --- following the inputs ----------------------------------------------------------------------------

    def follow(self) -> None:
        """Move the curves to the settings in force, or start what they need first."""
        settings = self.inputs.settings
        if self.survey is None:
            self.run()
        elif needs_run(self.survey, settings) or self.inputs.trajectory != self._flown:
            self.run(_SETTLE_SECONDS)
        elif needs_other_matrices(self.survey, settings):
            if self._renewing is None:
                self._renewing = asyncio.get_running_loop().create_task(self._renew())
        else:
            self._show_moved(None)

    def _show_moved(self, renewal: Renewed | None) -> None:
        assert self.survey is not None
        settings = self.inputs.settings
        same = dict(settings.values) == dict(self.survey.settings.values)
        self.gap = self.gap if same else None
        self._put_on_screen(self.survey.study if same else moved(self.survey, settings, renewal))

    async def _renew(self) -> None:
        """Matrices for other frames or periods, in a worker; only the last settings count."""
        try:
            while True:
                assert self.survey is not None
                survey, settings = self.survey, self.inputs.settings
                renewal = await elsewhere(renewed, survey.study, settings)
                if settings is self.inputs.settings:
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

    def _close(self) -> None:
        self._stop()
        self.noise.stop()

    async def run_exactly(self, settle: float = 0.0) -> None:
        """Run the survey in a process of its own and show it; progress and cancel are on the page."""
        task = asyncio.current_task()
        await asyncio.sleep(settle)
        settings, trajectory, before = self.inputs.settings, self.inputs.trajectory, self.shown
        self._started = time.monotonic()
        self._session.running = True
        self._busy(True)
        self._progressed(0.0, "starting")
        try:
            survey: Survey = await run_alone(run_survey, settings, trajectory, progress=self._progressed)
        except (ValueError, RunLost) as error:
            if trajectory is not None and trajectory != self._flown:  # the file is refused, not kept
                self.inputs.take(self._flown)
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
        with pn.io.hold():
            self.tabs.last_moment(int(survey.star_frames[-1].time_s), len(survey.star_frames))
            self._finish(task, "")
            self.follow()

    def _finish(self, task: asyncio.Task[None] | None, said: str) -> None:
        """The run is over; a run that was replaced leaves the bar to the one that replaced it."""
        if self._running is not None and self._running is not task:
            return
        self._running = None
        self._session.running = False
        self._busy(False)
        self._state.object = _said(said) if said else ""

    def _busy(self, busy: bool) -> None:
        self.cancel.visible = self._progress.visible = busy

    def _progressed(self, share: float, what: str) -> None:
        spent = time.monotonic() - self._started
        left = f", about {spent / share * (1 - share):.0f} s left" if share > 0.1 else ""
        self._progress.value = round(100 * share)
        self._state.object = _said(escape(f"Computing: {what}, {100 * share:.0f} %{left}"))

    # --- on screen ---------------------------------------------------------------------------------------

    def _look(self) -> None:
        if self.shown is not None:
            self._put_on_screen(self.shown.study)

    def _put_on_screen(self, study: Study) -> None:
        assert self.survey is not None
        self.shown = Shown(
            self.survey, study, **self.tabs.looks, ensemble=self.noise.ensemble_of(study), gap=self.gap
        )
        self._session.keep("suborbital", Finding(self.shown, self.inputs.settings))
        with pn.io.hold():
            said = answer(self.shown, self.inputs.settings, self.gap)
            if self._answer.object != said:
                self._answer.object = said
            self.tabs.show(self.shown)

    def _json(self) -> io.BytesIO:
        if self.shown is None or self.survey is None:
            return io.BytesIO(b"{}")
        content = survey_json(self.survey, self.shown.study, self.inputs.settings)
        if self.gap is not None:
            content["linear_gap"] = gap_json(self.gap)
        if self.shown.ensemble is not None:
            content["white_noise_monte_carlo"] = noise_json(self.shown.ensemble)
        return io.BytesIO(json.dumps(content, ensure_ascii=False, allow_nan=False, indent=1).encode("utf-8"))


def _said(text: str) -> str:
    return f'<p class="know" role="note">{text}</p>'
