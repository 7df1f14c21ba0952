"""A component marks only itself as belonging to its page, without walking through its parts.

When a component is made, and each time anything of one with parts changes, Panel marks everything below it as
belonging to its page: at each level again, and for the page's frame the whole document. But each part has marked
itself when it was made.

Written for: Panel 1.9.4, panel-material-ui 0.16.6
Upstream: none found, searched 2026-11-22
Needless when: tests/app/upstream/test_page_marks.py::test_as_shipped_a_change_walks_through_the_page fails
"""

from __future__ import annotations

from typing import Any

from panel.reactive import ReactiveCustomBase


def _mark(_: type[ReactiveCustomBase], props: Any, ref: str) -> None:
    if (mark := f"__ref:{ref}") not in props.tags:
        props.tags.append(mark)


def mark_own_part() -> None:
    """Install the override; the server calls it once, before it serves."""
    ReactiveCustomBase._patch_datamodel_ref = classmethod(_mark)
