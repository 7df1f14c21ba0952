"""A page that for a while hears nothing of its server."""

import functools
import re

from playwright.sync_api import Page, WebSocketRoute


class Deaf:
    """A page that, while it is deaf, hears nothing of the server; what the person does there arrives."""

    def __init__(self, page: Page) -> None:
        self.deaf = False
        self._page = page
        self._messages: list[tuple[WebSocketRoute, str | bytes]] = []
        page.route_web_socket(re.compile("/ws"), self._join)

    def _join(self, socket: WebSocketRoute) -> None:
        server = socket.connect_to_server()
        server.on_message(functools.partial(self._receive, socket))

    def _receive(self, socket: WebSocketRoute, message: str | bytes) -> None:
        if self.deaf:
            self._messages.append((socket, message))
        else:
            socket.send(message)

    def hear(self) -> None:
        """Hear what was said meanwhile, in order."""
        self.deaf = False
        for socket, message in self._messages:
            socket.send(message)
        self._messages.clear()
