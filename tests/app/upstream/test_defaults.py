"""The defaults that are remembered are those that Bokeh works out anew each time."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import pytest
from bokeh.core.property.descriptors import PropertyDescriptor, UnsetValueError
from bokeh.model import Model
from bokeh.models import ColumnDataSource, Slider, Title

from app.upstream import defaults
from app.upstream.defaults import remember_defaults

pytestmark = pytest.mark.long

_AS_SHIPPED = PropertyDescriptor._get_default


@pytest.fixture(autouse=True)
def remembered() -> Iterator[None]:
    remember_defaults()
    yield
    PropertyDescriptor._get_default = _AS_SHIPPED  # type: ignore[method-assign]
    defaults._known.clear()


def _shown(model: Model, name: str) -> Any:
    """What a look at a property gives, in words: models and functions by their kind, all else as it is written."""
    try:
        value = getattr(model, name)
    except UnsetValueError:
        return "unset"
    return type(value) if isinstance(value, Model) or callable(value) else re.sub(r"id='\w+'", "", repr(value))


@pytest.mark.filterwarnings("ignore::bokeh.util.warnings.BokehDeprecationWarning")
def test_every_model_shows_the_same_defaults(monkeypatch: pytest.MonkeyPatch) -> None:
    import panel_material_ui  # noqa: F401  (its models are among them)

    compared = 0
    for kind in list(Model.model_class_reverse_map.values()):
        if kind.__name__ == "IPyWidget":  # the only one that cannot stand by itself: it wants a bundle
            continue
        models = [kind(), kind()]
        names = models[0].properties() - set(models[0]._property_values)
        with monkeypatch.context() as patch:
            patch.setattr(PropertyDescriptor, "_get_default", _AS_SHIPPED)
            fresh = kind()
            expected = {name: _shown(fresh, name) for name in names}
        for model in models:  # the second is answered from what the first left
            assert {name: _shown(model, name) for name in names} == expected, kind
            compared += len(names)
    assert compared > 10_000
    assert len(defaults._known) > 3000


def test_what_may_change_is_each_models_own() -> None:
    one, other = ColumnDataSource(), ColumnDataSource()
    one.data["x"] = [1.0]
    assert "x" not in other.data
    assert one.selected is not other.selected
    first = Slider(start=0, end=1, value=0, step=0.1)
    first.tags.append("mark")
    assert Slider(start=0, end=1, value=0, step=0.1).tags == []


def test_a_theme_comes_before_what_is_remembered() -> None:
    from bokeh.document import Document
    from bokeh.themes import Theme

    assert Title().text_font_size == "13px"
    document = Document(theme=Theme(json={"attrs": {"Title": {"text_font_size": "99px"}}}))
    title = Title()
    document.add_root(title)
    assert title.text_font_size == "99px"
    assert Title().text_font_size == "13px"


def test_as_shipped_a_default_is_worked_out_at_each_look(monkeypatch: pytest.MonkeyPatch) -> None:
    worked_out: list[str] = []
    shipped = PropertyDescriptor.instance_default

    def counted(descriptor: PropertyDescriptor[Any], model: Any) -> Any:
        worked_out.append(descriptor.name)
        return shipped(descriptor, model)

    monkeypatch.setattr(PropertyDescriptor, "instance_default", counted)
    looks = []
    for hand in (_AS_SHIPPED, defaults._get_default):
        defaults._known.clear()
        monkeypatch.setattr(PropertyDescriptor, "_get_default", hand)
        title, worked_out[:] = Title(), []
        assert title.text_font_size == title.text_font_size == "13px"
        looks.append(worked_out.count("text_font_size"))
    assert looks == [2, 1]
