"""Static files and large messages go out compressed, once made, to whoever takes them so."""

import gzip
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from bokeh.settings import settings
from tornado.httpclient import AsyncHTTPClient, HTTPResponse
from tornado.httpserver import HTTPServer
from tornado.testing import bind_unused_port
from tornado.web import Application
from tornado.websocket import _PerMessageDeflateCompressor, _PerMessageDeflateDecompressor

from app.serving import packed
from app.upstream.connection import _frame

BUNDLE = "/static/js/bokeh.min.js"


async def fetch(path: str, **headers: str) -> HTTPResponse:
    """The answer to a request, as it is on the line."""
    application = Application([])
    application.default_router.rules[:0] = packed.packed_files()
    socket, port = bind_unused_port()
    server = HTTPServer(application)
    server.add_socket(socket)
    try:
        client = AsyncHTTPClient(force_instance=True)
        given = {name.replace("_", "-"): value for name, value in headers.items()}
        return await client.fetch(
            f"http://127.0.0.1:{port}{path}", headers=given, decompress_response=False, raise_error=False
        )
    finally:
        server.stop()


async def test_a_bundle_is_compressed_once_for_all_visitors(monkeypatch: pytest.MonkeyPatch) -> None:
    packed._packed.cache_clear()
    made = []

    def compress(content: bytes, *options: Any, **named: Any) -> bytes:
        made.append(len(content))
        return compressed(content, *options, **named)

    compressed = gzip.compress
    monkeypatch.setattr(packed.gzip, "compress", compress)
    whole = (Path(settings.bokehjs_path()) / "js" / "bokeh.min.js").read_bytes()
    for _ in range(3):
        answer = await fetch(BUNDLE + "?v=1", Accept_Encoding="gzip, br")
        assert answer.headers["Content-Encoding"] == "gzip"
        assert "javascript" in answer.headers["Content-Type"]
        assert answer.headers["Vary"] == "Accept-Encoding"
        assert "max-age=315360000" in answer.headers["Cache-Control"]
        assert gzip.decompress(answer.body) == whole
        assert 3 * len(answer.body) < len(whole)
    assert made == [len(whole)]
    plain = await fetch(BUNDLE)
    assert "Content-Encoding" not in plain.headers
    assert plain.body == whole
    part = await fetch(BUNDLE, Accept_Encoding="gzip", Range="bytes=0-9")
    assert (part.code, part.body) == (206, whole[:10])
    again = await fetch(BUNDLE, Accept_Encoding="gzip", If_None_Match=answer.headers["Etag"])
    assert (again.code, again.body) == (304, b"")


@pytest.mark.parametrize(
    "path", ["/static/../server.py", "/static/%2e%2e/urls.py", "/static/extensions/panel/../../x"]
)
async def test_no_other_file_is_sent(path: str) -> None:
    assert (await fetch(path, Accept_Encoding="gzip")).code in (403, 404)


async def test_a_component_s_bundle_stays_by_its_hash() -> None:
    import panel  # noqa: F401  # makes its files known

    answer = await fetch("/static/extensions/panel/panel.min.js?0123abcd", Accept_Encoding="gzip")
    assert (answer.code, answer.headers["Content-Encoding"]) == (200, "gzip")
    assert "max-age=315360000" in answer.headers["Cache-Control"]


def test_large_messages_are_compressed_and_small_ones_between_them_are_not() -> None:
    options: Any = {"persistent": True, "max_wbits": None}
    websocket = SimpleNamespace(_compressor=_PerMessageDeflateCompressor(**options))
    browser = _PerMessageDeflateDecompressor(max_message_size=10**7, **options)
    for text in (b"a page " * 30_000, b"a page, again " * 20_000):
        frame = _frame(1, text, websocket)
        assert frame[0] == 0xC1  # the last of its message, compressed, text
        assert len(frame) < len(text) / 50
        size = {126: 2, 127: 8}.get(frame[1], 0)
        assert browser.decompress(frame[2 + size :]) == text
        assert _frame(1, b"a step", websocket) == b"\x81\x06a step"
    assert _frame(1, b"x" * 200_000, SimpleNamespace())[0] == 0x81
