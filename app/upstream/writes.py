"""Changes are sent to the browser in the order they are made, and without a timer.

A message names models that messages before it have brought; a page that gets them in another order fails. As
shipped, two hands write: Bokeh (3.9) puts a change into words at once but writes it when the event that made it has
been dealt with; Panel (1.9.4) writes at once where the connection is free, and otherwise puts the change into a queue
and looks again every 10 ms. So each could overtake the other, a slider's step waited for the clock, and a queue was
forgotten when its last change came just as the one before had been written: the last news of a run waited for the
next thing that person did.

Here every change takes its place in the connection's own line when it is put into words.

Written for: Panel 1.9.4, Bokeh 3.9.2
Upstream: holoviz/panel#6443, holoviz/panel#6667 (merged: in order among Panel's own)
Needless when: tests/app/upstream/test_writes.py::test_all_is_sent_at_once_and_in_the_order_it_was_made fails
"""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from typing import Any

import panel.io.document as panel_document
from bokeh.document import Document
from bokeh.document.events import DocumentPatchedEvent
from bokeh.server.connection import ServerConnection

_under_way: set[asyncio.Task[None]] = set()  # the loop itself keeps no task alive


def _in_line(connection: Any, events: list[DocumentPatchedEvent]) -> asyncio.Task[None]:
    message = connection.protocol.create("PATCH-DOC", events)
    turn = connection._socket.write_lock.acquire()
    task = asyncio.ensure_future(_write(connection, message, turn))
    _under_way.add(task)
    task.add_done_callback(_under_way.discard)
    return task


async def _write(connection: Any, message: Any, turn: Any) -> None:
    with await turn:
        await asyncio.gather(*panel_document.dispatch_tornado(connection, msg=message))


def _panels(_: Document, connections: Sequence[Any], events: list[DocumentPatchedEvent]) -> None:
    for connection in connections:
        _in_line(connection, events)


def _bokehs(connection: ServerConnection, event: DocumentPatchedEvent) -> asyncio.Task[None]:
    return _in_line(connection, [event])


def repair() -> None:
    """Install the override; the server calls it once, before it serves."""
    panel_document.schedule_write_events = _panels
    ServerConnection.send_patch_document = _bokehs
