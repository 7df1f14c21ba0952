"""Changes reach the browser whole and in the order they are made: none stays behind, none waits for a clock.

A lost connection closes in silence, and a fault is told without its traceback.
"""

import asyncio
import threading
import weakref
from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import panel as pn
import panel.io.document as panel_document
import pytest
import tornado.websocket
from bokeh.document import Document
from bokeh.models import Div
from bokeh.server.connection import ServerConnection
from bokeh.server.contexts import BokehSessionContext
from bokeh.server.session import ServerSession
from panel.io.server import WSHandler
from panel.io.state import set_curdoc
from tornado.httpserver import HTTPServer
from tornado.ioloop import IOLoop
from tornado.iostream import StreamClosedError
from tornado.locks import Lock
from tornado.testing import bind_unused_port
from tornado.web import Application
from waiting import PATIENCE

from app.upstream import connection as ours
from app.upstream.connection import LostConnection, NoTracebacks

pytestmark = pytest.mark.watches("app/upstream", "docs/upstream")


@dataclass
class _Hands:
    """The two that write: Panel's function and Bokeh's."""

    panel: Callable[..., None]
    bokeh: Callable[..., Awaitable[None]]


_OURS = _Hands(ours._panels, ours._bokehs)
_AS_SHIPPED = _Hands(panel_document.schedule_write_events, ServerConnection.send_patch_document)


class _Socket:
    """The part of a connection's socket that is asked."""

    def __init__(self, sent: list[str]) -> None:
        self.write_lock = Lock()
        self._sent = sent

    async def send_message(self, text: str) -> None:
        """As Bokeh's."""
        with await self.write_lock.acquire():
            await asyncio.sleep(0)
            self._sent.append(text)


class _Connection:
    """Messages are their own text; what was sent is remembered in its order."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, written: Callable[[], Awaitable[None]] | None = None) -> None:
        self.sent: list[str] = []
        self._socket = _Socket(self.sent)
        self.protocol = self

        def dispatch(conn: _Connection, msg: str) -> list[Any]:
            async def write() -> None:
                if written:
                    await written()
                conn.sent.append(msg)

            return [write()]

        monkeypatch.setattr(panel_document, "dispatch_tornado", dispatch)
        monkeypatch.setattr(panel_document, "extra_socket_handlers", {_Socket: dispatch})

    def create(self, _: str, events: list[str]) -> str:
        return events[0]


async def _turns() -> None:
    for _ in range(20):  # of the event loop, in which no time passes
        await asyncio.sleep(0)


async def _two_changes(hands: _Hands, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The second is made just when the first has been written; what has been sent when all tasks are done."""
    start, end = asyncio.Event(), asyncio.Event()

    async def written() -> None:
        start.set()
        await end.wait()

    doc, connection = Document(), _Connection(monkeypatch, written)
    hands.panel(doc, [connection], ["first"])
    await start.wait()
    end.set()  # the first's task goes on before the second's begins
    hands.panel(doc, [connection], ["second"])
    await _turns()
    return connection.sent


async def _while_writing(hands: _Hands, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Something else is being written when a change is made, and Bokeh has more to write after it."""
    doc, connection = Document(), _Connection(monkeypatch)
    async with connection._socket.write_lock:
        hands.panel(doc, [connection], ["Panel's"])
        await _turns()
        bokehs = asyncio.ensure_future(hands.bokeh(connection, "Bokeh's"))
        await _turns()
        assert not connection.sent, "written into the midst of another message"
    await _turns()
    await bokehs
    return list(connection.sent)


async def _words_first(hands: _Hands, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Bokeh has put a change into words and will write it when the event has been dealt with."""
    doc, connection = Document(), _Connection(monkeypatch)
    bokehs = hands.bokeh(connection, "Bokeh's")
    hands.panel(doc, [connection], ["Panel's"])
    await _turns()
    await bokehs
    await _turns()
    return list(connection.sent)


@pytest.mark.parametrize(
    ("happens", "made", "shipped"),
    [
        (_two_changes, ["first", "second"], ["first"]),
        (_while_writing, ["Panel's", "Bokeh's"], ["Bokeh's"]),
        (_words_first, ["Bokeh's", "Panel's"], ["Panel's", "Bokeh's"]),
    ],
)
def test_all_is_sent_at_once_and_in_the_order_it_was_made(
    happens: Any, made: list[str], shipped: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert asyncio.run(happens(_OURS, monkeypatch)) == made
    assert asyncio.run(happens(_AS_SHIPPED, monkeypatch)) == shipped, "the repair can go when none of these holds"


async def test_a_fault_in_a_message_does_not_hold_up_the_line(monkeypatch: pytest.MonkeyPatch) -> None:
    async def written() -> None:
        raise ValueError("a fault")

    connection = _Connection(monkeypatch, written)
    with pytest.raises(ValueError, match="a fault"):
        await ours._bokehs(connection, "x")
    assert connection._socket.write_lock._block._value == 1, "the line goes on"


@pytest.mark.parametrize(("asked", "sent"), [("PULL-DOC-REQ", True), ("SERVER-INFO-REQ", False)])
def test_what_a_hold_collects_once_the_document_is_sent_is_told(
    asked: str, sent: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(panel_document, "_drain_unconnected_events", ours._collected)
    document, changes = Document(), list[Any]()
    document.on_change(changes.append)

    async def replies(*_: Any) -> str:
        with pn.io.hold(document):
            document.title = "in what is sent"
        return "the reply"

    monkeypatch.setattr(WSHandler, "_handle", replies)
    handler = ours.FirstChanges.__new__(ours.FirstChanges)
    handler.connection = SimpleNamespace(session=SimpleNamespace(document=document))
    assert asyncio.run(handler._handle(SimpleNamespace(msgtype=asked))) == "the reply"
    assert not changes
    with pn.io.hold(document):
        document.title = "changed after"
    assert [each.title for each in changes] == ["changed after"] * sent


async def test_what_a_task_changes_is_told_once_the_session_is_free(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(panel_document, "_drain_unconnected_events", ours._collected)
    document, titles = Document(), asyncio.Queue[str]()
    context = BokehSessionContext("of a test", None, document)
    document._session_context = weakref.ref(context)
    session = ServerSession(context.id, document, IOLoop.current())
    context._set_session(session)

    class Connection:
        async def send_patch_document(self, event: Any) -> None:
            titles.put_nowait(event.title)

    session.subscribe(Connection())
    ours._sent.add(document)
    with pn.io.hold(document):
        document.title = "by a task"
    assert await asyncio.wait_for(titles.get(), PATIENCE) == "by a task"
    session.destroy()


_TEXTS = ['{"msgid": "1"}', "{}", "ü" * 200]  # lengths on both sides of each way to say one
_ARRAYS = [b"", b"\x00" * 125, bytes(range(126)), b"x" * 65535, b"y" * 65536]


def _message() -> Any:
    buffers = [SimpleNamespace(ref={"id": f"{i}"}, to_bytes=lambda data=data: data) for i, data in enumerate(_ARRAYS)]
    header, metadata, content = _TEXTS
    return SimpleNamespace(header_json=header, metadata_json=metadata, content_json=content, _buffers=buffers)


def _sent(dispatch: Any) -> tuple[int, list[Any]]:
    """Number of writes of a message, and the text that a client of another make receives."""

    async def run() -> tuple[int, list[Any]]:
        served: asyncio.Future[Any] = asyncio.get_running_loop().create_future()

        class Handler(tornado.websocket.WebSocketHandler):
            def open(self, *_: str, **__: str) -> None:
                served.set_result(self)

        server = HTTPServer(Application([("/ws", Handler)]))
        listening, port = bind_unused_port()
        server.add_socket(listening)
        client = await tornado.websocket.websocket_connect(f"ws://127.0.0.1:{port}/ws", max_message_size=10**6)
        socket = await served
        stream, writes = socket.ws_connection.stream, 0
        write = stream.write

        def counted(data: bytes) -> Any:
            nonlocal writes
            writes += 1
            return write(data)

        stream.write = counted
        await asyncio.gather(*dispatch(SimpleNamespace(_socket=socket), msg=_message()))
        received = [await client.read_message() for _ in range(len(_TEXTS) + 2 * len(_ARRAYS))]
        client.close()
        server.stop()
        await server.close_all_connections()
        return writes, received

    return asyncio.run(run())


def test_a_message_arrives_whole_and_is_written_once() -> None:
    writes, received = _sent(ours._dispatch)
    assert writes == 1
    assert received == _sent(panel_document.dispatch_tornado)[1]
    assert received[:3] == _TEXTS
    assert received[4::2] == _ARRAYS


@pytest.mark.parametrize("at_once", [False, True])
def test_a_page_closed_meanwhile_is_no_fault(at_once: bool) -> None:
    """The first write finds out; or it has been found out, and a further write is refused."""
    tried: list[bytes] = []

    def write(whole: bytes) -> Any:
        tried.append(whole)
        if at_once:
            raise StreamClosedError
        future: asyncio.Future[None] = asyncio.get_running_loop().create_future()
        future.set_exception(StreamClosedError())
        return future

    async def end() -> None:
        websocket = SimpleNamespace(is_closing=lambda: False, stream=SimpleNamespace(write=write))
        socket = SimpleNamespace(ws_connection=websocket, write_lock=Lock())
        await asyncio.gather(*ours._dispatch(SimpleNamespace(_socket=socket), msg=_message()))
        await ours._answer(_message(), socket)
        async with asyncio.timeout(PATIENCE):  # the line goes on
            (await socket.write_lock.acquire()).__enter__()

    asyncio.run(end())
    assert len(tried) == 2


def test_nothing_is_written_to_a_page_that_has_gone() -> None:
    for websocket in (None, SimpleNamespace(is_closing=lambda: True)):
        socket = SimpleNamespace(ws_connection=websocket, write_lock=Lock())
        assert not ours._dispatch(SimpleNamespace(_socket=socket), msg=_message())
        asyncio.run(ours._answer(_message(), socket))


def test_a_connection_that_a_ping_has_found_lost_may_close() -> None:
    session: Any = SimpleNamespace(subscribe=lambda _: None, unsubscribe=lambda _: None)
    handler = LostConnection.__new__(LostConnection)
    handler.connection = ServerConnection(None, None, None, session)
    handler.connection.detach_session()
    handler.close_code = handler.close_reason = None
    handler.on_close()


def test_no_traceback_of_the_product(monkeypatch: pytest.MonkeyPatch) -> None:
    passed: list[Any] = []

    async def on(_: Any, message: Any) -> None:
        passed.append(message)

    monkeypatch.setattr(WSHandler, "send_message", on)
    fault = SimpleNamespace(msgtype="ERROR", content={"text": "in /home", "traceback": "File /home"})
    asyncio.run(NoTracebacks.send_message(NoTracebacks.__new__(NoTracebacks), fault))
    assert passed == [fault]
    assert "home" not in str(fault.content)


@pytest.mark.parametrize("sent", [False, True])
async def test_a_change_while_the_page_loads_is_told_once_its_document_was_sent(
    sent: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(ServerSession, "_document_patched", ours._patched)
    calls: list[Any] = []
    monkeypatch.setattr(ours, "_in_line", lambda connection, events: calls.append((connection, events[0].new)))
    document, text = Document(), Div()
    document.add_root(text)
    session: Any = ServerSession("a", document)
    page: Any = object()
    session.subscribe(page)
    document._session_context = lambda: SimpleNamespace(session=session)  # type: ignore[assignment, return-value]
    pn.state._thread_id_[document] = threading.get_ident()
    pn.state._connected[document] = True  # and not yet loaded
    if sent:
        ours._sent.add(document)
    with set_curdoc(document), pn.io.hold():
        text.text = "a result that has come"
    assert calls == ([(page, "a result that has come")] if sent else [])
    assert text.text == "a result that has come"
