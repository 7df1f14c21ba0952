"""Fonts are loaded for the characters that a page has.

Reports to send upstream, versions and ends: docs/upstream/fonts.md
"""

from panel_material_ui.base import FONT_CSS


def load_fonts_by_need() -> None:
    """Leave out the sheet that declares each font once more; the server calls it once, before it serves."""
    FONT_CSS.clear()
