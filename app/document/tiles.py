"""Key figures as tiles of a page, each with its limit, its margin as a bar and in words.

Those that fail come first, then the other limited ones; those without a limit are one line below.
"""

from html import escape

from app.document.blocks import KeyFigure, KeyFigures
from app.document.numbers import margin_in_short


def tiles_html(figures: KeyFigures, before: KeyFigures | None = None) -> str:
    """Tiles as HTML; values ``before`` a change, found by name, are an outline of the bar and told beside it."""
    old = {figure.label: figure for figure in before.items} if before else {}
    limited = sorted(
        (figure for figure in figures.items if figure.met is not None), key=lambda figure: bool(figure.met)
    )
    tiles = "".join(_tile(figure, old.get(figure.label)) for figure in limited or figures.items)
    if not limited:
        return f'<dl class="tiles" aria-label="{escape(figures.caption)}">{tiles}</dl>'
    others = "".join(_other(figure, old.get(figure.label)) for figure in figures.items if figure.met is None)
    return (
        f'<div class="key"><dl class="tiles" aria-label="{escape(figures.caption)}">{tiles}</dl>'
        f'<dl class="others quiet" aria-label="Values without a limit">{others}</dl></div>'
    )


def _other(figure: KeyFigure, was: KeyFigure | None) -> str:
    label = escape(figure.label)
    return (
        f'<div class="card" title="{label}: {escape(figure.detail)}"><dt>{label}</dt> '
        f'<dd class="big num">{escape(figure.value)}</dd> {_change(figure, was)}</div>'
    )


def _tile(figure: KeyFigure, was: KeyFigure | None) -> str:
    mark = limit = tone = ""
    if figure.met is not None:
        tone = "good" if figure.met else "bad"
        short = ("✓" if figure.met else "✗") if figure.used is None else margin_in_short(1 - figure.used)
        mark = f'<span class="mark" title="margin">{short}</span>'
        limit = f"limit {figure.limit}"
    bar = f'<i style="width:{_share(figure.used)}%"></i>'
    if was is not None and was.met is not None:
        bar += f'<b style="width:{_share(was.used)}%"></b>'
    below = f"<span>{escape(limit or figure.limit or 'no limit')}</span>{_change(figure, was)}"
    label = escape(figure.label)
    return (
        f'<div class="card tile {tone}" title="{label}: {escape(figure.detail)}"><dt>{label}</dt>'
        f'<dd><span class="big num">{escape(figure.value)}</span> {mark}</dd>'
        f'<dd class="bar" aria-hidden="true">{bar}</dd><dd class="fine">{below}</dd></div>'
    )


def _share(used: float | None) -> str:
    return "0" if used is None else f"{100 * min(used, 1):.0f}"


def _change(figure: KeyFigure, was: KeyFigure | None) -> str:
    """The value before the change, where it was another."""
    if was is None or was.value == figure.value:
        return ""
    return f'<span class="delta num">was {escape(was.value)}</span>'
