"""Websocket frames are sent at once.

A message is a dozen small frames and more: with Nagle's algorithm the second waits until the browser has confirmed
the first, up to 40 ms. Tornado leaves it on unless asked, and Bokeh does not ask.

Written for: Panel 1.9.4, Bokeh 3.9.2, Tornado 6.6.1
Upstream: none found, searched 2026-11-22
Needless when: tests/app/upstream/test_frames_at_once.py::test_as_shipped_frames_wait fails
"""

from __future__ import annotations

from typing import Any

from panel.io.server import WSHandler


class FramesAtOnce(WSHandler):
    """A connection without Nagle's algorithm."""

    def open(self, *arguments: Any, **options: Any) -> None:
        """As Bokeh, then with TCP_NODELAY unless the connection was refused."""
        super().open(*arguments, **options)
        if self.ws_connection is not None:
            self.set_nodelay(True)
