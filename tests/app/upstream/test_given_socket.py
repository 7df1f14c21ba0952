"""The server listens on the given socket."""

from __future__ import annotations

import socket
from typing import Any

import bokeh.server.server
import pytest

from app.upstream.listening import listen_on


def test_as_shipped_the_server_binds_by_itself(shipped: dict[str, Any]) -> None:
    assert shipped["binds"]


def test_it_takes_the_socket_it_is_given(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bokeh.server.server, "bind_sockets", bokeh.server.server.bind_sockets)
    with socket.create_server(("127.0.0.1", 0)) as listening:
        port = listening.getsockname()[1]
        listen_on(listening, port)
        server = bokeh.server.server.Server({}, port=1, address="192.0.2.1")
        assert server.port == port
        server._http.stop()
