"""The page around all pages: what belongs to it, and what its busy line costs everybody else."""

from __future__ import annotations

from typing import Any

import pytest
from bokeh.model import DataModel, Model

from app.page import Frame
from app.server import first_design
from app.state import Session

# The Material download button passes both names of one argument to its own base class.
pytestmark = pytest.mark.filterwarnings("ignore:Both 'variant' and 'button_style':PendingDeprecationWarning")


def _models(root: Model) -> list[DataModel]:
    return list(root.select({"type": DataModel}))


def test_every_component_is_marked_as_the_pages():
    """By this Panel finds what to clear away with a page, whenever it was made."""
    frame = Frame(Session(first_design()))
    root = frame.view.get_root()
    before = _models(root)
    frame._go_to("explore")
    after = _models(root)
    assert len(after) > len(before) > 30
    assert [model for model in after if f"__ref:{root.ref['id']}" not in model.tags] == []


def test_a_run_begins_without_a_walk_through_the_document(monkeypatch: pytest.MonkeyPatch):
    """That walk took 100 ms, at the beginning and the end of each run, in which nobody's slider moved."""
    session = Session(first_design())
    root = Frame(session).view.get_root()
    walked: list[Any] = []
    monkeypatch.setattr(Model, "references", lambda model: walked.append(model) or {model})
    session.running = True
    assert root.data.busy
    assert walked == []
