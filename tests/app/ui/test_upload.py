"""Uploads leave nothing in memory."""

import tracemalloc
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from bokeh.document import Document
from panel.io.state import set_curdoc
from waiting import soon

import app.subjects.trajectory.page as trajectory_page
from app.serving.server import first_design
from app.session import Session
from app.subjects.sar.upload import UploadedPicture
from app.subjects.trajectory.page import TrajectoryPage
from app.ui.upload import UploadedFile, upload
from nav_model.base.errors import InputError

_LARGE = 8_000_000  # bytes


@pytest.fixture
def traced() -> Iterator[None]:
    tracemalloc.start()
    yield
    tracemalloc.stop()


def _send(button: Any, name: str, size: int) -> None:
    button._handle_msg({"status": "initializing"})
    whole = {"name": name, "chunk": 1, "total_chunks": 1, "mime_type": ""}
    button._handle_msg({"status": "upload_event", **whole, "data": bytes(size)})
    button._handle_msg({"status": "finished"})


def test_a_button_forgets_what_came_be_it_refused_or_not(traced: None) -> None:
    sizes: list[int] = []
    refused: list[str] = []
    with set_curdoc(Document()):
        button = upload("A file", ".csv", _LARGE, lambda _, content: sizes.append(len(content)), refused.append)
        button.get_root(Document())
        before, _ = tracemalloc.get_traced_memory()
        for size in (_LARGE, _LARGE + 1, _LARGE):
            _send(button, "a.csv", size)
        after, _ = tracemalloc.get_traced_memory()
    assert (sizes, refused) == ([_LARGE, _LARGE], ["larger than 8 MB"])
    assert after - before < 0.1 * _LARGE


async def _as_flown(*_: object) -> tuple[tuple[()], str]:
    """Instead of a worker that reads a file: one that is flown as it is."""
    return (), "flown"


async def test_pages_keep_a_flight_and_a_phase_history_on_the_disk(
    traced: None, monkeypatch: pytest.MonkeyPatch
) -> None:
    session = Session(first_design())
    page = TrajectoryPage(session)
    monkeypatch.setattr(page, "begin", lambda *_: None)
    monkeypatch.setattr(trajectory_page, "read_in_pool", _as_flown)
    picture = UploadedPicture(session, lambda: None)
    await page._uploaded("flight.out", b"small")  # imports what it needs
    before, _ = tracemalloc.get_traced_memory()
    await page._uploaded("flight.out", bytes(_LARGE))
    await picture._opened("history.npz", bytes(_LARGE))
    assert page._file is not None
    assert picture.file is not None
    assert [path.stat().st_size for path in (page._file.path, picture.file[1])] == [_LARGE, _LARGE]
    # A thread lets go of what it wrote a moment after it has said so.
    await soon(lambda: tracemalloc.get_traced_memory()[0] - before < 0.1 * _LARGE, "the files to leave the memory")
    for file in (page._on_disk, picture._on_disk):
        file.delete()


async def test_a_file_takes_the_place_of_the_one_before_unless_the_disk_is_full(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    file = UploadedFile()
    first = await file.put(b"first")
    second = await file.put(b"second")
    assert first != second  # a page that follows the path notices
    assert [path.read_bytes() for path in second.parent.iterdir()] == [b"second"]
    with Path("/dev/full").open("wb", buffering=0) as full:
        monkeypatch.setattr("os.fdopen", lambda number, mode: full)
        with pytest.raises(InputError, match="the server cannot keep it: No space left on device"):
            await file.put(b"third")
    assert [path.read_bytes() for path in second.parent.iterdir()] == [b"second"]
    file.delete()
    assert not second.parent.exists()
