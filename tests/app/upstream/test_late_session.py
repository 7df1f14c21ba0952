"""A session sees the cookies of its connection; tests/app/serving shows that who only looks makes none."""

from http.cookies import SimpleCookie
from types import SimpleNamespace

import pytest
from bokeh.document import Document
from bokeh.server.contexts import _RequestProxy
from panel.config import config
from panel.io.state import set_curdoc
from tornado.web import create_signed_value

from app.upstream.late_session import connecting_cookies, visitor

pytestmark = pytest.mark.watches("app/upstream", "docs/upstream")


def test_the_cookies_of_the_connection_are_seen() -> None:
    connecting = SimpleNamespace(cookies=SimpleCookie("theme=dark; opening=dark.wide.sar"), arguments={}, headers={})
    request = _RequestProxy(connecting, arguments={}, cookies={"theme": "light"}, headers={})  # of the page's token
    document = Document()
    document._session_context = lambda: SimpleNamespace(request=request)
    with set_curdoc(document):
        assert connecting_cookies() == {"theme": "dark", "opening": "dark.wide.sar"}
    assert connecting_cookies() == {}


def test_a_visitor_is_the_person_who_logged_in_or_else_an_address(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(config, "cookie_secret", "x" * 32)
    document = Document()

    def who(**cookies: str) -> str:
        connecting = SimpleNamespace(cookies=SimpleCookie(), arguments={}, headers={}, remote_ip="192.0.2.7")
        request = _RequestProxy(connecting, arguments={}, cookies=cookies, headers={})
        document._session_context = lambda: SimpleNamespace(request=request)
        with set_curdoc(document):
            return visitor()

    assert who() == "192.0.2.7"
    assert who(user="ada") == "192.0.2.7"  # a cookie that nobody signed
    assert who(user=create_signed_value("x" * 32, "user", "ada").decode()) == "ada"
    assert visitor() == ""  # outside a page
