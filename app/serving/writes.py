"""Two repairs of how Panel (1.9.4) writes changes to the browser.

Changes that are made while earlier ones are being written reach the browser too. Panel queues them and starts a task
for them; but that task returns without a look at the queue when the task before it has just taken the mark off that
something is being written. What was queued, the last news of a run for one, then waited for the next thing that
person did.

And they go out as soon as the connection is free. Where another message is just being written, the answer to a
slider's step for one, Panel looks again 10 ms later.
"""

from __future__ import annotations

import panel.io.document as panel_document
from bokeh.document import Document

_as_shipped = panel_document._dispatch_msgs


async def _dispatch_msgs(doc: Document) -> None:
    for connection in list(panel_document._WRITE_MSGS.get(doc, ())):
        if (lock := getattr(connection._socket, "write_lock", None)) is not None:
            async with lock:
                pass
    if panel_document._WRITE_MSGS.get(doc):
        panel_document._WRITE_BLOCK[doc] = True
    await _as_shipped(doc)


def repair() -> None:
    """Put them in place; the server calls it once, before it serves."""
    panel_document._dispatch_msgs = _dispatch_msgs
