"""Key figures as tiles of a page, each with its limit, its margin as a bar and in words.

Those that fail come first, then those that are open, then the other limited ones; those without a limit are one line
below. Nothing is green beside one that fails or is open.
"""

from html import escape

from app.document.blocks import KeyFigure, KeyFigures
from app.document.numbers import margin_in_short
from app.document.pane import term

_ORDER = ("not met", "refused", "open", "met")


def tiles_html(figures: KeyFigures, before: KeyFigures | None = None) -> str:
    """Tiles as HTML; values ``before`` a change, found by name, are an outline of the bar and told beside it."""
    old = {figure.label: figure for figure in before.items} if before else {}
    limited = sorted(
        (figure for figure in figures.items if figure.state), key=lambda figure: _ORDER.index(figure.state)
    )
    met = "good" if all(figure.met for figure in limited) else ""
    tones = {"met": met, "not met": "bad"}
    tiles = "".join(
        _tile(figure, old.get(figure.label), tones.get(figure.state, "")) for figure in limited or figures.items
    )
    if not limited:
        return f'<dl class="tiles" aria-label="{escape(figures.caption)}">{tiles}</dl>'
    others = "".join(_other(figure, old.get(figure.label)) for figure in figures.items if not figure.state)
    return (
        f'<div class="key"><dl class="tiles" aria-label="{escape(figures.caption)}">{tiles}</dl>'
        f'<dl class="others quiet" aria-label="Values without a limit">{others}</dl></div>'
    )


def _other(figure: KeyFigure, was: KeyFigure | None) -> str:
    return (
        f'<div class="card"><dt>{_name(figure)}</dt> '
        f'<dd><span class="big num">{escape(figure.value)}</span> {_change(figure, was)}</dd></div>'
    )


def _tile(figure: KeyFigure, was: KeyFigure | None, tone: str) -> str:
    mark = limit = ""
    if figure.state:
        short = figure.state
        if figure.met is not None:
            short = ("✓" if figure.met else "✗") if figure.used is None else margin_in_short(1 - figure.used)
        mark = f'<span class="mark" title="margin">{short}</span>'
        limit = f"limit {figure.limit}"
    bar = f'<i style="width:{_share(figure.used)}%"></i>'
    if was is not None and was.state:
        bar += f'<b style="width:{_share(was.used)}%"></b>'
    bar = f'<dd class="bar" aria-hidden="true">{bar}</dd>' if figure.state else ""
    below = f"<span>{escape(limit or figure.limit or 'no limit')}</span>{_change(figure, was)}"
    beside = f'<dd class="fine quiet">{escape(figure.beside)}</dd>' if figure.beside else ""
    return (
        f'<div class="card tile {tone}"><dt>{_name(figure)}</dt>'
        f'<dd><span class="big num{" last" if figure.last else ""}">{escape(figure.value)}</span> {mark}</dd>'
        f'{bar}<dd class="fine">{below}</dd>{beside}</div>'
    )


def _name(figure: KeyFigure) -> str:
    """The label of a figure, which unfolds what the figure is."""
    return term(escape(figure.label), figure.detail) if figure.detail else escape(figure.label)


def _share(used: float | None) -> str:
    return "0" if used is None else f"{100 * min(used, 1):.0f}"


def _change(figure: KeyFigure, was: KeyFigure | None) -> str:
    """The value before the change, where it was another."""
    if was is None or figure.last or was.last or was.value == figure.value:
        return ""
    return f'<span class="delta num">was {escape(was.value)}</span>'
