"""Downloads: small ones under a chart or a table, and files that take a while to make."""

import io
from collections.abc import Awaitable, Callable
from typing import Any

import panel_material_ui as pmui

from app.work.run import Run
from nav_model.base.errors import InputError

Content = str | bytes
_LOOK: dict[str, Any] = {"variant": "text", "margin": (0, 8)}


def download(
    label: str, filename: str, make: Callable[[], Content | Awaitable[Content]], **look: Any
) -> pmui.FileDownload:
    """A link-like button; `make` gives the content of the file when it is pressed. ``look``: as the button has it.

    An InputError that `make` raises is told above the page, and no file is saved.
    """

    async def made() -> io.BytesIO:
        content = make()
        if isinstance(content, Awaitable):
            content = await content
        button.data = None  # the browser saves what changes, and the same file may be wanted again
        return io.BytesIO(content.encode("utf-8") if isinstance(content, str) else content)

    button = pmui.FileDownload(callback=made, filename=filename, label=label, **_LOOK | look)
    return button


def run_download(run: Run, write: Callable[[], Awaitable[bytes]]) -> Callable[[], Awaitable[bytes]]:
    """Source for `download` of a file that is the result of a run.

    Parameters
    ----------
    run : Run
        Of the person's session, for this button alone.
    write : callable
        Makes the file's bytes; it must not hold up the event loop. Why it did not is told above the page.
    """

    async def made() -> bytes:
        await run.start(lambda _: write())
        if run.message:
            raise InputError("The file was not written", run.message)
        return run.result or b""

    return made
