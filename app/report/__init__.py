"""Design reports: their content (`content`, `inputs`, `comparison`, `studies`), drawn by `app.document`."""

from __future__ import annotations

from collections.abc import Sequence
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from nav_model.base.errors import InputError

if TYPE_CHECKING:
    from app.document.blocks import Chapter, Report, Section
    from nav_model.budget import Budget

SPREADSHEET = ".xlsx"

SUFFIXES = (".html", ".pdf", SPREADSHEET)
"""The kinds of file a report comes in; a spreadsheet is of one design's budget alone."""


def report_bytes(
    budgets: Sequence[Budget],
    kind: str,
    now: datetime | None = None,
    added: Sequence[Section] = (),
    studies: Sequence[Sequence[Section]] = (),
    front: Chapter | None = None,
    display: str = "",
) -> bytes:
    """The report as the bytes of a file of `kind`, one of `SUFFIXES`; pages have it made in a worker process.

    Sections `added` are placed before the shared ones; `studies` are `app.report.studies.study_sections` for each
    budget, which go into its chapter; ``front`` is the first page; ``display`` how its figures are told, as a
    link says it (`app.document.display`).
    """
    if kind == SPREADSHEET:
        from app.report.spreadsheet import workbook_bytes

        (budget,) = budgets
        return workbook_bytes(budget)
    from app.document.display import display_of
    from app.report.content import report_of

    return document_bytes(report_of(budgets, now, added, studies, front, display_of(display)), kind)


def document_bytes(report: Report, kind: str) -> bytes:
    """A report as the bytes of a file, ".html" or ".pdf"."""
    if kind == ".pdf":
        from app.document.pdf import to_pdf

        return to_pdf(report)
    from app.document.html import to_html

    return to_html(report).encode()


def kind_of(target: Path) -> str:
    """The kind of report a file's suffix asks for, one of `SUFFIXES`.

    Raises
    ------
    InputError
        For another suffix.
    """
    kind = target.suffix.lower()
    if kind not in SUFFIXES:
        raise InputError("-o", f"{str(target)!r} does not end in {', '.join(SUFFIXES[:-1])} or {SUFFIXES[-1]}")
    return kind
