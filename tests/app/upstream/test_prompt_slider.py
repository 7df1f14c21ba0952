"""A step of a slider is worked off at once, and once."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import panel_material_ui as pmui
import pytest
from bokeh.document import Document
from panel.io.state import state

from app.upstream.prompt_slider import PromptSlider


def _step(slider: pmui.FloatSlider, monkeypatch: pytest.MonkeyPatch) -> tuple[list[int], list[Any]]:
    """Waits [ms] and what is worked off at once, when the browser tells of one step."""
    waits: list[int] = []
    at_once: list[Any] = []
    document = Document()
    document._session_context = lambda: SimpleNamespace(destroyed=False)  # type: ignore[assignment,return-value]
    with monkeypatch.context() as patch:
        patch.setattr(document, "add_timeout_callback", lambda work, delay: waits.append(delay))
        patch.setattr(type(state), "execute", lambda _, work, **__: at_once.append(work))
        slider._server_change(document, "ref", None, "value", 0.0, 1.0)
    return waits, at_once


def test_as_shipped_a_step_waits_and_comes_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    slider = pmui.FloatSlider()
    waits, at_once = _step(slider, monkeypatch)
    assert waits == [50]
    assert not at_once
    assert {"value", "value_throttled"} <= set(slider._linked_properties)


def test_it_does_neither(monkeypatch: pytest.MonkeyPatch) -> None:
    slider = PromptSlider()
    waits, at_once = _step(slider, monkeypatch)
    assert not waits
    assert len(at_once) == 1
    assert slider._linked_properties == ("value",)
