"""A server that stops finishes the responses in progress.

Bokeh's way to stop listening also closes every connection at the next turn of the event loop, with responses in
progress.

Written for: Bokeh 3.9.2
Upstream: none found, searched 2026-11-22
Needless when: tests/app/upstream/test_answers_in_progress.py::test_as_shipped_open_connections_are_cut fails
"""

from __future__ import annotations

from bokeh.server.server import BaseServer


def let_nobody_new_in(server: BaseServer) -> None:
    """Stop listening; open connections stay open."""
    server._http.stop()
