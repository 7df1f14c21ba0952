"""An open page without a browser: Bokeh's protocol over a websocket, as chromium was seen to speak it."""

from __future__ import annotations

import asyncio
import json
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, Self

from tornado.httpclient import AsyncHTTPClient, HTTPRequest
from tornado.websocket import WebSocketClientConnection, websocket_connect

_CHARTS = 4  # of the Budget page
_TOKEN = re.compile(r'"token":"([^"]+)"')


@dataclass
class Tab:
    """One open page; ``errors`` are what the server said of its own fault, or that it hung up; ``heard`` is called
    with each change that arrives."""

    server: str
    connection: WebSocketClientConnection
    objects: list[dict[str, Any]] = field(default_factory=list)
    errors: list[str] = field(default_factory=list)
    heard: Callable[[str], None] | None = None
    _sent: int = 0
    _messages: int = 0
    _closing: bool = False
    _waiting: set[str] = field(default_factory=set)
    _answered: asyncio.Future[None] | None = None
    _greeted: asyncio.Event = field(default_factory=asyncio.Event)
    _reply: asyncio.Future[str] | None = None
    _reading: asyncio.Task[None] | None = None

    @classmethod
    async def open(cls, server: str, cookies: str = "") -> Tab:
        """Fetch the page, connect, take the document, say that it stands."""
        tab = await cls.connect(server, await cls.fetch(server, cookies), cookies)
        await tab.greeted()
        await tab.pull()
        await tab.event("document_ready")
        await asyncio.wait_for(tab._stand(), 120)
        return tab

    @staticmethod
    async def fetch(server: str, cookies: str = "") -> str:
        """The token of a page."""
        known = {"Cookie": cookies} if cookies else {}
        page = await AsyncHTTPClient().fetch(server + "/", headers=known, request_timeout=120)
        match = _TOKEN.search(page.body.decode())
        assert match, "no token in the page"
        return match[1]

    @classmethod
    async def connect(cls, server: str, token: str, cookies: str = "") -> Self:
        """The page of a token, connected and no more."""
        known = {"Cookie": cookies} if cookies else {}
        request = HTTPRequest(server.replace("http", "ws") + "/ws", headers={"Origin": server, **known})
        connection = await websocket_connect(
            request, subprotocols=["bokeh", token], max_message_size=100_000_000, ping_interval=0
        )
        assert connection.protocol is not None
        connection.protocol.set_nodelay(True)  # as browsers do
        tab = cls(server, connection)
        tab._reading = asyncio.create_task(tab._read())
        return tab

    async def greeted(self) -> None:
        """The server knows the page: what is sent before its greeting is lost."""
        await asyncio.wait_for(self._greeted.wait(), 120)

    async def _stand(self) -> None:
        """Take the document until its charts are there."""
        while sum(model["name"] == "Figure" for model in self.objects) < _CHARTS:
            await asyncio.sleep(0.05)
            await self.pull()

    async def pull(self) -> None:
        """Take the document as it is now."""
        await self.ask()
        await self.taken()

    async def ask(self) -> None:
        """Ask for the document."""
        self._reply = asyncio.get_running_loop().create_future()
        await self.send("PULL-DOC-REQ", {})

    async def taken(self) -> None:
        """The document that was asked for is there."""
        assert self._reply is not None
        self.objects = list(_objects(json.loads(await asyncio.wait_for(self._reply, 120))["doc"]))

    def find(self, **wanted: Any) -> dict[str, Any]:
        """The model that has these attributes."""
        for model in self.objects:
            if wanted.items() <= {k: v for k, v in model["attributes"].items() if _plain(v)}.items():
                return model
        raise LookupError(f"no model with {wanted}")

    async def until(self, **wanted: Any) -> dict[str, Any]:
        """The model that has these attributes, once the page has it: what is below the first screen comes later."""
        async with asyncio.timeout(120):
            while True:
                try:
                    return self.find(**wanted)
                except LookupError:
                    await asyncio.sleep(0.3)
                    await self.pull()

    async def set(self, model: str, **values: Any) -> None:
        """Change a model as the browser's side does."""
        for name, value in values.items():
            change = {"kind": "ModelChanged", "model": {"id": model}, "attr": name, "new": value}
            await self.send("PATCH-DOC", {"events": [change]})

    async def turn(self, title: str) -> None:
        """Turn to the tab of this title."""
        bar = next(model for model in self.objects if "tabs" in model["attributes"])
        await self.set(bar["id"], active=[tab[1] for tab in bar["attributes"]["tabs"]].index(title))

    async def event(self, name: str, **values: Any) -> None:
        """Send an event such as a click."""
        entries = {"entries": list(values.items())} if values else {}
        data = {"type": "event", "name": name, "values": {"type": "map", **entries}}
        await self.send(
            "PATCH-DOC", {"events": [{"kind": "MessageSent", "msg_type": "bokeh_event", "msg_data": data}]}
        )

    async def click(self, data: str) -> None:
        """Press the button that shows this model's data."""
        await self.event(
            "dom_event", model={"id": self._shown_by(data)}, node="click", data={"type": "map", "entries": []}
        )

    def _shown_by(self, data: str) -> str:
        """The model that the browser makes a component of, by that of its data."""
        return next(m["id"] for m in self.objects if _id(m["attributes"].get("data")) == data)

    def row(self, key: str) -> tuple[str, dict[str, Any]]:
        """The sheet of the design, and all that it first said of an input."""
        for model in self.objects:
            for group in model["attributes"].get("groups", ()):
                for row in dict(group["entries"])["rows"]:
                    if (entries := dict(row["entries"]))["key"] == key:
                        return self._shown_by(model["id"]), entries
        raise LookupError(f"no row {key}")

    async def slide(self, key: str, place: float) -> None:
        """Move the slider of an input to a place."""
        await self.tell(key, place=place)

    async def tell(self, key: str, **done: Any) -> None:
        """Say what a person does to the row of an input."""
        self._messages += 1
        entries = [["key", key], ["number", self._messages], *map(list, done.items())]
        sheet = self.row(key)[0]
        await self.event("data_event", model={"id": sheet}, data={"type": "map", "entries": entries})

    def expect(self, models: set[str]) -> asyncio.Future[None]:
        """Done when each of these models has been heard of again."""
        self._waiting, self._answered = set(models), asyncio.get_running_loop().create_future()
        return self._answered

    async def close(self) -> None:
        """Hang up."""
        self._closing = True
        self.connection.close()
        if self._reading is not None:
            await self._reading  # the server's answer; without it the socket would be left to the collector

    async def cut(self) -> None:
        """Lose the connection without a word, whatever is under way."""
        self._closing = True
        assert self.connection.protocol is not None
        self.connection.protocol.stream.close()
        if self._reading is not None:
            await self._reading

    async def send(self, kind: str, content: Any) -> None:
        """Send a message; text goes as it is."""
        self._sent += 1
        header = json.dumps({"msgid": str(self._sent), "msgtype": kind})
        text = content if isinstance(content, str) else json.dumps(content)
        # Written at once, then waited for: where one waits between frames, those of another message come between.
        await asyncio.gather(*map(self.connection.write_message, (header, "{}", text)))

    async def _message(self) -> tuple[str, Any] | None:
        """Kind and content of the next message; None where the connection ends before its last frame.

        They are its first and third frame; the frames of arrays are counted, not looked at.
        """
        frames: list[Any] = []
        expected = 3
        while expected:
            if (frame := await self.connection.read_message()) is None:  # told once: no other may be waited for
                return None
            if not frames:
                expected += 2 * json.loads(frame).get("num_buffers", 0)
            frames.append(frame)
            expected -= 1
        return json.loads(frames[0])["msgtype"], frames[2]

    async def _read(self) -> None:
        while (message := await self._message()) is not None:
            kind, content = message
            if kind == "ACK":
                self._greeted.set()
            elif kind == "PULL-DOC-REPLY" and self._reply is not None:
                self._reply.set_result(str(content))
            elif kind == "PATCH-DOC":
                if self.heard is not None:
                    self.heard(str(content))
                if not self._waiting:
                    continue
                self._waiting -= {model for model in self._waiting if f'"{model}"' in str(content)}
                if not self._waiting and self._answered is not None and not self._answered.done():
                    self._answered.set_result(None)
            elif kind == "ERROR":
                self.errors.append(str(content))
        if self._reply is not None and not self._reply.done() and not self._closing:
            self._reply.set_exception(ConnectionError("the server hung up"))
        if not self._closing:
            self.errors.append(f"the server hung up: {self.connection.close_code} {self.connection.close_reason}")


def _objects(part: Any) -> Iterator[dict[str, Any]]:
    if isinstance(part, dict):
        if part.get("type") == "object" and "attributes" in part:
            yield part
        for value in part.values():
            yield from _objects(value)
    elif isinstance(part, list):
        for value in part:
            yield from _objects(value)


def _id(value: Any) -> str | None:
    return value.get("id") if isinstance(value, dict) else None


def _plain(value: Any) -> bool:
    return isinstance(value, str | int | float | bool)
