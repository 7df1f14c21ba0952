"""Malicious or hasty messages over the sockets of pages; all tests share one server."""

import asyncio
import json
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from bokeh.document import Document
from bokeh.server.connection import ServerConnection
from open_page import Tab
from panel.io.state import set_curdoc
from tornado.websocket import WebSocketClosedError
from waiting import PATIENCE

from app.library.store import Library
from app.serving import handlers
from nav_model.base.errors import InputError

pytestmark = [pytest.mark.long, pytest.mark.watches("app")]

PASSWORD = "correct horse battery"
_SLIDER = "imu.angle_random_walk"
_DATA = ("timelines", "response lines 0")


async def _step(tab: Tab) -> None:
    """A slider step that must be answered."""
    answered = tab.expect({(await tab.until(name=name))["id"] for name in _DATA})
    await tab.slide(_SLIDER, tab.row(_SLIDER)[1]["place"] - 0.02)
    await asyncio.wait_for(answered, PATIENCE)


def _change(model: str, attribute: str, value: Any) -> dict[str, Any]:
    return {"events": [{"kind": "ModelChanged", "model": {"id": model}, "attr": attribute, "new": value}]}


def _row(tab: Tab, **done: Any) -> dict[str, Any]:
    """The message of the browser's side of the sheet, with whatever is said of a row."""
    entries = [["key", _SLIDER], ["number", 1], *map(list, done.items())]
    values = {"model": {"id": tab.row(_SLIDER)[0]}, "data": {"type": "map", "entries": entries}}
    event = {
        "type": "event", "name": "data_event", "values": {"type": "map", "entries": list(map(list, values.items()))}
    }  # fmt: skip
    return {"events": [{"kind": "MessageSent", "msg_type": "bokeh_event", "msg_data": event}]}


def _messages(tab: Tab) -> list[tuple[str, Any]]:
    sheet, bar = tab.row(_SLIDER)[0], next(model["id"] for model in tab.objects if "tabs" in model["attributes"])
    return [
        ("PATCH-DOC", _row(tab, place="a lot")),
        ("PATCH-DOC", _row(tab, place=[None])),
        ("PATCH-DOC", _row(tab, place={"type": "number", "value": "nan"})),
        ("PATCH-DOC", _row(tab, place={"type": "number", "value": "+inf"})),
        ("PATCH-DOC", _row(tab, place=1e308)),
        ("PATCH-DOC", _row(tab, text="9" * 1_000_000)),
        ("PATCH-DOC", _row(tab, text="<script>alert(1)</script>")),
        ("PATCH-DOC", _row(tab, unit="kg")),
        ("PATCH-DOC", _row(tab, number=[1])),
        ("PATCH-DOC", _change(bar, "active", "a lot")),
        ("PATCH-DOC", _change(bar, "active", {"type": "number", "value": "nan"})),
        ("PATCH-DOC", _change(bar, "no_such_thing", 1)),
        ("PATCH-DOC", _change("p999999", "value", 1)),
        ("PATCH-DOC", {"events": [{"kind": "Explode"}]}),
        (
            "PATCH-DOC",
            {"events": [{"kind": "MessageSent", "msg_type": "bokeh_event", "msg_data": {"type": "event"}}]},
        ),
        ("PATCH-DOC", {"events": [{"kind": "RootRemoved", "model": {"id": sheet}}]}),
        ("PATCH-DOC", "[" * 50_000 + "]" * 50_000),
        ("PATCH-DOC", "not JSON"),
        ("PUSH-DOC", {"doc": {"version": "3.9.2", "title": "owned", "roots": []}}),
        ("NO-SUCH-MESSAGE", {}),
    ]


@pytest.fixture(scope="module")
def logged(serving: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Any, set[str]]]:
    """A server that logs as JSON, and the set of words that its log must not hold when it has ended."""
    folder = tmp_path_factory.mktemp("logged")
    secret: set[str] = set()
    with serving("--log", "json", "--library", str(folder / "library.db"), log=folder / "log") as served:
        yield served, secret
    text = (folder / "log").read_text()
    events = [json.loads(line) for line in text.splitlines()]
    assert {"started", "request", "session opened", "stopped"} <= {event.get("event") for event in events}
    assert not [word for word in secret if word in text]


async def test_hostile_messages_hurt_nobody_else_and_are_told_nothing(logged: Any) -> None:
    served, secret = logged
    secret.add("alert(1)")
    bystander, attackers = await Tab.open(served.address), [await Tab.open(served.address)]
    for kind, content in _messages(attackers[0]):
        sent = False
        while not sent:
            with suppress(ConnectionError, WebSocketClosedError):  # it may hang up on this or the one before
                await attackers[-1].send(kind, content)
                sent = True
                await attackers[-1].pull()
                continue
            attackers.append(await Tab.open(served.address))
    await _step(bystander)  # answered after everything that came before it
    assert not bystander.errors
    errors = " ".join(error for tab in attackers for error in tab.errors)
    assert "the server could not do this" in errors
    for internal in ("Traceback", "site-packages", "/app/", ".py"):
        assert internal not in errors
    for tab in (bystander, *attackers):
        await tab.close()
    assert served.ask("/liveness")[0] == 200


def test_faults_in_callbacks_count_as_those_of_messages_do(monkeypatch: pytest.MonkeyPatch) -> None:
    class Page:
        def __init__(self) -> None:
            self.document, self.faults = Document(), 0

        def shows(self, document: Document) -> bool:
            return document is self.document

        def count_fault(self) -> None:
            self.faults += 1

    page, other = pages = Page(), Page()
    monkeypatch.setattr(handlers, "_connections", list(pages))
    with set_curdoc(page.document):
        for fault in (KeyError("status"), InputError("lines", "are too many"), AttributeError("get")):
            handlers.handle_page_fault(fault)
    assert (page.faults, other.faults) == (2, 0)


def test_the_log_never_says_what_a_design_says(logged: Any) -> None:
    served, secret = logged
    served.hello(served.token("/?n=SECRETNAME&arw=0.77757deg/sqrt(h)"), search="?n=SECRETNAME&arw=0.77757deg/sqrt(h)")
    served.hello(served.token("/?n=SECRETNAME&arw=SECRETVALUE"), search="?n=SECRETNAME&arw=SECRETVALUE")
    served.ask("/SECRETPATH?x=SECRETVALUE")
    token = served.token()

    async def rubbish() -> None:
        connection = await served.connect(token)
        await connection.read_message()
        await connection.write_message('{"SECRETMESSAGE": 1}')
        await served.hang_up(connection)

    asyncio.run(rubbish())
    secret |= {"SECRETNAME", "SECRETVALUE", "SECRETMESSAGE", "0.77757", token}


@pytest.mark.slow
def test_a_message_behind_the_end_of_its_session_is_passed_over(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(handlers, "_here", SimpleNamespace(heard=lambda: None), raising=False)
    late: Any = handlers.LimitedWSHandler.__new__(handlers.LimitedWSHandler)
    late.ws_connection, late.connection = object(), ServerConnection.__new__(ServerConnection)
    late.connection._session = None
    assert asyncio.run(late._handle(SimpleNamespace(msgtype="PATCH-DOC"))) is None


def test_nobody_saves_under_another_name(serving: Any, people: Path, tmp_path: Path) -> None:
    """The field with the name is shown disabled to whoever is logged in; a browser can be made to change it."""
    place = tmp_path / "library.db"
    with serving("--password-file", str(people), "--library", str(place), "--processes", "1") as served:
        served.log_in("ada", PASSWORD)

        async def forge(name: str) -> None:
            tab = await Tab.open(served.address, served.sent["Cookie"])
            await tab.turn("Review")
            field = await tab.until(label="Your name")
            assert field["attributes"]["value"] == "ada"
            assert field["attributes"]["disabled"]
            await tab.set(field["id"], disabled=False, value=name)
            await tab.click(tab.find(label="Save as new design")["id"])
            await tab.until(label="Save as revision 2 of MEMS IMU at X band")
            await tab.close()

        asyncio.run(forge("bob"))
        asyncio.run(forge(""))
    library = Library(place)
    assert [saved.author for saved in library.designs()] == ["ada", "ada"]
    library.close()
