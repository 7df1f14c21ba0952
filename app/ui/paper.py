"""The page on paper: without tools, black on white, charts as wide as the sheet.

A figure is drawn for the screen and keeps its width when the sheet is narrower, so it is made smaller as a whole
just before printing. The rest is style: each part's own sheet says what it does on paper (`app.ui.theme`).
"""

from __future__ import annotations

from bokeh.document import Document
from bokeh.events import DocumentReady
from bokeh.models import CustomJS

_WIDTH = 690  # CSS pixels of an A4 sheet between its margins, less a frame's

_SCRIPT = (
    """
const style = document.createElement("style")
style.textContent = "@media print { @page { margin: 12mm } html, body { height: auto !important } }"
document.head.append(style)
const figures = (root) => [...root.querySelectorAll("*")].flatMap((element) =>
  element.classList.contains("bk-Figure") ? [element] : element.shadowRoot ? figures(element.shadowRoot) : [])
window.addEventListener("beforeprint", () => {
  for (const figure of figures(document)) figure.style.zoom = Math.min(1, WIDTH / (figure.offsetWidth || 1))
})
window.addEventListener("afterprint", () => {
  for (const figure of figures(document)) figure.style.zoom = ""
})
""".replace("WIDTH", str(_WIDTH))
)  # fmt: skip


def fit_to_paper(document: Document) -> None:
    """Make this page fit the sheet when it is printed."""
    document.js_on_event(DocumentReady, CustomJS(code=_SCRIPT))
