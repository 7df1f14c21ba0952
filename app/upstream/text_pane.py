"""An HTML pane sends only its text when the text changes, and not all of its look.

Reports to send upstream, versions and ends: docs/upstream/text_pane.md
"""

from typing import Any

import panel as pn


class TextPane(pn.pane.HTML):
    """HTML whose text changes often."""

    def say(self, text: str) -> None:
        """Show another text."""
        self.object = text

    def _update(self, ref: str, model: Any) -> None:
        model.text = self._transform_object(self.object)["object"]
