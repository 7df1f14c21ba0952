"""What a login leaves in the browser and on the server.

The cookie of a login is for this site only, and over TLS only if the page came that way.

Panel sets it, and Tornado that of a form, without SameSite and without Secure.

Written for: Panel 1.9.4
Upstream: none found, searched 2026-11-22
Needless when: tests/app/upstream/test_login_cookie.py::test_as_shipped_the_cookie_travels_anywhere fails

Tokens of an OAuth login are encrypted with the key that was given.

`panel serve` makes the cipher of its key; `panel.serve` takes the key and leaves tokens as they are.

Written for: Panel 1.9.4
Upstream: none found, searched 2026-11-22
Needless when: tests/app/upstream/test_token_encryption.py::test_as_shipped_a_key_encrypts_nothing fails
"""

from __future__ import annotations

from typing import Any

from panel.config import config
from panel.io.state import state
from tornado.web import RequestHandler


class CookieForThisSite(RequestHandler):
    """A login whose cookies stay here."""

    def set_cookie(self, name: str, value: str | bytes, *arguments: Any, **options: Any) -> None:
        """As Tornado, with SameSite and perhaps Secure."""
        secure = self.request.protocol == "https"
        super().set_cookie(name, value, *arguments, **{**options, "samesite": "Lax", "secure": secure})


def encrypt_tokens(key: bytes) -> None:
    """Use a Fernet key for all sessions of this process."""
    from cryptography.fernet import Fernet

    config.oauth_encryption_key = key
    state.encryption = Fernet(key)
