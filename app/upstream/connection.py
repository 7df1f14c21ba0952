"""A page's connection: how it is kept, and how changes are sent over it, in order, all of them, and at once.

Bokeh (3.9) puts a change into words at once but writes it when the event that made it has been dealt with; Panel
(1.9.4) writes at once where the connection is free, and otherwise puts the change into a queue that it looks at every
10 ms. Here every change takes its place in the connection's own line when it is put into words. Changes made right
after the page was sent are kept, a message is one write, and a page that is closed meanwhile is no error.

A connection lost at a ping closes without an error, and errors are sent without a traceback, which would reveal paths
and versions: each class here is a part of the connection's handler.

Reports to send upstream, versions and ends: docs/upstream/connection.md
"""

import asyncio
import functools
import json
import threading
from collections.abc import Sequence
from contextlib import suppress
from typing import Any
from weakref import WeakSet

import panel.io.document as panel_document
from bokeh.document import Document
from bokeh.document.events import DocumentPatchedEvent
from bokeh.protocol.message import Message
from bokeh.server.connection import ServerConnection
from bokeh.server.session import ServerSession
from panel.io.server import WSHandler
from tornado.iostream import StreamClosedError

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
    """Events to be told of all that a hold collected before the page was ready."""
    if document not in _sent:
        collected: list[Any] = _drain_as_shipped(document, lock)
        return collected
    with lock:
        events, callbacks = list(document.callbacks._held_events), document.callbacks
        callbacks._held_events, callbacks._hold = [], None
    session = document.session_context.session if document.session_context else None
    if session is None or session._pending_writes is not None:
        return events
    # A task of ours made the changes, such as a result that has come: they are written once the session is free.
    document.add_next_tick_callback(functools.partial(panel_document._dispatch_events, document, events))
    return []


_patched_as_shipped = ServerSession._document_patched


def _patched(session: ServerSession, event: DocumentPatchedEvent) -> None:
    """Tell the page of a change, also of one that a task of ours made, outside the document's lock."""
    if session._pending_writes is not None:
        _patched_as_shipped(session, event)
    elif session.document in _sent:  # else it will be sent whole, with the change
        for connection in session._subscribed_connections:
            _in_line(connection, [event])


def keep_first_changes() -> None:
    """Install the overrides; the server calls it once, before it serves."""
    panel_document._drain_unconnected_events = _collected
    ServerSession._document_patched = _patched


_TEXT, _BINARY = 0x1, 0x2  # kinds of frame, RFC 6455 section 5.2


_LARGE = 100_000  # bytes: a whole page; a step's are less, and compressing them would cost more than they are worth


def _frame(kind: int, data: bytes, websocket: Any) -> bytes:
    """A whole message of a server, compressed where it is large and the browser takes it so (RFC 6455 section 5.2;
    RFC 7692 leaves that open for each). What is compressed is to be written next: it refers to what was before."""
    packing = getattr(websocket, "_compressor", None) if len(data) >= _LARGE else None
    if packing is not None:
        data, kind = packing.compress(data), kind | 0x40
    size = len(data)
    if size < 126:
        length = bytes([size])
    elif size < 1 << 16:
        length = b"\x7e" + size.to_bytes(2, "big")
    else:
        length = b"\x7f" + size.to_bytes(8, "big")
    return bytes([0x80 | kind]) + length + data


def _dispatch(connection: Any, events: Sequence[Any] | None = None, msg: Any = None) -> Sequence[asyncio.Task[None]]:
    """As Panel's ``dispatch_tornado``: begin to write a message; what comes back is done when it is written."""
    websocket = connection._socket.ws_connection
    if websocket is None or websocket.is_closing() or not (events or msg):
        return []
    whole = _whole(msg or connection.protocol.create("PATCH-DOC", events), websocket)
    try:
        return [asyncio.ensure_future(_written(websocket.stream.write(whole)))]
    except StreamClosedError:
        return []


def _whole(message: Any, websocket: Any) -> bytes:
    """Every frame of a message, one after the other."""
    texts = (message.header_json, message.metadata_json, message.content_json)
    frames = [_frame(_TEXT, text.encode(), websocket) for text in texts]
    for buffer in message._buffers:
        frames.append(_frame(_TEXT, json.dumps(buffer.ref).encode(), websocket))
        frames.append(_frame(_BINARY, bytes(buffer.to_bytes()), websocket))
    return b"".join(frames)


async def _answer(message: Any, socket: Any) -> int:
    """As Bokeh's ``Message.send``: write what answers a message of the page; its bytes."""
    with await socket.write_lock.acquire():
        websocket = socket.ws_connection
        if websocket is None or websocket.is_closing():
            return 0
        whole = _whole(message, websocket)
        with suppress(StreamClosedError):
            await websocket.stream.write(whole)
    return len(whole)


async def _written(outcome: asyncio.Future[None]) -> None:
    with suppress(StreamClosedError):
        await outcome


def write_once() -> None:
    """Install the override; the server calls it once, before it serves."""
    panel_document.dispatch_tornado = _dispatch
    Message.send = _answer


class LostConnection(WSHandler):
    """Closes in silence once it has no session to tell."""

    def on_close(self) -> None:
        """As Bokeh, unless nobody is there."""
        if self.connection is None or self.connection._session is not None:
            super().on_close()

    def _is_gone(self) -> bool:
        """True if there is no session for a message that came all the same."""
        return self.connection is None or self.connection._session is None


class NoTracebacks(WSHandler):
    """Tells that something failed, and no more."""

    async def send_message(self, message: Any) -> None:
        """As Bokeh, but for what an error carries."""
        if message.msgtype == "ERROR":
            message.content = {"text": "the server could not do this", "traceback": None}
        await super().send_message(message)
