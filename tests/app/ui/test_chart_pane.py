"""What a change of text sends to the browser."""

from bokeh.document import Document

from app.ui.html_pane import TextPane, html_pane


def test_new_text_is_all_that_changes():
    """The pane's update is a private name of Panel's: were it another, the sheet would be sent again."""
    pane = html_pane("<p>old</p>")
    model = pane.get_root()
    document, sent = Document(), []
    document.add_root(model)
    document.on_change(lambda event: sent.append(event.attr))
    sheets = list(model.stylesheets)
    pane.object = "<p>new & more</p>"
    assert "new &amp; more" in model.text
    assert sent == ["text"]
    assert all(now is before for now, before in zip(model.stylesheets, sheets, strict=True))


def test_it_shows_at_first_what_the_shipped_pane_shows():
    text = '<b title="a">&lt; 1 &amp; √2</b>'
    ours, theirs = TextPane(text), TextPane.__mro__[1](text)
    ours.object = theirs.object = text + "!"
    assert ours.get_root().text == theirs.get_root().text
