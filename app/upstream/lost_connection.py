"""A connection lost at a ping closes without an error.

Bokeh takes its session away when a ping fails, and asks for it when Tornado then reports the connection closed: an
AssertionError in the log for each.

Written for: Panel 1.9.4, Bokeh 3.9.2
Upstream: bokeh/bokeh#13655 (merged: the ping cleans up, and so brought this)
Needless when: tests/app/upstream/test_lost_connection.py::test_as_shipped_closing_is_a_fault fails
"""

from __future__ import annotations

from panel.io.server import WSHandler


class LostConnection(WSHandler):
    """Closes in silence once it has no session to tell."""

    def on_close(self) -> None:
        """As Bokeh, unless nobody is there."""
        if self.connection is None or self.connection._session is not None:
            super().on_close()
