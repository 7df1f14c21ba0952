"""White noise as an ensemble, flown on demand in a separate process."""

from collections.abc import Callable

import panel_material_ui as pmui

from app.declared import chosen, required
from app.session import Session
from app.subjects.suborbital.charts.content import Content
from app.ui.run_bar import RunBar
from app.ui.view import View
from app.work.cancellable import run_alone
from app.work.run import Run
from nav_model.suborbital.noise_ensemble import NoiseEnsemble, fly_noise
from nav_model.suborbital.study import Study

_RUNS = [50, 100, 200, 500, 1000]


class NoisePanel(View):
    """How many runs, start and cancel. The result of `run` is a study and the ensemble flown with it.

    Parameters
    ----------
    session : Session
    current : callable
        What is on the page; None before the first answer.
    """

    run = required(Run)
    runs = chosen(100, _RUNS, "Runs")

    def __init__(self, session: Session, current: Callable[[], Content | None]) -> None:
        super().__init__(run=session.new_run())
        self._current = current
        runs = pmui.Select.from_param(self.param.runs, width=110, margin=(10, 6, 4, 6))
        self._view = self.bar = RunBar(self.run, self.start, "Run the ensemble", runs)
        self.bar.cancel.label = "Cancel the ensemble"

    def ensemble_of(self, study: Study) -> NoiseEnsemble | None:
        """The ensemble, if it was flown with this very study."""
        of, ensemble = self.run.result or (None, None)
        return ensemble if study is of else None

    def start(self) -> object:
        """Fly the study on the page; an ensemble under way is cancelled."""
        page = self._current()
        if page is None:
            return None
        runs = self.runs

        async def fly(run: Run) -> tuple[Study, NoiseEnsemble]:
            track = page.survey.track
            ensemble = await run_alone(
                fly_noise, page.study, runs, int(page.survey.settings["seed"]),
                None if track is None else track.covariance, progress=lambda share, what: run.tell(what, share),
            )  # fmt: skip
            return page.study, ensemble

        return self.run.start(fly)

    def note(self, study: Study) -> None:
        """Say whether the ensemble is of the study on the page."""
        stale = self.run.result is not None and self.ensemble_of(study) is None
        self.bar.message = "The inputs have changed. Run again for an ensemble at these inputs." if stale else ""
