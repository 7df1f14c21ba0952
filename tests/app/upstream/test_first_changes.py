"""Changes between sending a page and its being ready reach the browser."""

from __future__ import annotations

import asyncio
import weakref
from types import SimpleNamespace
from typing import Any

import panel as pn
import panel.io.document as panel_document
import pytest
from bokeh.document import Document
from bokeh.server.contexts import BokehSessionContext
from bokeh.server.session import ServerSession
from panel.io.server import WSHandler
from tornado.ioloop import IOLoop
from waiting import PATIENCE

from app.upstream import sending


@pytest.mark.parametrize(("asked", "told"), [("PULL-DOC-REQ", True), ("SERVER-INFO-REQ", False)])
def test_what_a_hold_collects_once_the_document_is_sent_is_told(
    asked: str, told: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(panel_document, "_drain_unconnected_events", sending._collected)
    document, changes = Document(), list[Any]()
    document.on_change(changes.append)

    async def replies(*_: Any) -> str:
        with pn.io.hold(document):
            document.title = "in what is sent"
        return "the reply"

    monkeypatch.setattr(WSHandler, "_handle", replies)
    handler = sending.FirstChanges.__new__(sending.FirstChanges)
    handler.connection = SimpleNamespace(session=SimpleNamespace(document=document))
    assert asyncio.run(handler._handle(SimpleNamespace(msgtype=asked))) == "the reply"
    assert not changes
    with pn.io.hold(document):
        document.title = "changed after"
    assert [each.title for each in changes] == ["changed after"] * told


def test_what_a_task_changes_meanwhile_is_told_once_the_session_is_free(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(panel_document, "_drain_unconnected_events", sending._collected)

    async def change() -> list[str]:
        document, told = Document(), asyncio.Queue[str]()
        context = BokehSessionContext("of a test", None, document)
        document._session_context = weakref.ref(context)
        session = ServerSession(context.id, document, IOLoop.current())
        context._set_session(session)

        class Connection:
            async def send_patch_document(self, event: Any) -> None:
                told.put_nowait(event.title)

        session.subscribe(Connection())
        sending._sent.add(document)
        with pn.io.hold(document):
            document.title = "by a task"
        found = [await asyncio.wait_for(told.get(), PATIENCE)]
        session.destroy()
        return found

    assert asyncio.run(change()) == ["by a task"]
