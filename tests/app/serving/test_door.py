"""The door: nothing without login, no forged way in, and a login that leads nobody astray."""

from __future__ import annotations

import urllib.parse
from typing import Any

import pytest
from bokeh.util.token import generate_jwt_token, generate_session_id, get_session_id
from tornado.web import create_signed_value

from app.serving.access import Tries

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
    assert headers["Location"] == "/?arw=1"
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


def test_forged_cookie(visitor: Any) -> None:
    for secret in ("", "secret", "x" * 64):
        visitor.cookies["user"] = create_signed_value(secret, "user", "ada").decode() if secret else "ada"
        assert visitor.ask("/")[0] == 302
        assert visitor.refused(generate_jwt_token(generate_session_id())) == 403


def test_a_session_nobody_was_given_is_not_opened(visitor: Any) -> None:
    visitor.log_in("ada", PASSWORD)
    assert visitor.hello(generate_jwt_token(generate_session_id())) is None
    assert visitor.refused("no.token") == 403
    forged = generate_jwt_token(generate_session_id(), secret_key=b"guess", signed=True)
    assert visitor.hello(forged) is None
    wanted = generate_session_id()
    assert get_session_id(visitor.token(f"/?bokeh-session-id={wanted}")) != wanted


@pytest.mark.parametrize("origin", ["http://example.org", "null", "http://127.0.0.1", "http://127.0.0.1.example.org"])
def test_wrong_origin_on_the_websocket(visitor: Any, origin: str) -> None:
    visitor.log_in("ada", PASSWORD)
    assert visitor.refused(visitor.token(), origin) == 403


def test_logout(visitor: Any) -> None:
    visitor.log_in("ada", PASSWORD)
    assert visitor.ask("/")[0] == 200
    status, text, _ = visitor.ask("/logout")
    assert status == 200
    assert "http" not in text
    visitor.cookies = {name: value for name, value in visitor.cookies.items() if value != '""'}
    assert visitor.ask("/")[0] == 302


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
