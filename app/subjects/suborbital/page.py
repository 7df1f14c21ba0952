"""The Suborbital page: what a star tracker repairs of an INS over a suborbital flight, and what it does not.

The inertial unit is the design's; the page adds flight, tracker, camera and initial errors.
"""

import json

import panel as pn
import param

from app.declared import required
from app.document.blocks import Answer
from app.document.tiles import tiles_html
from app.session import Session
from app.subjects.suborbital.answer import WAITING, answer
from app.subjects.suborbital.camera import CameraNoisePanel
from app.subjects.suborbital.charts.content import Content
from app.subjects.suborbital.inputs import InputPanel, Trajectory
from app.subjects.suborbital.studies import asked, fly_study
from app.subjects.suborbital.views import CAMERA_NOISE, StudyViews
from app.ui.downloads import download
from app.ui.first_screen import screen_of_views
from app.ui.html_pane import html_pane
from app.ui.run_bar import RunBar
from app.ui.study_page import StudyPage
from app.work.cancellable import RunLost
from app.work.pool import run_in_pool
from app.work.run import Run
from nav_model.base.errors import InputError
from nav_model.budget import Budget
from nav_model.design import Design
from nav_model.suborbital.moving import moved, needs_other_matrices, renewed
from nav_model.suborbital.study import LinearParts, Study
from nav_model.suborbital.survey import Survey, needs_run
from nav_model.suborbital.survey_json import survey_json

_SETTLE_SECONDS = 0.6  # a slider that needs a new run has come to rest after this long


class SuborbitalPage(StudyPage[Survey]):
    """Everything below the tab. The first run starts when the page is opened, unless its result is in the cache.

    Its result is the last exact run; `renewal` makes the matrices that other frames or periods need.
    """

    kind = "suborbital"
    of_design = False
    waiting = WAITING
    renewal = required(Run)
    inputs = required(InputPanel)
    camera = required(CameraNoisePanel)
    study = required(StudyViews)

    def __init__(self, session: Session) -> None:
        camera, inputs = CameraNoisePanel(session), InputPanel(session)
        super().__init__(
            session, renewal=session.new_run(), inputs=inputs, camera=camera, study=StudyViews(camera, inputs)
        )
        self._flown: Trajectory = None  # the trajectory of the last exact run
        self._tiles = html_pane("", margin=(8, 0, 0, 0))
        self._bar = RunBar(self.run, self.begin, "Run full simulation", strip=True)
        self.study.views.param.watch(lambda _: self._sweep_camera(), "chosen")
        tools = pn.Row(self._bar, download("Study (JSON)", "suborbital.json", self._json))
        self._view = screen_of_views(self._strip, pn.Column(self.inputs.notice, self._tiles), self.study, tools)
        self._open()

    def show(self, budget: Budget) -> None:
        """Follow the design's inertial unit, where the study takes it."""
        self.inputs.follow(budget.design)

    # --- following the inputs ----------------------------------------------------------------------------

    @param.depends("inputs.settings", "inputs.trajectory", watch=True)
    def follow(self) -> None:
        """Move the curves to the current settings, or start what they need first."""
        survey, settings = self._result, self.inputs.settings
        if survey is None:
            self.begin()
        elif needs_run(survey, settings) or self.inputs.trajectory != self._flown:
            self.begin(_SETTLE_SECONDS)
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
        renewal = await run_in_pool(renewed, survey.study, settings.study_inputs())
        if survey is self._result and settings is self.inputs.settings:
            with pn.io.hold():
                self._show_moved(survey, renewal)

    @param.depends("run.progress", watch=True)
    def _tell_progress(self) -> None:
        """Before the first answer the views say how far it is."""
        super()._tell_progress()
        if self.study.page is None:
            self.study.say_coming(self.run.progress.words if self.run.progress else "")

    @param.depends("renewal.message", watch=True)
    def _say_renewal(self) -> None:
        self._say(self.renewal.message)

    @property
    def _key(self) -> tuple[str, ...] | None:
        return asked(self.inputs.settings)

    async def _study(self, run: Run) -> Survey:
        settings, trajectory = self.inputs.settings, self.inputs.trajectory
        try:
            survey = await fly_study(settings, trajectory, lambda share, what: run.tell(what, share))
        except (InputError, RunLost) as error:
            if trajectory is None or trajectory == self._flown:
                raise
            self.inputs.refuse(self._flown, str(error))
            assert self._result is not None  # a trajectory is opened beside one
            return self._result
        self._flown = trajectory
        return survey

    def _receive(self, survey: Survey) -> None:
        self.study.last_moment(int(survey.star_frames[-1].time_s))
        self.follow()

    def _subject(self, design: Design) -> object:
        return ()  # what a moved input needs is begun at once, and the curves move meanwhile

    def _verdict(self, survey: Survey) -> Answer:
        return answer(self.study.page)[0] if self.study.page else WAITING

    # --- on screen ---------------------------------------------------------------------------------------

    @param.depends(
        "study.case", "study.channel", "study.aided_sources", "study.along_track", "study.moment", watch=True
    )
    def _look(self) -> None:
        if self._result is not None and self.study.page is not None:
            self._put_on_screen(self._result, self.study.page.study)

    def _put_on_screen(self, survey: Survey, study: Study) -> None:
        page = Content(survey, study, self.inputs.settings, **self.study.looks)
        self._session.keep("suborbital", page)
        with pn.io.hold():
            self._tiles.object = tiles_html(answer(page)[1])
            self.study.page = page
            self._write()
            self._sweep_camera()

    def _sweep_camera(self) -> None:
        page = self.study.page
        if page is not None and self.study.views.chosen == CAMERA_NOISE:
            self.camera.show(page)

    def _json(self) -> str:
        page = self.study.page
        if page is None:
            return "{}"
        content = survey_json(page.survey, page.study, page.settings)
        return json.dumps(content, ensure_ascii=False, allow_nan=False, indent=1)
