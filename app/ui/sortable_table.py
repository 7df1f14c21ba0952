"""A table that is sorted by pressing its headings, in the browser: no message to the server, no library.

A row is chosen by the button in it, where the table has any.
"""

from collections.abc import Callable
from functools import partial
from typing import Any, ClassVar

import panel as pn
import param

from app.ui.theme import SHEET
from app.upstream.plain_script import PlainScript

WHOLE = ".scroll.tall { max-height: none; }"
"""Style of a table whose view scrolls, so that the table itself need not."""


class SortableTable(PlainScript):
    """Our own HTML with one table; a column whose heading holds a `<button>` can be sorted.

    A cell sorts by its `data-sort` attribute when it has one (a number or a text), else by what it says; an
    empty `data-sort` goes last in both directions. The order chosen survives new content, and so do the
    place scrolled to and the focus on a row's button.
    """

    html = param.String(default="", doc="Already escaped.")
    chosen = param.String(default="", doc="Value of the button last pressed.")

    _stylesheets: ClassVar[list[str]] = [SHEET]

    def __init__(self, take: Callable[[str], object] | None = None, **params: Any) -> None:
        """take: called with the value of a button that is pressed, again if it is pressed again; may be async."""
        super().__init__(**{"sizing_mode": "stretch_width", **params})
        self._take = take
        self.param.watch(self._pressed, "chosen")

    def _pressed(self, event: Any) -> None:
        if event.new and self._take is not None:
            self.chosen = ""
            pn.state.execute(partial(self._take, event.new), schedule=False)
