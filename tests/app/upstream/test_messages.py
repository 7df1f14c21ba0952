"""What a page is told of a fault."""

from __future__ import annotations

import asyncio
from types import SimpleNamespace
from typing import Any

import pytest
from panel.io.server import WSHandler

from app.upstream.connection import NoTracebacks


def test_as_shipped_a_fault_is_told_with_its_traceback(shipped: dict[str, Any]) -> None:
    kind, content = shipped["fault"]
    assert kind == "ERROR"
    assert "Traceback" in content["traceback"]


def test_no_traceback_of_the_product(monkeypatch: pytest.MonkeyPatch) -> None:
    passed: list[Any] = []

    async def on(_: Any, message: Any) -> None:
        passed.append(message)

    monkeypatch.setattr(WSHandler, "send_message", on)
    fault = SimpleNamespace(msgtype="ERROR", content={"text": "in /home", "traceback": "File /home"})
    asyncio.run(NoTracebacks.send_message(NoTracebacks.__new__(NoTracebacks), fault))
    assert passed == [fault]
    assert "home" not in str(fault.content)
