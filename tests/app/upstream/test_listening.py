"""The server listens on the socket it is given, and when it stops listening it finishes what is in progress."""

import asyncio
import socket
from types import SimpleNamespace

import bokeh.server.server
import pytest
from bokeh.server.server import BaseServer

from app.upstream.listening import let_nobody_new_in, listen_on


async def test_open_connections_stay_open() -> None:
    done: list[str] = []

    async def cut() -> None:
        done.append("cut")

    loop = asyncio.get_running_loop()
    server = BaseServer.__new__(BaseServer)
    server._http = SimpleNamespace(stop=lambda: done.append("closed"), close_all_connections=cut)
    server._loop = SimpleNamespace(add_callback=lambda work: loop.create_task(work()))
    let_nobody_new_in(server)
    await asyncio.sleep(0)
    await asyncio.sleep(0)
    assert done == ["closed"]


def test_it_takes_the_socket_it_is_given(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bokeh.server.server, "bind_sockets", bokeh.server.server.bind_sockets)
    with socket.create_server(("127.0.0.1", 0)) as listening:
        port = listening.getsockname()[1]
        listen_on(listening, port)
        server = bokeh.server.server.Server({}, port=1, address="192.0.2.1")
        assert server.port == port
        server._http.stop()
