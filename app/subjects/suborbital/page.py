"""The Suborbital page: what a star tracker repairs of an INS over a suborbital flight, and what it does not."""

from __future__ import annotations

import asyncio
import io
import json

import panel as pn
import param

from app.declared import held
from app.document.pane import html_of
from app.session import Session
from app.subjects.suborbital.answer import WAITING, answer
from app.subjects.suborbital.charts import Shown
from app.subjects.suborbital.finding import Finding
from app.subjects.suborbital.inputs import InputPanel, Trajectory
from app.subjects.suborbital.noise import NoisePanel
from app.subjects.suborbital.tabs import StudyTabs
from app.ui.downloads import download
from app.ui.grid import cell, grid
from app.ui.html_pane import block_pane
from app.ui.run_bar import RunBar
from app.work.alone import RunLost, run_alone
from app.work.pool import elsewhere
from app.work.run import Run
from nav_model.budget import Budget
from nav_model.suborbital.study import Gap, Study, position_gap
from nav_model.suborbital.survey import Renewed, Survey, moved, needs_other_matrices, needs_run, renewed, run_survey
from nav_model.suborbital.survey_json import gap_json, noise_json, survey_json

_SETTLE_SECONDS = 0.6  # a slider that needs a new run has come to rest after this long


class SuborbitalPage(pn.viewable.Viewer):
    """Everything below the tab. The first run starts when the page is opened.

    The result of `exact` is the last exact run; `renewal` makes the matrices that other frames or periods need.
    """

    exact = held(Run)
    renewal = held(Run)
    inputs = held(InputPanel)
    noise = held(NoisePanel)
    tabs = held(StudyTabs)

    def __init__(self, session: Session) -> None:
        noise = NoisePanel(session, lambda: self.tabs.shown)
        super().__init__(
            exact=session.new_run(), renewal=session.new_run(), inputs=InputPanel(session), noise=noise,
            tabs=StudyTabs(noise),
        )  # fmt: skip
        self._session = session
        self._gap: Gap | None = None  # of the moved curves that the last exact run replaced
        self._flown: Trajectory = None  # the trajectory of the last exact run
        self._answer = block_pane(WAITING)
        self.bar = RunBar(self.exact, self.run, "Recompute exactly")
        self._view = pn.Column(
            self._answer,
            pn.Row(self.bar, download("Study (JSON)", "suborbital.json", self._json)),
            self.inputs.notice,
            grid(cell(3, self.inputs), cell(9, self.tabs), margin=(4, 6)),
        )
        if pn.state.curdoc:
            self.run()

    def __panel__(self) -> pn.Column:
        return self._view

    def show(self, budget: Budget) -> None:
        """The design enters by the button only; the study has its own inputs."""

    @property
    def survey(self) -> Survey | None:
        """The last exact run."""
        survey: Survey | None = self.exact.result
        return survey

    # --- following the inputs ----------------------------------------------------------------------------

    @param.depends("inputs.settings", "inputs.trajectory", watch=True)
    def follow(self) -> None:
        """Move the curves to the settings in force, or start what they need first."""
        survey, settings = self.survey, self.inputs.settings
        if survey is None:
            self.run()
        elif needs_run(survey, settings) or self.inputs.trajectory != self._flown:
            self.run(_SETTLE_SECONDS)
        elif needs_other_matrices(survey, settings):
            self.renewal.start(lambda _: self._renew(survey))
        else:
            self._show_moved(survey, None)

    def _show_moved(self, survey: Survey, renewal: Renewed | None) -> None:
        settings = self.inputs.settings
        same = dict(settings.values) == dict(survey.settings.values)
        self._gap = self._gap if same else None
        self._put_on_screen(survey, survey.study if same else moved(survey, settings, renewal))

    async def _renew(self, survey: Survey) -> None:
        """Matrices for other frames or periods; those of settings that are no longer in force are dropped."""
        settings = self.inputs.settings
        renewal = await elsewhere(renewed, survey.study, settings)
        if survey is self.survey and settings is self.inputs.settings:
            with pn.io.hold():
                self._show_moved(survey, renewal)

    @param.depends("renewal.message", watch=True)
    def _say_renewal(self) -> None:
        self.bar.message = self.renewal.message

    def run(self, settle: float = 0.0) -> asyncio.Task[None]:
        """Start an exact run at the settings in force, after `settle` seconds; one under way is cancelled."""
        return self.exact.start(lambda run: self._run_survey(run, settle))

    async def _run_survey(self, run: Run, settle: float) -> Survey | None:
        await asyncio.sleep(settle)
        settings, trajectory, before = self.inputs.settings, self.inputs.trajectory, self.tabs.shown
        try:
            survey: Survey = await run_alone(
                run_survey, settings, trajectory, progress=lambda share, what: run.tell(what, share)
            )
        except (ValueError, RunLost) as error:
            if trajectory is None or trajectory == self._flown:
                raise
            self.inputs.refuse(self._flown, str(error))
            return self.survey
        same_flight = before is not None and not needs_run(before.survey, settings) and trajectory == self._flown
        self._gap, self._flown = None, trajectory
        if before is not None and same_flight and not before.exact:
            self._gap = position_gap(before.study.pure.position_m, before.study.aided.position_m, survey.study)
        return survey

    @param.depends("exact.result", watch=True)
    def _show_exact(self) -> None:
        if self.survey is not None:
            with pn.io.hold():
                self.tabs.last_moment(int(self.survey.star_frames[-1].time_s))
                self.follow()

    # --- on screen ---------------------------------------------------------------------------------------

    @param.depends("tabs.case", "tabs.channel", "tabs.aided_sources", "tabs.along_track", "tabs.moment",
                   "noise.run.result", watch=True)  # fmt: skip
    def _look(self) -> None:
        if self.survey is not None and self.tabs.shown is not None:
            self._put_on_screen(self.survey, self.tabs.shown.study)

    def _put_on_screen(self, survey: Survey, study: Study) -> None:
        ensemble = self.noise.ensemble_of(study)
        shown = Shown(survey, study, **self.tabs.looks, ensemble=ensemble, gap=self._gap)
        self._session.keep("suborbital", Finding(shown, self.inputs.settings))
        with pn.io.hold():
            said = html_of(*answer(shown, self.inputs.settings))
            if self._answer.object != said:
                self._answer.object = said
            self.noise.note(study)
            self.tabs.shown = shown

    def _json(self) -> io.BytesIO:
        shown = self.tabs.shown
        if shown is None:
            return io.BytesIO(b"{}")
        content = survey_json(shown.survey, shown.study, self.inputs.settings)
        if shown.gap is not None:
            content["linear_gap"] = gap_json(shown.gap)
        if shown.ensemble is not None:
            content["white_noise_monte_carlo"] = noise_json(shown.ensemble)
        return io.BytesIO(json.dumps(content, ensure_ascii=False, allow_nan=False, indent=1).encode("utf-8"))
