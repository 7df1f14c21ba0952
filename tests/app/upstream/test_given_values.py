"""What a model was given is all that its page and its neighbours need to know of it."""

from collections.abc import Iterator
from typing import Any

import bokeh.model.util
import pytest
from bokeh.core.has_props import HasProps
from bokeh.core.property.descriptors import UnsetValueError
from bokeh.core.serialization import Serializer
from bokeh.document import Document
from bokeh.model import Model
from bokeh.models import ColumnDataSource, Div, LinearAxis
from bokeh.plotting import figure
from bokeh.themes import Theme

from app.upstream.rendering import check_given_values

pytestmark = [pytest.mark.long, pytest.mark.watches("app/upstream", "docs/upstream")]

_PLACES = (
    (HasProps, "__init__"), (HasProps, "themed_values"), (HasProps, "query_properties_with_values"),
    (bokeh.model.util, "visit_immediate_value_references"),
)  # fmt: skip
_AS_SHIPPED = [getattr(*place) for place in _PLACES]


def _as_shipped() -> None:
    for (holder, name), shipped in zip(_PLACES, _AS_SHIPPED, strict=True):
        setattr(holder, name, shipped)


@pytest.fixture(autouse=True)
def in_place() -> Iterator[None]:
    check_given_values()
    yield
    _as_shipped()


def _content(model: Model) -> dict[str, Any]:
    """A model in words, without the numbers of models."""

    def plain(part: Any) -> Any:
        if isinstance(part, dict):
            return {key: plain(value) for key, value in part.items() if key != "id"}
        return [plain(value) for value in part] if isinstance(part, list) else part

    return plain(Serializer().encode(model))


@pytest.mark.filterwarnings("ignore::bokeh.util.warnings.BokehDeprecationWarning")
def test_every_model_is_told_and_searched_as_before() -> None:
    import panel_material_ui  # noqa: F401  (its models are among them)

    def content(kind: type[Model]) -> Any:
        model = kind()
        return _content(model), sorted(type(each).__name__ for each in model.references())

    compared = 0
    for kind in list(Model.model_class_reverse_map.values()):
        if not issubclass(kind, Model) or kind.__name__ == "IPyWidget":  # which wants a bundle
            continue
        _as_shipped()
        try:
            expected = content(kind)
        except UnsetValueError:  # it cannot stand by itself
            continue
        finally:
            check_given_values()
        assert content(kind) == expected, kind
        compared += 1
    assert compared > 400


def _page() -> Document:
    plot = figure(x_axis_label="t", title="a")
    plot.line("x", "y", source=ColumnDataSource({"x": [1.0], "y": [2.0]}, name="data"))
    document = Document(theme=Theme(json={"attrs": {"Title": {"text_font_size": "99px"}}}))
    document.add_root(plot)
    document.add_root(Div(text="b", tags=["mark"]))
    return document


def test_a_page_is_told_and_searched_as_before() -> None:
    def plain(document: Document) -> tuple[Any, Any]:
        return [_content(root) for root in document.roots], sorted(type(model).__name__ for model in document.models)

    ours = plain(_page())
    _as_shipped()
    assert ours == plain(_page())


def test_what_is_put_into_an_empty_container_later_is_told() -> None:
    div = Div()
    div.tags.append("mark")
    source = ColumnDataSource()
    source.data["x"] = [1]
    assert _content(div)["attributes"]["tags"] == ["mark"]
    assert "x" in str(_content(source)["attributes"]["data"])
    axis = LinearAxis()
    document = Document()
    plot = figure()
    document.add_root(plot)
    plot.add_layout(axis, "above")  # a list that nobody had looked at
    assert axis.document is document
