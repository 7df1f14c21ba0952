"""Work of a server before anybody asks for it."""

import asyncio
import sys
from types import ModuleType
from typing import Any

import pytest

from app.serving import server
from app.subjects import Subject


async def test_subjects_begin_once_the_first_page_has_loaded(monkeypatch: pytest.MonkeyPatch) -> None:
    designs: list[Any] = []

    async def ahead(design: Any) -> None:
        designs.append(design)

    room = ModuleType("app.subjects.wind.page")
    room.__dict__.update(ahead=ahead)
    monkeypatch.setitem(sys.modules, room.__name__, room)
    wind = Subject("wind", ahead="page:ahead")
    monkeypatch.setattr(server, "SUBJECTS", (Subject("rain"), wind))
    monkeypatch.setattr(server, "_REST", 0.0)
    loaded = asyncio.Event()
    task = asyncio.create_task(server._prepare(loaded))
    for _ in range(5):
        await asyncio.sleep(0)
    assert not designs
    loaded.set()
    await task
    assert designs == [server.first_design()]
