"""The printed page: design, date and version on top, no tools, black on white, charts as wide as the sheet.

A figure is drawn for the screen and keeps its width when the sheet is narrower, so it is made smaller as a whole
just before printing. The rest is style: each part's own sheet says what it does on paper (`app.ui.theme`).
"""

from importlib.metadata import version
from pathlib import Path

from bokeh.document import Document
from bokeh.events import DocumentReady
from bokeh.models import CustomJS

_WIDTH = 690  # CSS pixels of an A4 sheet between its margins, less a frame's

_SCRIPT = Path(__file__).with_suffix(".js").read_text("utf-8").replace("WIDTH", str(_WIDTH))
_SCRIPT = _SCRIPT.replace("VERSION", version("navbudget"))


def fit_to_paper(document: Document) -> None:
    """Make this page fit the sheet when it is printed."""
    document.js_on_event(DocumentReady, CustomJS(code=_SCRIPT))
