"""What a page may send, and what it is told of a fault."""

from __future__ import annotations

import asyncio
from types import SimpleNamespace
from typing import Any

import pytest
from bokeh.protocol.exceptions import ProtocolError
from panel.io.server import WSHandler

from app.upstream.push_doc import NoPushDoc
from app.upstream.tracebacks import NoTracebacks


def test_as_shipped_a_page_may_put_another_document_in_its_place(shipped: dict[str, Any]) -> None:
    assert shipped["push"] == ["OK", "another"]


def test_as_shipped_a_fault_is_told_with_its_traceback(shipped: dict[str, Any]) -> None:
    kind, content = shipped["fault"]
    assert kind == "ERROR"
    assert "Traceback" in content["traceback"]


def test_neither_of_the_product(monkeypatch: pytest.MonkeyPatch) -> None:
    passed: list[Any] = []

    async def on(_: Any, message: Any) -> None:
        passed.append(message)

    monkeypatch.setattr(WSHandler, "_handle", on, raising=False)
    monkeypatch.setattr(WSHandler, "send_message", on)
    with pytest.raises(ProtocolError, match="not taken"):
        asyncio.run(NoPushDoc._handle(NoPushDoc.__new__(NoPushDoc), SimpleNamespace(msgtype="PUSH-DOC")))
    assert not passed
    change = SimpleNamespace(msgtype="PATCH-DOC")
    asyncio.run(NoPushDoc._handle(NoPushDoc.__new__(NoPushDoc), change))
    fault = SimpleNamespace(msgtype="ERROR", content={"text": "in /home", "traceback": "File /home"})
    asyncio.run(NoTracebacks.send_message(NoTracebacks.__new__(NoTracebacks), fault))
    assert passed == [change, fault]
    assert "home" not in str(fault.content)
