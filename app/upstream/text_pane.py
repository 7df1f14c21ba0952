"""An HTML pane sends only its text when the text changes.

Panel works out and sends all of its look again, its sheet included: a quarter of a slider's step.

Written for: Panel 1.9.4
Upstream: holoviz/panel#5278 (merged: for designs only)
Needless when: tests/app/upstream/test_text_pane.py::test_as_shipped_a_new_text_sends_the_sheet_again fails
"""

from __future__ import annotations

from typing import Any

import panel as pn


class TextPane(pn.pane.HTML):
    """HTML whose text changes often."""

    def say(self, text: str) -> None:
        """Show another text."""
        self.object = text

    def _update(self, ref: str, model: Any) -> None:
        model.text = self._transform_object(self.object)["object"]
