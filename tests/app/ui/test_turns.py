"""Parts of a page that are made later: in another turn, once it is loaded, once a slider rests."""

import asyncio
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import panel as pn
import pytest
from bokeh.core.types import ID
from bokeh.document import Document
from bokeh.server.session import ServerSession
from panel.io.state import set_curdoc
from tornado.ioloop import IOLoop
from waiting import soon

from app.ui import turns
from app.ui.turns import debounce, defer, once_loaded


class _Clock:
    """The time that `debounce` sees; it passes when told to."""

    now = 0.0

    def monotonic(self) -> float:
        return self.now


def _in_a_session(work: Callable[[Document, SimpleNamespace], None], events: list[Any]) -> None:
    """Call it in a session; from the first of its `events`, wait for all of it."""

    async def run() -> None:
        document, context = Document(), SimpleNamespace(destroyed=False)
        document._session_context = lambda: context
        session = ServerSession(ID("a"), document, IOLoop.current())
        with set_curdoc(document):
            work(document, context)
        await soon(lambda: events, "the first piece")
        while len(asyncio.all_tasks()) > 1:
            await asyncio.sleep(0)
        session.destroy()

    asyncio.run(run())


@pytest.mark.parametrize("closed", [False, True])
def test_the_work_is_done_in_another_turn_unless_the_page_is_closed(closed: bool) -> None:
    done: list[str] = []

    def work(_: Document, context: SimpleNamespace) -> None:
        defer(lambda: done.append("worked"))
        assert done == []
        context.destroyed = closed
        done.append("begun")

    _in_a_session(work, done)
    assert done == ["begun"] if closed else ["begun", "worked"]


def test_a_fault_is_told_and_leaves_the_document_able_to_change(monkeypatch: pytest.MonkeyPatch) -> None:
    documents: list[Document] = []
    faults: list[BaseException] = []
    monkeypatch.setattr(pn.config, "exception_handler", faults.append)

    def fail() -> None:
        raise ZeroDivisionError

    def work(document: Document, _: SimpleNamespace) -> None:
        documents.append(document)
        defer(fail)

    _in_a_session(work, faults)
    assert documents[0].models._freeze_count == 0
    assert [type(fault) for fault in faults] == [ZeroDivisionError]


def test_what_waits_for_a_slider_to_rest_is_done_at_once_and_when_it_rests(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = _Clock()
    monkeypatch.setattr(turns, "time", clock)
    done: list[float] = []
    rested: list[float] = []

    def note() -> None:
        done.append(clock.now)
        rested[:] = done[1:]

    def work(*_: Any) -> None:
        call = debounce(note)
        for _ in range(5):
            call()
            clock.now += 0.1
        assert done == [0.0]
        clock.now += 10.0

    _in_a_session(work, rested)
    assert done == [0.0, pytest.approx(10.5)]


def test_without_a_server_all_is_done_at_once() -> None:
    done: list[int] = []
    defer(lambda: done.append(1))
    assert done == [1]


def test_what_waits_for_the_first_screen_is_one_change(monkeypatch: pytest.MonkeyPatch) -> None:
    faults: list[BaseException] = []
    monkeypatch.setattr(pn.config, "exception_handler", faults.append)
    document, place = Document(), pn.Column()

    def fail() -> None:
        raise ZeroDivisionError

    with set_curdoc(document):
        pn.state._loaded[document] = False  # as in a session
        document.add_root(place.get_root(document))
        for work in (lambda: place.append(pn.pane.HTML("a")), fail, lambda: place.append(pn.pane.HTML("b"))):
            once_loaded(work)
        assert not place.objects
        pn.state._on_load(document)
        assert [part.object for part in place.objects] == ["a", "b"]
        assert sum(model.__class__.__name__ == "HTML" for model in document.models) == 2
        assert [type(fault) for fault in faults] == [ZeroDivisionError]
        once_loaded(lambda: place.append(pn.pane.HTML("c")))
        assert len(place.objects) == 3
