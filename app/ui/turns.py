"""Large parts of a page made piece by piece: between two turns everybody else's sliders move."""

from __future__ import annotations

import asyncio
import time
from collections import deque
from collections.abc import Callable, Iterable

import panel as pn

from app.upstream.frozen_models import frozen_models

_LONGEST = 0.1  # seconds of a turn in which another piece is begun; what a turn costs besides is about as much
_BETWEEN = 0.01  # seconds: the dozen frames of a slider step come in, and it is answered


def in_turns(pieces: Iterable[Callable[[], None]], after: float = 0.0) -> None:
    """Do the pieces in order, a few in each turn of the server, until all are done or the page is closed.

    The first begins ``after`` so many seconds, in which what was changed before reaches the browser. In a script or
    a test, where there is no server: all at once.
    """
    document, waiting = pn.state.curdoc, deque(pieces)
    if document is None or document.session_context is None:
        for piece in waiting:
            piece()
        return

    async def run() -> None:
        await asyncio.sleep(after)
        while waiting and document.session_context is not None and not document.session_context.destroyed:
            until = time.monotonic() + _LONGEST
            with pn.io.hold(), frozen_models(document):
                while waiting and time.monotonic() < until:
                    waiting.popleft()()
            await asyncio.sleep(_BETWEEN)

    pn.state.execute(run)
