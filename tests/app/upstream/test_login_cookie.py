"""The cookie of a login is for this site, and over TLS only where the page came that way."""

from __future__ import annotations

import pytest
from panel.auth import BasicLoginHandler
from tornado.httputil import HTTPServerRequest, RequestStartLine
from tornado.web import Application, RequestHandler

from app.upstream.login import CookieForThisSite


class _Connection:
    """What a handler asks of one."""

    context = None

    def set_close_callback(self, _: object) -> None:
        """Never closed."""


def _cookies(kind: type[RequestHandler], protocol: str) -> str:
    request = HTTPServerRequest(start_line=RequestStartLine("GET", "/", "HTTP/1.0"), connection=_Connection())  # type: ignore[arg-type]
    request.protocol = protocol
    handler = kind(Application(cookie_secret="of a test"), request)
    handler.set_secure_cookie("user", "ada")
    return str(handler._new_cookie["user"].OutputString())


def test_as_shipped_the_cookie_travels_anywhere() -> None:
    assert "samesite" not in _cookies(BasicLoginHandler, "https").lower()
    assert "secure" not in _cookies(BasicLoginHandler, "https").lower()


@pytest.mark.parametrize("protocol", ["http", "https"])
def test_it_stays_here(protocol: str) -> None:
    said = _cookies(CookieForThisSite, protocol)
    assert "SameSite=Lax" in said
    assert ("Secure" in said) == (protocol == "https")
