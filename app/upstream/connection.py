"""How a page's connection is kept, and what it says: each class here is a part of its handler.

Websocket frames are sent at once.

A message is a dozen small frames and more: with Nagle's algorithm the second waits until the browser has confirmed
the first, up to 40 ms. Tornado leaves it on unless asked, and Bokeh does not ask.

Written for: Panel 1.9.4, Bokeh 3.9.2, Tornado 6.6.1
Upstream: none found, searched 2026-11-22
Needless when: tests/app/upstream/test_frames_at_once.py::test_as_shipped_frames_wait fails

A connection lost at a ping closes without an error.

Bokeh takes its session away when a ping fails, and asks for it when Tornado then reports the connection closed: an
AssertionError in the log for each.

Written for: Panel 1.9.4, Bokeh 3.9.2
Upstream: bokeh/bokeh#13655 (merged: the ping cleans up, and so brought this)
Needless when: tests/app/upstream/test_lost_connection.py::test_as_shipped_closing_is_a_fault fails

Errors are sent to the browser without a traceback, which would reveal paths and versions.

Written for: Panel 1.9.4, Bokeh 3.9.2
Upstream: none found, searched 2026-11-22
Needless when: tests/app/upstream/test_messages.py::test_as_shipped_a_fault_is_told_with_its_traceback fails
"""

from __future__ import annotations

from typing import Any

from panel.io.server import WSHandler


class FramesAtOnce(WSHandler):
    """A connection without Nagle's algorithm."""

    def open(self, *arguments: Any, **options: Any) -> None:
        """As Bokeh, then with TCP_NODELAY unless the connection was refused."""
        super().open(*arguments, **options)
        if self.ws_connection is not None:
            self.set_nodelay(True)


class LostConnection(WSHandler):
    """Closes in silence once it has no session to tell."""

    def on_close(self) -> None:
        """As Bokeh, unless nobody is there."""
        if self.connection is None or self.connection._session is not None:
            super().on_close()


class NoTracebacks(WSHandler):
    """Tells that something failed, and no more."""

    async def send_message(self, message: Any) -> None:
        """As Bokeh, but for what an error carries."""
        if message.msgtype == "ERROR":
            message.content = {"text": "the server could not do this", "traceback": None}
        await super().send_message(message)
