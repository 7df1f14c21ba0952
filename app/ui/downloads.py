"""Small downloads under a chart or a table."""

from __future__ import annotations

import io
from collections.abc import Awaitable, Callable

import panel_material_ui as pmui


def download(
    label: str, filename: str, make: Callable[[], io.BytesIO] | Callable[[], Awaitable[io.BytesIO]]
) -> pmui.FileDownload:
    """A link-like button; `make` is called when it is pressed."""
    return pmui.FileDownload(
        callback=make, filename=filename, label=label, description="", variant="text", size="small", margin=(0, 8)
    )
