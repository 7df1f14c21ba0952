"""A server of Panel's as shipped, and what a visitor sees of it, told as JSON: run as a program of its own.

The product replaces parts of Panel and Bokeh for a whole process, so what is shipped is looked at in another.
"""

from __future__ import annotations

import asyncio
import json
import re
import socket
import sys
from typing import Any

import panel as pn
from bokeh.server.server import Server
from cryptography.fernet import Fernet
from panel.io.state import state
from tornado.httpclient import AsyncHTTPClient, HTTPClientError, HTTPRequest
from tornado.websocket import websocket_connect


async def look() -> dict[str, Any]:
    made: list[int] = []

    def app() -> pn.pane.HTML:
        made.append(1)
        return pn.pane.HTML("here")

    server = pn.serve(
        {"/": app}, address="127.0.0.1", port=0, show=False, start=False, verbose=False,
        oauth_encryption_key=Fernet.generate_key(),
    )  # fmt: skip
    server.start()
    found: dict[str, Any] = {"encrypts": state.encryption is not None}
    try:
        Server({}, port=server.port, address="127.0.0.1")
        found["binds"] = False
    except OSError:
        found["binds"] = True
    here = f"127.0.0.1:{server.port}"
    page = (await AsyncHTTPClient().fetch(f"http://{here}/", request_timeout=300)).body.decode()
    found["made"] = len(made)
    found["foreign"] = (await AsyncHTTPClient().fetch(f"http://{here}/", headers={"Host": "evil.example"})).code
    offered = []
    for path in ("autoload.js?bokeh-autoload-element=a", "metadata"):
        try:
            await AsyncHTTPClient().fetch(f"http://{here}/{path}", request_timeout=300)
            offered.append(path.partition("?")[0])
        except HTTPClientError:
            pass
    found["offered"] = offered
    token = re.search(r'"token":"([^"]+)"', page)
    assert token
    request = HTTPRequest(f"ws://{here}/ws", headers={"Origin": f"http://{here}"})
    connection = await websocket_connect(request, subprotocols=["bokeh", token[1]])

    async def answer() -> tuple[str, dict[str, Any]]:
        header, _, content = [str(await asyncio.wait_for(connection.read_message(), 300)) for _ in range(3)]
        return json.loads(header)["msgtype"], json.loads(content)

    async def send(kind: str, content: dict[str, Any]) -> None:
        for part in ({"msgid": "1", "msgtype": kind}, {}, content):
            await connection.write_message(json.dumps(part))

    async def reply() -> tuple[str, dict[str, Any]]:
        """To what was sent; changes of the document come in between."""
        while (said := await answer())[0] not in ("OK", "ERROR"):
            pass
        return said

    assert (await answer())[0] == "ACK"
    (client,) = server._tornado._clients
    stream = client._socket.ws_connection.stream.socket
    found["nodelay"] = stream.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)
    await send("PULL-DOC-REQ", {})
    assert (await answer())[0] == "PULL-DOC-REPLY"
    document, changed = client.session.document, asyncio.Event()

    def change() -> None:
        with pn.io.hold(document):
            document.title = "changed"
        changed.set()

    document.add_next_tick_callback(change)
    await changed.wait()
    await send("SERVER-INFO-REQ", {})
    found["told before it is ready"] = (await answer())[0]
    await send("PATCH-DOC", {"events": []})
    found["change"] = await reply()
    await send("PATCH-DOC", {"events": [{"kind": "ModelChanged", "model": {"id": "no such"}, "attr": "a", "new": 1}]})
    found["fault"] = await reply()
    connection.close()
    server.stop(wait=False)
    return found


if __name__ == "__main__":
    json.dump(asyncio.run(look()), sys.stdout)
