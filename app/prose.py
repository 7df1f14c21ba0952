"""Text for our own HTML."""

from __future__ import annotations

import re
from html import escape

_MARK = re.compile(r"\[[A-Z]-\d+\]")


def prose(text: str) -> str:
    """Text for our own HTML: escaped, equation marks such as [T-9] kept in one piece."""
    return _MARK.sub(r'<span class="nw">\g<0></span>', escape(text))
