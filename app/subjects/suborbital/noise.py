"""White noise as an ensemble, flown on demand in a process of its own, with progress and cancel."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.subjects.suborbital.charts import Shown
from app.ui.html_pane import html_pane
from app.work.alone import RunLost, run_alone
from nav_model.suborbital.noise_ensemble import NoiseEnsemble, fly_noise

_RUNS = (50, 100, 200, 500, 1000)


class NoiseRun:
    """The controls above the charts. `ensemble` belongs to one study and is dropped when that moves on.

    current: what is on the page (None before the first answer); flown: called with a new ensemble in place.
    """

    def __init__(self, current: Callable[[], Shown | None], flown: Callable[[], None]) -> None:
        self._current, self._flown = current, flown
        self._task: asyncio.Task[None] | None = None
        self._of: Any = None  # the study the ensemble was flown with
        self._ensemble: NoiseEnsemble | None = None
        look: dict[str, Any] = {"description": "", "size": "small", "margin": (10, 6, 4, 6)}
        self.runs = pmui.Select(label="Runs", options=list(_RUNS), value=100, width=110, **look)
        self.start = pmui.Button(label="Fly the ensemble", icon="play_arrow", variant="outlined", **look)
        self.cancel = pmui.Button(
            label="Cancel the ensemble", icon="close", variant="outlined", visible=False, **look
        )
        self._state = html_pane("", margin=(2, 8))
        self.start.on_click(lambda _: self.run())
        self.cancel.on_click(lambda _: self.stop())
        self.view = pn.Column(
            pn.FlexBox(self.runs, self.start, self.cancel, align_items="center",
                       sizing_mode="stretch_width", margin=0),
            self._state,
            sizing_mode="stretch_width",
            margin=0,
        )  # fmt: skip

    def ensemble_of(self, study: Any) -> NoiseEnsemble | None:
        """The ensemble, if it was flown with this very study."""
        return self._ensemble if study is self._of else None

    def run(self) -> None:
        """Start flying at the inputs in force; an ensemble under way is ended."""
        self.stop()
        if self._current() is not None:
            self._task = asyncio.get_running_loop().create_task(self.fly())

    def stop(self) -> None:
        """End the ensemble under way."""
        if self._task is not None:
            self._task.cancel()

    async def fly(self) -> None:
        """Fly the ensemble of the study on the page and show it."""
        task = asyncio.current_task()
        shown = self._current()
        assert shown is not None
        track = shown.survey.track
        covariance = None if track is None else track.covariance
        self.cancel.visible = True
        try:
            ensemble = await run_alone(
                fly_noise, shown.study, int(self.runs.value), int(shown.survey.settings["seed"]), covariance,
                progress=self._progressed,
            )  # fmt: skip
        except (ValueError, RunLost) as error:
            self._finish(task, f'<span class="mark">✗ Not flown.</span> {escape(str(error))}')
            return
        except asyncio.CancelledError:
            self._finish(task, "Cancelled.")
            raise
        self._ensemble, self._of = ensemble, shown.study
        now = self._current()
        same = now is not None and now.study is shown.study
        self._finish(task, "" if same else "The inputs have moved on since; fly again for the ensemble at these.")
        self._flown()

    def _progressed(self, share: float, what: str) -> None:
        self._state.object = _said(f"Flying: {escape(what)}, {100 * share:.0f} %")

    def _finish(self, task: asyncio.Task[None] | None, said: str) -> None:
        if self._task is not None and self._task is not task:
            return
        self._task = None
        self.cancel.visible = False
        self._state.object = _said(said) if said else ""


def _said(text: str) -> str:
    return f'<p class="know" role="note">{text}</p>'
