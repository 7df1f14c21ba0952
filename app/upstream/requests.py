"""Where the server listens, which requests are answered, and what of them is believed.

It listens on a socket that it is given, and finishes the responses in progress when it stops. Rules come before every
route of the server, including the websocket's and the static files'; a visitor's address and protocol are what
X-Forwarded-For and X-Forwarded-Proto say; a page opens at every address that a browser may send; and only the page
and its connection are served.

Reports to send upstream, versions and ends: docs/upstream/requests.md
"""

import socket
from collections.abc import Sequence
from urllib.parse import urlsplit

import bokeh.server.server
import panel.io.location
from bokeh.server.server import BaseServer
from bokeh.server.urls import per_app_patterns
from tornado.httpserver import _HTTPRequestContext
from tornado.httputil import HTTPHeaders
from tornado.routing import Rule
from tornado.web import RequestHandler


def listen_on(listening: socket.socket, port: int) -> None:
    """Have the next server of this process use a socket that listens already."""
    bokeh.server.server.bind_sockets = lambda *_: ([listening], port)


def stop_accepting(server: BaseServer) -> None:
    """Stop listening; open connections stay open."""
    server._http.stop()


def ask_first(server: BaseServer, rules: Sequence[Rule]) -> None:
    """Check each request by these rules first."""
    server._tornado.default_router.rules[:0] = rules


_SET_BY_PROXIES = ("X-Forwarded-For", "X-Forwarded-Proto")
_shipped = _HTTPRequestContext._apply_xheaders


def trust_proxies_only() -> None:
    """Have every server of this process leave out what proxies hand on."""
    _HTTPRequestContext._apply_xheaders = _apply  # type: ignore[method-assign]


def _apply(self: _HTTPRequestContext, headers: HTTPHeaders) -> None:
    _shipped(self, HTTPHeaders({name: headers[name] for name in _SET_BY_PROXIES if name in headers}))


def _params(protocol: str | None, host: str | None, uri: str | None) -> dict[str, str]:
    href = (f"{protocol}:" if protocol else "") + (f"//{host}" if host else "") + (uri or "")
    # A request's path never has the host in it; "//a" would be taken for one.
    at = urlsplit(f"//{host or ''}")
    path, _, search = (uri or "").partition("?")
    values = {"protocol": f"{protocol}:" if protocol else "", "hostname": at.hostname or "", "href": href,
             "port": str(at.port or ""), "pathname": path, "search": f"?{search}" if search else ""}  # fmt: skip
    return {name: value for name, value in values.items() if value}


def read_any_address() -> None:
    """Install the override; the server calls it once, before it serves."""
    panel.io.location._get_location_params = _params


def serve_only(page: type[RequestHandler], connection: type[RequestHandler]) -> None:
    """Have the next server of this process answer with these two, the page's path and the connection's below it."""
    per_app_patterns[:] = [(r"/ws", connection), (r"/?", page)]
