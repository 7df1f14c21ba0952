"""The base class of pages and of their parts."""

from typing import Any

import panel as pn


class View(pn.viewable.Viewer):
    """Part of a page with one layout, `_view`, which a subclass makes with itself."""

    _view: Any

    def __panel__(self) -> Any:
        return self._view
