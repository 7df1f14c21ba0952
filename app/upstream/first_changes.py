"""Changes made right after the page was sent reach the browser.

A page has its connection, is sent its document, draws it and then says that it is ready. As shipped what a hold
collects before that last word is dropped, "since the document is serialized in full once the session connects". It
was serialized before: what changes between the two, a second on a busy machine, is never seen.

Written for: Panel 1.9.4, Bokeh 3.9.2
Upstream: holoviz/panel#8698 (merged: drops them on purpose)
Needless when: tests/app/upstream/test_first_changes.py::test_as_shipped_a_change_before_it_is_ready_is_lost fails
"""

from __future__ import annotations

import functools
import threading
from typing import Any
from weakref import WeakSet

import panel.io.document as panel_document
from bokeh.document import Document
from panel.io.server import WSHandler

_sent: WeakSet[Document] = WeakSet()
_shipped = panel_document._drain_unconnected_events


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
        told: list[Any] = _shipped(document, lock)
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


def repair() -> None:
    """Install the override; the server calls it once, before it serves."""
    panel_document._drain_unconnected_events = _collected
