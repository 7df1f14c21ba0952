"""What the shipped libraries do badly in the browser, mended there: invisible parts that stand on every page."""

from __future__ import annotations

from panel.custom import JSComponent

from app.upstream.back_button import BackButton
from app.upstream.layout_passes import LayoutPasses
from app.upstream.select_keys import SelectKeys
from app.upstream.style_writes import StyleWrites


def mends() -> list[JSComponent]:
    """One of each, for a page's main column."""
    return [kind(margin=0, width=0, height=0) for kind in (StyleWrites, SelectKeys, BackButton, LayoutPasses)]
