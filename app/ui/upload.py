"""Uploads: a button that takes a file from the user's machine."""

from collections.abc import Callable
from functools import partial
from typing import Any

import panel as pn

from app.upstream.file_input import LimitedFileInput

_LOOK: dict[str, Any] = {"icon": "upload_file", "variant": "outlined", "margin": (2, 4)}


def upload(
    label: str,
    kinds: str,
    most: int,
    taken: Callable[[str, bytes], object],
    refused: Callable[[str], None],
    *,
    forget: bool = False,
    **look: Any,
) -> LimitedFileInput:
    """A button for a file of some kinds, such as ``.csv,.npz``, of at most so many bytes.

    `taken` is called with name and content, and may be asynchronous; `refused` with why there is no file. To
    ``forget`` the file lets the same one be opened again. ``look``: as the button has it.
    """
    button = LimitedFileInput(refused, label=label, accept=kinds, max_file_size=most, **_LOOK | look)

    def arrived(event: Any) -> None:
        if event.new:
            name = str(button.filename or "file")
            if forget:
                button.clear()
            pn.state.execute(partial(taken, name, event.new), schedule=False)

    button.param.watch(arrived, "value")
    return button
