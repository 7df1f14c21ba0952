"""Frames leave without waiting for the browser."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from panel.io.server import WSHandler

from app.upstream.connection import FramesAtOnce


@pytest.mark.long
def test_as_shipped_frames_wait(shipped: dict[str, Any]) -> None:
    assert shipped["nodelay"] == 0


@pytest.mark.parametrize("opened", [True, False])
def test_they_do_not_wait_once_a_connection_is_open(opened: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[bool] = []

    def bokehs(handler: Any) -> None:
        handler.ws_connection = (
            SimpleNamespace(set_nodelay=asked.append, is_closing=lambda: False) if opened else None
        )

    monkeypatch.setattr(WSHandler, "open", bokehs)
    handler = FramesAtOnce.__new__(FramesAtOnce)
    handler.stream = None  # type: ignore[attr-defined]
    handler.open()
    assert asked == [True] * opened
