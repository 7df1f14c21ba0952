"""Limits on what a page sends: counted by message, and by session for what its changes leave on the server.

Bokeh bounds a frame. A message may have any number of them, and a document keeps whatever a browser adds to it.
"""

import json
from typing import Any

FRAME = 256
"""Bytes that a frame of a message costs beside its content."""
_SHARE = 5  # of the largest message, for what all changes of a session leave


class Allowance:
    """Memory that the changes of one session leave: the last value of each attribute of each model.

    `most` is the largest message [bytes]; a fifth of it may stay.
    """

    def __init__(self, most: int) -> None:
        self._most = most / _SHARE
        self._left: dict[tuple[str, str], int] = {}
        self._sum = 0

    def against(self, message: Any) -> str:
        """Why a message is refused; empty if it is taken, and counted."""
        if message.msgtype == "PULL-DOC-REQ":
            return ""
        if message.msgtype != "PATCH-DOC":
            return "a message that no page sends"
        try:
            for event in message.content["events"]:
                if event["kind"] == "MessageSent":  # its receiver bounds what it keeps
                    continue
                if event["kind"] != "ModelChanged":
                    return "a change that no page makes"
                self._count((event["model"]["id"], event["attr"]), _size(event, message))
        except (KeyError, TypeError):
            return "malformed"
        return "" if self._sum <= self._most else "too much for one page"

    def _count(self, place: tuple[str, str], size: int) -> None:
        self._sum += size - self._left.get(place, 0)
        self._left[place] = size


def _size(event: Any, message: Any) -> int:
    return len(json.dumps(event)) + sum(len(buffer.to_bytes()) for buffer in message.buffers)
