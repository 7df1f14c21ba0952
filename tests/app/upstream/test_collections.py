"""Closing a page does not start a full garbage collection."""

from __future__ import annotations

import gc

import panel.io.document
import pytest

from app.upstream.collections import leave_collecting

_AS_SHIPPED = panel.io.document._garbage_collect


@pytest.fixture
def collected(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Grows with each full collection that is asked for."""
    asked: list[int] = []
    monkeypatch.setattr(gc, "collect", lambda: asked.append(1))
    monkeypatch.setattr(panel.io.document, "_panel_last_cleanup", -1e9)
    monkeypatch.setattr(panel.io.document, "_garbage_collect", _AS_SHIPPED)
    return asked


def test_as_shipped_a_closed_page_is_a_full_collection(collected: list[int]) -> None:
    panel.io.document._garbage_collect()
    assert collected
    assert "_garbage_collect" in panel.io.document._destroy_document.__code__.co_names


def test_it_is_left_to_others(collected: list[int]) -> None:
    leave_collecting()
    panel.io.document._garbage_collect()
    assert not collected
