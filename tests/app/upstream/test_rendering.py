"""A new text is all that a pane sends."""

import panel as pn
import pytest
from bokeh.document import Document

from app.ui.html_pane import html_pane
from app.upstream.rendering import TextPane

pytestmark = pytest.mark.watches("app/upstream", "docs/upstream")


def test_the_text_alone_is_sent() -> None:
    pane = html_pane("<p>old</p>")
    assert isinstance(pane, TextPane)
    model, document, sent = pane.get_root(), Document(), []
    document.add_root(model)
    document.on_change(lambda event: sent.append(event.attr))
    pane.object = "<p>new & more</p>"
    assert "new &amp; more" in model.text
    assert sent == ["text"]


def test_it_shows_at_first_what_the_shipped_pane_shows() -> None:
    text = '<b title="a">&lt; 1 &amp; √2</b>'
    ours, theirs = TextPane(text), pn.pane.HTML(text)
    ours.object = theirs.object = text + "!"
    assert ours.get_root().text == theirs.get_root().text
