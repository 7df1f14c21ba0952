"""What is sent of a change is the same, and the design is asked of style sheets alone."""

from __future__ import annotations

from typing import Any

import panel as pn
import panel_material_ui as pmui
import pytest
from panel.reactive import Reactive

from app.upstream import design_once


def _asked(monkeypatch: pytest.MonkeyPatch, **changes: Any) -> tuple[int, Any]:
    """How often a change asks the design, and what the browser's side is then."""
    box = pmui.TextInput(label="a", stylesheets=["p { margin: 0; }"])
    model = box.get_root()
    asked: list[int] = []
    shipped = pn.theme.base.Design.params

    def params(*arguments: Any, **options: Any) -> Any:
        asked.append(1)
        return shipped(*arguments, **options)

    with monkeypatch.context() as patch:
        patch.setattr(pn.theme.base.Design, "params", params)
        box.param.update(**changes)
    sheets = [getattr(sheet, "url", sheet) for sheet in model.stylesheets]
    return len(asked), (model.data.value, model.data.label, sheets)


def test_as_shipped_a_change_of_text_asks_the_design(monkeypatch: pytest.MonkeyPatch) -> None:
    assert _asked(monkeypatch, value="b")[0]


@pytest.mark.parametrize("changes", [{"value": "b", "label": "c"}, {"stylesheets": ["p { margin: 1px; }"]}])
def test_what_is_sent_stays(monkeypatch: pytest.MonkeyPatch, changes: dict[str, Any]) -> None:
    shipped = _asked(monkeypatch, **changes)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Reactive, "_update_properties", design_once._update_properties)
        ours = _asked(monkeypatch, **changes)
    assert ours[1] == shipped[1]
    assert bool(ours[0]) == ("stylesheets" in changes)
