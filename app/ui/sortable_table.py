"""A table that is sorted by pressing its headings, in the browser: no message to the server, no library.

A row is chosen by a button in it, or several by their ticks, where the table has any.
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
    empty `data-sort` goes last in both directions. The order chosen survives new content, and so do the place
    scrolled to and the focus on what a row has to press.
    """

    html = param.String(default="", doc="Already escaped.")
    ticked = param.List(default=[], doc="Values of the rows that are ticked, also of rows that are not shown.")
    over = param.Boolean(doc="Whether it opens over the page: Escape, wherever the focus is, tells `take` nothing.")

    _stylesheets: ClassVar[list[str]] = [SHEET]

    def __init__(self, take: Callable[[str], object] | None = None, **params: Any) -> None:
        """take: called with the value of a button that is pressed; may be async."""
        super().__init__(**{"sizing_mode": "stretch_width", **params})
        self._take = take

    def _handle_msg(self, msg: Any) -> None:
        if self._take is not None and isinstance(msg, str):
            pn.state.execute(partial(self._take, msg), schedule=False)
