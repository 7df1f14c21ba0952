"""Images of the user's phase history, with and without the design's navigation error."""

import asyncio
from collections.abc import Callable
from dataclasses import replace
from html import escape
from pathlib import Path
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.charts.kinds import PictureChart
from app.charts.screen.pictures import picture_gallery
from app.declared import chosen, declared, required
from app.document.blocks import Text
from app.document.pane import html_of
from app.session import Session
from app.subjects.sar.charts import to_npz, uploaded_picture
from app.subjects.sar.run import SarResult
from app.ui.downloads import download
from app.ui.fields import TextInput, number
from app.ui.html_pane import html_pane
from app.ui.run_bar import RunBar
from app.ui.upload import UploadedFile, upload
from app.ui.view import View
from app.work.pool import run_in_pool
from app.work.run import Run
from nav_model.base.errors import InputError
from nav_model.sar.pictures import uploaded_pictures
from nav_model.sar.strategies import NAMES, STRATEGY_KEYS

MOST_BYTES = 32 * 2**20
_HELP = Text(
    "Takes a phase history in the format of the public AFRL collections, as an NPZ file of at most 32 MiB: fp "
    "(frequencies × pulses, complex), freq [Hz], antenna x, y, z [m] relative to the scene centre, and reference "
    "range r0 [m] of each pulse. The design's error is applied from the first to the last pulse, at the file's "
    "wavelength."
)
_LOOK: dict[str, Any] = {"margin": (8, 6)}


class UploadedPicture(View):
    """Upload, choice of strategy and extent, and the two pictures, formed anew whenever one of them changes."""

    run = required(Run)
    file: tuple[str, Path] | None = declared(param.Parameter(default=None, doc="The file's name, and where it is."))
    strategy = chosen("2", {NAMES[key]: key for key in STRATEGY_KEYS[1:]}, "Navigation error of")
    half_width = param.String(default="50", label="Half width [m]")

    def __init__(self, session: Session, result: Callable[[], SarResult | None]) -> None:
        super().__init__(run=session.new_run())
        self._session = session
        self._result = result
        self._on_disk = UploadedFile()
        self._input = upload("Open a phase history", ".npz", MOST_BYTES, self._opened, self._refused, **_LOOK)
        self._bar = RunBar(
            self.run,
            self.form,
            "Form the images",
            self._input,
            pmui.Select.from_param(self.param.strategy, width=230, **_LOOK),
            TextInput.from_param(self.param.half_width, width=110, **_LOOK),
        )
        self._pictures = html_pane("")
        take = download("Images (NPZ)", "sar-phase-history.npz", lambda: to_npz(self.run.result))
        self._images = pn.Column(self._pictures, take, visible=False)
        self._view = pn.Column(html_pane(f"<h3>Your phase history</h3>{html_of(_HELP)}"), self._bar, self._images)

    def form(self) -> None:
        """Form the pictures of what is chosen, with the design's error as the last study has it."""
        self._images.visible = False  # of an earlier choice or study
        self.run.start(self._form)

    async def _form(self, run: Run) -> PictureChart:
        result = self._result()
        if self.file is None:
            raise InputError("Phase history", "open a file first")
        if result is None:
            raise InputError("Phase history", "run the strategies first: the image needs their navigation error")
        half = number("Half width [m]", self.half_width, 1.0, 5000.0)
        name, path = self.file
        run.tell(f"Forming {name}")
        residual = result.study.typical.residual[[STRATEGY_KEYS.index(self.strategy)]]
        data = await asyncio.to_thread(path.read_bytes)
        pictures = await run_in_pool(uploaded_pictures, name, data, result.study.time, residual, half)
        chart = uploaded_picture(pictures, name, self.strategy)
        self._session.keep("sar", replace(result, uploaded=chart))
        return chart

    @param.depends("run.result", watch=True)
    def _show(self) -> None:
        chart: PictureChart | None = self.run.result
        if chart is not None:
            self._pictures.object = f'<h3>{escape(chart.title)}</h3><div class="pair">{picture_gallery(chart)}</div>'
            self._images.visible = True

    @param.depends("file", "strategy", "half_width", watch=True)
    def _form_again(self) -> None:
        if self.file is not None:
            self.form()

    async def _opened(self, name: str, content: bytes) -> None:
        try:
            self.file = (name, await self._on_disk.put(content))
        except InputError as error:
            self._refused(f"{error}.")

    def _refused(self, why: str) -> None:
        self._bar.message = f"Not formed. {why}"
