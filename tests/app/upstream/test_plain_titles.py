"""An accordion's titles are told as words, and nothing else is made for them."""

from __future__ import annotations

import panel as pn
import panel_material_ui as pmui
from bokeh.document import Document
from panel.models.markup import HTML

from app.upstream.plain_titles import WordedAccordion


def _told(kind: type[pmui.Accordion]) -> tuple[list[str], list[str], int]:
    """Titles, kinds of what the parts show, and how many panes of text there are."""
    accordion = kind(("One", pn.Column()), ("Two", pn.Row(pmui.Switch())), active=[1])
    root = accordion.get_root(Document())
    texts = sum(isinstance(model, HTML) for model in root.references())
    return root.data._names, [type(part).__name__ for part in root.data.objects], texts


def test_titles_and_parts_are_the_same_without_panes() -> None:
    *shipped, _ = _told(pmui.Accordion)
    *ours, panes = _told(WordedAccordion)
    assert ours == shipped == [["One", "Two"], ["Column", "Row"]]
    assert panes == 0


def test_as_shipped_each_title_brings_an_empty_pane() -> None:
    assert _told(pmui.Accordion)[2] == 2
