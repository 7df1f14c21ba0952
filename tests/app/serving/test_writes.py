"""No change stays in the server's queue because another was being written when it was made."""

from __future__ import annotations

import asyncio
from typing import Any

import panel.io.document as panel_document
import pytest
from bokeh.document import Document

from app.serving import writes


class _Socket:
    """What `_dispatch_msgs` asks of a connection that is neither Tornado's nor busy."""


class _Connection:
    def __init__(self) -> None:
        self._socket = _Socket()
        self.protocol = self
        self.sent: list[str] = []

    def create(self, _: str, events: list[str]) -> str:
        return events[0]


async def _two_changes(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The second is made just when the first has been written; what has been sent when all tasks are done."""
    doc, connection = Document(), _Connection()
    begun, end = asyncio.Event(), asyncio.Event()

    def dispatch(conn: _Connection, msg: str) -> list[Any]:
        async def write() -> None:
            begun.set()
            await end.wait()
            conn.sent.append(msg)

        return [write()]

    monkeypatch.setattr(panel_document, "extra_socket_handlers", {_Socket: dispatch})
    panel_document.schedule_write_events(doc, [connection], ["first"])
    await begun.wait()
    end.set()  # the first's task goes on before the second's begins
    panel_document.schedule_write_events(doc, [connection], ["second"])
    await asyncio.sleep(0.1)
    return connection.sent


def test_a_change_made_while_another_is_written_is_sent(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(panel_document, "_dispatch_msgs", writes._dispatch_msgs)
    assert asyncio.run(_two_changes(monkeypatch)) == ["first", "second"]


def test_panel_itself_still_needs_the_repair(monkeypatch: pytest.MonkeyPatch) -> None:
    """When this fails, `app.serving.writes` has done its work and can go."""
    monkeypatch.setattr(panel_document, "_dispatch_msgs", writes._as_shipped)
    assert asyncio.run(_two_changes(monkeypatch)) == ["first"]
