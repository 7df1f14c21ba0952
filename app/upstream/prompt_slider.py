"""A slider's steps reach the server at once and only once, and the newest wins.

Panel waits 50 ms with each change, hears every step twice (as "value" and as "value_throttled"), turns the busy flag
of the whole server on and off for it, which nothing here shows, and lifts the write protection of every parameter for
as long. It works out how to tell the page what the page has said. It works off a value although the page has sent a
newer one: on a busy server they queue.

Written for: Panel 1.9.4, panel-material-ui 0.16.6, Tornado 6.6.1
Upstream: none found, searched 2026-11-23
Needless when: tests/app/upstream/test_prompt_slider.py::test_as_shipped_a_step_waits_and_comes_twice fails
"""

from __future__ import annotations

import asyncio
import select
import time
from typing import Any, ClassVar

import panel_material_ui as pmui
from bokeh.document import Document
from panel.io.state import state
from panel.reactive import _syncing

_LONGEST = 0.2  # seconds that a value waits for what the page has sent after it


class PromptSlider(pmui.FloatSlider):
    """A slider that is followed step by step."""

    _priority_changes: ClassVar[list[str]] = ["value"]

    @property
    def _linked_properties(self) -> tuple[str, ...]:
        """What is heard of the browser."""
        return ("value",)

    async def _change_coroutine(self, doc: Document, event_id: str | None = None) -> None:
        """Read all that the page has sent, which may put a newer value in this one's place, and work off the last."""
        until = time.monotonic() + _LONGEST
        while _more_to_read(doc) and time.monotonic() < until:
            await asyncio.sleep(0)
        await super()._change_coroutine(doc, event_id)

    def _process_events(self, events: dict[str, Any]) -> None:
        """Take a value that comes from the page, which need not be told of it again."""
        document = state.curdoc
        if document:
            self._in_process__events[document] = events
        try:
            with _syncing(self, list(events)):
                for name, value in self._process_property_change(events).items():
                    setattr(self, name, value)
        finally:
            self._in_process__events.pop(document, None)

    def _param_change(self, *events: Any) -> None:
        """Tell the page what is not what it says itself."""
        said = self._in_process__events.get(state.curdoc, {})
        if news := [event for event in events if said.get(event.name) != event.new]:
            super()._param_change(*news)


def _more_to_read(document: Document) -> bool:
    """Whether a page has sent what the server has not looked at."""
    session = document.session_context.session if document.session_context else None
    for connection in session._subscribed_connections if session else ():
        websocket = connection._socket.ws_connection
        if websocket is None or websocket.stream.closed():
            continue
        arrived = select.poll()
        arrived.register(websocket.stream.fileno(), select.POLLIN)
        if websocket.stream._read_buffer_size or arrived.poll(0):
            return True
    return False
