"""Only the page and its connection are served.

Bokeh also offers each page as a script for other sites, its metadata, and a session over a plain request, with no
switch to leave them out.

Written for: Panel 1.9.4, Bokeh 3.9.2
Upstream: none found, searched 2026-11-22
Needless when: tests/app/upstream/test_routes.py::test_as_shipped_the_page_is_offered_to_other_sites fails
"""

from __future__ import annotations

from bokeh.server.urls import per_app_patterns
from tornado.web import RequestHandler


def serve_only(page: type[RequestHandler], connection: type[RequestHandler]) -> None:
    """Have the next server of this process answer with these two, the page's path and the connection's below it."""
    per_app_patterns[:] = [(r"/ws", connection), (r"/?", page)]
