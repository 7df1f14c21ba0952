"""Who may enter: a page to log in on, drawn by this product and fetching nothing, in front of Panel's own checks."""

from __future__ import annotations

import asyncio
import time
from collections import OrderedDict, deque
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from panel.auth import BasicAuthProvider, LogoutHandler, OAuthProvider
from panel.config import config
from tornado.web import HTTPError

from app.serving.logs import event
from app.serving.passwords import MAX_NAME, MAX_PASSWORD, Passwords
from app.serving.rules import Rules
from app.upstream.login_cookie import CookieForThisSite
from app.upstream.token_encryption import encrypt_tokens

_TRIES = 10
_WINDOW = 60.0  # seconds
_PEERS = 10_000

# One thread: hashing takes memory and time on purpose, and a flood of tries must not take more than one core.
_hashing = ThreadPoolExecutor(max_workers=1, thread_name_prefix="password")


@cache
def _pages() -> Environment:
    return Environment(loader=PackageLoader("app", "serving"), autoescape=True, undefined=StrictUndefined)


def plain_page(title: str, text: str, **more: Any) -> str:
    """A page of ours outside the dashboard: a message, or the form to log in."""
    fields = {"form": None, "failed": "", "name": "", "again": "", "link_text": "", **more}
    return _pages().get_template("plain.html").render(title=title, text=text, **fields)


class Tries:
    """Failed logins by peer at this process, so that nobody can guess without end."""

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._failed: OrderedDict[str, deque[float]] = OrderedDict()

    def too_many(self, peer: str) -> bool:
        """Whether a peer has failed too often in the last minute."""
        failed = self._failed.get(peer, deque())
        while failed and failed[0] < self._clock() - _WINDOW:
            failed.popleft()
        return len(failed) >= _TRIES

    def failed(self, peer: str) -> None:
        """Count a failure."""
        self._failed.setdefault(peer, deque()).append(self._clock())
        self._failed.move_to_end(peer)
        while len(self._failed) > _PEERS:
            self._failed.popitem(last=False)


class PasswordLogin(CookieForThisSite):
    """The page to log in on; a name and a password against the file."""

    passwords: Passwords
    tries: Tries

    def get(self) -> None:
        """The form."""
        self._form(self._next(self.get_query_argument("next", "/")))

    async def post(self) -> None:
        """Check, then send on to where the visitor was going."""
        name = self.get_body_argument("username", "")[:MAX_NAME]
        password = self.get_body_argument("password", "", strip=False)[: MAX_PASSWORD + 1]
        wanted = self._next(self.get_query_argument("next", "/"))
        peer = self.request.remote_ip or ""
        if self.tries.too_many(peer):
            self.set_status(429)
            self.set_header("Retry-After", "60")
            self._form(wanted, "Too many tries. Wait a minute, then try again.", name)
            return
        fits = await asyncio.get_running_loop().run_in_executor(_hashing, self.passwords.fits, name, password)
        event("login" if fits else "login refused", peer=peer)
        if not fits:
            self.tries.failed(peer)
            self.set_status(401)
            self._form(wanted, "Name or password is wrong.", name)
            return
        self.set_current_user(name)
        self.redirect(wanted)

    def _next(self, wanted: str) -> str:
        """Where to go afterwards, on this host only."""
        # Browsers take a backslash for a slash, and leave out tabs and ends of lines.
        if not wanted.startswith("/") or wanted.startswith("//") or "\\" in wanted or not wanted.isprintable():
            raise HTTPError(400, "next must be a path on this server")
        return wanted

    def _form(self, wanted: str, failed: str = "", name: str = "") -> None:
        self.set_header("Cache-Control", "no-store")
        self.write(plain_page("Log in", "", form=Markup(self.xsrf_form_html()), failed=failed, name=name))


class Goodbye(LogoutHandler):
    """Log out."""

    def get(self) -> None:
        """Forget the visitor."""
        for name in ("user", "id_token", "access_token", "refresh_token", "oauth_expiry"):
            self.clear_cookie(name)
        self.write(plain_page("Logged out", "You are logged out.", again=".", link_text="Log in again"))


class PasswordProvider(BasicAuthProvider):
    """Panel's basic login with our page, against hashes in a file that may change while the server runs."""

    def __init__(self, passwords: Passwords) -> None:
        super().__init__()
        PasswordLogin.passwords = self._passwords = passwords
        PasswordLogin.tries = Tries()

    @property
    def get_user(self) -> Callable[[Any], str | None]:
        """The name a request carries, if the file still knows it."""
        panels = super().get_user  # counts who is connected

        def get_user(handler: Any) -> str | None:
            signed = handler.get_secure_cookie("user", max_age_days=config.oauth_expiry)
            if signed is None or not self._passwords.knows(signed.decode("utf-8")):
                return None
            return str(panels(handler))

        return get_user

    @property
    def login_handler(self) -> type[PasswordLogin]:
        """Our page."""
        return PasswordLogin

    @property
    def logout_handler(self) -> type[Goodbye]:
        """Ours too: Panel's page fetches a picture from elsewhere."""
        return Goodbye


def provider_of(rules: Rules) -> dict[str, Any]:
    """What the server must be told for access control; nothing if everybody may enter."""
    config.cookie_secret = rules.cookie_secret
    config.oauth_expiry = rules.login_hours / 24
    if rules.password_file is not None:
        return {
            "auth_provider": PasswordProvider(Passwords(rules.password_file)),
            "cookie_secret": rules.cookie_secret,
            "xsrf_cookies": True,
        }
    if rules.oauth is None:
        return {}
    oauth = rules.oauth
    config.oauth_provider = oauth.provider
    config.oauth_key, config.oauth_secret = oauth.key, oauth.secret
    if oauth.redirect_uri:
        config.oauth_redirect_uri = oauth.redirect_uri
    if oauth.encryption_key:
        encrypt_tokens(oauth.encryption_key)
    return {"auth_provider": _OAuth(), "cookie_secret": rules.cookie_secret}


class _OAuth(OAuthProvider):
    """Panel's OAuth; only the page to leave by is ours."""

    @property
    def logout_handler(self) -> type[Goodbye]:
        return Goodbye
