"""A page may change what it shows, not put another document in its place.

Bokeh takes a whole document from any browser that has a session: what was checked when the page was built is gone.

Written for: Panel 1.9.4, Bokeh 3.9.2
Upstream: none found, searched 2026-11-22
Needless when: tests/app/upstream/test_messages.py::test_as_shipped_a_page_may_put_another_document_in_its_place fails
"""

from __future__ import annotations

from typing import Any

from bokeh.protocol.exceptions import ProtocolError
from panel.io.server import WSHandler


class NoPushDoc(WSHandler):
    """Refuses the message that carries a whole document."""

    async def _handle(self, message: Any) -> Any:
        if message.msgtype == "PUSH-DOC":
            raise ProtocolError("PUSH-DOC is not taken")
        return await super()._handle(message)
