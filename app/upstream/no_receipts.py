"""A change from a page is applied without a reply.

Bokeh answers each with a message of its own, which nothing in the browser waits for: a twentieth of a slider's step.
That a change was not taken is still told, and what a page asks for is still answered. What the receipt also did is
kept: nothing more is read from a page that has not taken what was sent to it.

Written for: Panel 1.9.4, Bokeh 3.9.2, Tornado 6.6.1
Upstream: none found, searched 2026-11-23
Needless when: tests/app/upstream/test_no_receipts.py::test_as_shipped_each_change_is_receipted fails
"""

from __future__ import annotations

from contextlib import suppress
from typing import Any

from panel.io.server import WSHandler
from tornado.iostream import StreamClosedError


class NoReceipts(WSHandler):
    """Answers what asks for an answer."""

    async def _schedule(self, work: Any) -> None:
        if getattr(work, "msgtype", "") != "OK":
            await super()._schedule(work)
            return
        with await self.write_lock.acquire():
            websocket = self.ws_connection
            if websocket is not None and websocket.stream.writing():
                with suppress(StreamClosedError):
                    await websocket.stream.write(b"")  # done when all before it is
