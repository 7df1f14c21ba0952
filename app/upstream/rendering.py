"""A component is rendered from the parameters of its class, each looked at once.

Copies of parameters that are there, as where one component has bounds of its own, remain in force.

Reports to send upstream, versions and ends: docs/upstream/rendering.md
"""

from functools import cache
from typing import Any

from panel.custom import ReactiveESM
from panel.reactive import Syncable
from panel.viewable import is_viewable_param

_shipped = ReactiveESM._get_properties


@cache
def _children(kind: type[ReactiveESM]) -> tuple[str, ...]:
    """The parameters that hold other components."""
    hidden = kind._property_mapping
    return tuple(
        name for name in kind.param if is_viewable_param(kind.param[name]) and hidden.get(name, "") is not None
    )


def _get_children(
    component: ReactiveESM, _: Any, document: Any, root: Any, parent: Any, comm: Any
) -> tuple[dict[str, Any], list[Any]]:
    made: dict[str, Any] = {}
    kept: list[Any] = []
    for name in _children(component.__class__):
        made[name], old = component._get_child_model(getattr(component, name), document, root, parent, comm)
        kept += old
    return made, kept


def _get_properties(component: ReactiveESM, document: Any) -> dict[str, Any]:
    private = type(component)._param__private
    private.disable_instance_params = True
    try:
        return _shipped(component, document)
    finally:
        private.disable_instance_params = False


def _init_params(component: Syncable) -> dict[str, Any]:
    found = {name: getattr(component, name) for name in component._synced_params}
    return {name: value for name, value in found.items() if value is not None}


def copy_none() -> None:
    """Install the override; the server calls it once, before it serves."""
    ReactiveESM._get_properties = _get_properties
    ReactiveESM._get_children = _get_children
    Syncable._init_params = _init_params
