"""The commands `serve` and `password`: the dashboard for one person or a team."""

from __future__ import annotations

import argparse
import dataclasses
import getpass
import math
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nav_model.base.errors import InputError, under

if TYPE_CHECKING:
    from app.serving.rules import Rules

_OAUTH = ("auth0", "azure", "azurev2", "bitbucket", "generic", "gitlab", "github", "google", "okta")


def add_to(commands: Any) -> None:
    """Declare the command."""
    _add_serve(commands.add_parser("serve", help="run the dashboard"))
    password = commands.add_parser("password", help="print a person's line for the password file")
    password.add_argument("name", metavar="NAME", help="the person; the password is asked for, or read from a pipe")
    password.set_defaults(run=_password)


def _add_serve(serve: argparse.ArgumentParser) -> None:
    add = serve.add_argument
    add("--port", type=int, default=5006, help="port (default 5006; 0 picks a free one)")
    add("--address", default="127.0.0.1", help="address to listen on (default 127.0.0.1, this machine only)")
    add("--allow-origin", action="append", default=[], metavar="HOST[:PORT]",
        help="public host name of the page, if it is not the address; may be repeated")  # fmt: skip
    add("--behind-proxy", action="store_true", help="trust X-Forwarded-For and X-Forwarded-Proto, which a proxy sets")
    who = serve.add_argument_group("who may log in (required unless the address is this machine only)")
    add = who.add_argument
    add("--password-file", type=Path, metavar="FILE", help="lines name:hash as `navbudget password NAME` prints them")
    add("--open", action="store_true", help="let in everybody who can reach the address")
    add("--cookie-secret-file", type=Path, metavar="FILE",
        help="signs the login; without it a restart ends all logins")  # fmt: skip
    add("--login-hours", type=float, default=12.0, metavar="H", help="how long a login lasts (default 12)")
    add("--oauth-provider", metavar="NAME", choices=_OAUTH, help=f"sign in through: {', '.join(_OAUTH)}")
    add("--oauth-key", metavar="ID", help="client id; the secret comes from PANEL_OAUTH_SECRET in the environment, "
        "a key to encrypt tokens from PANEL_OAUTH_ENCRYPTION")  # fmt: skip
    add("--oauth-redirect-uri", metavar="URL", help="address to which the provider returns the visitor")
    add("--oauth-allow", action="append", default=[], metavar="WHO",
        help="user, @domain of a mail address, or * for every account; may be repeated")  # fmt: skip
    add("--login-store", default="", metavar="PATH-or-URL", help="where logins and failed attempts are kept for all "
        "processes (default: a PostgreSQL library; else a file that ends with the server)")  # fmt: skip
    add = serve.add_argument
    add("--library", default="", metavar="PATH-or-URL",
        help="saved designs: a file, or postgresql://... (default: a file in the user's data folder)")  # fmt: skip
    add("--review-key", type=Path, metavar="FILE",
        help="Ed25519 key (PEM) that signs and verifies reviews; all servers of one library share it (default: one "
        "in the user's data folder, made when first needed)")  # fmt: skip
    limits = serve.add_argument_group("limits")
    add = limits.add_argument
    add("--max-sessions", type=int, default=100, metavar="N", help="open pages at a time (default 100)")
    add("--session-lifetime", type=float, default=60.0, metavar="S",
        help="how long a page is kept after its connection is lost (default 60)")  # fmt: skip
    add("--max-message", type=float, default=20.0, metavar="MB",
        help="largest message a browser may send, uploads included (default 20)")  # fmt: skip
    add("--processes", type=int, metavar="N", help="processes that serve pages (default: 1 for one person; with "
        "logins or --open one per core, 4 at most)")  # fmt: skip
    add("--workers", type=int, metavar="N", help="processes for heavy work such as reports and Monte Carlo runs, "
        "shared out among those that serve pages (default: one less than cores)")  # fmt: skip
    add("--grace", type=float, default=10.0, metavar="S", help="time for heavy work after SIGTERM (default 10)")
    add("--log", choices=("text", "json"), default="text", help="text: warnings; json: every event, one line each")
    serve.set_defaults(run=_serve)


def _serve(options: argparse.Namespace) -> int:
    from app.library.place import look_at
    from app.library.seal import check_key
    from app.serving.rules import Rules, cookie_secret, oauth_from

    given = vars(options)
    rules = dataclasses.replace(
        Rules(**{field.name: given[field.name] for field in dataclasses.fields(Rules) if field.name in given}),
        allow_origin=tuple(options.allow_origin),
        cookie_secret=cookie_secret(options.cookie_secret_file),
        oauth=oauth_from(
            options.oauth_provider, options.oauth_key, options.oauth_redirect_uri, tuple(options.oauth_allow)
        ),
        login_store=options.login_store or (options.library if options.library.startswith("postgres") else ""),
        max_message=round(1e6 * options.max_message) if math.isfinite(options.max_message) else 0,
    )
    rules.check()  # before the screen is loaded: a wrong command is refused at once
    if options.review_key is not None:
        check_key(options.review_key)
    with under("--library"):
        warning = look_at(options.library)
    if warning:
        print(f"navbudget: {warning}", file=sys.stderr, flush=True)
    with tempfile.TemporaryDirectory(prefix="navbudget-") as folder:
        if not rules.login_store:
            rules = dataclasses.replace(rules, login_store=str(Path(folder) / "logins.db"))
        return _run(rules, options.library)


def _run(rules: Rules, library: str) -> int:
    if rules.password_file is not None:
        from app.serving.logins import Logins

        Logins(rules.login_store).close()  # made once, before several processes open it
    if rules.page_processes > 1:
        from app.serving.supervisor import supervise

        return supervise(rules, library)
    from app.library.place import use_library
    from app.library.seal import use_key
    from app.serving.server import serve

    use_library(library)
    use_key(rules.review_key)
    serve(rules)
    return 0


def _password(options: argparse.Namespace) -> int:
    from app.serving.passwords import password_line

    try:
        if sys.stdin.isatty():
            password = getpass.getpass("Password: ")
            if getpass.getpass("Again: ") != password:
                raise InputError("password", "the two passwords differ")
        else:
            password = sys.stdin.readline().rstrip("\r\n")
        password.encode()
    except EOFError as error:
        raise InputError("password", "none was given") from error
    except UnicodeError as error:
        raise InputError("password", "is not UTF-8 text") from error
    print(password_line(options.name, password))
    return 0
