"""Blocks of a document as HTML: on a page in the product's own sheet, and in an HTML report."""

from __future__ import annotations

from collections.abc import Callable
from html import escape
from itertools import groupby

from app.document.blocks import Answer, Block, Bullets, Cell, Column, KeyFigure, KeyFigures, Table, Text
from app.document.prose import prose

Said = Callable[[str], str]
"""Literal text -> HTML: escaped, its equation marks as links to where this document has them."""


def html_of(*blocks: Block, said: Said = prose) -> str:
    """Blocks as HTML, in order.

    Raises
    ------
    KeyError
        For a block that is more than text, such as a chart, which each document draws in its own way.
    """
    return "".join(_RENDERERS[type(block)](block, said) for block in blocks)


def _answer(answer: Answer, said: Said) -> str:
    why = "".join(f"<p>{said(sentence)}</p>" for sentence in answer.sentences)
    return f'<div class="strip {answer.tone}" role="status"><h2>{escape(answer.word)}</h2>{why}</div>'


def _key_figures(figures: KeyFigures, said: Said) -> str:
    cards = "".join(_card(figure, said) for figure in figures.items)
    return f'<dl class="cards" aria-label="{escape(figures.caption)}">{cards}</dl>'


def _card(figure: KeyFigure, said: Said) -> str:
    limit = ""
    if figure.met is not None:
        mark = "✓ within" if figure.met else "✗ over"
        limit = (
            f'<dd class="fine"><span class="mark">{mark}</span> the limit '
            f'<span class="num">{escape(figure.limit)}</span></dd>'
        )
    return (
        f'<div class="card"><dt>{escape(figure.label)}</dt><dd class="big num">{escape(figure.value)}</dd>'
        f'<dd class="fine quiet">{said(figure.detail)}</dd>{limit}</div>'
    )


def _table(table: Table, said: Said) -> str:
    """A table in a region that scrolls by itself; a mark is printed as a word, never by colour alone."""
    classes = [_css(column) for column in table.columns]
    rows, body = [], "<tbody>"
    for row in table.rows:
        if len(row) == 1:
            rows.append(
                f'{"</tbody>" if rows else ""}<tbody><tr class="group"><th scope="rowgroup" colspan="{len(classes)}">'
                f"{said(row[0].text)}</th></tr>"
            )
            body = ""
            continue
        cells = "".join(f"<td{css}>{_cell(cell, said)}</td>" for cell, css in zip(row[1:], classes[1:], strict=True))
        rows.append(f'{body}<tr><th scope="row">{_cell(row[0], said)}</th>{cells}</tr>')
        body = ""
    note = f'<p class="note quiet">{said(table.note)}</p>' if table.note else ""
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="{escape(table.caption)}">'
        f'<table class="checks" id="{escape(table.key)}"><caption>{said(table.caption)}</caption>'
        f"<thead>{_heads(table.columns, said)}</thead>{''.join(rows)}</tbody></table></div>{note}"
    )


def _heads(columns: tuple[Column, ...], said: Said) -> str:
    groups = ""
    if any(column.group for column in columns):
        parts = []
        for name, members in groupby(columns, key=lambda column: column.group):
            width = len(list(members))
            parts.append(f'<th scope="colgroup" colspan="{width}">{said(name)}</th>' if name else "<td></td>" * width)
        groups = f"<tr>{''.join(parts)}</tr>"
    heads = "".join(f'<th scope="col"{_css(column)}>{said(column.title)}</th>' for column in columns)
    return f"{groups}<tr>{heads}</tr>"


def _css(column: Column) -> str:
    return ' class="num"' if column.numeric else ""


def _cell(cell: Cell, said: Said) -> str:
    if cell.mark:
        return f'{said(cell.text)} <span class="mark {cell.tone}">{escape(cell.mark)}</span>'
    return f'<span class="tone {cell.tone}">{said(cell.text)}</span>' if cell.tone else said(cell.text)


def _text(text: Text, said: Said) -> str:
    return f"<p>{said(text.text)}</p>"


def _bullets(bullets: Bullets, said: Said) -> str:
    label = f' aria-label="{escape(bullets.caption)}"' if bullets.caption else ""
    items = "".join(f"<li>{said(item)}</li>" for item in bullets.items)
    return f'<ul class="cautions quiet"{label}>{items}</ul>'


_RENDERERS: dict[type, Callable[..., str]] = {
    Answer: _answer,
    KeyFigures: _key_figures,
    Table: _table,
    Text: _text,
    Bullets: _bullets,
}
