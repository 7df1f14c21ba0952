"""Several views in one place, with a switch that shows one."""

from collections.abc import Callable, Mapping, Sequence
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
    groups : mapping of str to sequence of str, optional
        Name -> names of views. The switch is between the groups then, with a second one between a group's views.

    Examples
    --------
    >>> views = NamedViews("What to see", {"Map": make_map, "Table": make_table})
    >>> views.chosen = "Table"
    """

    chosen = param.String(doc="Name of the view that is shown.")

    def __init__(
        self,
        label: str,
        views: Mapping[str, Callable[[], Any]],
        groups: Mapping[str, Sequence[str]] | None = None,
    ) -> None:
        super().__init__(chosen=next(iter(views)))
        self._groups = groups or {name: (name,) for name in views}
        self._views = dict(views)
        self._places = {
            name: pn.Column(visible=False, sizing_mode="stretch_both", stylesheets=[NARROW]) for name in views
        }
        look: dict[str, Any] = {"margin": (6, 10, 6, 0), "stylesheets": [PRINT_NOTHING, SWITCH]}
        self._switch = pmui.RadioButtonGroup(label=label, options=list(self._groups), **look)
        self._switch.param.watch(self._turn, "value")
        self._within = pmui.RadioButtonGroup(label=f"{label}, one of a group", visible=False, **look)
        self._within.param.watch(lambda event: self.param.update(chosen=event.new), "value")
        self._view = pn.Column(
            pn.FlexBox(self._switch, self._within),
            *self._places.values(),
            sizing_mode="stretch_both",
            styles={"min-height": "0"},
            stylesheets=[NARROW],
        )
        self._show()

    def _turn(self, event: Any) -> None:
        if self.chosen not in self._groups[event.new]:
            self.chosen = self._groups[event.new][0]

    @param.depends("chosen", watch=True)
    def _show(self) -> None:
        place = self._places[self.chosen]
        if not place.objects:
            place.append(self._views[self.chosen]())
        group = next(name for name, names in self._groups.items() if self.chosen in names)
        names = self._groups[group]
        self._within.param.update(options=list(names), value=self.chosen, visible=len(names) > 1)
        self._switch.value = group
        for name, other in self._places.items():
            other.visible = name == self.chosen
