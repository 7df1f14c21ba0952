"""Which headers say where a request behind a proxy comes from."""

from __future__ import annotations

import socket
from types import SimpleNamespace
from typing import Any

from tornado.httpserver import _HTTPRequestContext
from tornado.httputil import HTTPHeaders

from app.upstream import requests

_SENT = HTTPHeaders(
    {"X-Forwarded-For": "192.0.2.7", "X-Forwarded-Proto": "https", "X-Real-Ip": "127.0.0.1", "X-Scheme": "http"}
)


def _context() -> _HTTPRequestContext:
    stream: Any = SimpleNamespace(socket=SimpleNamespace(family=socket.AF_INET))
    return _HTTPRequestContext(stream, ("127.0.0.1", 1), None)


def test_as_shipped_a_visitor_chooses_an_address() -> None:
    context = _context()
    requests._shipped(context, _SENT)
    assert (context.remote_ip, context.protocol) == ("127.0.0.1", "http")


def test_what_the_proxy_says_holds() -> None:
    context = _context()
    requests._apply(context, _SENT)
    assert (context.remote_ip, context.protocol) == ("192.0.2.7", "https")
