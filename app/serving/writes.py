"""A repair of Panel (1.9.4): changes that are made while earlier ones are being written reach the browser too.

Panel queues them and starts a task for them; but that task returns without a look at the queue when the task before
it has just taken the mark off that something is being written. What was queued, the last news of a run for one, then
waited for the next thing that person did.
"""

from __future__ import annotations

import panel.io.document as panel_document
from bokeh.document import Document

_as_shipped = panel_document._dispatch_msgs


async def _dispatch_msgs(doc: Document) -> None:
    if panel_document._WRITE_MSGS.get(doc):
        panel_document._WRITE_BLOCK[doc] = True
    await _as_shipped(doc)


def repair() -> None:
    """Put it in place; the server calls it once, before it serves."""
    panel_document._dispatch_msgs = _dispatch_msgs
