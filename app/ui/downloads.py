"""Downloads: small ones under a chart or a table, and files that take a while to make."""

from __future__ import annotations

import io
from collections.abc import Awaitable, Callable

import panel_material_ui as pmui

from app.work.run import Run


def download(
    label: str, filename: str, make: Callable[[], io.BytesIO] | Callable[[], Awaitable[io.BytesIO]]
) -> pmui.FileDownload:
    """A link-like button; `make` is called when it is pressed."""
    return pmui.FileDownload(callback=make, filename=filename, label=label, variant="text", margin=(0, 8))


def run_download(
    run: Run, write: Callable[[], Awaitable[bytes]], failed: Callable[[str], None]
) -> Callable[[], Awaitable[io.BytesIO]]:
    """The callback of a `FileDownload` whose file is the result of a run.

    Parameters
    ----------
    run : Run
        Of the person's session, for this button alone.
    write : callable
        Makes the file's bytes; it must not hold up the event loop.
    failed : callable
        Told why there is no file.
    """

    async def made() -> io.BytesIO:
        await run.start(lambda _: write())
        if run.message:
            failed(run.message)
        return io.BytesIO(run.result or b"")

    return made
