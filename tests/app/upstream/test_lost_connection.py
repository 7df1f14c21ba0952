"""A connection that a ping has found lost closes in silence."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from bokeh.server.connection import ServerConnection
from panel.io.server import WSHandler

from app.upstream.connection import LostConnection


def _lost(kind: type[WSHandler]) -> WSHandler:
    session: Any = SimpleNamespace(subscribe=lambda _: None, unsubscribe=lambda _: None)
    handler = kind.__new__(kind)
    handler.connection = ServerConnection(None, None, None, session)  # type: ignore[arg-type]
    handler.connection.detach_session()
    handler.close_code = handler.close_reason = None
    return handler


def test_as_shipped_closing_is_a_fault() -> None:
    with pytest.raises(AssertionError):
        _lost(WSHandler).on_close()


def test_it_may_close() -> None:
    _lost(LostConnection).on_close()
