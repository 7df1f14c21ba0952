"""`navbudget serve` on real sockets: who gets in, how many, what is told, and how it ends."""

from __future__ import annotations

import asyncio
import http.client
import json
import os
import re
import signal
import socket
import subprocess
import sys
import time
import urllib.parse
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from bokeh.util.token import generate_jwt_token, generate_session_id
from tornado.httpclient import HTTPClientError, HTTPRequest
from tornado.web import create_signed_value
from tornado.websocket import WebSocketClientConnection, WebSocketClosedError, websocket_connect

from app.cli import main
from app.serving.access import Tries
from app.serving.passwords import Passwords, password_line, read_passwords
from app.serving.rules import OAuth, Rules, cookie_secret, is_loopback, oauth_from
from nav_model.inputs import DesignError

PASSWORD = "correct horse battery"
_TOKEN = re.compile(r'"token":"([^"]+)"')
_XSRF = re.compile(r'name="_xsrf" value="([^"]+)"')


async def hang_up(connection: WebSocketClientConnection) -> None:
    connection.close()
    with suppress(TimeoutError):
        async with asyncio.timeout(0.5):
            while await connection.read_message() is not None:
                pass


@dataclass
class Served:
    """A running server and the cookies of one visitor."""

    process: subprocess.Popen[str]
    port: int
    cookies: dict[str, str] = field(default_factory=dict)

    def ask(
        self, path: str, body: dict[str, str] | None = None, **headers: str
    ) -> tuple[int, str, http.client.HTTPMessage]:
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=20)
        sent = {"Cookie": "; ".join(f"{k}={v}" for k, v in self.cookies.items()), **headers}
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

    def log_in(self, name: str, password: str, path: str = "/login") -> tuple[int, str, http.client.HTTPMessage]:
        found = _XSRF.search(self.ask(path)[1])
        assert found
        return self.ask(path, {"_xsrf": found[1], "username": name, "password": password})

    def token(self) -> str:
        """Of a newly opened page."""
        status, text, _ = self.ask("/")
        assert status == 200
        found = _TOKEN.search(text)
        assert found
        return found[1]

    async def connect(self, token: str, origin: str | None = None) -> WebSocketClientConnection:
        return await websocket_connect(
            HTTPRequest(
                f"ws://127.0.0.1:{self.port}/ws",
                headers={
                    "Origin": origin or f"http://127.0.0.1:{self.port}",
                    "Cookie": "; ".join(f"{k}={v}" for k, v in self.cookies.items()),
                },
            ),
            subprotocols=["bokeh", token],
        )

    def hello(self, token: str, origin: str | None = None) -> str | None:
        """The first thing the server says to a connection; None if it hangs up instead."""

        async def first() -> str | None:
            connection = await self.connect(token, origin)
            said = await asyncio.wait_for(connection.read_message(), 20)
            if said is not None:
                await hang_up(connection)
            return said if said is None else str(said)

        return asyncio.run(first())

    def refused(self, token: str, origin: str | None = None) -> int:
        """The status with which a connection is refused."""
        with pytest.raises(HTTPClientError) as caught:
            self.hello(token, origin)
        return int(caught.value.code)

    def metrics(self, **headers: str) -> dict[str, float]:
        status, text, _ = self.ask("/metrics", **headers)
        assert status == 200
        pairs = (line.rpartition(" ") for line in text.splitlines() if not line.startswith("#"))
        return {name: float(value) for name, _, value in pairs}


@contextmanager
def serving(*options: str, log: Path | None = None) -> Iterator[Served]:
    with open(log or os.devnull, "w") as errors:
        process = subprocess.Popen(
            [sys.executable, "-m", "app.cli", "serve", "--port", "0", *options],
            stdout=subprocess.PIPE,
            stderr=errors,
            text=True,
        )
        assert process.stdout is not None
        with process:
            line = process.stdout.readline()
            assert line.startswith("NavBudget on http://"), line
            try:
                yield Served(process, int(line.rpartition(":")[2]))
            finally:
                if process.poll() is None:
                    process.terminate()
                assert process.wait(timeout=20) == 0


@pytest.fixture(scope="module")
def people(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("people") / "people"
    path.write_text(f"# the team\n\n{password_line('ada', PASSWORD)}\n{password_line('bob', PASSWORD + '2')}\n")
    return path


@pytest.fixture(scope="module")
def guarded(people: Path) -> Iterator[Served]:
    with serving("--password-file", str(people)) as served:
        yield served


@pytest.fixture
def visitor(guarded: Served) -> Served:
    return Served(guarded.process, guarded.port)


# --- the door --------------------------------------------------------------------------------------------


def test_nothing_without_login(visitor: Served) -> None:
    status, _, headers = visitor.ask("/?arw=0.5deg/sqrt(h)")
    assert status == 302
    assert headers["Location"].startswith("./login?next=%2F%3Farw")
    forged = generate_jwt_token(generate_session_id())
    assert visitor.refused(forged) == 403
    assert visitor.ask("/autoload.js?bokeh-autoload-element=x")[0] == 404
    assert visitor.ask("/metadata")[0] == 404


def test_login_leads_to_where_the_visitor_was_going(visitor: Served) -> None:
    status, _, headers = visitor.log_in("ada", PASSWORD, "/login?next=%2F%3Farw%3D1")
    assert status == 302
    assert headers["Location"] == "/?arw=1"
    (user,) = (line for line in headers.get_all("Set-Cookie") or [] if line.startswith("user="))
    assert "HttpOnly" in user
    assert "SameSite=Lax" in user
    assert "ACK" in str(visitor.hello(visitor.token()))


@pytest.mark.parametrize(
    ("name", "password"),
    [("ada", PASSWORD + "2"), ("eve", PASSWORD), ("ada", ""), ("", ""), ("ada", "x" * 5000), ("<b>ada", PASSWORD)],
)
def test_wrong_password(visitor: Served, name: str, password: str) -> None:
    status, text, _ = visitor.log_in(name, password)
    assert status == 401
    assert "Name or password is wrong." in text
    assert "<b>" not in text
    assert "user" not in visitor.cookies
    assert visitor.ask("/")[0] == 302


def test_login_form_must_come_from_the_page(visitor: Served) -> None:
    assert visitor.ask("/login", {"username": "ada", "password": PASSWORD})[0] == 403
    assert "user" not in visitor.cookies


@pytest.mark.parametrize(
    "wanted", ["https://example.org/", "//example.org/", "/\\example.org", "javascript:alert(1)"]
)
def test_login_does_not_send_anybody_elsewhere(visitor: Served, wanted: str) -> None:
    assert visitor.ask(f"/login?next={urllib.parse.quote(wanted, safe='')}")[0] == 400


def test_forged_cookie(visitor: Served) -> None:
    for secret in ("", "secret", "x" * 64):
        visitor.cookies["user"] = create_signed_value(secret, "user", "ada").decode() if secret else "ada"
        assert visitor.ask("/")[0] == 302
        assert visitor.refused(generate_jwt_token(generate_session_id())) == 403


def test_a_session_nobody_was_given_is_not_opened(visitor: Served) -> None:
    visitor.log_in("ada", PASSWORD)
    assert visitor.hello(generate_jwt_token(generate_session_id())) is None
    assert visitor.refused("no.token") == 403
    forged = generate_jwt_token(generate_session_id(), secret_key=b"guess", signed=True)
    assert visitor.hello(forged) is None
    assert visitor.ask(f"/?bokeh-session-id={generate_session_id()}")[0] == 403


@pytest.mark.parametrize("origin", ["http://example.org", "null", "http://127.0.0.1", "http://127.0.0.1.example.org"])
def test_wrong_origin_on_the_websocket(visitor: Served, origin: str) -> None:
    visitor.log_in("ada", PASSWORD)
    assert visitor.refused(visitor.token(), origin) == 403


def test_logout(visitor: Served) -> None:
    visitor.log_in("ada", PASSWORD)
    assert visitor.ask("/")[0] == 200
    status, text, _ = visitor.ask("/logout")
    assert status == 200
    assert "http" not in text
    visitor.cookies = {name: value for name, value in visitor.cookies.items() if value != '""'}
    assert visitor.ask("/")[0] == 302


def test_who_is_taken_out_of_the_file_is_out(tmp_path: Path) -> None:
    people = tmp_path / "people"
    people.write_text(password_line("ada", PASSWORD) + "\n" + password_line("bob", PASSWORD))
    passwords = Passwords(people)
    assert passwords.knows("ada")
    assert passwords.fits("ada", PASSWORD)
    people.write_text(password_line("bob", PASSWORD + "!"))
    assert not passwords.knows("ada")
    assert not passwords.fits("ada", PASSWORD)
    assert not passwords.fits("bob", PASSWORD)
    assert passwords.fits("bob", PASSWORD + "!")
    people.write_text("broken")
    assert not passwords.knows("bob")
    people.unlink()
    assert not passwords.fits("bob", PASSWORD + "!")


def test_guessing_is_slowed() -> None:
    now = [0.0]
    tries = Tries(lambda: now[0])
    for _ in range(10):
        assert not tries.too_many("a")
        tries.failed("a")
    assert tries.too_many("a")
    assert not tries.too_many("b")
    now[0] = 61.0
    assert not tries.too_many("a")


# --- the command -----------------------------------------------------------------------------------------


def refusal(capsys: pytest.CaptureFixture[str], *options: str) -> str:
    assert main(["serve", *options]) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    return said


@pytest.mark.parametrize("address", ["0.0.0.0", "::", "192.0.2.1", "example.org"])
def test_off_loopback_needs_a_decision(capsys: pytest.CaptureFixture[str], address: str) -> None:
    said = refusal(capsys, "--address", address)
    assert address in said
    assert "--password-file" in said
    assert "--open" in said


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--max-sessions", "0"], "--max-sessions: 0 is outside 1 to 10000"),
        (["--port", "70000"], "--port"),
        (["--session-lifetime", "nan"], "--session-lifetime"),
        (["--max-message", "inf"], "--max-message"),
        (["--workers", "0"], "--workers"),
        (["--allow-origin", "*"], "--allow-origin"),
        (["--allow-origin", "https://example.org"], "--allow-origin"),
        (["--password-file", "/nowhere"], "/nowhere: No such file"),
        (["--oauth-provider", "github"], "--oauth-key"),
        (["--oauth-key", "id"], "needs --oauth-provider"),
        (["--cookie-secret-file", "/dev/null"], "holds 0 characters"),
    ],
)
def test_wrong_options(capsys: pytest.CaptureFixture[str], options: list[str], said: str) -> None:
    assert said in refusal(capsys, *options)


def test_open_contradicts_a_password_file(people: Path) -> None:
    with pytest.raises(DesignError, match="contradicts"):
        Rules(open=True, password_file=people).check()


@pytest.mark.parametrize(
    "text",
    ["", "# nobody", "ada", "ada:secret", "ada:scrypt$16384$8$1$AAAA$AAAA", "ada:scrypt$16383$8$1$$",
     "ada:scrypt$99999999999$8$1$AAAAAAAAAAAAAAAAAAAAAA==$" + "A" * 43 + "=", "\x00\xff"],
)  # fmt: skip
def test_a_wrong_password_file_is_refused_without_quoting_it(tmp_path: Path, text: str) -> None:
    path = tmp_path / "people"
    path.write_text(text, encoding="latin-1")
    with pytest.raises(DesignError) as caught:
        read_passwords(path)
    assert "secret" not in str(caught.value).replace(str(tmp_path), "")


def test_a_name_twice_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "people"
    path.write_text(f"{password_line('ada', PASSWORD)}\n{password_line('ada', PASSWORD)}")
    with pytest.raises(DesignError, match="second time"):
        read_passwords(path)


def test_password_command(tmp_path: Path) -> None:
    path = tmp_path / "people"
    with path.open("w") as out:
        subprocess.run(
            [sys.executable, "-m", "app.cli", "password", "ada"],
            input=PASSWORD + "\n",
            stdout=out,
            text=True,
            check=True,
        )
    assert Passwords(path).fits("ada", PASSWORD)
    assert PASSWORD not in path.read_text()
    for name, password in (("a:b", PASSWORD), ("#a", PASSWORD), ("ada", "short"), ("a\nb", PASSWORD)):
        with pytest.raises(DesignError):
            password_line(name, password)


def test_hash_is_scrypt_of_the_standard() -> None:
    """RFC 7914, section 12, third vector: what the file holds is scrypt, not something like it."""
    from app.serving.passwords import _key

    key = _key("pleaseletmein", b"SodiumChloride", 16384, 8, 1)
    assert key.hex() == "7023bdcb3afd7348461c06cd81fd38ebfda8fbba904f8e3ea9b543f6545da1f2"


def test_loopback() -> None:
    assert all(is_loopback(x) for x in ("127.0.0.1", "127.8.8.8", "::1", "localhost", "::ffff:127.0.0.1"))
    assert not any(is_loopback(x) for x in ("0.0.0.0", "::", "10.0.0.1", "localhost.example.org", "::ffff:10.0.0.1"))


def test_oauth_needs_its_parts_and_says_who_may_enter() -> None:
    environment = {"PANEL_OAUTH_SECRET": "s"}
    with pytest.raises(DesignError, match="PANEL_OAUTH_SECRET"):
        oauth_from("github", "id", None, ("ada",), {})
    with pytest.raises(DesignError, match="--oauth-allow"):
        oauth_from("github", "id", None, (), environment)
    oauth = oauth_from("github", "id", None, ("ada", "@example.org"), environment)
    assert isinstance(oauth, OAuth)
    assert all(oauth.admits(x) for x in ("ada", "Ada", "bob@example.org"))
    assert not any(
        oauth.admits(x) for x in ("bob", "ada@evil.org", "x@example.org.evil", "@example.org@evil", "None")
    )


def test_oauth_sends_to_the_provider(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PANEL_OAUTH_SECRET", "secret-of-the-client")
    with serving("--oauth-provider", "github", "--oauth-key", "the-id", "--oauth-allow", "ada") as served:
        assert served.ask("/")[2]["Location"].startswith("./login")
        _, _, headers = served.ask("/login")
        assert headers["Location"].startswith("https://github.com/login/oauth/authorize?")
        assert "client_id=the-id" in headers["Location"]
        assert "secret-of-the-client" not in str(headers)
        assert served.refused(generate_jwt_token(generate_session_id())) == 403


def test_cookie_secret_outlives_a_restart(tmp_path: Path) -> None:
    assert cookie_secret(None) != cookie_secret(None)
    path = tmp_path / "secret"
    path.write_text("s" * 40 + "\n")
    assert cookie_secret(path) == "s" * 40


# --- limits, health, what the operator sees --------------------------------------------------------------


def test_session_limit(tmp_path: Path) -> None:
    with serving("--max-sessions", "2", "--session-lifetime", "1") as served:

        async def crowd() -> None:
            loop = asyncio.get_running_loop()
            tokens = [await loop.run_in_executor(None, served.token) for _ in range(2)]
            connections = [await served.connect(token) for token in tokens]
            for connection in connections:
                assert "ACK" in str(await connection.read_message())
            status, text, headers = await loop.run_in_executor(None, served.ask, "/?f=9GHz")
            assert status == 503
            assert headers["Retry-After"] == "60"
            assert "All places are taken" in text
            connections.append(await served.connect(tokens[0]))  # the same page again is not a new session
            for connection in connections:
                await hang_up(connection)

        asyncio.run(crowd())
        metrics = served.metrics()
        assert metrics["navbudget_sessions_limit"] == 2
        assert metrics["navbudget_sessions_refused_total"] == 1
        deadline = time.monotonic() + 20
        while served.ask("/")[0] == 503:
            assert time.monotonic() < deadline, "closed pages keep their places"
            time.sleep(0.2)


def test_metrics_and_liveness(visitor: Served) -> None:
    assert visitor.ask("/liveness")[0] == 200
    before = visitor.metrics()
    visitor.log_in("ada", PASSWORD)
    visitor.token()
    after = visitor.metrics()
    assert after["navbudget_sessions_opened_total"] == before["navbudget_sessions_opened_total"] + 1
    assert after["navbudget_sessions"] >= 1
    assert after["navbudget_uptime_seconds"] > before["navbudget_uptime_seconds"] > 0
    assert 5e7 < after["process_resident_memory_bytes"] < 2e9


def test_metrics_are_not_for_a_forwarded_stranger(visitor: Served) -> None:
    stranger = {"X-Forwarded-For": "192.0.2.7"}
    assert visitor.ask("/metrics", **stranger)[0] == 403
    visitor.log_in("ada", PASSWORD)
    assert visitor.ask("/metrics", **stranger)[0] == 200


def test_behind_a_proxy_the_visitor_is_who_the_proxy_says(people: Path, tmp_path: Path) -> None:
    log = tmp_path / "log"
    with serving("--password-file", str(people), "--behind-proxy", "--log", "json", log=log) as served:
        assert served.ask("/metrics", **{"X-Forwarded-For": "192.0.2.7"})[0] == 403
        found = _XSRF.search(served.ask("/login")[1])
        assert found
        body = {"_xsrf": found[1], "username": "ada", "password": PASSWORD}
        _, _, headers = served.ask("/login", body, **{"X-Forwarded-For": "192.0.2.7", "X-Forwarded-Proto": "https"})
        (user,) = (line for line in headers.get_all("Set-Cookie") or [] if line.startswith("user="))
        assert "Secure" in user
    assert any(
        e.get("event") == "login" and e["peer"] == "192.0.2.7" for e in map(json.loads, log.read_text().splitlines())
    )


def test_every_answer_keeps_other_sites_out(visitor: Served) -> None:
    for path in ("/login", "/liveness", "/metrics", "/nowhere", "/static/js/bokeh.min.js"):
        headers = visitor.ask(path)[2]
        assert "frame-ancestors 'none'" in headers["Content-Security-Policy"]
        assert headers["X-Content-Type-Options"] == "nosniff"
        assert "Tornado" not in headers["Server"]


def test_oversized_requests_do_not_stop_the_server(visitor: Served) -> None:
    with socket.create_connection(("127.0.0.1", visitor.port), timeout=20) as raw:
        raw.sendall(b"POST /login HTTP/1.1\r\nHost: localhost\r\nContent-Length: 10000000\r\n\r\n")
        assert raw.recv(100).startswith((b"HTTP/1.1 400", b"HTTP/1.1 413"))
    visitor.log_in("ada", PASSWORD)
    token = visitor.token()

    async def flood() -> int | None:
        connection = await visitor.connect(token)
        await connection.read_message()
        with suppress(WebSocketClosedError):
            await connection.write_message("x" * 21_000_000)
        await hang_up(connection)
        return connection.close_code

    assert asyncio.run(flood()) in {1006, 1009, None}
    assert visitor.ask("/liveness")[0] == 200


def test_json_log_never_says_what_a_design_says(tmp_path: Path) -> None:
    log = tmp_path / "log"
    with serving("--log", "json", log=log) as served:
        served.ask("/?n=SECRETNAME&arw=0.777deg/sqrt(h)")
        served.ask("/?n=SECRETNAME&arw=SECRETVALUE")
        served.ask("/SECRETPATH?x=SECRETVALUE")
        token = served.token()

        async def rubbish() -> None:
            connection = await served.connect(token)
            await connection.read_message()
            await connection.write_message('{"SECRETMESSAGE": 1}')
            await hang_up(connection)

        asyncio.run(rubbish())
    text = log.read_text()
    events = [json.loads(line) for line in text.splitlines()]
    assert {"started", "request", "session opened", "stopped"} <= {e.get("event") for e in events}
    assert not re.search("SECRET(NAME|VALUE|MESSAGE)|0\\.777", text)
    assert token not in text


# --- the end ---------------------------------------------------------------------------------------------


def children_of(pid: int) -> set[int]:
    found = subprocess.run(["ps", "-o", "pid=", "--ppid", str(pid)], capture_output=True, text=True, check=False)
    direct = {int(word) for word in found.stdout.split()}
    return direct.union(*(children_of(child) for child in direct)) if direct else direct


@pytest.mark.parametrize("signal_number", [signal.SIGTERM, signal.SIGINT])
def test_a_signal_leaves_no_process(signal_number: signal.Signals) -> None:
    code = (
        "import asyncio, time, threading, app.server as s, app.workers as w\n"
        "from app.serving.rules import Rules\n"
        "from tornado.ioloop import IOLoop\n"
        "if __name__ == '__main__':\n"
        "    loop = IOLoop.current().asyncio_loop\n"
        "    loop.call_later(0.1, lambda: asyncio.ensure_future(w.elsewhere(time.sleep, 600), loop=loop))\n"
        "    s.serve(Rules(port=0, grace=0.5, workers=2))\n"
    )
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stdout.readline().startswith("NavBudget on")
        deadline = time.monotonic() + 20
        while len(family := children_of(process.pid)) < 2:  # a worker and the tracker of shared resources
            assert time.monotonic() < deadline
            time.sleep(0.05)
        began = time.monotonic()
        process.send_signal(signal_number)
        assert process.wait(timeout=15) == 0
        assert time.monotonic() - began < 8
    deadline = time.monotonic() + 5
    while alive := {pid for pid in family if Path(f"/proc/{pid}").exists()}:
        assert time.monotonic() < deadline, f"still running: {alive}"
        time.sleep(0.05)
