"""What the shipped libraries do badly in the browser, mended there: invisible parts that stand on every page."""

from __future__ import annotations

from panel.custom import JSComponent

from app.mends.back_button import BackButton
from app.mends.layout_passes import LayoutPasses
from app.mends.select_keys import SelectKeys
from app.mends.style_writes import StyleWrites


def mends() -> list[JSComponent]:
    """One of each, for a page's main column."""
    return [kind(margin=0, width=0, height=0) for kind in (StyleWrites, SelectKeys, BackButton, LayoutPasses)]
