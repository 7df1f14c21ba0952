"""A page's connection: how it is kept, and how changes are sent over it, in order, all of them, and at once.

Bokeh (3.9) puts a change into words at once but writes it when the event that made it has been dealt with; Panel
(1.9.4) writes at once where the connection is free, and otherwise puts the change into a queue that it looks at every
10 ms. Here every change takes its place in the connection's own line when it is put into words. Changes made right
after the page was sent are kept.

A connection lost at a ping closes without an error, and errors are sent without a traceback, which would reveal paths
and versions: each class here is a part of the connection's handler.

Reports to send upstream, versions and ends: docs/upstream/connection.md
"""

import asyncio
import functools
import threading
from collections.abc import Sequence
from contextlib import suppress
from typing import Any
from weakref import WeakSet

import panel.io.document as panel_document
from bokeh.document import Document
from bokeh.document.events import DocumentPatchedEvent
from bokeh.server.connection import ServerConnection
from panel.io.server import WSHandler
from tornado.websocket import WebSocketClosedError

_under_way: set[asyncio.Task[None]] = set()  # the loop itself keeps no task alive


def _in_line(connection: Any, events: list[DocumentPatchedEvent]) -> asyncio.Task[None]:
    message = connection.protocol.create("PATCH-DOC", events)
    turn = connection._socket.write_lock.acquire()
    task = asyncio.ensure_future(_write(connection, message, turn))
    _under_way.add(task)
    task.add_done_callback(_under_way.discard)
    return task


async def _write(connection: Any, message: Any, turn: Any) -> None:
    with await turn, suppress(WebSocketClosedError):  # a page that is closed meanwhile is no error
        await asyncio.gather(*panel_document.dispatch_tornado(connection, msg=message))


def _panels(_: Document, connections: Sequence[Any], events: list[DocumentPatchedEvent]) -> None:
    for connection in connections:
        _in_line(connection, events)


def _bokehs(connection: ServerConnection, event: DocumentPatchedEvent) -> asyncio.Task[None]:
    return _in_line(connection, [event])


def send_in_order() -> None:
    """Install the override; the server calls it once, before it serves."""
    panel_document.schedule_write_events = _panels
    ServerConnection.send_patch_document = _bokehs


_sent: WeakSet[Document] = WeakSet()
_drain_as_shipped = panel_document._drain_unconnected_events


class FirstChanges(WSHandler):
    """Remembers that a page has been sent its document."""

    async def _handle(self, message: Any) -> Any:
        reply = await super()._handle(message)
        if message.msgtype == "PULL-DOC-REQ" and self.connection is not None:
            _sent.add(self.connection.session.document)
        return reply


def _collected(document: Document, lock: threading.Lock) -> list[Any]:
    """What is to be told of all that a hold collected before the page was ready."""
    if document not in _sent:
        told: list[Any] = _drain_as_shipped(document, lock)
        return told
    with lock:
        events, callbacks = list(document.callbacks._held_events), document.callbacks
        callbacks._held_events, callbacks._hold = [], None
    session = document.session_context.session if document.session_context else None
    if session is None or session._pending_writes is not None:
        return events
    # A task of ours made the changes, such as a result that has come: they are written once the session is free.
    document.add_next_tick_callback(functools.partial(panel_document._dispatch_events, document, events))
    return []


def keep_first_changes() -> None:
    """Install the override; the server calls it once, before it serves."""
    panel_document._drain_unconnected_events = _collected


class LostConnection(WSHandler):
    """Closes in silence once it has no session to tell."""

    def on_close(self) -> None:
        """As Bokeh, unless nobody is there."""
        if self.connection is None or self.connection._session is not None:
            super().on_close()

    def _given_up(self) -> bool:
        """Whether there is no session for a message that came all the same."""
        return self.connection is None or self.connection._session is None


class NoTracebacks(WSHandler):
    """Tells that something failed, and no more."""

    async def send_message(self, message: Any) -> None:
        """As Bokeh, but for what an error carries."""
        if message.msgtype == "ERROR":
            message.content = {"text": "the server could not do this", "traceback": None}
        await super().send_message(message)
