"""The size of an upload is limited on the server."""

from collections.abc import Iterator
from typing import Any

import panel_material_ui as pmui
import pytest
from bokeh.document import Document
from panel.io.state import set_curdoc

from app.upstream.file_input import LimitedFileInput

pytestmark = pytest.mark.watches("app/upstream", "docs/upstream")


def _send(widget: pmui.FileInput, *chunks: bytes, whole: bool = True) -> None:
    """As a browser that does not check, or does not end."""
    widget._handle_msg({"status": "initializing"})
    for number, data in enumerate(chunks, start=1):
        widget._handle_msg(
            {"status": "upload_event", "name": "a", "chunk": number, "total_chunks": len(chunks),
             "mime_type": "", "data": data}
        )  # fmt: skip
    if whole:
        widget._handle_msg({"status": "finished"})


@pytest.fixture(autouse=True)
def of_a_page() -> Iterator[None]:
    with set_curdoc(Document()):
        yield


@pytest.fixture
def widget() -> Any:
    refused: list[str] = []
    result = LimitedFileInput(refused.append, max_file_size=1000)
    return result, refused


def test_what_is_too_large_is_dropped(widget: Any) -> None:
    upload, refused = widget
    taken: list[bytes] = []
    upload.param.watch(lambda event: taken.append(event.new), "value")
    _send(upload, b"x" * 600, b"y" * 400)
    assert [len(content) for content in taken] == [1000]
    _send(upload, b"x" * 600, b"y" * 401)
    _send(upload)
    upload._handle_msg({"status": "error", "error": "File too large"})
    assert refused == ["larger than 0 MB", "the file is empty", "File too large"]
    assert len(taken) == 1
    assert not upload._file_buffer
    _send(upload, b"again")
    assert taken[-1] == b"again"


def test_of_uploads_that_nobody_ends_a_page_keeps_one(widget: Any) -> None:
    first, refused = widget
    others = [LimitedFileInput(refused.append, max_file_size=1000) for _ in range(5)]
    for upload in (first, *others, first, *others):
        _send(upload, b"x" * 900, whole=False)
    for upload in (first, *others[:-1]):  # which go on although they were dropped
        upload._handle_msg({"status": "upload_event", "name": "b", "chunk": 1, "total_chunks": 2, "mime_type": "",
                            "data": b"y" * 90})  # fmt: skip
    assert not any(upload._file_buffer for upload in (first, *others[:-1]))
    assert refused[-1] == "another file was chosen before it had arrived"
    with set_curdoc(Document()):  # somebody else's page is not concerned
        _send(first, b"z", whole=False)
    others[-1]._handle_msg({"status": "finished"})
    assert others[-1].value == b"x" * 900


@pytest.mark.parametrize(
    "msg",
    [None, 3, "finished", [], {}, {"status": []}, {"status": "explode"}, {"status": "upload_event"},
     *({"status": "upload_event", "name": "a", "mime_type": "", "chunk": 1, "total_chunks": 1, "data": b"x"} | wrong
       for wrong in ({"name": 3}, {"mime_type": None}, {"chunk": "1"}, {"chunk": 2}, {"chunk": 0},
                     {"total_chunks": None}, {"data": None}, {"data": "text"}, {"data": {}}))],
)  # fmt: skip
def test_what_no_button_sends_is_ignored(widget: Any, msg: Any) -> None:
    upload, refused = widget
    upload._handle_msg({"status": "initializing"})
    upload._handle_msg(msg)
    assert not upload._file_buffer
    _send(upload, b"good")
    assert (upload.value, refused) == (b"good", [])


def test_a_part_that_contradicts_the_one_before_is_ignored(widget: Any) -> None:
    upload, refused = widget
    upload._handle_msg({"status": "initializing"})
    part = {"status": "upload_event", "name": "a", "mime_type": "", "data": b"x"}
    upload._handle_msg(part | {"chunk": 3, "total_chunks": 3})
    upload._handle_msg(part | {"chunk": 1, "total_chunks": 2})
    assert refused == []
    assert list(upload._file_buffer["a"]["chunks"]) == [3]
