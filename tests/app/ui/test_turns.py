"""Large parts of a page are made in turns: in order, with room for others in between, and not for a closed page."""

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
from app.ui.turns import in_turns, once_loaded, once_quiet


class _Clock:
    """The time that `in_turns` sees; it passes when told to."""

    now = 0.0

    def monotonic(self) -> float:
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> _Clock:
    made = _Clock()
    monkeypatch.setattr(turns, "time", made)
    return made


def _in_a_session(
    work: Callable[[Document, SimpleNamespace], None], begun: list[Any], other: Callable[[], None] = lambda: None
) -> None:
    """Call it in a session; from when something has `begun`, do another's work in each turn of the loop."""

    async def run() -> None:
        document, context = Document(), SimpleNamespace(destroyed=False)
        document._session_context = lambda: context
        session = ServerSession(ID("a"), document, IOLoop.current())
        with set_curdoc(document):
            work(document, context)
        await soon(lambda: begun, "the first piece")
        while len(asyncio.all_tasks()) > 1:
            other()
            await asyncio.sleep(0)
        session.destroy()

    asyncio.run(run())


def test_others_come_in_between(clock: _Clock) -> None:
    done: list[str] = []

    def piece(number: int) -> None:
        clock.now += 0.06
        done.append(str(number))

    def other() -> None:
        if done and done[-1] != "other":
            done.append("other")

    _in_a_session(lambda *_: in_turns([lambda n=n: piece(n) for n in range(6)]), done, other)
    assert done == ["0", "1", "other", "2", "3", "other", "4", "5", "other"]  # a turn is 0.1 s and what was begun


def test_nothing_is_made_for_a_closed_page(clock: _Clock) -> None:
    done: list[int] = []

    def work(_: Document, context: SimpleNamespace) -> None:
        def piece() -> None:
            clock.now += 0.12
            done.append(1)
            context.destroyed = True

        in_turns([piece] * 5)

    _in_a_session(work, done)
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

    _in_a_session(work, told)
    assert kept[0].models._freeze_count == 0
    assert [type(fault) for fault in told] == [ZeroDivisionError]


def test_what_waits_for_a_slider_to_rest_is_done_at_once_and_when_it_rests(clock: _Clock) -> None:
    done: list[float] = []
    rested: list[float] = []

    def note() -> None:
        done.append(clock.now)
        rested[:] = done[1:]

    def work(*_: Any) -> None:
        call = once_quiet(note)
        for _ in range(5):
            call()
            clock.now += 0.1
        assert done == [0.0]
        clock.now += 10.0

    _in_a_session(work, rested)
    assert done == [0.0, pytest.approx(10.5)]


def test_without_a_server_all_is_done_at_once() -> None:
    done: list[int] = []
    in_turns([lambda n=n: done.append(n) for n in range(3)])
    assert done == [0, 1, 2]


def test_what_waits_for_the_first_screen_is_one_change(monkeypatch: pytest.MonkeyPatch) -> None:
    told: list[BaseException] = []
    monkeypatch.setattr(pn.config, "exception_handler", told.append)
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
        assert [type(fault) for fault in told] == [ZeroDivisionError]
        once_loaded(lambda: place.append(pn.pane.HTML("c")))
        assert len(place.objects) == 3
