"""The host names under which this server answers.

A browser takes whatever address a name server gives: a foreign site's name that leads here ("DNS rebinding") would
make this server's pages that site's own. So the host name of a request is checked before anything else.
"""

import re
import urllib.parse
from collections.abc import Callable, Sequence
from typing import Any

from tornado.httputil import HTTPServerRequest
from tornado.routing import Matcher, Rule
from tornado.web import RequestHandler

from app.serving.access import plain_page
from app.serving.rules import in_numbers, is_everywhere, is_loopback

_CONTROL = re.compile(r"[\x00-\x1f\x7f]")


class Hosts:
    """The names a server answers under.

    Loopback names and the address it listens on, at any port (a forwarded port may differ); the names of
    ``--allow-origin``, exactly; and every numeric address if it listens on all, as these do not depend on a name
    server.
    """

    def __init__(self, address: str, allowed: Sequence[str]) -> None:
        self._address = address.casefold()
        self._allowed = {name.casefold() for name in allowed}
        self._everywhere = is_everywhere(address)

    def admit(self, host: str) -> bool:
        """True if a request's Host, ``name`` or ``name:port``, is one of them."""
        host = host.casefold()
        try:
            place = urllib.parse.urlsplit(f"//{host}")
            name, port = place.hostname or "", place.port
        except ValueError:
            return False
        if place.netloc != host or "@" in host:
            return False
        if host in self._allowed or (port in (80, 443) and name in self._allowed):
            return True
        if is_loopback(name) or (name == self._address and bool(name)):
            return True
        return self._everywhere and in_numbers(name) is not None


class _If(Matcher):
    """Matches the requests for which a test holds."""

    def __init__(self, test: Callable[[HTTPServerRequest], bool]) -> None:
        self._test = test

    def match(self, request: HTTPServerRequest) -> dict[str, Any] | None:
        return {} if self._test(request) else None


class Refusal(RequestHandler):
    """The response to both, for every method."""

    def initialize(self, status: int, title: str, text: str) -> None:
        self._status, self._page = status, plain_page(title, text)

    def prepare(self) -> None:
        """Send the status and the page that says why."""
        self.set_status(self._status)
        self.set_header("Cache-Control", "no-store")
        self.finish(self._page)


def first_rules(hosts: Hosts) -> list[Rule]:
    """The rules before every route."""
    other_name = (
        "This server does not answer under the name in the address. Open it under its own name; its operator can "
        "allow another one with --allow-origin HOST or HOST:PORT."
    )
    no_path = "The address holds characters that no address here has."

    def foreign(request: HTTPServerRequest) -> bool:
        return len(request.headers.get_list("Host")) > 1 or not hosts.admit(request.host)

    def unreadable(request: HTTPServerRequest) -> bool:  # by the handlers of files
        return bool(_CONTROL.search(urllib.parse.unquote(request.path)))

    return [
        Rule(_If(foreign), Refusal, {"status": 421, "title": "Not under this name", "text": other_name}),
        Rule(_If(unreadable), Refusal, {"status": 400, "title": "No such page", "text": no_path}),
    ]
