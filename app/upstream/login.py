"""Traces of a login: a cookie for this site only, over TLS if the page came that way, and encrypted tokens.

Reports to send upstream, versions and ends: docs/upstream/login.md
"""

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
