"""A component looks the same and holds fewer copies; a new text is all that a pane sends."""

from collections.abc import Iterator
from typing import Any

import panel as pn
import panel_material_ui as pmui
import pytest
from bokeh.document import Document
from panel.custom import ReactiveESM
from panel.reactive import Syncable

from app.ui.html_pane import html_pane
from app.upstream.rendering import TextPane, skip_event_copies

pytestmark = pytest.mark.watches("app/upstream", "docs/upstream")

_PLACES = ((ReactiveESM, "_get_properties"), (ReactiveESM, "_get_children"), (Syncable, "_init_params"))
_AS_SHIPPED = [getattr(*place) for place in _PLACES]


@pytest.fixture
def in_place() -> Iterator[None]:
    skip_event_copies()
    yield
    for (holder, name), shipped in zip(_PLACES, _AS_SHIPPED, strict=True):
        setattr(holder, name, shipped)


def _rendered() -> tuple[int, list[dict[str, Any]]]:
    """Copies of parameters that rendering made, and what was rendered: the values of each model."""
    slider = pmui.FloatSlider(label="a", start=0, end=2, value=1)
    slider.param.width.bounds = (0, 7)
    parts = [slider, pmui.TextInput(label="b", value="c"), pmui.Select(label="d", options={"e": 1, "f": 2})]
    accordion = pmui.Accordion(("g", pmui.Column(*parts)), active=[0])

    def copies() -> int:
        return sum(len(part._param__private.params) for part in (*parts, accordion))

    before = copies()
    root = accordion.get_root(Document())
    assert slider.param.width.bounds == (0, 7)  # its own, all along
    assert pmui.FloatSlider.param.width.bounds != (0, 7)
    values = [
        {
            name: value
            for name, value in model.properties_with_values(include_defaults=False).items()
            if isinstance(value, str | int | float | None) or name == "options"
        }
        for model in root.references()
    ]
    return copies() - before, sorted(values, key=repr)


def test_what_is_rendered_is_the_same(request: pytest.FixtureRequest) -> None:
    _rendered()  # what is said once for each kind
    expected = _rendered()[1]
    request.getfixturevalue("in_place")
    copied, values = _rendered()
    assert len(values) > 5
    assert [{k: v for k, v in value.items() if k != "name"} for value in values] == [
        {k: v for k, v in value.items() if k != "name"} for value in expected
    ]
    assert copied < 20


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
