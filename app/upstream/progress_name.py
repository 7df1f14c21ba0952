"""The line that shows long work has a name for screen readers, which the page as shipped leaves out.

Written for: panel-material-ui 0.16.6
Upstream: none found, searched 2026-11-22
Needless when: tests/browser/test_as_shipped.py::test_the_busy_line_has_no_name fails
"""

from __future__ import annotations

from typing import Any

PROGRESS_NAME: dict[str, Any] = {"defaultProps": {"aria-label": "long work under way"}}
"""Of a theme's component ``MuiLinearProgress``."""
