"""A page of the server spoken to over its socket by somebody who means harm: only their own page suffers."""

from __future__ import annotations

import asyncio
import json
from contextlib import suppress
from pathlib import Path
from typing import Any

import pytest
from open_page import Tab
from tornado.websocket import WebSocketClosedError
from waiting import PATIENCE

from app.library.store import Library

PASSWORD = "correct horse battery"
_SLIDER = {"label": "Angle random walk", "show_value": False}
_DATA = ("timelines", "response lines 0")


async def _step(tab: Tab) -> None:
    """A slider step that must be answered."""
    slider = tab.find(**_SLIDER)
    answered = tab.expect({(await tab.until(name=name))["id"] for name in _DATA})
    slider["attributes"]["value"] -= 0.02
    await tab.set(slider["id"], value=slider["attributes"]["value"])
    await asyncio.wait_for(answered, PATIENCE)


def _change(model: str, attribute: str, value: Any) -> dict[str, Any]:
    return {"events": [{"kind": "ModelChanged", "model": {"id": model}, "attr": attribute, "new": value}]}


def _messages(tab: Tab) -> list[tuple[str, Any]]:
    slider, box = tab.find(**_SLIDER)["id"], tab.find(label="Angle random walk", name="Angle random walk")["id"]
    return [
        ("PATCH-DOC", _change(slider, "value", "a lot")),
        ("PATCH-DOC", _change(slider, "value", [None])),
        ("PATCH-DOC", _change(slider, "value", {"type": "number", "value": "nan"})),
        ("PATCH-DOC", _change(slider, "value", {"type": "number", "value": "+inf"})),
        ("PATCH-DOC", _change(slider, "value", 1e308)),
        ("PATCH-DOC", _change(slider, "no_such_thing", 1)),
        ("PATCH-DOC", _change("p999999", "value", 1)),
        ("PATCH-DOC", _change(box, "value", "9" * 1_000_000)),
        ("PATCH-DOC", _change(box, "value", "<script>alert(1)</script>")),
        ("PATCH-DOC", {"events": [{"kind": "Explode"}]}),
        (
            "PATCH-DOC",
            {"events": [{"kind": "MessageSent", "msg_type": "bokeh_event", "msg_data": {"type": "event"}}]},
        ),
        ("PATCH-DOC", {"events": [{"kind": "RootRemoved", "model": {"id": slider}}]}),
        ("PATCH-DOC", "[" * 50_000 + "]" * 50_000),
        ("PATCH-DOC", "not JSON"),
        ("PUSH-DOC", {"doc": {"version": "3.9.2", "title": "owned", "roots": []}}),
        ("NO-SUCH-MESSAGE", {}),
    ]


def test_hostile_messages_hurt_nobody_else_and_are_told_nothing(serving: Any, tmp_path: Path) -> None:
    log = tmp_path / "log"
    with serving("--log", "json", "--library", str(tmp_path / "l.db"), log=log) as served:
        address = f"http://127.0.0.1:{served.port}"

        async def attack() -> None:
            bystander, attackers = await Tab.open(address), [await Tab.open(address)]
            for kind, content in _messages(attackers[0]):
                sent = False
                while not sent:
                    with suppress(ConnectionError, WebSocketClosedError):  # it may hang up on this or the one before
                        await attackers[-1].send(kind, content)
                        sent = True
                        await attackers[-1].pull()
                        continue
                    attackers.append(await Tab.open(address))
            await _step(bystander)  # answered after everything that came before it
            assert not bystander.errors
            said = " ".join(error for tab in attackers for error in tab.errors)
            assert "the server could not do this" in said
            for secret in ("Traceback", "site-packages", "/app/", ".py"):
                assert secret not in said
            for tab in (bystander, *attackers):
                await tab.close()

        asyncio.run(attack())
        assert served.ask("/liveness")[0] == 200
    text = log.read_text()
    assert "alert(1)" not in text
    assert all(json.loads(line) for line in text.splitlines())


@pytest.mark.slow
def test_nobody_saves_under_another_name(serving: Any, people: Path, tmp_path: Path) -> None:
    """The field with the name is shown disabled to whoever is logged in; a browser can be made to change it."""
    place = tmp_path / "library.db"
    with serving("--password-file", str(people), "--library", str(place), "--processes", "1") as served:
        served.log_in("ada", PASSWORD)
        cookies = "; ".join(f"{key}={value}" for key, value in served.cookies.items())

        async def forge(name: str) -> None:
            tab = await Tab.open(f"http://127.0.0.1:{served.port}", cookies)
            await tab.turn("Review")
            field = await tab.until(label="Your name")
            assert field["attributes"]["value"] == "ada"
            assert field["attributes"]["disabled"]
            await tab.set(field["id"], disabled=False, value=name)
            await tab.click(tab.find(label="Save as new design")["id"])
            await tab.until(label="1 revision")
            await tab.close()

        asyncio.run(forge("bob"))
        asyncio.run(forge(""))
    library = Library(place)
    assert [saved.author for saved in library.designs()] == ["ada", "ada"]
    library.close()
