"""A file that takes a while to make: a button to download it whose work is a run."""

from __future__ import annotations

import io
from collections.abc import Awaitable, Callable

from app.work.run import Run


def run_download(
    run: Run, write: Callable[[], Awaitable[bytes]], failed: Callable[[str], None]
) -> Callable[[], Awaitable[io.BytesIO]]:
    """The callback of a `FileDownload`.

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
