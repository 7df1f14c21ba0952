"""A report's table as HTML for a page: one content, shown in the product's own sheet."""

from __future__ import annotations

from html import escape

from app.document.blocks import Cell, Table
from app.document.prose import prose


def table_html(table: Table) -> str:
    """A table in a region that scrolls by itself; a mark is printed as a word, never by colour alone."""
    classes = [' class="num"' if column.numeric else "" for column in table.columns]
    head = "".join(
        f'<th scope="col"{css}>{prose(column.title)}</th>' for column, css in zip(table.columns, classes, strict=True)
    )
    rows = []
    for row in table.rows:
        if len(row) == 1:
            rows.append(f'<tr><th scope="rowgroup" colspan="{len(classes)}"><b>{prose(row[0].text)}</b></th></tr>')
            continue
        cells = "".join(f"<td{css}>{_cell(cell)}</td>" for cell, css in zip(row[1:], classes[1:], strict=True))
        rows.append(f'<tr><th scope="row">{_cell(row[0])}</th>{cells}</tr>')
    note = f'<p class="know quiet">{prose(table.note)}</p>' if table.note else ""
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="{escape(table.caption)}"><table class="checks">'
        f"<caption>{prose(table.caption)}</caption><thead><tr>{head}</tr></thead><tbody>{''.join(rows)}</tbody>"
        f"</table></div>{note}"
    )


def _cell(cell: Cell) -> str:
    mark = f' <span class="mark">{escape(cell.mark)}</span>' if cell.mark else ""
    quiet = ' class="quiet"' if cell.tone == "quiet" else ""
    return f"<span{quiet}>{prose(cell.text)}</span>{mark}"
