"""The cookie of a login is for this site, over TLS only where the page came that way; a key encrypts its tokens."""

import pytest
from cryptography.fernet import Fernet
from panel.config import config
from panel.io.state import state
from tornado.httputil import HTTPServerRequest, RequestStartLine
from tornado.web import Application

from app.upstream.login import CookieForThisSite, encrypt_tokens

pytestmark = pytest.mark.watches("app/upstream", "docs/upstream")


class _Connection:
    """The part of one that a handler asks."""

    context = None

    def set_close_callback(self, _: object) -> None:
        """Never closed."""


@pytest.mark.parametrize("protocol", ["http", "https"])
def test_the_cookie_stays_here(protocol: str) -> None:
    request = HTTPServerRequest(start_line=RequestStartLine("GET", "/", "HTTP/1.0"), connection=_Connection())
    request.protocol = protocol
    handler = CookieForThisSite(Application(cookie_secret="of a test"), request)
    handler.set_secure_cookie("user", "ada")
    cookie = str(handler._new_cookie["user"].OutputString())
    assert "SameSite=Lax" in cookie
    assert ("Secure" in cookie) == (protocol == "https")


def test_a_key_encrypts() -> None:
    key = Fernet.generate_key()
    before = config.oauth_encryption_key
    try:
        encrypt_tokens(key)
        assert Fernet(key).decrypt(state.encryption.encrypt(b"token")) == b"token"
    finally:
        config.oauth_encryption_key, state.encryption = before, None
