"""An HTML pane sends only its text when the text changes.

Panel works out and sends all of its look again, its sheet included: half of a slider's step. And it asks, for each
text, whether and how the page may be told, which is known while changes are held: three times the work of telling it.

Written for: Panel 1.9.4
Upstream: holoviz/panel#5278 (merged: for designs only)
Needless when: tests/app/upstream/test_text_pane.py::test_as_shipped_a_new_text_sends_the_sheet_again fails
"""

from __future__ import annotations

from typing import Any

import panel as pn
from param.parameterized import discard_events


class TextPane(pn.pane.HTML):
    """HTML whose text changes often."""

    def say(self, text: str) -> None:
        """Show another text; in a hold only the browser is notified, not the watchers of the pane."""
        if self.object == text:  # type: ignore[has-type]
            return
        document = pn.state.curdoc
        if document is None or not document.callbacks.hold_value:
            self.object = text
            return
        with discard_events(self):
            self.object = text
        for ref, (model, _) in self._models.items():
            self._update(ref, model)

    def _update(self, ref: str, model: Any) -> None:
        model.text = self._transform_object(self.object)["object"]
