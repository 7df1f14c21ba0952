"""Closing a page does not start a full garbage collection, and no task of Panel's keeps a page.

Panel collects in full some seconds after any page was closed: two seconds with fifty open ones, in which nobody is
answered. `app.serving.collector` says when to instead. And the first page starts a task that never ends, and whose
context holds that page.

Written for: Panel 1.9.4
Upstream: holoviz/panel#6518 (merged: once for pages closed together)
Needless when: tests/app/upstream/test_collections.py::test_as_shipped_a_closed_page_is_a_full_collection fails
"""

from __future__ import annotations

import panel as pn
import panel.io.document


def leave_collecting() -> None:
    """Install the override permanently; the server calls it once, before it serves."""
    panel.io.document._garbage_collect = lambda: None
    pn.state._schedule_busy_cleanup()  # outside any page, and before there is a loop for its task
