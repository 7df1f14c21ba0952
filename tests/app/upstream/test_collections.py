"""Closing a page does not start a full garbage collection."""

import gc

import panel.io.document
import pytest

from app.upstream.collections import leave_collecting


def test_it_is_left_to_others(monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[int] = []
    monkeypatch.setattr(gc, "collect", lambda: asked.append(1))
    monkeypatch.setattr(panel.io.document, "_panel_last_cleanup", -1e9)
    monkeypatch.setattr(panel.io.document, "_garbage_collect", panel.io.document._garbage_collect)
    leave_collecting()
    panel.io.document._garbage_collect()
    assert not asked
