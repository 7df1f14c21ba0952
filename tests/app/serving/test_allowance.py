"""Limits on what a page sends: by message, and by session for what stays."""

import asyncio
import gc
import json
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace
from typing import Any
from weakref import ref

import pytest
from bokeh.protocol import Protocol
from bokeh.protocol.receiver import Receiver
from bokeh.util.serialization import make_id
from open_page import Tab
from tornado.websocket import WebSocketClosedError
from waiting import PATIENCE

from app.serving.allowance import Allowance
from app.serving.handlers import LimitedWSHandler

pytestmark = [pytest.mark.long, pytest.mark.watches("app/serving", "app/upstream")]

_MOST = 1_000_000  # bytes of a message, as the server below is told
_SENT = 60_000_000  # by a flood that nobody stops


def _message(*events: Any, kind: str = "PATCH-DOC", buffers: int = 0) -> Any:
    parts = [SimpleNamespace(to_bytes=lambda: bytes(buffers))] if buffers else []
    return SimpleNamespace(msgtype=kind, content={"events": list(events)}, buffers=parts)


def _set(model: str, value: Any, attr: str = "value") -> dict[str, Any]:
    return {"kind": "ModelChanged", "model": {"id": model}, "attr": attr, "new": value}


def test_a_value_again_and_again_counts_once() -> None:
    allowance = Allowance(_MOST)
    for _ in range(100):
        assert not allowance.against(_message(_set("p1", "x" * 100_000)))


def test_values_side_by_side_are_summed_and_so_are_arrays() -> None:
    scalars, arrays = Allowance(_MOST), Allowance(_MOST)
    assert not scalars.against(_message(_set("p1", "x" * 90_000), _set("p2", "x" * 90_000)))
    assert scalars.against(_message(_set("p3", "x" * 90_000)))
    assert not arrays.against(_message(_set("p1", {"type": "bytes", "data": {"id": "b"}}), buffers=90_000))
    assert arrays.against(_message(_set("p2", {"type": "bytes", "data": {"id": "b"}}), buffers=120_000))


@pytest.mark.parametrize(
    "message",
    [
        _message(kind="PUSH-DOC"),
        _message({"kind": "RootAdded", "model": {"id": "p1"}}),
        _message({"kind": "ColumnsStreamed", "model": {"id": "p1"}, "attr": "data", "data": {}}),
        _message({"kind": "TitleChanged", "title": "x"}),
        _message({"kind": "ModelChanged"}),
        _message({"kind": "ModelChanged", "model": {"id": []}, "attr": "x"}),
        _message("not an event"),
        SimpleNamespace(msgtype="PATCH-DOC", content=[], buffers=[]),
    ],
)
def test_only_what_pages_send_is_taken(message: Any) -> None:
    assert Allowance(_MOST).against(message)


async def test_half_a_message_is_freed_without_waiting_for_a_collection() -> None:
    """Garbage waits for a quiet moment, and a flood leaves none."""
    handler = LimitedWSHandler.__new__(LimitedWSHandler)
    handler.receiver = Receiver(Protocol())
    for text in ({"msgid": "1", "msgtype": "PATCH-DOC", "num_buffers": 2}, {}, {"events": []}, {"id": "1"}):
        await handler.receiver.consume(json.dumps(text))
    await handler.receiver.consume(bytes(1000))
    part = ref(handler.receiver._partial)
    gc.disable()
    try:
        handler._drop_receiver()
        assert part() is None
    finally:
        gc.enable()


@pytest.fixture(scope="module")
def served(serving: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Any, Path]]:
    log = tmp_path_factory.mktemp("flooded") / "log"
    with serving("--log", "json", "--max-message", str(_MOST / 1e6), log=log) as result:
        yield result, log


async def _endless(tab: Tab) -> None:
    """One message, whose buffers never end."""
    for text in ({"msgid": "1", "msgtype": "PATCH-DOC", "num_buffers": 1_000_000}, {}, {"events": []}):
        await tab.connection.write_message(json.dumps(text))
    for _ in range(_SENT // 500_000):
        await tab.connection.write_message(json.dumps({"id": make_id()}))
        await tab.connection.write_message(bytes(500_000), binary=True)


async def _roots(tab: Tab) -> None:
    for number in range(_SENT // 500_000):
        div = {"type": "object", "name": "Div", "id": f"own{number}", "attributes": {"text": "x" * 500_000}}
        await tab.send("PATCH-DOC", {"events": [{"kind": "RootAdded", "model": div}]})


async def _values(tab: Tab) -> None:
    """Values of models that the page does have."""
    models = [model["id"] for model in tab.objects]
    for number in range(_SENT // 100_000):
        await tab.send("PATCH-DOC", {"events": [_set(models[number % len(models)], f"{number}" * 20_000, "name")]})


async def _faults(tab: Tab) -> None:
    for _ in range(2000):
        await tab.send("PATCH-DOC", {"events": [_set("no such model", 1)]})


async def _deep(tab: Tab) -> None:
    await tab.send("PATCH-DOC", "[" * 50_000)
    for _ in range(100):
        await tab.send("NO-SUCH-MESSAGE", {})


@pytest.mark.parametrize("flood", [_endless, _roots, _values, _faults, _deep])
async def test_a_flood_ends_its_own_page_alone_and_is_a_few_lines_of_log(
    served: tuple[Any, Path], flood: Any
) -> None:
    server, log = served
    before = log.stat().st_size
    bystander, flooding = await Tab.open(server.address), await Tab.open(server.address)
    with suppress(WebSocketClosedError):
        await flood(flooding)
    async with asyncio.timeout(PATIENCE):
        await flooding._reading  # until it is hung up on
    await bystander.pull()
    await bystander.close()
    assert not bystander.errors
    assert "hung up: 1008" in flooding.errors[-1]
    assert log.stat().st_size - before < 100_000
