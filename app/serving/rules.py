"""The server's settings, checked before anything listens."""

import ipaddress
import os
import secrets
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from nav_model.base.errors import InputError

_SHORTEST_SECRET = 32
_ENOUGH = 4  # processes of pages unless more are asked for


@dataclass(frozen=True)
class OAuth:
    """Sign-in through an OAuth provider that Panel knows; ``allow`` says who of its accounts may enter."""

    provider: str
    key: str
    secret: str
    redirect_uri: str | None
    encryption_key: bytes | None
    allow: tuple[str, ...]

    def admits(self, user: str) -> bool:
        """True if an account may enter: ``*``, its name, or ``@domain`` of its mail address; case does not count."""
        name = user.casefold()
        domain = f"@{name.rpartition('@')[2]}" if "@" in name else None
        return any(rule == "*" or rule.casefold() in {name, domain} for rule in self.allow)


@dataclass(frozen=True)
class Rules:
    """Settings of the server. Times in seconds, sizes in bytes."""

    address: str = "127.0.0.1"
    port: int = 5006
    allow_origin: tuple[str, ...] = ()
    open: bool = False
    password_file: Path | None = None
    cookie_secret: str = ""
    oauth: OAuth | None = None
    behind_proxy: bool = False
    max_sessions: int = 100
    session_lifetime: float = 60.0
    login_hours: float = 12.0
    login_store: str = ""
    review_key: Path | None = None
    max_message: int = 20_000_000
    processes: int | None = None
    workers: int | None = None
    grace: float = 10.0
    log: str = "text"

    @property
    def protected(self) -> bool:
        """True if a visitor must log in."""
        return self.password_file is not None or self.oauth is not None

    @property
    def page_processes(self) -> int:
        """Number of processes that serve pages: as set; otherwise one for a single user, one per core for a team."""
        team = self.protected or self.open
        return self.processes if self.processes is not None else min(_ENOUGH, os.cpu_count() or 1) if team else 1

    def check(self) -> None:
        """Refuse settings that cannot be served.

        Raises
        ------
        InputError
            Naming the option, what was given and what is allowed.
        """
        _within("--port", self.port, 0, 65535)
        _within("--max-sessions", self.max_sessions, 1, 10_000)
        _within("--session-lifetime", self.session_lifetime, 1, 86_400)
        _within("--login-hours", self.login_hours, 0.01, 24 * 365)
        _within("--max-message", self.max_message / 1e6, 1, 1000)
        _within("--grace", self.grace, 0, 600)
        _within("--processes", self.page_processes, 1, 64)
        if self.workers is not None:
            _within("--workers", self.workers, 1, 256)
        for origin in self.allow_origin:
            if not origin or "/" in origin or "*" in origin or not origin.isprintable() or " " in origin:
                raise InputError("--allow-origin", f"{origin!r} is not HOST or HOST:PORT")
        if self.open and self.protected:
            raise InputError("--open", "contradicts --password-file or --oauth-provider; give one of them")
        if self.password_file is not None and self.oauth is not None:
            raise InputError("--password-file", "does not go together with --oauth-provider; give one of them")
        if not (is_loopback(self.address) or self.protected or self.open):
            raise InputError(
                "--address",
                f"{self.address} can be reached from other machines: give --password-file FILE or "
                "--oauth-provider NAME, or --open to let everybody in",
            )


def _within(option: str, value: float, least: float, most: float) -> None:
    if not least <= value <= most:
        raise InputError(option, f"{value:g} is outside {least:g} to {most:g}")


def in_numbers(address: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    """An address that needs no name server, an IPv4 address mapped into IPv6 as itself; None for a name."""
    try:
        number = ipaddress.ip_address(address)
    except ValueError:
        return None
    return getattr(number, "ipv4_mapped", None) or number


def is_loopback(address: str) -> bool:
    """True if only this machine can reach an address."""
    return address == "localhost" or ((number := in_numbers(address)) is not None and number.is_loopback)


def is_everywhere(address: str) -> bool:
    """True if listening on an address is listening on all that this machine has."""
    return (number := in_numbers(address)) is not None and number.is_unspecified


def cookie_secret(path: Path | None) -> str:
    """The secret that signs the login cookie: from a file, or random, so that a restart logs everybody out."""
    if path is None:
        return secrets.token_urlsafe(48)
    try:
        text = path.read_text(encoding="utf-8").strip()
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "not a text file"
        raise InputError("--cookie-secret-file", f"{path}: {reason}") from error
    if len(text) < _SHORTEST_SECRET:
        raise InputError(
            "--cookie-secret-file", f"{path} holds {len(text)} characters; at least {_SHORTEST_SECRET} are needed"
        )
    return text


def oauth_from(
    provider: str | None,
    key: str | None,
    redirect_uri: str | None,
    allow: tuple[str, ...],
    environment: Mapping[str, str] = os.environ,
) -> OAuth | None:
    """OAuth as asked for; its secrets come from the environment, where no process list shows them.

    Raises
    ------
    InputError
        If a part is missing, or nobody is allowed.
    """
    if provider is None:
        for option, given in (
            ("--oauth-key", key),
            ("--oauth-redirect-uri", redirect_uri),
            ("--oauth-allow", allow),
        ):
            if given:
                raise InputError(option, "needs --oauth-provider")
        return None
    if not key:
        raise InputError("--oauth-key", "missing: the client id the provider gave you")
    secret = environment.get("PANEL_OAUTH_SECRET", "")
    if not secret:
        raise InputError("PANEL_OAUTH_SECRET", "missing in the environment: the client secret of the provider")
    if not allow:
        raise InputError(
            "--oauth-allow",
            "missing: every account of the provider could sign in; name users or @domains, or '*' for all",
        )
    encryption = environment.get("PANEL_OAUTH_ENCRYPTION")
    return OAuth(provider, key, secret, redirect_uri, encryption.encode() if encryption else None, allow)
