"""Closing a page does not start a full garbage collection, and no task of Panel's keeps a page.

`app.serving.collector` says when to collect instead.

Reports to send upstream, versions and ends: docs/upstream/collections.md
"""

import panel as pn
import panel.io.document


def leave_collecting() -> None:
    """Install the override permanently; the server calls it once, before it serves."""
    panel.io.document._garbage_collect = lambda: None
    pn.state._schedule_busy_cleanup()  # outside any page, and before there is a loop for its task
