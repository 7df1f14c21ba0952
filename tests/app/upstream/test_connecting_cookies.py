"""Which cookies a session sees: those of the page's request as shipped, those of the connection here."""

from __future__ import annotations

from http.cookies import SimpleCookie
from types import SimpleNamespace

import panel as pn
from bokeh.document import Document
from bokeh.server.contexts import _RequestProxy
from panel.io.state import set_curdoc

from app.upstream.late_session import connecting_cookies


def _session() -> Document:
    """Of a token with one cookie, and a connection with a newer one."""
    connecting = SimpleNamespace(cookies=SimpleCookie("theme=dark; opening=dark.wide.sar"), arguments={}, headers={})
    request = _RequestProxy(connecting, arguments={}, cookies={"theme": "light"}, headers={})
    document = Document()
    document._session_context = lambda: SimpleNamespace(request=request)
    return document


def test_as_shipped_a_session_sees_old_cookies():
    with set_curdoc(_session()):
        assert pn.state.cookies == {"theme": "light"}


def test_the_cookies_of_the_connection_are_seen():
    with set_curdoc(_session()):
        assert connecting_cookies() == {"theme": "dark", "opening": "dark.wide.sar"}
    assert connecting_cookies() == {}
