"""A change is not receipted; what asks for an answer has one; a page that takes nothing is not read from."""

from __future__ import annotations

import asyncio
from types import SimpleNamespace
from typing import Any

import pytest
from panel.io.server import WSHandler
from tornado.locks import Lock
from waiting import soon

from app.upstream.no_receipts import NoReceipts


class _Stream:
    """A connection whose other end has taken nothing, until told."""

    def __init__(self) -> None:
        self.taken = asyncio.Event()
        self.written: list[bytes] = []

    def writing(self) -> bool:
        return not self.taken.is_set()

    def write(self, data: bytes) -> Any:
        self.written.append(data)
        return asyncio.ensure_future(self.taken.wait())


def _connection(stream: _Stream) -> NoReceipts:
    made = NoReceipts.__new__(NoReceipts)
    made.ws_connection = SimpleNamespace(stream=stream)
    made.write_lock = Lock()
    return made


def test_as_shipped_each_change_is_receipted(shipped: dict[str, Any]) -> None:
    assert shipped["change"][0] == "OK"


def test_what_asks_for_an_answer_has_one(monkeypatch: pytest.MonkeyPatch) -> None:
    sent: list[str] = []

    async def send(_: Any, message: Any) -> None:
        sent.append(message.msgtype)

    monkeypatch.setattr(WSHandler, "_schedule", send)

    async def run() -> None:
        stream = _Stream()
        stream.taken.set()
        for kind in ("OK", "PULL-DOC-REPLY", "ERROR"):
            await _connection(stream)._schedule(SimpleNamespace(msgtype=kind))

    asyncio.run(run())
    assert sent == ["PULL-DOC-REPLY", "ERROR"]


def test_the_next_change_is_read_when_all_is_taken() -> None:
    async def run() -> None:
        stream = _Stream()
        next_read = asyncio.ensure_future(_connection(stream)._schedule(SimpleNamespace(msgtype="OK")))
        await soon(lambda: next_read.done() or stream.written, "it waits until all is taken")
        for _ in range(10):
            await asyncio.sleep(0)
        assert not next_read.done()
        assert b"".join(stream.written) == b""
        stream.taken.set()
        await next_read

    asyncio.run(run())
