"""A page's connection: frames leave at once, a lost one closes in silence, a fault is told without its traceback."""

import asyncio
from types import SimpleNamespace
from typing import Any

import pytest
from bokeh.server.connection import ServerConnection
from panel.io.server import WSHandler

from app.upstream.connection import FramesAtOnce, LostConnection, NoTracebacks


@pytest.mark.parametrize("opened", [True, False])
def test_frames_do_not_wait_once_a_connection_is_open(opened: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[bool] = []

    def bokehs(handler: Any) -> None:
        handler.ws_connection = (
            SimpleNamespace(set_nodelay=asked.append, is_closing=lambda: False) if opened else None
        )

    monkeypatch.setattr(WSHandler, "open", bokehs)
    handler = FramesAtOnce.__new__(FramesAtOnce)
    handler.stream = None
    handler.open()
    assert asked == [True] * opened


def test_a_connection_that_a_ping_has_found_lost_may_close() -> None:
    session: Any = SimpleNamespace(subscribe=lambda _: None, unsubscribe=lambda _: None)
    handler = LostConnection.__new__(LostConnection)
    handler.connection = ServerConnection(None, None, None, session)
    handler.connection.detach_session()
    handler.close_code = handler.close_reason = None
    handler.on_close()


def test_no_traceback_of_the_product(monkeypatch: pytest.MonkeyPatch) -> None:
    passed: list[Any] = []

    async def on(_: Any, message: Any) -> None:
        passed.append(message)

    monkeypatch.setattr(WSHandler, "send_message", on)
    fault = SimpleNamespace(msgtype="ERROR", content={"text": "in /home", "traceback": "File /home"})
    asyncio.run(NoTracebacks.send_message(NoTracebacks.__new__(NoTracebacks), fault))
    assert passed == [fault]
    assert "home" not in str(fault.content)
