"""The host names under which this server answers.

A browser takes whatever address a name server gives: a foreign site's name that leads here ("DNS rebinding") would
make this server's pages that site's own. So the host name of a request is checked before anything else.
"""

import ipaddress
import re
import urllib.parse
from collections.abc import Sequence
from typing import Any

from tornado.httputil import HTTPServerRequest
from tornado.routing import Matcher, Rule
from tornado.web import RequestHandler

from app.serving.access import plain_page
from app.serving.rules import is_loopback

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
        try:
            self._everywhere = ipaddress.ip_address(address).is_unspecified
        except ValueError:
            self._everywhere = False

    def admit(self, host: str) -> bool:
        """Whether a request's Host, ``name`` or ``name:port``, is one of them."""
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
        return is_loopback(name) or (name == self._address and bool(name)) or (self._everywhere and _in_numbers(name))


def _in_numbers(name: str) -> bool:
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return False
    return True


class ForeignHost(Matcher):
    """Matches a request under a host name that is not this server's."""

    def __init__(self, hosts: Hosts) -> None:
        self._hosts = hosts

    def match(self, request: HTTPServerRequest) -> dict[str, Any] | None:
        """An empty dictionary if so."""
        known = len(request.headers.get_list("Host")) < 2 and self._hosts.admit(request.host)
        return None if known else {}


class NoPath(Matcher):
    """Matches a path with control characters, which the file handlers cannot handle."""

    def match(self, request: HTTPServerRequest) -> dict[str, Any] | None:
        """An empty dictionary if so."""
        return {} if _CONTROL.search(urllib.parse.unquote(request.path)) else None


class Refusal(RequestHandler):
    """The response to both, for every method."""

    def initialize(self, status: int, title: str, text: str) -> None:
        self._status, self._page = status, plain_page(title, text)

    def prepare(self) -> None:
        """Answer."""
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
    return [
        Rule(ForeignHost(hosts), Refusal, {"status": 421, "title": "Not under this name", "text": other_name}),
        Rule(NoPath(), Refusal, {"status": 400, "title": "No such page", "text": no_path}),
    ]
