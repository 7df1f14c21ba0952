"""A server that stops ends what it is just answering.

Bokeh's own way to listen no longer also closes every connection at the next turn, and what is being answered with it.

Written for: Bokeh 3.9.2
Upstream: none found, searched 2026-11-22
Needless when: tests/app/upstream/test_answers_in_progress.py::test_as_shipped_open_connections_are_cut fails
"""

from __future__ import annotations

from bokeh.server.server import BaseServer


def let_nobody_new_in(server: BaseServer) -> None:
    """Listen no longer; what is open stays open."""
    server._http.stop()
