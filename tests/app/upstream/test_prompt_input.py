"""A box's text is shown as it was, without touching what it does not change."""

from __future__ import annotations

import panel_material_ui as pmui
import pytest
from bokeh.document import Document
from panel.io.state import set_curdoc

from app.upstream.prompt_input import PromptInput


def _touched(box: pmui.TextInput, monkeypatch: pytest.MonkeyPatch) -> int:
    """How many other parameters are written to when the value changes."""
    seen: set[str] = set()
    with monkeypatch.context() as patch:
        for name in ("label", "width", "margin"):
            kind = type(box.param[name])
            shipped = kind.__setattr__

            def noted(parameter: object, attribute: str, value: object, shipped: object = shipped) -> None:
                if attribute == "readonly":
                    seen.add(str(getattr(parameter, "name", "")))
                shipped(parameter, attribute, value)  # type: ignore[operator]

            patch.setattr(kind, "__setattr__", noted)
        box.value = "1 m"
    return len(seen - {"value", "value_input"})


def test_as_shipped_every_parameter_is_touched(monkeypatch: pytest.MonkeyPatch) -> None:
    assert _touched(pmui.TextInput(), monkeypatch) > 10


def test_none_is_and_the_text_is_shown(monkeypatch: pytest.MonkeyPatch) -> None:
    box = PromptInput()
    assert _touched(box, monkeypatch) == 0
    assert box.value_input == "1 m"


def test_a_text_to_follow_is_one_change(monkeypatch: pytest.MonkeyPatch) -> None:
    box = PromptInput(value="1 m")
    told: list[set[str]] = []
    monkeypatch.setattr(box, "_param_change", lambda *events: told.append({event.name for event in events}))
    box.param.watch(lambda *events: told.append({event.name for event in events}), ["value", "value_input"])
    box.follow("2 m")
    box.follow("2 m")
    assert (box.value, box.value_input) == ("2 m", "2 m")
    assert told == [{"value", "value_input"}]


def test_in_a_hold_the_page_alone_is_told() -> None:
    box, told = PromptInput(value="1 m"), []
    document, model = Document(), box.get_root()
    document.add_root(model)
    box.param.watch(told.append, ["value", "value_input"])
    with set_curdoc(document):
        document.hold()
        for _ in range(2):
            box.follow("2 m")
    assert (box.value, box.value_input) == (model.data.value, model.data.value_input) == ("2 m", "2 m")
    assert {event.attr for event in document.callbacks._held_events} == {"value", "value_input"}
    assert len(document.callbacks._held_events) == 2
    assert not told
