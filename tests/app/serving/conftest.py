"""`navbudget serve` as a process, and a visitor that speaks to it over raw sockets."""

import asyncio
import http.client
import re
import ssl
import subprocess
import urllib.parse
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from served import serving as serving_process
from tornado.httpclient import HTTPClientError, HTTPRequest
from tornado.websocket import WebSocketClientConnection, websocket_connect
from waiting import PATIENCE

from app.serving.passwords import password_line

_PASSWORD = "correct horse battery"
_TOKEN = re.compile(r'"token":"([^"]+)"')
_XSRF = re.compile(r'name="_xsrf" value="([^"]+)"')


@dataclass
class Served:
    """A running server and the cookies of one visitor, who may come through a proxy: over TLS, to a name."""

    process: subprocess.Popen[str]
    port: int
    cookies: dict[str, str] = field(default_factory=dict)
    trusting: ssl.SSLContext | None = None
    name: str = ""

    @property
    def address(self) -> str:
        return f"http{'s' if self.trusting else ''}://{self.name or f'127.0.0.1:{self.port}'}"

    @property
    def sent(self) -> dict[str, str]:
        """Headers of every request."""
        cookies = "; ".join(f"{key}={value}" for key, value in self.cookies.items())
        return {"Cookie": cookies, **({"Host": self.name} if self.name else {})}

    def ask(
        self, path: str, body: dict[str, str] | None = None, **headers: str
    ) -> tuple[int, str, http.client.HTTPMessage]:
        if self.trusting:
            connection = http.client.HTTPSConnection("127.0.0.1", self.port, context=self.trusting, timeout=PATIENCE)
        else:
            connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=PATIENCE)
        sent = self.sent | headers
        if body is not None:
            sent["Content-Type"] = "application/x-www-form-urlencoded"
        connection.request(
            "GET" if body is None else "POST", path, None if body is None else urllib.parse.urlencode(body), sent
        )
        answer = connection.getresponse()
        text = answer.read().decode()
        for line in answer.headers.get_all("Set-Cookie") or []:
            name, _, rest = line.partition("=")
            self.cookies[name] = rest.split(";")[0]
        connection.close()
        return answer.status, text, answer.headers

    def log_in(
        self, name: str, password: str, path: str = "/login", form: str = "", **headers: str
    ) -> tuple[int, str, http.client.HTTPMessage]:
        """By the form of the path, or of another one."""
        match = _XSRF.search(self.ask(form or path)[1])
        return self.ask(path, {"_xsrf": match[1], "username": name, "password": password}, **headers)

    def log_out(self) -> tuple[int, str, http.client.HTTPMessage]:
        match = _XSRF.search(self.ask("/logout")[1])
        return self.ask("/logout", {"_xsrf": match[1]})

    def token(self, path: str = "/") -> str:
        """Of a newly opened page."""
        status, text, _ = self.ask(path)
        assert status == 200
        return _TOKEN.search(text)[1]

    async def connect(
        self, token: str, origin: str | None = None, search: str = "", **headers: str
    ) -> WebSocketClientConnection:
        """As a page does, whose address goes on like this behind its path."""
        return await websocket_connect(
            HTTPRequest(
                f"ws{'s' if self.trusting else ''}://127.0.0.1:{self.port}/ws{search}",
                headers=self.sent | {"Origin": origin or self.address} | headers,
                validate_cert=False,
                ssl_options=self.trusting,
            ),
            subprotocols=["bokeh", token],
        )

    async def enter(self, token: str = "", **headers: str) -> WebSocketClientConnection:
        """A connection that is let in, of a newly opened page or that of a token."""
        connection = await self.connect(token or await asyncio.to_thread(self.token), **headers)
        assert "ACK" in str(await connection.read_message())
        return connection

    @staticmethod
    async def hang_up(*connections: WebSocketClientConnection) -> None:
        """Close and let the server know."""
        for connection in connections:
            connection.close()
            async with asyncio.timeout(PATIENCE):
                while await connection.read_message() is not None:
                    pass

    def hello(self, token: str, origin: str | None = None, search: str = "", **headers: str) -> str | None:
        """The first thing the server says to a connection; None if it hangs up instead."""

        async def first() -> str | None:
            connection = await self.connect(token, origin, search, **headers)
            message = await asyncio.wait_for(connection.read_message(), PATIENCE)
            if message is not None:
                await self.hang_up(connection)
            return message if message is None else str(message)

        return asyncio.run(first())

    def refused(self, token: str, origin: str | None = None, **headers: str) -> int:
        """The status with which a connection is refused."""
        with pytest.raises(HTTPClientError) as caught:
            self.hello(token, origin, **headers)
        return int(caught.value.code)

    def metrics(self, **headers: str) -> dict[str, float]:
        status, text, _ = self.ask("/metrics", **headers)
        assert status == 200
        pairs = (line.rpartition(" ") for line in text.splitlines() if not line.startswith("#"))
        return {name: float(value) for name, _, value in pairs}


@contextmanager
def _serving(*options: str, **named: Any) -> Iterator[Served]:
    with serving_process(*options, **named) as (address, process):
        yield Served(process, int(address.rpartition(":")[2]))


@pytest.fixture(scope="session")
def serving() -> Callable[..., Any]:
    """A context manager: a server started with options, seen by a visitor without cookies."""
    return _serving


@pytest.fixture(scope="session")
def people(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("people") / "people"
    path.write_text(f"# the team\n\n{password_line('ada', _PASSWORD)}\n{password_line('bob', _PASSWORD + '2')}\n")
    return path


@pytest.fixture(scope="session")
def guarded(people: Path) -> Iterator[Served]:
    with _serving("--password-file", str(people), "--processes", "1") as served:
        yield served


@pytest.fixture
def visitor(guarded: Served) -> Served:
    return Served(guarded.process, guarded.port)
