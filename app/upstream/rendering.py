"""Costs of a page's parts on the server, to make and to change them.

Only the properties that a model was given are processed when it is created, searched for models, and serialized.
Unset properties have their default, which the browser knows too; and no default that all models of a kind share holds
another model. One thing is not noticed any more: that a property without a default was never set, before the page is
sent.

An HTML pane sends only its text when the text changes, and not all of its look.

Reports to send upstream, versions and ends: docs/upstream/rendering.md
"""

from collections.abc import Callable
from functools import cache
from typing import Any

import bokeh.model.util
import panel as pn
from bokeh.core.has_props import HasProps
from bokeh.core.property.descriptors import PropertyDescriptor
from bokeh.core.property.singletons import Intrinsic, Undefined
from bokeh.core.property.wrappers import PropertyValueContainer
from bokeh.model import Model

_shipped_query = HasProps.query_properties_with_values


def _init(model: HasProps, **properties: Any) -> None:
    super(HasProps, model).__init__()
    model._property_values = {}
    model._unstable_default_values = {}
    model._unstable_themed_values = {}
    for name, value in properties.items():
        if value is not Undefined and value is not Intrinsic:
            setattr(model, name, value)
    for descriptor in _persistent_defaults(model.__class__):
        if descriptor.name not in properties:
            descriptor._get(model)  # which keeps it
    model._initialized = True


@cache
def _persistent_defaults(kind: type[HasProps]) -> tuple[PropertyDescriptor[Any], ...]:
    """The properties whose default a model has by itself and from the start: models, and containers that hold some.

    An empty container is made when it is looked at: for most, never.
    """
    descriptors = (each for each in kind.descriptors() if each.has_unstable_default(kind))
    return tuple(each for each in descriptors if not _is_empty(each.class_default(kind)))


def _is_empty(default: Any) -> bool:
    return isinstance(default, PropertyValueContainer) and not default


def _themed(model: HasProps) -> dict[str, Any] | None:
    return model.__dict__.get("__themed_values__")


def _visit(value: Any, visitor: Callable[[Model], None]) -> None:
    if not isinstance(value, HasProps):
        bokeh.model.util.visit_value_and_its_immediate_references(value, visitor)
        return
    referring = value.properties_with_refs()
    given = value._property_values, value._unstable_default_values, _themed(value) or {}
    for values in given:
        for name in referring.keys() & values.keys():
            bokeh.model.util.visit_value_and_its_immediate_references(getattr(value, name), visitor)


def _query(
    model: HasProps,
    query: Callable[[PropertyDescriptor[Any]], bool],
    *,
    include_defaults: bool = True,
    include_undefined: bool = False,
) -> dict[str, Any]:
    if include_defaults or _themed(model):
        return _shipped_query(model, query, include_defaults=include_defaults, include_undefined=include_undefined)
    defaults, values = model._unstable_default_values, {}
    for name in model.properties(_with_props=True):
        if (name in model._property_values or name in defaults) and query(descriptor := model.lookup(name)):
            value = descriptor.get_value(model)
            if not (name in defaults and isinstance(value, PropertyValueContainer)):
                values[name] = value
    return values


def check_given_values() -> None:
    """Install the override; the server calls it once, before it serves."""
    for name, ours in {"__init__": _init, "themed_values": _themed, "query_properties_with_values": _query}.items():
        setattr(HasProps, name, ours)
    bokeh.model.util.visit_immediate_value_references = _visit


class TextPane(pn.pane.HTML):
    """HTML whose text changes often."""

    def say(self, text: str) -> None:
        """Show another text."""
        self.object = text

    def _update(self, ref: str, model: Any) -> None:
        model.text = self._transform_object(self.object)["object"]
