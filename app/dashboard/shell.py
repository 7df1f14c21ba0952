"""The page's own component: sidebar, bar and what stands below."""

from __future__ import annotations

from typing import Any

import panel_material_ui as pmui


class Shell(pmui.Page):
    """The page as shipped, but its busy line may come and go without a walk through the whole document.

    That walk marks everything below as belonging to this page, each time anything of the page changes; but each
    component has marked itself when it was made.
    """

    @classmethod
    def _patch_datamodel_ref(cls, props: Any, ref: str) -> None:
        if (mark := f"__ref:{ref}") not in props.tags:
            props.tags.append(mark)
