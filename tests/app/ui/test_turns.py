"""Large parts of a page are made in turns: in order, with room for others in between, and not for a closed page."""

from __future__ import annotations

import asyncio
import itertools
import time
from collections.abc import Callable
from types import SimpleNamespace

import panel as pn
import pytest
from bokeh.core.types import ID
from bokeh.document import Document
from bokeh.server.session import ServerSession
from panel.io.state import set_curdoc
from tornado.ioloop import IOLoop

from app.ui.turns import in_turns


def _in_a_session(work: Callable[[Document, SimpleNamespace], None], seconds: float) -> None:
    """Call it in a session, then let others work for so long."""

    async def run() -> None:
        document, context = Document(), SimpleNamespace(destroyed=False)
        document._session_context = lambda: context  # type: ignore[assignment,return-value]
        session = ServerSession(ID("a"), document, IOLoop.current())
        with set_curdoc(document):
            work(document, context)
        await asyncio.sleep(seconds)
        session.destroy()

    asyncio.run(run())


def test_others_come_in_between() -> None:
    done: list[tuple[int, float]] = []

    def piece(number: int) -> None:
        time.sleep(0.06)
        done.append((number, time.monotonic()))

    _in_a_session(lambda *_: in_turns([lambda n=n: piece(n) for n in range(6)]), 0.8)
    assert [number for number, _ in done] == list(range(6))
    gaps = [later - earlier - 0.06 for (_, earlier), (_, later) in itertools.pairwise(done)]
    assert sum(gap > 0.008 for gap in gaps) >= 2  # three turns of two pieces


def test_nothing_is_made_for_a_closed_page() -> None:
    done: list[int] = []

    def work(_: Document, context: SimpleNamespace) -> None:
        def piece() -> None:
            time.sleep(0.12)
            done.append(1)
            context.destroyed = True

        in_turns([piece] * 5)

    _in_a_session(work, 0.4)
    assert done == [1]


def test_a_fault_is_told_and_leaves_the_document_able_to_change(monkeypatch: pytest.MonkeyPatch) -> None:
    kept: list[Document] = []
    told: list[BaseException] = []
    monkeypatch.setattr(pn.config, "exception_handler", told.append)

    def fail() -> None:
        raise ZeroDivisionError

    def work(document: Document, _: SimpleNamespace) -> None:
        kept.append(document)
        in_turns([fail])

    _in_a_session(work, 0.1)
    assert kept[0].models._freeze_count == 0
    assert [type(fault) for fault in told] == [ZeroDivisionError]


def test_without_a_server_all_is_done_at_once() -> None:
    done: list[int] = []
    in_turns([lambda n=n: done.append(n) for n in range(3)])
    assert done == [0, 1, 2]
