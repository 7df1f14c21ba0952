"""The socket of a server, where a request comes from behind a proxy, and addresses that Panel stumbles at as shipped.

That foreign hosts and paths that are not offered get nothing is shown in tests/app/serving.
"""

import asyncio
import socket
from types import SimpleNamespace
from typing import Any

import bokeh.server.server
import pytest
from bokeh.server.server import BaseServer
from panel.io import location
from tornado.httpserver import _HTTPRequestContext
from tornado.httputil import HTTPHeaders

from app.upstream import requests

pytestmark = pytest.mark.watches("app/upstream", "docs/upstream")

_SHIPPED = location._get_location_params


def test_what_the_proxy_says_holds() -> None:
    stream: Any = SimpleNamespace(socket=SimpleNamespace(family=socket.AF_INET))
    context = _HTTPRequestContext(stream, ("127.0.0.1", 1), None)
    by_proxy = {"X-Forwarded-For": "192.0.2.7", "X-Forwarded-Proto": "https"}
    requests._apply(context, HTTPHeaders(by_proxy | {"X-Real-Ip": "127.0.0.1", "X-Scheme": "http"}))
    assert (context.remote_ip, context.protocol) == ("192.0.2.7", "https")


@pytest.mark.parametrize(("host", "uri"), [("[::1]:5006", "/"), ("a", "/?b=c?d")])
def test_every_address_is_taken_apart(host: str, uri: str) -> None:
    result = requests._params("http", host, uri)
    assert result["href"] == f"http://{host}{uri}"
    assert result["pathname"] == "/"
    assert result.get("search", "") == uri[1:]


@pytest.mark.parametrize("host", ["127.0.0.1:5006", "server.example"])
@pytest.mark.parametrize("uri", ["/", "/?f=9GHz", "/ws?f=9GHz&arw=0.5deg/sqrt(h)"])
def test_plain_addresses_are_as_ever(host: str, uri: str) -> None:
    assert requests._params("https", host, uri) == _SHIPPED("https", host, uri)


async def test_open_connections_stay_open() -> None:
    done: list[str] = []

    async def cut() -> None:
        done.append("cut")

    loop = asyncio.get_running_loop()
    server = BaseServer.__new__(BaseServer)
    server._http = SimpleNamespace(stop=lambda: done.append("closed"), close_all_connections=cut)
    server._loop = SimpleNamespace(add_callback=lambda work: loop.create_task(work()))
    requests.stop_accepting(server)
    await asyncio.sleep(0)
    await asyncio.sleep(0)
    assert done == ["closed"]


def test_it_takes_the_socket_it_is_given(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bokeh.server.server, "bind_sockets", bokeh.server.server.bind_sockets)
    with socket.create_server(("127.0.0.1", 0)) as listening:
        port = listening.getsockname()[1]
        requests.listen_on(listening, port)
        server = bokeh.server.server.Server({}, port=1, address="192.0.2.1")
        assert server.port == port
        server._http.stop()
