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

from app.console.arguments import declare
from nav_model.base.errors import InputError

if TYPE_CHECKING:
    from app.serving.rules import Rules


def add_to(commands: Any) -> None:
    """Declare the command."""
    declare(commands, __file__, serve=_serve, password=_password)


def _serve(options: argparse.Namespace) -> int:
    from app.library.place import look_at
    from app.library.seal import check_key
    from app.serving.rules import Rules, cookie_secret, oauth_from

    rules = Rules(
        address=options.address,
        port=options.port,
        allow_origin=tuple(options.allow_origin),
        open=options.open,
        password_file=options.password_file,
        cookie_secret=cookie_secret(options.cookie_secret_file),
        oauth=oauth_from(
            options.oauth_provider, options.oauth_key, options.oauth_redirect_uri, tuple(options.oauth_allow)
        ),
        behind_proxy=options.behind_proxy,
        max_sessions=options.max_sessions,
        session_lifetime=options.session_lifetime,
        login_hours=options.login_hours,
        review_key=options.review_key,
        login_store=options.login_store or (options.library if options.library.startswith("postgres") else ""),
        max_message=round(1e6 * options.max_message) if math.isfinite(options.max_message) else 0,
        processes=options.processes,
        workers=options.workers,
        grace=options.grace,
        log=options.log,
    )
    rules.check()  # before the screen is loaded: a wrong command is refused at once
    if options.review_key is not None:
        check_key(options.review_key)
    try:
        warning = look_at(options.library)
    except InputError as error:
        raise error.under("--library") from error
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
