"""The server listens on a socket that it is given, and stops listening before it stops.

A server that stops finishes the responses in progress.

Bokeh's way to stop listening also closes every connection at the next turn of the event loop, with responses in
progress.

Written for: Bokeh 3.9.2
Upstream: none found, searched 2026-11-22
Needless when: tests/app/upstream/test_answers_in_progress.py::test_as_shipped_open_connections_are_cut fails

The server listens on an existing socket.

Several processes share one socket, and a port must be taken before anything slow is imported. Bokeh binds a socket of
its own, by address and port.

Written for: Panel 1.9.4, Bokeh 3.9.2
Upstream: bokeh/bokeh#13812 (closed, no action), bokeh/bokeh#12091 (merged: Unix sockets only)
Needless when: tests/app/upstream/test_given_socket.py::test_as_shipped_the_server_binds_by_itself fails
"""

from __future__ import annotations

import socket

import bokeh.server.server
from bokeh.server.server import BaseServer


def let_nobody_new_in(server: BaseServer) -> None:
    """Stop listening; open connections stay open."""
    server._http.stop()


def listen_on(listening: socket.socket, port: int) -> None:
    """Have the next server of this process use a socket that listens already."""
    bokeh.server.server.bind_sockets = lambda *_: ([listening], port)
