"""Our own HTML on a page, in the product's sheet."""

from html import escape

from app.ui.theme import SHEET
from app.upstream.rendering import TextPane


def html_pane(text: str, margin: int | tuple[int, ...] = (4, 10)) -> TextPane:
    """Our own HTML, in the product's sheet."""
    return TextPane(text, stylesheets=[SHEET], sizing_mode="stretch_width", margin=margin)


def stale_mark(why: str) -> str:
    """The mark of what belongs to an earlier design, with the reason."""
    return f'<p><span class="stale">stale</span> {escape(why)}</p>'
