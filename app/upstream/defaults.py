"""Default values of a Bokeh model are computed once per kind of model.

Each read of an unset property copies and checks its default anew, which is half of the work of sending a
page and a third of finding what a change of its parts has added. Values that could change are left alone: each model
has its own. That of an empty list or dict is a new one, unchecked.

Written for: Bokeh 3.9.2
Upstream: bokeh/bokeh#13174 (merged: less of it, not none)
Needless when: tests/app/upstream/test_defaults.py::test_as_shipped_a_default_is_worked_out_at_each_look fails
"""

from __future__ import annotations

from typing import Any

from bokeh.core.property.descriptors import PropertyDescriptor
from bokeh.core.property.wrappers import PropertyValueContainer

_shipped = PropertyDescriptor._get_default
_known: dict[tuple[type, str], Any] = {}
_empty: dict[tuple[type, str], type[PropertyValueContainer]] = {}


def _get_default(descriptor: PropertyDescriptor[Any], model: Any) -> Any:
    name = descriptor.name
    key = (model.__class__, name)
    themed = model.themed_values()
    if themed is None or name not in themed:
        if key in _known:
            return _known[key]
        own = model._unstable_default_values
        if key in _empty and name not in own:
            own[name] = new = _empty[key]()
            new._register_owner(model, descriptor)
            return new
    first = name not in model._unstable_default_values
    default = _shipped(descriptor, model)
    if themed is None or name not in themed:
        if not descriptor.has_unstable_default(model):
            _known[key] = default
        elif first and isinstance(default, PropertyValueContainer) and not default:
            _empty[key] = type(default)
    return default


def remember_defaults() -> None:
    """Install the override; the server calls it once, before it serves."""
    PropertyDescriptor._get_default = _get_default
