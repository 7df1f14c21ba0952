"""A column may be taller than the window.

Bokeh limits heights to 100 % of the parent: in a page's main column the window, for each table and column
below. What is taller would hang over the next.

Written for: Bokeh 3.9.2, panel-material-ui 0.16.6
Upstream: none found, searched 2026-11-22
Needless when: tests/browser/test_as_shipped.py::test_a_column_does_not_grow_over_the_window fails
"""

from __future__ import annotations

FULL_HEIGHT = {"max-height": "none"}
"""Styles of the page's main column, and of a column of several parts in one that scrolls."""
