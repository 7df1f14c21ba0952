"""Rules before every route of the server, including the websocket's and the static files'.

Bokeh takes further routes behind its own only, and answers under any name that a request was made under.

Written for: Panel 1.9.4, Bokeh 3.9.2, Tornado 6.6.1
Upstream: none found, searched 2026-11-22
Needless when: tests/app/upstream/test_ask_first.py::test_as_shipped_a_foreign_host_is_served fails
"""

from __future__ import annotations

from collections.abc import Sequence

from bokeh.server.server import BaseServer
from tornado.routing import Rule


def ask_first(server: BaseServer, rules: Sequence[Rule]) -> None:
    """Check each request by these rules first."""
    server._tornado.default_router.rules[:0] = rules
