"""The strip above a page: verdict, the value and limit that decide, cause, and what to do. It stays while the page
scrolls."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import panel as pn

from app.document.blocks import Answer
from app.document.pane import html_of
from app.ui.html_pane import html_pane
from app.ui.view import View

_SHEET = Path(__file__).with_suffix(".css").read_text("utf-8")


class AnswerStrip(View):
    """An `Answer` in one line, with controls at its right end.

    Parameters
    ----------
    answer : Answer
        Its first answer; the tone colours the strip, the word says the same without colour.
    controls : viewables
        Placed beside the answer, such as a switch or a button.

    Examples
    --------
    >>> strip = AnswerStrip(Answer("✓ Closes", "good", ("Margin +6 %.",)))
    >>> strip.show(Answer("✗ Does not close", "bad", ("2.44 × the limit.",)), "1 input is invalid.")
    """

    def __init__(self, answer: Answer, *controls: Any) -> None:
        super().__init__()
        self._text = html_pane(_strip_html(answer, ""), margin=0)
        self._view = pn.Row(self._text, *controls, css_classes=[answer.tone], stylesheets=[_SHEET])

    def show(self, answer: Answer, note: str = "") -> None:
        """Show another answer. A ``note`` says why it is one of other inputs: the strip is grey then."""
        self._text.say(_strip_html(answer, note))
        self._view.css_classes = ["open" if note else answer.tone]


def _strip_html(answer: Answer, note: str) -> str:
    if note:
        answer = replace(answer, sentences=(f"⚠ {note}", *answer.sentences))
    return html_of(answer).replace('class="', 'class="bare ', 1)
