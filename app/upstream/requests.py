"""Which requests are answered, and what of them is believed.

Rules before every route of the server, including the websocket's and the static files'.

Bokeh takes further routes behind its own only, and answers under any name that a request was made under.

Written for: Panel 1.9.4, Bokeh 3.9.2, Tornado 6.6.1
Upstream: none found, searched 2026-11-22
Needless when: tests/app/upstream/test_ask_first.py::test_as_shipped_a_foreign_host_is_served fails

Behind a proxy, a visitor's address and protocol are what X-Forwarded-For and X-Forwarded-Proto say.

Tornado prefers X-Real-Ip and X-Scheme, which most proxies hand on as a visitor sent them: anybody could take any
address, also this machine's own, to which the metrics are open.

Written for: Tornado 6.6.1
Upstream: tornadoweb/tornado#2579 (open)
Needless when: tests/app/upstream/test_proxy_headers.py::test_as_shipped_a_visitor_chooses_an_address fails

A page opens at every address that a browser may send.

Panel takes the address of a request apart at each ":" and "?": an IPv6 host, or a second "?" in a query, ends in an
exception while the session is made, and the visitor sees an empty page.

Written for: Panel 1.9.4
Upstream: none found, searched 2026-11-22
Needless when: tests/app/upstream/test_request_location.py::test_as_shipped_some_addresses_are_a_fault fails

Only the page and its connection are served.

Bokeh also offers each page as a script for other sites, its metadata, and a session over a plain request, with no
switch to leave them out.

Written for: Panel 1.9.4, Bokeh 3.9.2
Upstream: none found, searched 2026-11-22
Needless when: tests/app/upstream/test_routes.py::test_as_shipped_the_page_is_offered_to_other_sites fails
"""

from __future__ import annotations

from collections.abc import Sequence
from urllib.parse import urlsplit

import panel.io.location
from bokeh.server.server import BaseServer
from bokeh.server.urls import per_app_patterns
from tornado.httpserver import _HTTPRequestContext
from tornado.httputil import HTTPHeaders
from tornado.routing import Rule
from tornado.web import RequestHandler


def ask_first(server: BaseServer, rules: Sequence[Rule]) -> None:
    """Check each request by these rules first."""
    server._tornado.default_router.rules[:0] = rules


_SET_BY_PROXIES = ("X-Forwarded-For", "X-Forwarded-Proto")
_shipped = _HTTPRequestContext._apply_xheaders


def believe_proxies_only() -> None:
    """Have every server of this process leave out what proxies hand on."""
    _HTTPRequestContext._apply_xheaders = _apply  # type: ignore[method-assign]


def _apply(self: _HTTPRequestContext, headers: HTTPHeaders) -> None:
    _shipped(self, HTTPHeaders({name: headers[name] for name in _SET_BY_PROXIES if name in headers}))


def _params(protocol: str | None, host: str | None, uri: str | None) -> dict[str, str]:
    href = (f"{protocol}:" if protocol else "") + (f"//{host}" if host else "") + (uri or "")
    # A request's path never has the host in it; "//a" would be taken for one.
    at = urlsplit(f"//{host or ''}")
    path, _, search = (uri or "").partition("?")
    found = {"protocol": f"{protocol}:" if protocol else "", "hostname": at.hostname or "", "href": href,
             "port": str(at.port or ""), "pathname": path, "search": f"?{search}" if search else ""}  # fmt: skip
    return {name: value for name, value in found.items() if value}


def read_any_address() -> None:
    """Install the override; the server calls it once, before it serves."""
    panel.io.location._get_location_params = _params


def serve_only(page: type[RequestHandler], connection: type[RequestHandler]) -> None:
    """Have the next server of this process answer with these two, the page's path and the connection's below it."""
    per_app_patterns[:] = [(r"/ws", connection), (r"/?", page)]
