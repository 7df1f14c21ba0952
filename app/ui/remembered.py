"""Values that the browser keeps between visits, in a cookie: a name, a preference."""

from typing import Any
from urllib.parse import unquote

import panel as pn
import param

from app.upstream.late_session import connecting_cookies
from app.upstream.plain_script import PlainScript

NAME_COOKIE = "navbudget-name"
"""Cookie of the name that a visitor without a login typed."""
DISPLAY_COOKIE = "navbudget-show"
"""Cookie of how figures are shown."""


class Remembered(PlainScript):
    """Keeps a text in the browser under a name; an empty text is forgotten.

    Parameters
    ----------
    key : str
        Name of the cookie.
    text : str or parameter
        What to keep; a parameter is followed.
    """

    key = param.String()
    text = param.String(default="")

    def __init__(self, key: str, text: Any) -> None:
        super().__init__(key=key, text=text, width=0, height=0, margin=0)


def login() -> str:
    """The login of the session's user; empty without access control."""
    user = pn.state.user
    return user if user and user != "guest" else ""


def recalled(key: str) -> str:
    """The value kept in the browser of the session being made; empty if none."""
    return unquote(connecting_cookies().get(key, ""))[:200]
