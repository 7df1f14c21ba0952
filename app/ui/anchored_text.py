"""Long text with anchors: the page's address cannot reach into a component."""

from typing import ClassVar

import param

from app.ui.theme import SHEET
from app.upstream.plain_script import PlainScript


class AnchoredText(PlainScript):
    """Our own HTML; `go_to` brings an element into view by its id, and the keyboard with it."""

    html = param.String(default="", doc="Already escaped.")
    asked = param.String(default="", doc="The id last asked for, and a count so that it can be asked for again.")

    _stylesheets: ClassVar[list[str]] = [SHEET]

    def go_to(self, name: str) -> None:
        """Bring the element of this id into view; an unknown one changes nothing."""
        count = int(self.asked.rpartition(" ")[2] or 0) + 1
        self.asked = f"{name} {count}"
