"""Changes made while something is being written: none stays in the server's queue, none waits for a clock."""

from __future__ import annotations

import asyncio
from typing import Any

import panel.io.document as panel_document
import pytest
from bokeh.document import Document
from tornado.locks import Lock

from app.serving import writes


class _Socket:
    """What `_dispatch_msgs` asks of a connection that is not Tornado's."""

    def __init__(self) -> None:
        self.write_lock = Lock()


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


async def _while_writing(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Something else is being written when a change is made; what has been sent a few turns after that has ended."""
    doc, connection = Document(), _Connection()

    def dispatch(conn: _Connection, msg: str) -> list[Any]:
        conn.sent.append(msg)
        return []

    monkeypatch.setattr(panel_document, "extra_socket_handlers", {_Socket: dispatch})
    async with connection._socket.write_lock:
        panel_document.schedule_write_events(doc, [connection], ["news"])
        await _turns()
        assert not connection.sent, "written into the midst of another message"
    await _turns()
    return list(connection.sent)


async def _turns() -> None:
    for _ in range(10):  # of the event loop, in which no time passes
        await asyncio.sleep(0)


def test_a_change_is_sent_as_soon_as_the_connection_is_free(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(panel_document, "_dispatch_msgs", writes._dispatch_msgs)
    assert asyncio.run(_while_writing(monkeypatch)) == ["news"]


def test_panel_itself_still_waits_for_a_clock(monkeypatch: pytest.MonkeyPatch) -> None:
    """When this fails, the wait in `app.serving.writes` can go."""
    monkeypatch.setattr(panel_document, "_dispatch_msgs", writes._as_shipped)
    assert asyncio.run(_while_writing(monkeypatch)) == []
