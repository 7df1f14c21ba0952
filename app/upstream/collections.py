"""Closing a page does not start a full garbage collection.

Panel collects in full some seconds after any page was closed: two seconds with fifty open ones, in which nobody is
answered. `app.serving.collector` says when to instead.

Written for: Panel 1.9.4
Upstream: holoviz/panel#6518 (merged: once for pages closed together)
Needless when: tests/app/upstream/test_collections.py::test_as_shipped_a_closed_page_is_a_full_collection fails
"""

from __future__ import annotations

import panel.io.document


def leave_collecting() -> None:
    """Install the override permanently; the server calls it once."""
    panel.io.document._garbage_collect = lambda: None
