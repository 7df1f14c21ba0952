"""Deferred work of a page: large parts once their place is in view, parts below the first screen, and parts that need
not follow every slider step."""

import asyncio
import time
from collections.abc import Callable

import panel as pn
from bokeh.document import Document

_SEEN = 0.02  # seconds in which what was changed reaches the browser
_QUIET = 0.4  # seconds: a key held down repeats ten times faster, one pressed again and again as fast


def _is_open(document: Document) -> bool:
    return document.session_context is not None and not document.session_context.destroyed


def defer(work: Callable[[], object]) -> None:
    """Do the work in another turn of the server, when what was changed before has reached the browser, unless the
    page is closed by then.

    In a script or a test, where there is no server: at once.
    """
    document = pn.state.curdoc
    if document is None or document.session_context is None:
        work()
        return

    async def run() -> None:
        await asyncio.sleep(_SEEN)
        if _is_open(document):
            with pn.io.hold():
                work()

    pn.state.execute(run)


def later(seconds: float, work: Callable[[], object]) -> None:
    """Do the work after so many seconds, unless the page is closed by then; never in a script or a test."""
    document = pn.state.curdoc
    if document is None or document.session_context is None:
        return

    def due() -> None:
        if _is_open(document):
            document.add_next_tick_callback(work)

    asyncio.get_running_loop().call_later(seconds, due)


def once_loaded(work: Callable[[], object]) -> None:
    """Do the work when the first screen has reached the browser; all such work is one change.

    At once if it has, and in a script or a test, where there is no page.
    """
    document = pn.state.curdoc
    if document is None or pn.state.loaded:
        work()
        return
    # The work holds its page: kept on the document, both go together, also if its browser is never ready.
    waiting: list[Callable[[], object]] = vars(document).setdefault("once_loaded", [])
    if not waiting:
        pn.state.onload(lambda: _complete(document, waiting))
    waiting.append(work)


def _complete(document: Document, waiting: list[Callable[[], object]]) -> None:
    with pn.io.hold():
        while waiting:
            pn.state.execute(waiting.pop(0), schedule=False)  # a fault in one is told, the others are made


def debounce(work: Callable[[], None]) -> Callable[[], None]:
    """A call that has the work done at once, and, while it is called again and again, not until that has ended: for
    parts that are not read or used while a slider moves.

    In a script or a test, where there is no server: at every call.
    """
    document, due, waits = pn.state.curdoc, 0.0, False
    if document is None or document.session_context is None:
        return work

    def look() -> None:
        """By a timer of the loop: one of the document's costs as much as some of the work."""
        if (wait := due - time.monotonic()) > 0:
            asyncio.get_running_loop().call_later(wait, look)
        elif _is_open(document):
            document.add_next_tick_callback(rested)

    def rested() -> None:
        nonlocal waits
        waits = False
        with pn.io.hold():
            work()

    def call() -> None:
        nonlocal due, waits
        moving, due = time.monotonic() < due, time.monotonic() + _QUIET
        if not moving:
            work()
        elif not waits:
            waits = True
            asyncio.get_running_loop().call_later(_QUIET, look)

    return call
