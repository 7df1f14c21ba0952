"""Default styles of all widgets and layouts."""

import inspect
from typing import Any

import panel as pn
import panel_material_ui as pmui


def set_defaults() -> None:
    """Set the classes' own defaults: small widgets, layouts as wide as the page. Called once, before serving."""
    kinds: list[Any] = [kind for _, kind in inspect.getmembers(pmui, inspect.isclass)]
    for kind in kinds:
        if "size" in getattr(kind, "param", ()) and "small" in getattr(kind.param.size, "objects", ()):
            kind.size = "small"  # on the class: Param copies what it inherits
    for layout in (pn.Column, pn.Row, pn.FlexBox):
        layout.sizing_mode = "stretch_width"
        layout.margin = 0
