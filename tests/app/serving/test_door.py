"""Access: nothing without login, no forged login, and no redirect to other hosts."""

import asyncio
import base64
import json
import urllib.parse
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from bokeh.util.token import generate_jwt_token, generate_session_id, get_session_id
from tornado.web import create_signed_value
from waiting import PATIENCE, until

from app.serving.hosts import Hosts
from app.serving.logins import Logins
from app.serving.passwords import password_line

pytestmark = pytest.mark.long

PASSWORD = "correct horse battery"


def test_nothing_without_login(visitor: Any) -> None:
    status, _, headers = visitor.ask("/?arw=0.5deg/sqrt(h)")
    assert status == 302
    assert headers["Location"].startswith("./login?next=%2F%3Farw")
    forged = generate_jwt_token(generate_session_id())
    assert visitor.refused(forged) == 403
    assert visitor.ask("/autoload.js?bokeh-autoload-element=x")[0] == 404
    assert visitor.ask("/metadata")[0] == 404


def test_login_leads_to_where_the_visitor_was_going(visitor: Any) -> None:
    status, _, headers = visitor.log_in("ada", PASSWORD, "/login?next=%2F%3Farw%3D1")
    assert status == 302
    assert headers["Location"] == "./?arw=1"  # a proxy may serve it all below a path of its own
    (user,) = (line for line in headers.get_all("Set-Cookie") or [] if line.startswith("user="))
    assert "HttpOnly" in user
    assert "SameSite=Lax" in user
    assert "ACK" in str(visitor.hello(visitor.token()))


@pytest.mark.parametrize(
    ("name", "password"),
    [("ada", PASSWORD + "2"), ("eve", PASSWORD), ("ada", ""), ("", ""), ("ada", "x" * 5000), ("<b>ada", PASSWORD)],
)
def test_wrong_password(visitor: Any, name: str, password: str) -> None:
    status, text, _ = visitor.log_in(name, password)
    assert status == 401
    assert "Name or password is wrong." in text
    assert "<b>" not in text
    assert "user" not in visitor.cookies
    assert visitor.ask("/")[0] == 302


def test_login_form_must_come_from_the_page(visitor: Any) -> None:
    assert visitor.ask("/login", {"username": "ada", "password": PASSWORD})[0] == 403
    assert "user" not in visitor.cookies


@pytest.mark.parametrize(
    "wanted", ["https://example.org/", "//example.org/", "/\\example.org", "/\t/example.org", "javascript:alert(1)"]
)
def test_login_does_not_send_anybody_elsewhere(visitor: Any, wanted: str) -> None:
    assert visitor.ask(f"/login?next={urllib.parse.quote(wanted, safe='')}")[0] == 400


@pytest.mark.parametrize(
    "wanted", ["/a\nb", "/\r\nSet-Cookie: a=b", "/\0", "/é", "/ a", "/\u2028", "/\x85", "\n/", "/a\n"]
)
def test_an_odd_way_on_is_refused_or_followed_and_never_a_fault(visitor: Any, wanted: str) -> None:
    path = f"/login?next={urllib.parse.quote(wanted, safe='')}"
    status, _, headers = visitor.log_in("ada", PASSWORD, path) if visitor.ask(path)[0] == 200 else visitor.ask(path)
    assert status in (302, 400)
    assert not any(sign in headers.get("Location", "") for sign in "\r\n")
    assert visitor.log_in("ada", PASSWORD, path, form="/login")[0] in (302, 400)


@pytest.mark.parametrize(
    "path", ["/static/%00", "/static/js/%00.js", "/static/extensions/panel/%00", "/static/a%0Ab", "/%00", "/login%00"]
)
def test_a_path_with_control_characters_is_no_fault(visitor: Any, path: str) -> None:
    assert visitor.ask(path)[0] == 400


def test_forged_cookie(visitor: Any) -> None:
    for secret in ("", "secret", "x" * 64):
        visitor.cookies["user"] = create_signed_value(secret, "user", "ada").decode() if secret else "ada"
        assert visitor.ask("/")[0] == 302
        assert visitor.refused(generate_jwt_token(generate_session_id())) == 403


def test_a_session_nobody_was_given_is_not_opened(visitor: Any) -> None:
    visitor.log_in("ada", PASSWORD)
    assert visitor.hello(generate_jwt_token(generate_session_id())) is None
    assert visitor.refused("no.token") == 403
    for content in ("[" * 30_000, "[1]", "5", "{}"):
        assert visitor.refused(base64.urlsafe_b64encode(content.encode()).decode().rstrip("=")) == 403
    for content in (b'{"session_id": [1]}', b'{"session_id": {}}'):
        assert visitor.hello(base64.urlsafe_b64encode(content).decode().rstrip("=")) is None
    forged = generate_jwt_token(generate_session_id(), secret_key=b"guess", signed=True)
    assert visitor.hello(forged) is None
    wanted = generate_session_id()
    assert get_session_id(visitor.token(f"/?bokeh-session-id={wanted}")) != wanted


def test_a_page_opens_for_the_person_who_fetched_it_alone(visitor: Any) -> None:
    visitor.log_in("ada", PASSWORD)
    token = visitor.token()
    other = replace(visitor, cookies={})
    other.log_in("bob", PASSWORD + "2")
    assert other.refused(token) == 403
    assert "ACK" in str(visitor.hello(token))
    assert other.refused(token) == 403  # nor once it is open
    visitor.log_in("ada", PASSWORD)  # anew, in another tab
    assert "ACK" in str(visitor.hello(token))


@pytest.mark.parametrize("origin", ["http://example.org", "null", "http://127.0.0.1", "http://127.0.0.1.example.org"])
def test_wrong_origin_on_the_websocket(visitor: Any, origin: str) -> None:
    visitor.log_in("ada", PASSWORD)
    assert visitor.refused(visitor.token(), origin) == 403


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:{port}", "127.0.0.1.evil.example:{port}", "a@127.0.0.1", "192.0.2.1",
             "127.0.0.1:{port}, evil.example", "[::1", ""]
)  # fmt: skip
def test_a_foreign_host_gets_nothing(visitor: Any, host: str) -> None:
    """A foreign site's name that leads to this machine: its pages must not become that site's."""
    foreign = host.format(port=visitor.port)
    for path in ("/", "/login", "/liveness", "/metrics", "/static/js/bokeh.min.js", "/nothing"):
        status, text, headers = visitor.ask(path, Host=foreign)
        assert status in (400, 421)
        assert "_xsrf" not in text
        assert "Set-Cookie" not in headers
    visitor.log_in("ada", PASSWORD)
    assert visitor.refused(visitor.token(), f"http://{foreign}", Host=foreign) in (400, 421)


@pytest.mark.parametrize("host", ["localhost:8000", "[::1]:8000", "127.0.0.1"])
def test_a_forwarded_port_of_this_machine_is_no_foreign_host(visitor: Any, host: str) -> None:
    visitor.log_in("ada", PASSWORD)
    assert visitor.ask("/", Host=host)[0] == 200
    assert "ACK" in str(visitor.hello(visitor.token(), f"http://{host}", Host=host))


@pytest.mark.parametrize(
    ("address", "allowed", "admitted", "foreign"),
    [
        ("127.0.0.1", (), ["localhost", "127.0.0.1:1"], ["10.0.0.1", "server.example"]),
        ("0.0.0.0", ("a.example",), ["A.example", "a.example:443", "10.0.0.1:5006", "[::1]:5006", "[fe80::1]"],
         ["a.example:81", "b.a.example", "localhost.example"]),
        ("::", ("a.example:81",), ["a.example:81", "10.0.0.1"], ["a.example", "a.example:82"]),
        ("server.example", (), ["server.example:5006", "localhost:5006"], ["10.0.0.1", "example"]),
    ],
)  # fmt: skip
def test_names_a_server_answers_under(
    address: str, allowed: tuple[str, ...], admitted: list[str], foreign: list[str]
) -> None:
    hosts = Hosts(address, allowed)
    assert [host for host in (*admitted, *foreign) if hosts.admit(host)] == admitted


def test_logout(visitor: Any) -> None:
    visitor.log_in("ada", PASSWORD)
    status, text, _ = visitor.ask("/")
    assert status == 200
    assert text.index('name="viewport"') < text.index("innerWidth")  # which is a desk's before a phone has read it
    visitor.ask("/logout")
    assert visitor.ask("/logout", {"_xsrf": "guessed"})[0] == 403
    assert visitor.ask("/")[0] == 200  # neither a link from elsewhere nor a form logs out
    status, text, _ = visitor.log_out()
    assert status == 200
    assert "http" not in text
    visitor.cookies = {name: value for name, value in visitor.cookies.items() if value != '""'}
    assert visitor.ask("/")[0] == 302


async def test_logging_out_closes_the_pages_of_this_login_and_no_others(visitor: Any) -> None:
    other = type(visitor)(visitor.process, visitor.port)
    for person in (visitor, other):
        person.log_in("ada", PASSWORD)
    leaving, staying = await visitor.enter(), await other.connect(other.token())
    await asyncio.to_thread(visitor.log_out)
    async with asyncio.timeout(PATIENCE):
        while await leaving.read_message() is not None:
            pass
    assert leaving.close_reason == "logged out"
    assert "ACK" in str(await staying.read_message())
    await other.hang_up(staying)


def test_guessing_is_slowed(tmp_path: Path) -> None:
    now = [0.0]
    tries = Logins(str(tmp_path / "logins.db"), lambda: now[0])
    for _ in range(10):
        assert not tries.too_many("a")
        tries.failed("a", "b")
    assert tries.too_many("a")
    assert tries.too_many("b")
    assert not tries.too_many("c")
    assert Logins(str(tmp_path / "logins.db"), lambda: now[0]).too_many("a")  # another process knows
    now[0] = 61.0
    assert not tries.too_many("a")
    for _ in range(10):
        tries.failed("a")
    now[0] = 30.0  # the clock is set back
    assert not tries.too_many("a")
    tries.failed("a")
    now[0] = 61.0
    assert not tries.too_many("a")


@pytest.fixture(scope="module")
def team(serving: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Any, Path, Path]]:
    """Two processes behind a proxy, their password file and their log."""
    folder = tmp_path_factory.mktemp("team")
    _write_people(folder / "people")
    options = ("--password-file", str(folder / "people"), "--behind-proxy", "--processes", "2", "--log", "json")
    with serving(*options, log=folder / "log") as served:
        yield served, folder / "people", folder / "log"


def _write_people(people: Path) -> None:
    """Four people with one password, hashed with a new salt each time."""
    people.write_text("".join(f"{password_line(name, PASSWORD)}\n" for name in ("ada", "bob", "cyd", "dee")))


def test_tries_are_counted_over_all_processes_and_for_an_account_from_everywhere(team: Any) -> None:
    served = replace(team[0], cookies={})

    def attempt(password: str, peer: str, name: str = "cyd") -> int:
        return int(served.log_in(name, password, **{"X-Forwarded-For": peer})[0])

    assert [attempt("guess", f"192.0.2.{peer}") for peer in range(10)] == [401] * 10
    assert attempt(PASSWORD, "192.0.2.99") == 429  # cyd's account, from an address that never failed
    assert attempt(PASSWORD, "192.0.2.99", "dee") == 302
    assert [attempt("guess", "192.0.2.77", f"name {count}") for count in range(10)] == [401] * 10
    assert attempt(PASSWORD, "192.0.2.77", "dee") == 429


def test_behind_a_proxy_the_visitor_is_who_the_proxy_says(team: Any) -> None:
    served, _, log = team
    served = replace(served, cookies={})
    for sent in ({}, {"X-Real-Ip": "127.0.0.1"}):  # a proxy hands on what it does not know
        for peer in ("192.0.2.7", "127.0.0.1, 192.0.2.7", "192.0.2.7:1234", "unknown", ""):
            assert served.ask("/metrics", **{"X-Forwarded-For": peer}, **sent)[0] == 403
    forwarded = {"X-Forwarded-For": "192.0.2.7", "X-Forwarded-Proto": "https"}
    claimed = {"X-Real-Ip": "192.0.2.8", "X-Scheme": "http"}
    _, _, headers = served.log_in("ada", PASSWORD, **forwarded, **claimed)
    (user,) = (line for line in headers.get_all("Set-Cookie") or [] if line.startswith("user="))
    assert "Secure" in user
    for path in ("/login", "/logout"):
        (form,) = replace(served, cookies={}).ask(path, **forwarded)[2].get_all("Set-Cookie")
        assert form.startswith("_xsrf=")
        assert "SameSite=Lax" in form
        assert "Secure" in form

    def logged() -> bool:
        events = map(json.loads, log.read_text().splitlines())
        return any(event.get("event") == "login" and event["peer"] == "192.0.2.7" for event in events)

    until(logged, "the login in the log")


def test_a_copied_cookie_ends_with_the_login_and_with_the_password(team: Any) -> None:
    served, people, _ = team
    served = replace(served, cookies={})
    served.log_in("ada", PASSWORD)
    copied = dict(served.cookies)
    assert served.ask("/")[0] == 200
    served.log_out()
    served.cookies = dict(copied)
    assert [served.ask("/")[0] for _ in range(6)] == [302] * 6
    served.cookies = {}
    for name in ("ada", "bob"):
        served.log_in(name, PASSWORD)
        assert served.ask("/")[0] == 200
        served.cookies, copied = {}, dict(served.cookies)
        token = replace(served, cookies=dict(copied)).token()
        _write_people(people)
        served.cookies = copied
        assert [served.ask("/")[0] for _ in range(4)] == [302] * 4
        assert served.refused(token) == 403
        served.cookies = {}


def test_another_persons_login_does_not_fit_a_name(visitor: Any) -> None:
    visitor.log_in("bob", PASSWORD + "2")
    bobs = visitor.cookies["login"]
    visitor.log_in("ada", PASSWORD)
    visitor.cookies["login"] = bobs
    assert visitor.ask("/")[0] == 302
