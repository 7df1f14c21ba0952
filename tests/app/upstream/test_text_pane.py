"""A new text is all that changes."""

from __future__ import annotations

import panel as pn
from bokeh.document import Document

from app.ui.html_pane import html_pane
from app.upstream.text_pane import TextPane


def _sent(pane: pn.pane.HTML) -> list[str]:
    """What a new text sends to the browser."""
    model = pane.get_root()
    document, sent = Document(), []
    document.add_root(model)
    document.on_change(lambda event: sent.append(event.attr))
    pane.object = "<p>new & more</p>"
    assert "new &amp; more" in model.text
    return sent


def test_as_shipped_a_new_text_sends_the_sheet_again() -> None:
    assert set(_sent(pn.pane.HTML("<p>old</p>", stylesheets=["p { margin: 0; }"]))) > {"text"}


def test_the_text_alone_is_sent() -> None:
    pane = html_pane("<p>old</p>")
    assert isinstance(pane, TextPane)
    assert _sent(pane) == ["text"]


def test_it_shows_at_first_what_the_shipped_pane_shows() -> None:
    text = '<b title="a">&lt; 1 &amp; √2</b>'
    ours, theirs = TextPane(text), pn.pane.HTML(text)
    ours.object = theirs.object = text + "!"
    assert ours.get_root().text == theirs.get_root().text
