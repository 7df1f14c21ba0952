"""When the page loses its server or is reloaded: results are marked as not current, the design is restored, and dark
mode is kept."""

from collections.abc import Callable
from typing import Any, ClassVar

import param

from app.ui.theme import BASE
from app.upstream.plain_script import PlainScript

THEME_COOKIE = "navbudget-theme"


class Lifeline(PlainScript):
    """Keeps the design in the browser's tab, restores it when the page is reloaded, and says when the server is gone.

    The tab forgets it when it is closed, or when somebody else logs in on it. A page that is opened, not loaded
    again, takes nothing back: it shows what its address says. ``come_back`` is called with what was kept: the texts
    `link` and `base`.
    """

    link = param.String(doc="The design in force and the study beside it, as a link's query.")
    base = param.String(doc="Key of the saved revision the design came from; empty: none.")
    who = param.String(doc="Who is logged in; empty: nobody has to.")
    dark = param.Boolean(doc="Whether the page is dark: kept in a cookie, for every page of this server.")

    _stylesheets: ClassVar[list[str]] = [BASE]
    _before = f'const THEME_COOKIE = "{THEME_COOKIE}"\n'

    def __init__(self, come_back: Callable[[str, str], None], **params: Any) -> None:
        super().__init__(**params)
        self._come_back = come_back

    def _handle_msg(self, msg: Any) -> None:
        link, base = (msg.get(key) for key in ("link", "base")) if isinstance(msg, dict) else (None, None)
        if isinstance(link, str) and isinstance(base, str):
            self._come_back(link, base)
