"""Facts of a new page about its browser: the tab in its address, dark or light, narrow or wide.

A browser tells the server nothing of these, so a script in the page puts them into a cookie before it connects.
Without cookies the page starts with the first tab, light and wide.
"""

from pathlib import Path
from typing import NamedTuple

from app.dashboard.lifeline import THEME_COOKIE
from app.subjects import tab_index
from app.upstream.late_session import connecting_cookies

_COOKIE = "navbudget-opening"
OPENING_SCRIPT = (
    Path(__file__).with_suffix(".js").read_text("utf-8").replace("COOKIE", _COOKIE).replace("THEME", THEME_COOKIE)
)
"""For the head of the page as the browser loads it."""
OPENING_SHEET = Path(__file__).with_suffix(".css").read_text("utf-8")
"""Its style until all of it is there."""


class Opening(NamedTuple):
    """Index of the first page, whether all is dark, whether the window is too narrow for the design beside it."""

    page: int
    dark: bool
    narrow: bool


def opening() -> Opening:
    """The opening state of the session that is being made."""
    cookies = connecting_cookies()
    system, width, page = (*cookies.get(_COOKIE, "").split("."), "", "", "")[:3]
    chosen = cookies.get(THEME_COOKIE, system)
    return Opening(tab_index(page) or 0, chosen == "dark", width == "narrow")
