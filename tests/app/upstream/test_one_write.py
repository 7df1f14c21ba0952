"""A message reaches the page whole, in one write."""

from __future__ import annotations

import asyncio
from types import SimpleNamespace
from typing import Any

import panel.io.document as panel_document
import pytest
import tornado.websocket
from tornado.httpserver import HTTPServer
from tornado.iostream import StreamClosedError
from tornado.locks import Lock
from tornado.testing import bind_unused_port
from tornado.web import Application
from waiting import PATIENCE

from app.upstream.sending import _answer, _dispatch

_TEXTS = ['{"msgid": "1"}', "{}", "ü" * 200]  # lengths on both sides of each way to say one
_ARRAYS = [b"", b"\x00" * 125, bytes(range(126)), b"x" * 65535, b"y" * 65536]


def _message() -> Any:
    buffers = [SimpleNamespace(ref={"id": f"{i}"}, to_bytes=lambda data=data: data) for i, data in enumerate(_ARRAYS)]
    header, metadata, content = _TEXTS
    return SimpleNamespace(header_json=header, metadata_json=metadata, content_json=content, _buffers=buffers)


def _sent(dispatch: Any) -> tuple[int, list[Any]]:
    """How many writes a message takes, and what a client of another make receives."""

    async def run() -> tuple[int, list[Any]]:
        served: asyncio.Future[Any] = asyncio.get_running_loop().create_future()

        class Handler(tornado.websocket.WebSocketHandler):
            def open(self, *_: str, **__: str) -> None:
                served.set_result(self)

        server = HTTPServer(Application([("/ws", Handler)]))
        listening, port = bind_unused_port()
        server.add_socket(listening)
        client = await tornado.websocket.websocket_connect(f"ws://127.0.0.1:{port}/ws", max_message_size=10**6)
        socket = await served
        stream, writes = socket.ws_connection.stream, 0
        write = stream.write

        def counted(data: bytes) -> Any:
            nonlocal writes
            writes += 1
            return write(data)

        stream.write = counted
        await asyncio.gather(*dispatch(SimpleNamespace(_socket=socket), msg=_message()))
        received = [await client.read_message() for _ in range(len(_TEXTS) + 2 * len(_ARRAYS))]
        client.close()
        server.stop()
        await server.close_all_connections()
        return writes, received

    return asyncio.run(run())


def test_a_message_arrives_whole_and_is_written_once() -> None:
    writes, received = _sent(_dispatch)
    assert writes == 1
    assert received == _sent(panel_document.dispatch_tornado)[1]
    assert received[:3] == _TEXTS
    assert received[4::2] == _ARRAYS


@pytest.mark.parametrize("at_once", [False, True])
def test_a_page_closed_meanwhile_is_no_fault(at_once: bool) -> None:
    """The first write finds out; or it has been found out, and a further write is refused."""
    tried: list[bytes] = []

    def write(whole: bytes) -> Any:
        tried.append(whole)
        if at_once:
            raise StreamClosedError
        future: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        future.set_exception(StreamClosedError())
        return future

    async def end() -> None:
        websocket = SimpleNamespace(is_closing=lambda: False, stream=SimpleNamespace(write=write))
        socket = SimpleNamespace(ws_connection=websocket, write_lock=Lock())
        await asyncio.gather(*_dispatch(SimpleNamespace(_socket=socket), msg=_message()))
        await _answer(_message(), socket)
        async with asyncio.timeout(PATIENCE):  # the line goes on
            (await socket.write_lock.acquire()).__enter__()

    asyncio.run(end())
    assert len(tried) == 2


def test_nothing_is_written_to_a_page_that_has_gone() -> None:
    for websocket in (None, SimpleNamespace(is_closing=lambda: True)):
        socket = SimpleNamespace(ws_connection=websocket, write_lock=Lock())
        assert not _dispatch(SimpleNamespace(_socket=socket), msg=_message())
        asyncio.run(_answer(_message(), socket))
