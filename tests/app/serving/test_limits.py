"""Limits on sessions and message sizes, and their metrics."""

import asyncio
import re
import socket
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from tornado.httpclient import HTTPClientError
from tornado.websocket import WebSocketClosedError
from waiting import PATIENCE, until

pytestmark = [pytest.mark.long, pytest.mark.watches("app/serving", "app/upstream")]

PASSWORD = "correct horse battery"


async def test_session_limit(serving: Any) -> None:
    with serving("--max-sessions", "2", "--session-lifetime", "1") as served:
        tokens = [await asyncio.to_thread(served.token) for _ in range(2)]
        connections = [await served.enter(token) for token in tokens]
        status, text, headers = await asyncio.to_thread(served.ask, "/?f=9GHz")
        assert status == 503
        assert headers["Retry-After"] == "60"
        assert "All places are taken" in text
        connections.append(await served.connect(tokens[0]))  # the same page again is not a new session
        await served.hang_up(*connections)
        metrics = served.metrics()
        assert metrics["navbudget_sessions_limit"] == 2
        assert metrics["navbudget_sessions_refused_total"] == 1
        until(lambda: served.ask("/")[0] != 503, "a closed page's place")


async def test_one_address_gets_half_of_the_places(serving: Any) -> None:
    with serving("--max-sessions", "4", "--behind-proxy", "--processes", "1") as served:
        tokens = [await asyncio.to_thread(served.token) for _ in range(4)]
        greedy, other = ({"X-Forwarded-For": address} for address in ("192.0.2.7", "192.0.2.8"))
        connections = [await served.enter(token, **greedy) for token in tokens[:2]]
        with pytest.raises(HTTPClientError, match="503"):
            await served.connect(tokens[2], **greedy)
        await served.hang_up(connections[0])  # a page that it has left gives way to its next
        connections[0] = await served.enter(tokens[2], **greedy)
        await served.hang_up(*connections, await served.enter(tokens[3], **other))


async def test_pages_that_an_address_has_left_do_not_keep_it_or_others_out(serving: Any) -> None:
    with serving("--max-sessions", "2", "--session-lifetime", "3600") as served:
        tokens = [await asyncio.to_thread(served.token) for _ in range(2)]
        for token in tokens:
            await served.hang_up(await served.enter(token))
        # The server hears of it in its own time; whoever only looks at the page takes no place.
        await asyncio.to_thread(until, lambda: served.ask("/")[0] == 200, "word of the pages that were left")
        third = await served.enter()
        tab = await served.enter(tokens[1])  # the older one gave way
        assert (await asyncio.to_thread(served.ask, "/"))[0] == 503  # and nobody does who is there
        await served.hang_up(third, tab)
        assert served.metrics()["navbudget_sessions_opened_total"] == 3


def test_metrics_and_liveness(visitor: Any) -> None:
    assert visitor.ask("/liveness")[0] == 200
    before = visitor.metrics()
    visitor.log_in("ada", PASSWORD)
    token = visitor.token()
    assert visitor.metrics()["navbudget_sessions_opened_total"] == before["navbudget_sessions_opened_total"]
    visitor.hello(token)  # whoever only looks at the page makes no session
    after = visitor.metrics()
    assert after["navbudget_sessions_opened_total"] == before["navbudget_sessions_opened_total"] + 1
    assert after["navbudget_sessions"] >= 1
    assert after["navbudget_uptime_seconds"] > 0  # of the process that answers
    assert 5e7 < after['process_resident_memory_bytes{process="0"}'] < 2e9


def test_metrics_are_not_for_a_forwarded_stranger(visitor: Any) -> None:
    stranger = {"X-Forwarded-For": "192.0.2.7"}
    assert visitor.ask("/metrics", **stranger)[0] == 403
    visitor.log_in("ada", PASSWORD)
    assert visitor.ask("/metrics", **stranger)[0] == 200


def test_every_answer_keeps_other_sites_out(visitor: Any) -> None:
    for path in ("/login", "/liveness", "/metrics", "/nowhere", "/static/js/bokeh.min.js"):
        headers = visitor.ask(path)[2]
        assert "frame-ancestors 'none'" in headers["Content-Security-Policy"]
        assert headers["X-Content-Type-Options"] == "nosniff"
        assert "Tornado" not in headers["Server"]


async def test_oversized_requests_do_not_stop_the_server(visitor: Any) -> None:
    with socket.create_connection(("127.0.0.1", visitor.port), timeout=PATIENCE) as raw:
        raw.sendall(b"POST /login HTTP/1.1\r\nHost: localhost\r\nContent-Length: 10000000\r\n\r\n")
        assert raw.recv(100).startswith((b"HTTP/1.1 400", b"HTTP/1.1 413"))
    visitor.log_in("ada", PASSWORD)
    connection = await visitor.connect(visitor.token())
    await connection.read_message()
    with suppress(WebSocketClosedError):
        await connection.write_message("x" * 21_000_000)
    await visitor.hang_up(connection)
    assert connection.close_code in {1006, 1009, None}
    assert visitor.ask("/liveness")[0] == 200


def test_every_upload_is_bounded_where_it_arrives() -> None:
    """The widget's own limit is checked in the browser alone, which a hostile one leaves out."""
    sources = {path: path.read_text() for path in (Path(__file__).parents[3] / "app").rglob("*.py")}
    assert sum("upload(" in text for text in sources.values()) >= 7
    assert not [name for name, text in sources.items() if re.search(r"\bFileInput\(|FileDropper\(", text)]
