"""Access control: our own login page, without external resources, in front of Panel's checks."""

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup
from panel.auth import BasicAuthProvider, BasicLoginHandler, LogoutHandler, OAuthProvider
from panel.config import config
from tornado.web import HTTPError

from app.serving.logins import Logins
from app.serving.logs import event
from app.serving.passwords import MAX_NAME, MAX_PASSWORD, Passwords
from app.serving.rules import Rules
from app.upstream.login import CookieForThisSite, encrypt_tokens

_LOGIN = "login"  # the cookie that the store knows; "user", which Panel reads, only carries the name

# One thread: hashing takes memory and time on purpose, and a flood of tries must not take more than one core.
_hashing = ThreadPoolExecutor(max_workers=1, thread_name_prefix="password")


@cache
def _pages() -> Environment:
    return Environment(loader=PackageLoader("app", "serving"), autoescape=True, undefined=StrictUndefined)


def plain_page(title: str, text: str, **more: Any) -> str:
    """A page of ours outside the dashboard: a message, or the form to log in."""
    fields = {"form": None, "leave": None, "failed": "", "name": "", "again": "", "link_text": "", **more}
    return _pages().get_template("plain.html").render(title=title, text=text, **fields)


class PasswordLogin(CookieForThisSite, BasicLoginHandler):
    """The login page: checks a name and a password against the file."""

    passwords: Passwords
    logins: Logins

    def get(self) -> None:
        """Show the form to log in."""
        self._form(self._next(self.get_query_argument("next", "/")))

    async def post(self) -> None:
        """Check, then send on to where the visitor was going."""
        name = self.get_body_argument("username", "")[:MAX_NAME]
        password = self.get_body_argument("password", "", strip=False)[: MAX_PASSWORD + 1]
        wanted = self._next(self.get_query_argument("next", "/"))
        peer = self.request.remote_ip or ""
        too_many, secret = await asyncio.get_running_loop().run_in_executor(_hashing, self._try, peer, name, password)
        if too_many:
            self.set_status(429)
            self.set_header("Retry-After", "60")
            self._form(wanted, "Too many tries. Wait a minute, then try again.", name)
            return
        event("login refused" if secret is None else "login", peer=peer)
        if secret is None:
            self.set_status(401)
            self._form(wanted, "Name or password is wrong.", name)
            return
        self.set_current_user(name)
        self.set_secure_cookie(_LOGIN, secret, expires_days=config.oauth_expiry, httponly=True)
        self.redirect(f".{wanted}")  # from this page: a proxy may serve it below a path of its own

    def _try(self, peer: str, name: str, password: str) -> tuple[bool, str | None]:
        """Try a password: True after too many tries, and the secret of the login if the password is right."""
        of_peer, of_account = f"from {peer}", f"for {name}"
        if self.logins.too_many(of_peer) or self.logins.too_many(of_account):
            return True, None
        mark = self.passwords.mark(name)
        if not self.passwords.fits(name, password) or mark is None:
            self.logins.failed(of_peer, of_account)
            return False, None
        return False, self.logins.begin(name, mark, 24 * config.oauth_expiry)

    def _next(self, wanted: str) -> str:
        """The address to go to afterwards, on this host only."""
        # Browsers take a backslash for a slash, and leave out tabs and ends of lines.
        if not wanted.startswith("/") or wanted.startswith("//") or "\\" in wanted or not wanted.isprintable():
            raise HTTPError(400, "next must be a path on this server")
        return wanted

    def _form(self, wanted: str, failed: str = "", name: str = "") -> None:
        self.set_header("Cache-Control", "no-store")
        self.write(plain_page("Log in", "", form=Markup(self.xsrf_form_html()), failed=failed, name=name))


class Logout(CookieForThisSite, LogoutHandler):
    """Log out, which a link from elsewhere cannot do."""

    def get(self) -> None:
        """Show the page with the button to log out."""
        self.set_header("Cache-Control", "no-store")
        self.write(plain_page("Log out", "", leave=Markup(self.xsrf_form_html())))

    def post(self) -> None:
        """Delete the cookie, and end the login for every copy of it."""
        self.check_xsrf_cookie()  # the server does so for passwords alone
        secret = self.get_secure_cookie(_LOGIN, max_age_days=config.oauth_expiry)
        if secret is not None:
            PasswordLogin.logins.end(secret.decode("utf-8"))
        for name in ("user", _LOGIN, "id_token", "access_token", "refresh_token", "oauth_expiry"):
            self.clear_cookie(name)
        self.write(plain_page("Logged out", "You are logged out.", again=".", link_text="Log in again"))


class PasswordProvider(BasicAuthProvider):
    """Panel's basic login with our page, against hashes in a file that may change while the server runs."""

    def __init__(self, passwords: Passwords, logins: Logins) -> None:
        super().__init__()
        PasswordLogin.passwords = self._passwords = passwords
        PasswordLogin.logins = self._logins = logins

    @property
    def get_user(self) -> Callable[[Any], str | None]:
        """The name a request carries, if its login holds: not ended, and made with the password the file has now."""
        panels = super().get_user  # counts who is connected

        def get_user(handler: Any) -> str | None:
            return str(panels(handler)) if self.still_in(handler) else None

        return get_user

    def still_in(self, handler: Any) -> bool:
        """True while the login that a request came with holds."""
        signed = handler.get_secure_cookie("user", max_age_days=config.oauth_expiry)
        secret = handler.get_secure_cookie(_LOGIN, max_age_days=config.oauth_expiry)
        if signed is None or secret is None:
            return False
        name = signed.decode("utf-8")
        mark = self._passwords.mark(name)
        return mark is not None and self._logins.holds(secret.decode("utf-8"), name, mark)

    @property
    def login_handler(self) -> type[PasswordLogin]:
        """The handler of our page to log in."""
        return PasswordLogin

    @property
    def logout_handler(self) -> type[Logout]:
        """The handler of our page to log out: Panel's fetches a picture from elsewhere."""
        return Logout


def provider_of(rules: Rules) -> dict[str, Any]:
    """The server's options for access control; empty if there is none."""
    config.cookie_secret = rules.cookie_secret
    config.oauth_expiry = rules.login_hours / 24
    if rules.password_file is not None:
        return {
            "auth_provider": PasswordProvider(Passwords(rules.password_file), Logins(rules.login_store)),
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
    """Panel's OAuth with our logout page."""

    @property
    def logout_handler(self) -> type[Logout]:
        return Logout
