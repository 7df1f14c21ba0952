"""The bar of a run: start, cancel, progress, and why it ended without a result."""

from collections.abc import Awaitable, Callable
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.declared import required
from app.ui.html_pane import html_pane
from app.ui.theme import PRINT_NOTHING
from app.ui.view import View
from app.work.run import Progress, Run

_LOOK: dict[str, Any] = {"margin": (8, 6)}


class RunBar(View):
    """Buttons and progress of one `Run`; `start` is called when the person presses its button.

    fields: what the person chooses before a start, in front of the button. ``strip``: whether the page has a strip
    that says why a run failed.
    """

    run = required(Run)
    message = param.String(default="", doc="What to say between runs, as text, until a run says more.")

    def __init__(
        self,
        run: Run,
        start: Callable[[], object],
        label: str,
        *fields: Any,
        strip: bool = False,
        align: str = "center",
    ) -> None:
        super().__init__(run=run)
        self._strip = strip
        self.start = pmui.Button(label=label, icon="play_arrow", variant="contained", **_LOOK)
        self.cancel = pmui.Button(
            label="Cancel", icon="stop", variant="outlined", disabled=run.param.running.rx.not_(), **_LOOK
        )

        async def pressed(_: Any) -> None:
            started = start()
            if isinstance(started, Awaitable):
                await started

        self.start.on_click(pressed)
        self.cancel.on_click(self._cancel)
        self.state = html_pane("", margin=(2, 10))
        self._view = pn.FlexBox(
            *fields, self.start, self.cancel, pn.Column(self.state, styles={"flex": "1 1 180px", "min-width": "0"}),
            align_items=align, margin=(0, 4), stylesheets=[PRINT_NOTHING],
        )  # fmt: skip

    def _cancel(self, _: Any) -> None:
        self.run.cancel()
        self.state.object = '<p role="status">Cancelling …</p>'  # what was found is still put together

    @param.depends("run.running", "run.progress", "run.message", watch=True)
    def _follow(self) -> None:
        run = self.run
        if run.running:
            self.state.object = progress_html(run.progress or Progress("Starting"))
        elif run.message and not (self._strip and not run.cancelled):
            look = "" if run.cancelled else ' class="strip bad"'
            self.state.object = f'<p role="alert"{look}><b>{escape(run.message)}</b></p>'
        else:
            self._tell()

    @param.depends("message", watch=True)
    def _tell(self) -> None:
        """The last word counts: a new message takes the place of why the last run failed."""
        if not self.run.running:
            self.state.object = f'<p role="status">{escape(self.message)}</p>' if self.message else ""


def progress_html(progress: Progress) -> str:
    """A bar and the words beside it; the bar moves to and fro while the progress is unknown."""
    value = "" if progress.share is None else f' value="{progress.share:.3f}"'
    return (
        f'<p role="status"><progress aria-label="Progress" max="1"{value}></progress> '
        f"<span>{escape(progress.words)}</span></p>"
    )
