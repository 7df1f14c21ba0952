"""Text for our own HTML."""

import re
from html import escape

from nav_model.equations import ALL_EQUATIONS

_MARK = re.compile(r"\[([A-Z]-\d+)\]")
_TITLES = {equation.mark: equation.title for equation in ALL_EQUATIONS}


def prose(text: str) -> str:
    """Text for our own HTML: escaped, equation marks such as [T-9] linked to the Theory page."""
    return _MARK.sub(_link, escape(text))


def _link(found: re.Match[str]) -> str:
    mark = found[1]
    if mark not in _TITLES:
        return f'<span class="nw">{found[0]}</span>'
    return f'<a class="eq" href="#theory-{mark}" title="{escape(_TITLES[mark])}">{found[0]}</a>'
