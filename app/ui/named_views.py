"""Several views in one place, with a switch that shows one."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param

from app.ui.theme import NARROW, PRINT_NOTHING, SWITCH
from app.ui.view import View


class NamedViews(View):
    """A switch between views, each made when it is first chosen.

    Each name of the switch is a button that says whether it is pressed: Tab goes from one to the next.

    Parameters
    ----------
    label : str
        What the switch is called for screen readers.
    views : mapping of str to callable
        Name -> what makes the view. The first is shown.

    Examples
    --------
    >>> views = NamedViews("What to see", {"Map": make_map, "Table": make_table})
    >>> views.chosen = "Table"
    """

    chosen = param.String(doc="Name of the view that is shown.")

    def __init__(self, label: str, views: Mapping[str, Callable[[], Any]]) -> None:
        super().__init__(chosen=next(iter(views)))
        self._views = dict(views)
        self._places = {
            name: pn.Column(visible=False, sizing_mode="stretch_both", stylesheets=[NARROW]) for name in views
        }
        self._switch = pmui.RadioButtonGroup(
            label=label, options=list(views), value=self.chosen, margin=(6, 10), stylesheets=[PRINT_NOTHING, SWITCH]
        )
        self._switch.param.watch(lambda event: self.param.update(chosen=event.new), "value")
        self._view = pn.Column(
            self._switch,
            *self._places.values(),
            sizing_mode="stretch_both",
            styles={"min-height": "0"},
            stylesheets=[NARROW],
        )
        self._show()

    @param.depends("chosen", watch=True)
    def _show(self) -> None:
        place = self._places[self.chosen]
        if not place.objects:
            place.append(self._views[self.chosen]())
        self._switch.value = self.chosen
        for name, other in self._places.items():
            other.visible = name == self.chosen
