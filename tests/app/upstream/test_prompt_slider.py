"""A step of a slider is worked off at once, and once."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import panel_material_ui as pmui
import pytest
from bokeh.document import Document
from panel.io.state import set_curdoc, state

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


def _worked_out(slider: pmui.FloatSlider, monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """What is looked at to be told to the page, when it says 0.5 and something here makes it 0.6 after all."""
    seen: list[Any] = []
    document, model = Document(), slider.get_root()
    document.add_root(model)
    slider.param.watch(lambda event: setattr(slider, "value", 0.6) if event.new == 0.5 else None, "value")
    with monkeypatch.context() as patch, set_curdoc(document):
        shipped = slider._update_properties
        patch.setattr(
            slider, "_update_properties",
            lambda *events, **more: seen.append(events[0].new) or shipped(*events, **more),
        )  # fmt: skip
        slider._process_events({"value": 0.5})
    assert (slider.value, model.data.value) == (0.6, 0.6)
    return seen


def test_as_shipped_what_the_page_says_is_worked_out_for_it(monkeypatch: pytest.MonkeyPatch) -> None:
    assert 0.5 in _worked_out(pmui.FloatSlider(step=0.1), monkeypatch)


def test_only_what_it_does_not_know_is(monkeypatch: pytest.MonkeyPatch) -> None:
    assert _worked_out(PromptSlider(step=0.1), monkeypatch) == [0.6]
