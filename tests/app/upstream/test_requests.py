"""Where a request comes from behind a proxy, and addresses that Panel stumbles at as shipped.

That foreign hosts and paths that are not offered get nothing is shown in tests/app/serving.
"""

import socket
from types import SimpleNamespace
from typing import Any

import pytest
from panel.io import location
from tornado.httpserver import _HTTPRequestContext
from tornado.httputil import HTTPHeaders

from app.upstream import requests

_SHIPPED = location._get_location_params


def test_what_the_proxy_says_holds() -> None:
    stream: Any = SimpleNamespace(socket=SimpleNamespace(family=socket.AF_INET))
    context = _HTTPRequestContext(stream, ("127.0.0.1", 1), None)
    by_proxy = {"X-Forwarded-For": "192.0.2.7", "X-Forwarded-Proto": "https"}
    requests._apply(context, HTTPHeaders(by_proxy | {"X-Real-Ip": "127.0.0.1", "X-Scheme": "http"}))
    assert (context.remote_ip, context.protocol) == ("192.0.2.7", "https")


@pytest.mark.parametrize(("host", "uri"), [("[::1]:5006", "/"), ("a", "/?b=c?d")])
def test_every_address_is_taken_apart(host: str, uri: str) -> None:
    found = requests._params("http", host, uri)
    assert found["href"] == f"http://{host}{uri}"
    assert found["pathname"] == "/"
    assert found.get("search", "") == uri[1:]


@pytest.mark.parametrize("host", ["127.0.0.1:5006", "server.example"])
@pytest.mark.parametrize("uri", ["/", "/?f=9GHz", "/ws?f=9GHz&arw=0.5deg/sqrt(h)"])
def test_plain_addresses_are_as_ever(host: str, uri: str) -> None:
    assert requests._params("https", host, uri) == _SHIPPED("https", host, uri)
