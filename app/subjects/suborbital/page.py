"""The Suborbital page: what a star tracker repairs of an INS over a suborbital flight, and what it does not.

The inertial unit is the design's; the page adds flight, tracker, camera and initial errors.
"""

import asyncio
import json

import panel as pn
import param

from app.declared import held
from app.document.blocks import Answer
from app.document.tiles import tiles_html
from app.session import Session
from app.subjects.suborbital.answer import WAITING, answer
from app.subjects.suborbital.camera import CameraNoisePanel
from app.subjects.suborbital.charts.shown import Shown
from app.subjects.suborbital.inputs import InputPanel, Trajectory
from app.subjects.suborbital.noise import NoisePanel
from app.subjects.suborbital.studies import fly_study, kept_study
from app.subjects.suborbital.views import CAMERA_NOISE, StudyViews
from app.ui.answer_strip import AnswerStrip
from app.ui.downloads import download
from app.ui.first_screen import screen_of_views
from app.ui.html_pane import html_pane
from app.ui.run_bar import RunBar
from app.ui.view import View
from app.work.alone import RunLost
from app.work.pool import elsewhere
from app.work.run import Run
from nav_model.base.errors import InputError
from nav_model.budget import Budget
from nav_model.suborbital.moving import moved, needs_other_matrices, renewed
from nav_model.suborbital.study import LinearParts, Study
from nav_model.suborbital.survey import Survey, needs_run
from nav_model.suborbital.survey_json import noise_json, survey_json

_SETTLE_SECONDS = 0.6  # a slider that needs a new run has come to rest after this long


class SuborbitalPage(View):
    """Everything below the tab. The first run starts when the page is opened, unless its result is in the cache.

    The result of `exact` is the last exact run; `renewal` makes the matrices that other frames or periods need.
    """

    exact = held(Run)
    renewal = held(Run)
    inputs = held(InputPanel)
    noise = held(NoisePanel)
    camera = held(CameraNoisePanel)
    study = held(StudyViews)

    def __init__(self, session: Session) -> None:
        noise, camera, inputs = (
            NoisePanel(session, lambda: self.study.shown),
            CameraNoisePanel(session),
            InputPanel(session),
        )
        super().__init__(
            exact=session.new_run(), renewal=session.new_run(), inputs=inputs, noise=noise, camera=camera,
            study=StudyViews(noise, camera, inputs),
        )  # fmt: skip
        self._session = session
        self._flown: Trajectory = None  # the trajectory of the last exact run
        self._strip = AnswerStrip(WAITING)
        self._tiles = html_pane("", margin=(8, 0, 0, 0))
        self.bar = RunBar(self.exact, self.run, "Run full simulation")
        self.study.views.param.watch(lambda _: self._sweep_camera(), "chosen")
        tools = pn.Row(self.bar, download("Study (JSON)", "suborbital.json", self._json))
        self._view = screen_of_views(pn.Column(self._strip, self.inputs.notice, self._tiles), self.study, tools)
        if pn.state.curdoc and not self._recall():
            self.run()

    def show(self, budget: Budget) -> None:
        """Follow the design's inertial unit, where the study takes it."""
        self.inputs.follow(budget.design)

    @property
    def survey(self) -> Survey | None:
        """The last exact run."""
        survey: Survey | None = self.exact.result
        return survey

    # --- following the inputs ----------------------------------------------------------------------------

    @param.depends("inputs.settings", "inputs.trajectory", watch=True)
    def follow(self) -> None:
        """Move the curves to the current settings, or start what they need first."""
        survey, settings = self.survey, self.inputs.settings
        if survey is None:
            self.run()
        elif needs_run(survey, settings) or self.inputs.trajectory != self._flown:
            self.run(_SETTLE_SECONDS)
        elif needs_other_matrices(survey.study, settings.study_inputs()):
            self.renewal.start(lambda _: self._renew(survey))
        else:
            self._show_moved(survey, None)

    def _show_moved(self, survey: Survey, renewal: LinearParts | None) -> None:
        settings = self.inputs.settings
        same, exact = dict(settings.values) == dict(survey.settings.values), survey.study
        self._put_on_screen(survey, exact if same else moved(exact, settings.study_inputs(), renewal))

    async def _renew(self, survey: Survey) -> None:
        """Matrices for other frames or periods; those of settings that are no longer in force are dropped."""
        settings = self.inputs.settings
        renewal = await elsewhere(renewed, survey.study, settings.study_inputs())
        if survey is self.survey and settings is self.inputs.settings:
            with pn.io.hold():
                self._show_moved(survey, renewal)

    @param.depends("exact.progress", "exact.message", watch=True)
    def _say_progress(self) -> None:
        """Before the first answer the view says how far it is, and the strip why there will be none."""
        if self.study.shown is None:
            message, progress = self.exact.message, self.exact.progress
            self._strip.show(Answer("No result yet", "warn", (message,)) if message else WAITING)
            self.study.say_coming(progress.words if progress else "")

    @param.depends("renewal.message", watch=True)
    def _say_renewal(self) -> None:
        self.bar.message = self.renewal.message

    def run(self, settle: float = 0.0) -> asyncio.Task[None]:
        """Start an exact run at the current settings, after `settle` seconds; one under way is cancelled."""
        return self.exact.start(lambda run: self._run_survey(run, settle))

    def _recall(self) -> bool:
        """Take what this server still has of the same study."""
        self.exact.result = kept_study(self.inputs.settings)
        return self.survey is not None

    async def _run_survey(self, run: Run, settle: float) -> Survey | None:
        await asyncio.sleep(settle)
        settings, trajectory = self.inputs.settings, self.inputs.trajectory
        try:
            survey = await fly_study(settings, trajectory, lambda share, what: run.tell(what, share))
        except (InputError, RunLost) as error:
            if trajectory is None or trajectory == self._flown:
                raise
            self.inputs.refuse(self._flown, str(error))
            return self.survey
        self._flown = trajectory
        return survey

    @param.depends("exact.result", watch=True)
    def _show_exact(self) -> None:
        if self.survey is not None:
            with pn.io.hold():
                self.study.last_moment(int(self.survey.star_frames[-1].time_s))
                self.follow()

    # --- on screen ---------------------------------------------------------------------------------------

    @param.depends("study.case", "study.channel", "study.aided_sources", "study.along_track", "study.moment",
                   "noise.run.result", watch=True)  # fmt: skip
    def _look(self) -> None:
        if self.survey is not None and self.study.shown is not None:
            self._put_on_screen(self.survey, self.study.shown.study)

    def _put_on_screen(self, survey: Survey, study: Study) -> None:
        ensemble = self.noise.ensemble_of(study)
        shown = Shown(survey, study, self.inputs.settings, **self.study.looks, ensemble=ensemble)
        self._session.keep("suborbital", shown)
        with pn.io.hold():
            word, figures = answer(shown)
            self._strip.show(word)
            self._tiles.object = tiles_html(figures)
            self.noise.note(study)
            self.study.shown = shown
            self._sweep_camera()

    def _sweep_camera(self) -> None:
        shown = self.study.shown
        if shown is not None and self.study.views.chosen == CAMERA_NOISE:
            self.camera.show(shown)

    def _json(self) -> str:
        shown = self.study.shown
        if shown is None:
            return "{}"
        content = survey_json(shown.survey, shown.study, shown.settings)
        if shown.ensemble is not None:
            content["white_noise_monte_carlo"] = noise_json(shown.ensemble)
        return json.dumps(content, ensure_ascii=False, allow_nan=False, indent=1)
