"""A session sees the cookies of its connection; tests/app/serving shows that who only looks makes none."""

from http.cookies import SimpleCookie
from types import SimpleNamespace

from bokeh.document import Document
from bokeh.server.contexts import _RequestProxy
from panel.io.state import set_curdoc

from app.upstream.late_session import connecting_cookies


def test_the_cookies_of_the_connection_are_seen() -> None:
    connecting = SimpleNamespace(cookies=SimpleCookie("theme=dark; opening=dark.wide.sar"), arguments={}, headers={})
    request = _RequestProxy(connecting, arguments={}, cookies={"theme": "light"}, headers={})  # of the page's token
    document = Document()
    document._session_context = lambda: SimpleNamespace(request=request)
    with set_curdoc(document):
        assert connecting_cookies() == {"theme": "dark", "opening": "dark.wide.sar"}
    assert connecting_cookies() == {}
