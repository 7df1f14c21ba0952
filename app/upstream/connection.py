"""How a page's connection is kept, and what it says: each class here is a part of its handler.

Frames are sent at once, a connection lost at a ping closes without an error, and errors are sent without a traceback,
which would reveal paths and versions.

Reports to send upstream, versions and ends: docs/upstream/connection.md
"""

from typing import Any

from panel.io.server import WSHandler


class FramesAtOnce(WSHandler):
    """A connection without Nagle's algorithm."""

    def open(self, *arguments: Any, **options: Any) -> None:
        """As Bokeh, then with TCP_NODELAY unless the connection was refused."""
        super().open(*arguments, **options)
        if self.ws_connection is not None:
            self.set_nodelay(True)


class LostConnection(WSHandler):
    """Closes in silence once it has no session to tell."""

    def on_close(self) -> None:
        """As Bokeh, unless nobody is there."""
        if self.connection is None or self.connection._session is not None:
            super().on_close()

    def _given_up(self) -> bool:
        """Whether there is no session for a message that came all the same."""
        return self.connection is None or self.connection._session is None


class NoTracebacks(WSHandler):
    """Tells that something failed, and no more."""

    async def send_message(self, message: Any) -> None:
        """As Bokeh, but for what an error carries."""
        if message.msgtype == "ERROR":
            message.content = {"text": "the server could not do this", "traceback": None}
        await super().send_message(message)
