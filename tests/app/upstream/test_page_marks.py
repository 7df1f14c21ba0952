"""A change of the frame leaves the parts of the page alone."""

from __future__ import annotations

from typing import Any

import panel_material_ui as pmui
import pytest
from bokeh.document import Document
from bokeh.model import Model
from panel.reactive import ReactiveCustomBase

from app.upstream.rendering import mark_own_part


def _walks(monkeypatch: pytest.MonkeyPatch) -> tuple[int, Model]:
    """How often the page is searched for one change of its frame, and its model."""
    page = pmui.Page(main=[pmui.TextInput(label="a")])
    document = Document()
    root = page.get_root(document)
    document.add_root(root)
    walked: list[Any] = []
    select = Model.select
    with monkeypatch.context() as patch:
        patch.setattr(Model, "select", lambda model, selector: walked.append(1) or select(model, selector))
        page.sidebar_open = not page.sidebar_open
    assert root.data.sidebar_open == page.sidebar_open
    return len(walked), root


def test_as_shipped_a_change_walks_through_the_page(monkeypatch: pytest.MonkeyPatch) -> None:
    assert _walks(monkeypatch)[0] >= 1


def test_a_change_walks_nowhere_and_all_parts_are_marked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ReactiveCustomBase, "_patch_datamodel_ref", ReactiveCustomBase._patch_datamodel_ref)
    mark_own_part()
    walked, root = _walks(monkeypatch)
    assert walked == 0
    mark = f"__ref:{root.ref['id']}"
    marked = [model for model in root.references() if mark in model.tags]
    assert len(marked) >= 2  # the page's data and the field's
