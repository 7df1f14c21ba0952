"""Blocks of a document as HTML: on a page in the product's own sheet, and in an HTML report."""

import re
from collections.abc import Callable
from html import escape
from itertools import groupby

from app.document.blocks import MARK, UNIT_GAP, Answer, Block, Bullets, Cell, Column, TableBlock, Text
from nav_model.equations import ALL_EQUATIONS

Prose = Callable[[str], str]
"""Literal text -> HTML: escaped, its equation marks as links to where this document has them."""
_TITLES = {equation.mark: equation.title for equation in ALL_EQUATIONS}
_RATE = re.compile(r"[\d.]+[ \N{NO-BREAK SPACE}][°µ\w]+/[°µ√\w/]+")  # a line may end at the stroke of m/s/√h


def prose(text: str) -> str:
    """Text for our pages: escaped, numbers kept with their units, marks such as [T-9] linked to the Theory page."""
    escaped = escape(UNIT_GAP.sub("\N{NO-BREAK SPACE}", text))
    return MARK.sub(_link, _RATE.sub(r'<span class="nw">\g<0></span>', escaped))


def _link(match: re.Match[str]) -> str:
    mark = match[1]
    if mark not in _TITLES:
        return f'<span class="nw">{match[0]}</span>'
    return f'<a class="eq" href="#theory-{mark}" title="{escape(_TITLES[mark])}">{match[0]}</a>'


def html_of(*blocks: Block, html: Prose = prose) -> str:
    """Blocks as HTML, in order.

    Raises
    ------
    KeyError
        For a block that is more than text, such as a chart, which each document draws in its own way.
    """
    return "".join(_RENDERERS[type(block)](block, html) for block in blocks)


def _answer(answer: Answer, html: Prose) -> str:
    why = " ".join(f"<p>{html(sentence)}</p>" for sentence in answer.sentences)  # one line of text in a report
    word = f"<h2>{html(answer.word)}</h2>" if answer.word else ""
    if answer.tip:
        word = term(word, answer.tip)
    return f'<div class="strip {answer.tone}" role="status">{word}{why}</div>'


def term(word: str, meaning: str) -> str:
    """A word, as HTML, that unfolds its meaning below it when it is pressed."""
    meaning = prose(meaning[:1].upper() + meaning[1:])
    return f'<details class="term"><summary>{word}</summary><div>{meaning}</div></details>'


_SENTENCES = 1.8  # weight of a column beyond which it holds sentences and keeps room where the screen is narrow
_MANY = 20  # rows of a sorted table beyond which it scrolls by itself


def _table(table: TableBlock, html: Prose) -> str:
    """A table in a region that scrolls by itself; a mark is printed as a word, never by colour alone."""
    body = "".join(_row(row, table, html) for row in table.rows)
    note = f'<p class="note quiet">{html(table.note)}</p>' if table.note else ""
    tall = " tall" if len(table.rows) > _MANY and any(column.sortable for column in table.columns) else ""
    return (
        f'<div class="scroll{tall}" tabindex="0" role="region" aria-label="{escape(table.caption)}">'
        f'<table class="checks" id="{escape(table.key)}"><caption>{html(table.caption)}</caption>'
        f"<thead>{_heads(table.columns, html)}</thead><tbody>{body}</tbody></table></div>{note}"
    )


def _heads(columns: tuple[Column, ...], html: Prose) -> str:
    groups = ""
    if any(column.group for column in columns):
        parts = []
        for name, members in groupby(columns, key=lambda column: column.group):
            width = len(list(members))
            parts.append(f'<th scope="colgroup" colspan="{width}">{html(name)}</th>' if name else "<td></td>" * width)
        groups = f"<tr>{''.join(parts)}</tr>"
    heads = "".join(f'<th scope="col"{_css(column)}>{_head(column, html)}</th>' for column in columns)
    return f"{groups}<tr>{heads}</tr>"


def _head(column: Column, html: Prose) -> str:
    return f'<button type="button">{html(column.title)}</button>' if column.sortable else html(column.title)


def _css(column: Column) -> str:
    if column.numeric:
        return ' class="num"'
    return ' class="wide"' if column.width > _SENTENCES else ""


def _row(row: tuple[Cell, ...], table: TableBlock, html: Prose) -> str:
    first, *others = row
    if not others:
        heading = f'<th scope="rowgroup" colspan="{len(table.columns)}">{html(first.text)}</th>'
        return f'</tbody><tbody><tr class="group">{heading}</tr>'
    cells = "".join(
        f"<td{_css(column)}{_sort(cell)}>{_chosen(cell, html)}</td>"
        for cell, column in zip(others, table.columns[1:], strict=True)
    )
    return f'<tr><th scope="row"{_sort(first)}>{_chosen(first, html, table.ticks)}</th>{cells}</tr>'


def _sort(cell: Cell) -> str:
    return "" if cell.sort is None else f' data-sort="{escape(str(cell.sort))}"'


def _chosen(cell: Cell, html: Prose, tick: bool = False) -> str:
    """A cell, with what a person chooses by it."""
    text, value = _cell(cell, html), escape(cell.value)
    if tick and value:
        return f'<label><input type="checkbox" value="{value}"> <span>{text}</span></label>'
    return f'<button type="button" value="{value}">{text}</button>' if value else text


def _cell(cell: Cell, html: Prose) -> str:
    text = html(cell.text).replace("\n", "<br>")
    if cell.more:
        more = html(cell.more).replace("\n", "<br>")
        return f"<details><summary>{text}</summary>{more}</details>"
    if cell.mark:
        return f'{text} <span class="mark {cell.tone}">{escape(cell.mark)}</span>'
    return f'<span class="tone {cell.tone}">{text}</span>' if cell.tone else text


def _bullets(bullets: Bullets, html: Prose) -> str:
    name = f'<p class="name">{html(bullets.caption)}</p>' if bullets.caption else ""
    label = f' aria-label="{escape(bullets.caption)}"' if bullets.caption else ""
    items = "".join(f"<li>{html(item)}</li>" for item in bullets.items)
    return f'{name}<ul class="cautions quiet"{label}>{items}</ul>'


_RENDERERS: dict[type, Callable[..., str]] = {
    Answer: _answer,
    TableBlock: _table,
    Text: lambda text, html: f"<p>{html(text.text)}</p>",
    Bullets: _bullets,
}
