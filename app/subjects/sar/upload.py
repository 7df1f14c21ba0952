"""A phase history of the user's own, formed with and without the design's navigation error."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.charts.screen.pictures import picture_gallery
from app.session import Session
from app.subjects.sar.charts import short_name, uploaded_picture
from app.subjects.sar.picture_downloads import PictureDownloads
from app.subjects.sar.run import SarResult
from app.ui.fields import number
from app.ui.html_pane import html_pane
from app.upstream.file_input import LimitedFileInput
from app.work.pool import elsewhere
from nav_model.errors import InputError
from nav_model.sar.pictures import uploaded_pictures
from nav_model.sar.strategies import STRATEGY_KEYS

MOST_BYTES = 32 * 2**20
_HELP = (
    "A phase history in the form of the public AFRL collections, as an npz file: <b>fp</b> (frequencies × pulses, "
    "complex), <b>freq</b> [Hz], antenna <b>x</b>, <b>y</b>, <b>z</b> [m] about the scene centre and reference range "
    "<b>r0</b> [m] a pulse; at most 32 MiB. The design's error is laid over its pulses from first to last; the phase "
    "it makes is that of the file's wavelength."
)


class UploadedPicture:
    """Upload, choice of strategy and extent, and the two pictures."""

    def __init__(self, session: Session, result: Callable[[], SarResult | None]) -> None:
        self._session = session
        self._result = result
        self._file: tuple[str, bytes] | None = None
        look: dict[str, Any] = {"description": "", "size": "small", "margin": (8, 6)}
        self._input = LimitedFileInput(
            lambda why: self._say(f"Not formed. {why}"),
            label="Open a phase history", accept=".npz", icon="upload_file", max_file_size=MOST_BYTES,
            variant="outlined", **look,
        )  # fmt: skip
        self._key = pmui.Select(
            label="Navigation error of strategy", value="2", width=230, **look,
            options={short_name(key): key for key in STRATEGY_KEYS[1:]},
        )  # fmt: skip
        self._half = pmui.TextInput(label="Half width [m]", value="50", width=110, **look)
        self._picture = html_pane("")
        self._take = PictureDownloads("Your phase history", "sar-phase-history")
        self._input.param.watch(self._opened, "value")
        for widget in (self._key, self._half):
            widget.param.watch(self._form, "value")
        self.view = pn.Column(
            html_pane(f"<h3>Your phase history</h3><p class='know quiet'>{_HELP}</p>"),
            pn.FlexBox(self._input, self._key, self._half, sizing_mode="stretch_width", margin=(0, 4)),
            self._picture,
            self._take.view,
            sizing_mode="stretch_width",
        )

    def refresh(self) -> None:
        """A new study is there: the picture is of the old one."""
        if self._file is not None:
            pn.state.execute(self._form)

    async def _opened(self, event: Any) -> None:
        if not event.new:
            return
        name = str(self._input.filename or "file")
        if len(event.new) > MOST_BYTES:
            self._say(f"{name}: {len(event.new) / 2**20:.0f} MiB; at most {MOST_BYTES >> 20} MiB are taken")
            return
        self._file = (name, event.new)
        await self._form()

    async def _form(self, _: Any = None) -> None:
        result = self._result()
        if self._file is None:
            return
        if result is None:
            self._say("Run the strategies first: the picture needs the design's navigation error.")
            return
        name, data = self._file
        key = self._key.value
        residual = result.study.typical[[STRATEGY_KEYS.index(key)]]
        try:
            half = number("Half width [m]", self._half.value or "", 1.0, 5000.0)
        except InputError as error:
            self._say(f"Not formed. {error}")
            return
        self._session.running = True
        self._picture.object = f"<p class='quiet'>Forming {escape(name)} …</p>"
        try:
            pictures = await elsewhere(uploaded_pictures, name, data, result.study.time, residual, half)
        except ValueError as error:
            self._say(f"Not formed. {error}")
        except BrokenProcessPool:
            self._say("The worker process ended before its time; open the file again.")
        else:
            chart = uploaded_picture(pictures, name, key)
            self._picture.object = f'<div class="pair">{picture_gallery(chart)}</div>'
            self._take.show(chart)
            if result is self._result():  # not of a study that a newer one has replaced meanwhile
                self._session.keep("sar", replace(result, uploaded=chart))
        finally:
            self._session.running = False

    def _say(self, text: str) -> None:
        self._take.hide()
        self._picture.object = f'<p role="alert"><b>{escape(text)}</b></p>'
