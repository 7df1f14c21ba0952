"""An import of the library's page."""

import asyncio
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from app.library import exchange
from app.library.store import Library
from app.subjects.review.library_view import LibraryView
from app.work import pool
from nav_model.budget import analyse
from nav_model.design import Design

pytestmark = pytest.mark.long


def test_an_archive_is_judged_in_a_worker_and_not_in_the_process_of_the_pages(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two thousand designs take a dozen seconds, during which no page would answer."""
    full, empty = Library(tmp_path / "full.db"), Library(tmp_path / "empty.db")
    saved = full.save(analyse(Design({"requirements.tilt": 1e-3})), "Ann")
    content = exchange.export_archive(full, [saved.design])

    def judged_here(*_: Any) -> None:
        raise AssertionError

    monkeypatch.setattr(exchange, "revision_from_file", judged_here)
    messages: list[str] = []

    async def ask(work: Any) -> Any:
        return work(empty)

    async def refresh() -> None: ...

    desk = SimpleNamespace(who="Bob", say=lambda text, wrong=False: messages.append(text), ask=ask)
    asyncio.run(LibraryView._brought(SimpleNamespace(desk=desk, refresh=refresh), "", content))  # type: ignore[arg-type]
    pool.stop()
    pool.pool.cache_clear()  # the next test has one of its own
    assert messages == ["Imported 1 design, 1 revision; 0 here already."]
    assert [design.text for design in empty.designs()] == [saved.text]
    for library in (full, empty):
        library.close()
