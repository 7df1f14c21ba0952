"""Sign-in through an OAuth provider: a small one on loopback carries the whole way, as Panel's generic one goes."""

import asyncio
import json
import threading
import urllib.parse
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import pytest
from bokeh.util.token import generate_jwt_token, generate_session_id
from tornado.httpserver import HTTPServer
from tornado.netutil import bind_sockets
from tornado.web import Application, RequestHandler
from waiting import PATIENCE

pytestmark = [pytest.mark.long, pytest.mark.watches("app/serving", "app/upstream")]

_SECRET = "secret-of-the-client"


@dataclass
class Provider:
    """Who is at the provider's keyboard, and what it was asked."""

    account: dict[str, Any]
    port: int = 0
    asked: list[tuple[str, dict[str, str]]] = field(default_factory=list)


class _Authorize(RequestHandler):
    """The provider's own page, where the person has agreed already: back with a code."""

    def get(self) -> None:
        provider = self.settings["provider"]
        given = {name: self.get_argument(name) for name in self.request.arguments}
        provider.asked.append(("authorize", given))
        back = urllib.parse.urlencode({"code": "the-code", "state": given["state"]})
        self.redirect(f"{given['redirect_uri']}?{back}")


class _Token(RequestHandler):
    """A code, with the client's secret, for a token."""

    def post(self) -> None:
        provider = self.settings["provider"]
        given = {name: self.get_body_argument(name) for name in self.request.body_arguments}
        provider.asked.append(("token", given))
        if (given.get("code"), given.get("client_secret")) != ("the-code", _SECRET):
            self.set_status(400)
            self.write({"error": "invalid_grant"})
            return
        self.write({"access_token": "the-token", "token_type": "Bearer"})


class _Person(RequestHandler):
    """A token for who it belongs to."""

    def get(self) -> None:
        provider = self.settings["provider"]
        provider.asked.append(("person", {"header": self.request.headers.get("Authorization", "")}))
        self.set_header("Content-Type", "application/json")
        self.write(json.dumps(provider.account))


@pytest.fixture(scope="module")
def provider() -> Iterator[Provider]:
    account_server, ready = Provider({"email": "ada@example.org"}), threading.Event()
    stop: list[Any] = []

    async def run() -> None:
        pages = [(r"/authorize", _Authorize), (r"/token", _Token), (r"/person", _Person)]
        (listening,) = bind_sockets(0, "127.0.0.1")
        server = HTTPServer(Application(pages, provider=account_server))
        server.add_sockets([listening])
        account_server.port = listening.getsockname()[1]
        over = asyncio.Event()
        stop.append((asyncio.get_running_loop(), over))
        ready.set()
        await over.wait()
        server.stop()
        await server.close_all_connections()

    thread = threading.Thread(target=lambda: asyncio.run(run()))
    thread.start()
    assert ready.wait(PATIENCE)
    yield account_server
    ((loop, over),) = stop
    loop.call_soon_threadsafe(over.set)
    thread.join()


def test_oauth_sends_to_the_provider(serving: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PANEL_OAUTH_SECRET", _SECRET)
    with serving("--oauth-provider", "github", "--oauth-key", "the-id", "--oauth-allow", "ada",
                 "--processes", "1") as served:  # fmt: skip
        assert served.ask("/")[2]["Location"].startswith("./login")
        _, _, headers = served.ask("/login")
        assert headers["Location"].startswith("https://github.com/login/oauth/authorize?")
        assert "client_id=the-id" in headers["Location"]
        assert _SECRET not in str(headers)
        assert served.refused(generate_jwt_token(generate_session_id())) == 403


@pytest.fixture(scope="module")
def generic(serving: Any, provider: Provider) -> Iterator[Any]:
    """A server that lets example.org and ada in, by whatever the provider says."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PANEL_OAUTH_SECRET", _SECRET)
        for name, path in (("AUTHORIZE", "authorize"), ("TOKEN", "token"), ("USER", "person")):
            patch.setenv(f"PANEL_OAUTH_{name}_URL", f"http://127.0.0.1:{provider.port}/{path}")
        allowed = ("--oauth-allow", "@example.org", "--oauth-allow", "ada")
        with serving("--oauth-provider", "generic", "--oauth-key", "the-id", *allowed) as served:
            yield served


@pytest.fixture
def stranger(generic: Any) -> Any:
    """A visitor the server knows nothing of."""
    return replace(generic, cookies={})


def _sign_in(served: Any) -> tuple[int, str]:
    """To the provider, back with its code, and what the page then says."""
    there = urllib.parse.urlsplit(served.ask("/login?next=%2F")[2]["Location"])
    status, _, headers = replace(served, port=there.port, cookies={}).ask(f"{there.path}?{there.query}")
    assert status == 302
    back = urllib.parse.urlsplit(headers["Location"])
    assert (back.hostname, back.port) == ("127.0.0.1", served.port)
    status, text, headers = served.ask(f"{back.path}?{back.query}")
    for _ in range(5):
        if status != 302 or "/authorize?" in headers["Location"]:
            break
        status, text, headers = served.ask(urllib.parse.urljoin("/", headers["Location"]))
    return status, text


def test_the_whole_way_through_a_provider(stranger: Any, provider: Provider) -> None:
    status, _ = _sign_in(stranger)
    assert status == 200
    assert "ACK" in str(stranger.hello(stranger.token()))
    asked = dict(provider.asked)
    assert asked["authorize"]["client_id"] == "the-id"
    assert _SECRET not in str(asked["authorize"])
    assert asked["token"]["client_secret"] == _SECRET
    assert "the-token" in asked["person"]["header"]
    assert stranger.ask("/logout", {})[0] == 403
    assert stranger.log_out()[0] == 200
    stranger.cookies = {name: value for name, value in stranger.cookies.items() if value != '""'}
    assert stranger.ask("/")[0] == 302


def test_an_account_that_is_not_allowed_gets_no_page(
    stranger: Any, provider: Provider, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(provider, "account", {"email": "eve@example.org.evil"})
    status, text = _sign_in(stranger)
    assert status in {302, 403}
    assert "token" not in text
    assert stranger.hello(generate_jwt_token(generate_session_id())) is None  # a session nobody was given


@pytest.mark.parametrize("forged", ["code=the-code", "code=the-code&state=forged", "code=wrong", "error=denied"])
def test_an_answer_nobody_asked_for_signs_nobody_in(stranger: Any, forged: str) -> None:
    stranger.ask("/login")
    stranger.ask(f"/login?{forged}")
    assert "user" not in stranger.cookies
    assert stranger.ask("/")[0] == 302
