"""The server listens on a socket that it is given, and a server that stops finishes the responses in progress.

Reports to send upstream, versions and ends: docs/upstream/listening.md
"""

import socket

import bokeh.server.server
from bokeh.server.server import BaseServer


def let_nobody_new_in(server: BaseServer) -> None:
    """Stop listening; open connections stay open."""
    server._http.stop()


def listen_on(listening: socket.socket, port: int) -> None:
    """Have the next server of this process use a socket that listens already."""
    bokeh.server.server.bind_sockets = lambda *_: ([listening], port)
