"""Messages name the same models, but the others are not listed for it."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from importlib import import_module
from typing import Any

import panel.io.model as panel_model
import pytest
from bokeh.document import Document
from bokeh.document.events import ModelChangedEvent
from bokeh.document.models import DocumentModelManager
from bokeh.model import Model
from bokeh.models import Column, Div
from bokeh.protocol.messages.patch_doc import patch_doc

from app.upstream import known_models


@pytest.fixture
def repaired() -> Iterator[None]:
    module: Any = import_module("bokeh.protocol.messages.patch_doc")
    with pytest.MonkeyPatch.context() as patch:  # which puts back what is overwritten here
        patch.setattr(module, "Serializer", module.Serializer)
        patch.setattr(panel_model, "Serializer", panel_model.Serializer)
        patch.setattr(DocumentModelManager, "synced_references", DocumentModelManager.synced_references)
        patch.setattr(Document, "apply_json_patch", Document.apply_json_patch)
        known_models.repair()
        yield


def _page() -> tuple[Document, Column]:
    document, column = Document(), Column(children=[Div(text=f"{i}") for i in range(50)])
    document.add_root(column)
    document.to_json()  # sent: none is new
    return document, column


def _looked_at(monkeypatch: pytest.MonkeyPatch) -> int:
    """How many models a message about one of fifty looks at."""
    document, column = _page()
    seen: set[int] = set()
    shipped: Any = Model.ref
    with monkeypatch.context() as patch:
        patch.setattr(Model, "ref", property(lambda model: (seen.add(id(model)), shipped.fget(model))[1]))
        patch_doc.create([ModelChangedEvent(document, column.children[0], "text", "x")])
    return len(seen)


def _there_and_back() -> tuple[Any, list[str]]:
    """A message that brings a new model and names an old one, and the page after a message back."""
    document, column = _page()
    old, new = column.children[0], Div(text="new")
    with document.models.freeze():
        column.children = [new, old]
        message = patch_doc.create([ModelChangedEvent(document, column, "children", [new, old])])
    told = message.content["events"][0]["new"]
    back = {"kind": "ModelChanged", "model": {"id": new.id}, "attr": "children", "new": []}
    document.apply_json_patch({"events": [{**back, "attr": "text", "new": "told"}]})  # type: ignore[typeddict-item]
    document.apply_json_patch(
        {"events": [{**back, "model": {"id": column.id}, "new": [{"id": old.id}]}]}  # type: ignore[typeddict-item]
    )
    kinds = [tuple(sorted(entry)) if entry.keys() != {"id"} else ("id",) for entry in told]
    return kinds, [new.text, *(child.text for child in column.children)]


def test_as_shipped_each_message_lists_every_model(monkeypatch: pytest.MonkeyPatch) -> None:
    assert _looked_at(monkeypatch) > 50


@pytest.mark.usefixtures("repaired")
def test_it_looks_at_what_it_names(monkeypatch: pytest.MonkeyPatch) -> None:
    assert _looked_at(monkeypatch) == 1


@pytest.mark.usefixtures("repaired")
def test_messages_bring_what_is_new_and_name_what_is_known() -> None:
    ours = _there_and_back()
    assert ours == ([("attributes", "id", "name", "type"), ("id",)], ["told", "0"])


def _described_back() -> tuple[Document, list[str]]:
    """A page names in full what the server has sent it; the page then, and the warnings."""
    document, column = _page()
    old = column.children[0]
    whole = {"type": "object", "name": "Div", "id": old.id, "attributes": {"text": "as the page knows it"}}
    back = {"kind": "ModelChanged", "model": {"id": column.id}, "attr": "children", "new": [whole]}
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        document.apply_json_patch({"events": [back]})  # type: ignore[typeddict-item]
    assert column.children == [old]
    assert old.text == "0"
    return document, [str(warning.message) for warning in told]


def test_as_shipped_a_model_that_the_page_describes_is_warned_of() -> None:
    assert "already known" in _described_back()[1][0]


@pytest.mark.usefixtures("repaired")
def test_a_model_that_the_page_describes_is_the_one_that_is_there() -> None:
    assert _described_back()[1] == []
