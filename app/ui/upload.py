"""Uploads: a button that takes a file from the user's machine, and a place on the disk for one that is used again.

No upload stays in memory: a page may be open for days.
"""

import asyncio
import os
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import panel as pn

from app.upstream.file_input import LimitedFileInput
from nav_model.base.errors import InputError

_LOOK: dict[str, Any] = {"icon": "upload_file", "variant": "outlined", "margin": (2, 4)}


def upload(
    label: str,
    kinds: str,
    most: int,
    taken: Callable[[str, bytes], object],
    refused: Callable[[str], None],
    **look: Any,
) -> LimitedFileInput:
    """A button for a file of some kinds, such as ``.csv,.npz``, of at most so many bytes.

    `taken` is called with name and content, and may be asynchronous; `refused` with why there is no file. The button
    forgets the file, and the same one can be opened again. ``look``: as the button has it.
    """
    button = LimitedFileInput(refused, label=label, accept=kinds, max_file_size=most, **_LOOK | look)

    def arrived(event: Any) -> None:
        if event.new:
            name = str(button.filename or "file")
            button.clear()
            pn.state.execute(partial(taken, name, event.new), schedule=False)

    button.param.watch(arrived, "value")
    return button


class UploadedFile:
    """The file that a page was given last, on the disk for as long as its session lasts."""

    def __init__(self) -> None:
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._path: Path | None = None
        if pn.state.curdoc:
            pn.state.on_session_destroyed(lambda _: self.delete())

    async def put(self, content: bytes) -> Path:
        """Keep a file in place of the one before.

        Raises
        ------
        InputError
            Where the disk takes no more; the file before stays.
        """
        try:
            return await asyncio.to_thread(self._put, content)
        except OSError as error:
            raise InputError("file", f"the server cannot keep it: {error.strerror}") from error

    def _put(self, content: bytes) -> Path:
        if self._folder is None:
            self._folder = tempfile.TemporaryDirectory(prefix="navbudget-")
        number, name = tempfile.mkstemp(dir=self._folder.name)
        path = Path(name)
        try:
            with os.fdopen(number, "wb") as file:
                file.write(content)
        except OSError:
            path.unlink()
            raise
        if self._path is not None:
            self._path.unlink()
        self._path = path
        return path

    def delete(self) -> None:
        """Delete the file."""
        if self._folder is not None:
            self._folder.cleanup()
            self._folder = self._path = None
