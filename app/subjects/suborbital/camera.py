"""The sweep of star-camera noise: computed in a worker while its view is open."""

from html import escape

import panel as pn
import param

from app.declared import required
from app.document.pane import html_of
from app.session import Session
from app.subjects.suborbital.charts.camera_noise import NOISES, camera_noise_answer, camera_noise_chart
from app.subjects.suborbital.charts.content import Content
from app.ui.first_screen import first_screen
from app.ui.follower import Follower
from app.ui.html_pane import html_pane
from app.ui.run_bar import progress_html
from app.ui.theme import NARROW
from app.work.pool import run_in_pool
from app.work.run import Progress, Run
from nav_model.suborbital.camera_noise import CameraNoise, sweep_camera_noise
from nav_model.suborbital.settings import Settings


class CameraNoisePanel(pn.viewable.Viewer):
    """Cost of the camera's noise, over three decades of it."""

    run = required(Run)

    def __init__(self, session: Session) -> None:
        super().__init__(run=session.new_run())
        self._message = html_pane("", margin=0)
        self._swept: Follower[tuple[CameraNoise, float]] = Follower(lambda: self.run.result)
        self._place = self._swept.later(
            lambda: self._swept.chart(lambda sweep: camera_noise_chart(*sweep)),
            sizing_mode="stretch_both", stylesheets=[NARROW],
        )  # fmt: skip
        self._settings: Settings | None = None

    def __panel__(self) -> pn.Column:
        return first_screen(self._message, left=[self._place], height="100%")

    def show(self, page: Content) -> None:
        """Sweep for its settings, unless that was done."""
        settings = page.settings
        if settings is not self._settings:
            self._settings = settings
            self._message.object = progress_html(Progress("Sweeping the centroid noise: 13 values"))

            async def sweep(_: Run) -> tuple[CameraNoise, float]:
                swept = await run_in_pool(sweep_camera_noise, page.study, settings, NOISES)
                return swept, float(settings["camera.centroid_noise"])

            self.run.start(sweep)

    @param.depends("run.running", watch=True)
    def _follow(self) -> None:
        if self.run.running:
            return
        if self.run.message:
            self._message.object = f"<p role='alert'>{escape(self.run.message)}</p>"
        elif self.run.result is not None:
            self._message.object = html_of(camera_noise_answer(*self.run.result))
            self._swept.follow()
