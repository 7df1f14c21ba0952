"""A change of the page's frame costs no walk through the whole document.

Each time anything of a component with parts changes, Panel marks everything below it as belonging to its page. For
the page itself that is the whole document, for a line that comes and goes; but each part has marked itself when it
was made.

Written for: Panel 1.9.4, panel-material-ui 0.16.6
Upstream: none found, searched 2026-11-22
Needless when: tests/app/upstream/test_page_marks.py::test_as_shipped_a_change_walks_through_the_page fails
"""

from __future__ import annotations

from typing import Any

import panel_material_ui as pmui


class OwnMarkPage(pmui.Page):
    """The page as shipped, marking itself alone."""

    @classmethod
    def _patch_datamodel_ref(cls, props: Any, ref: str) -> None:
        if (mark := f"__ref:{ref}") not in props.tags:
            props.tags.append(mark)
