"""A drawer over a part of a page: what is filled in now and then, beside what is looked at."""

from pathlib import Path
from typing import Any

import panel as pn
import panel_material_ui as pmui

from app.ui.html_pane import html_pane
from app.ui.view import View

_SHEET = Path(__file__).with_suffix(".css").read_text("utf-8")


class Drawer(View):
    """Parts under a title, and the button that opens them and closes them again.

    Attributes
    ----------
    button : Button
        For a place on the page.
    note : TextPane
        Under the title, for what the page says.
    """

    def __init__(self, title: str, icon: str, *parts: Any) -> None:
        super().__init__()
        self.button = pmui.Button(label=title, icon=icon, variant="outlined", margin=(8, 6))
        close = pmui.Button(label="Close", icon="close", variant="text", margin=(4, 6))
        head = pn.Row(html_pane(f"<h2>{title}</h2>", margin=(4, 10)), close)
        self.note = html_pane("", margin=(0, 10))
        self._view = pn.Column(head, self.note, *parts, visible=False, stylesheets=[_SHEET])
        for button in (self.button, close):
            button.on_click(lambda _: self._view.param.update(visible=not self._view.visible))

    def open(self) -> None:
        """Show the parts."""
        self._view.visible = True
