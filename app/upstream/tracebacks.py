"""Errors are sent to the browser without a traceback, which would reveal paths and versions.

Written for: Panel 1.9.4, Bokeh 3.9.2
Upstream: none found, searched 2026-11-22
Needless when: tests/app/upstream/test_messages.py::test_as_shipped_a_fault_is_told_with_its_traceback fails
"""

from __future__ import annotations

from typing import Any

from panel.io.server import WSHandler


class NoTracebacks(WSHandler):
    """Tells that something failed, and no more."""

    async def send_message(self, message: Any) -> None:
        """As Bokeh, but for what an error carries."""
        if message.msgtype == "ERROR":
            message.content = {"text": "the server could not do this", "traceback": None}
        await super().send_message(message)
