"""Behind a proxy, a visitor's address and protocol are what X-Forwarded-For and X-Forwarded-Proto say.

Tornado prefers X-Real-Ip and X-Scheme, which most proxies hand on as a visitor sent them: anybody could take any
address, also this machine's own, to which the metrics are open.

Written for: Tornado 6.6.1
Upstream: tornadoweb/tornado#2579 (open)
Needless when: tests/app/upstream/test_proxy_headers.py::test_as_shipped_a_visitor_chooses_an_address fails
"""

from __future__ import annotations

from tornado.httpserver import _HTTPRequestContext
from tornado.httputil import HTTPHeaders

_SET_BY_PROXIES = ("X-Forwarded-For", "X-Forwarded-Proto")
_shipped = _HTTPRequestContext._apply_xheaders


def believe_proxies_only() -> None:
    """Have every server of this process leave out what proxies hand on."""
    _HTTPRequestContext._apply_xheaders = _apply  # type: ignore[method-assign]


def _apply(self: _HTTPRequestContext, headers: HTTPHeaders) -> None:
    _shipped(self, HTTPHeaders({name: headers[name] for name in _SET_BY_PROXIES if name in headers}))
