"""Details under a page's first screen: folded, and made when they are first opened."""

from collections.abc import Callable, Sequence
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.ui.view import View

_SHEET = "@media print { .MuiAccordion-root:not(.Mui-expanded) { display: none; } }"


class Folded(View):
    """Titled parts that unfold.

    Parameters
    ----------
    parts : sequence of (str, callable)
        Title, and what makes the part when it is first opened.

    Examples
    --------
    >>> details = Folded([("Requirements", lambda: pn.pane.Str("none"))])
    """

    def __init__(self, parts: Sequence[tuple[str, Callable[[], Any]]]) -> None:
        super().__init__()
        self._parts = tuple(parts)
        self._places = [pn.Column() for _ in parts]
        self._view = pmui.Accordion(
            *((title, place) for (title, _), place in zip(parts, self._places, strict=True)),
            active=[],
            toggle=False,
            disable_gutters=True,
            title_variant="body2",
            sizing_mode="stretch_width",
            margin=(8, 10),
            stylesheets=[_SHEET],
        )
        self._view.param.watch(self._opened, "active")

    def _opened(self, event: Any) -> None:
        for index in event.new:
            if not self._places[index].objects:
                self._places[index].append(self._parts[index][1]())
