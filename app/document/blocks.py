"""The blocks of a report: plain data, independent of HTML and PDF.

Every text is literal: renderers escape it. A mark such as ``[T-9]`` in a text is a reference to the equation of
that mark. A `Cell`'s mark is a word set off from its text; it is always printed, so nothing hangs on colour.
"""

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from app.charts.kinds import Chart, Drawing
from app.charts.words import in_words
from nav_model.equations.entry import Equation, Symbol

MARK = re.compile(r"\[([TSBP]-\d+)\]")
"""A reference to an equation."""

UNIT_GAP = re.compile(r"(?<=\d) (?=%|(?:dB|rad|[mkcµ]?m|[mc]?m/s|[mkMG]?Hz|[mµ]?g|m?s|h|min|arcsec)\b)")
"""The blank between a number and its unit, where no line should end."""


@dataclass(frozen=True)
class Cell:
    """A table cell; ``mark`` is a word beside the text and ``tone`` (good, bad, warn, quiet) how it is set.

    ``sort`` replaces the text when the table is sorted; an empty text puts the row last. ``value`` is what
    a person chooses with the button, or the tick, that the cell then is. ``more`` unfolds under the text.
    """

    text: str
    mark: str = ""
    tone: str = ""
    sort: float | str | None = None
    value: str = ""
    more: str = ""


@dataclass(frozen=True)
class Column:
    """A column's head; ``width`` is its weight, 0 for as wide as its content.

    Neighbours of one ``group`` share that as a head.
    """

    title: str
    numeric: bool = False
    width: float = 0
    group: str = ""
    sortable: bool = False


@dataclass(frozen=True)
class TableBlock:
    """A table. The first cell of a row heads it; a row of one cell heads the rows that follow.

    On a page a cell with a value is a button, or, first in a row of a table with ``ticks``, a box to tick.
    """

    key: str
    caption: str
    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]
    note: str = ""
    ticks: bool = False


CellLike = Cell | str
"""A cell as it is told: often a text without more."""

Row = tuple[CellLike, ...]


def table(
    key: str,
    caption: str,
    columns: Iterable[Column | str | tuple[str, float]],
    rows: Iterable[Row],
    note: str = "",
    ticks: bool = False,
) -> TableBlock:
    """A table, told by texts where a text says all.

    Examples
    --------
    >>> heads = (("Quantity", 1.5), *numbers("Value", "Limit"), "Verdict")  # 1.5: its width
    >>> tilt = table("limits", "Limits", heads, [("Tilt", "2.1°", "3°", Cell("✓ met", tone="good"))])
    """
    return TableBlock(
        key,
        caption,
        tuple(column if isinstance(column, Column) else _column(column) for column in columns),
        tuple(tuple(cell if isinstance(cell, Cell) else Cell(cell) for cell in row) for row in rows),
        note,
        ticks,
    )


def numbers(*titles: str, width: float = 0, group: str = "", sortable: bool = False) -> tuple[Column, ...]:
    """Heads of columns of numbers."""
    return tuple(Column(title, True, width, group, sortable) for title in titles)


def _column(column: str | tuple[str, float]) -> Column:
    return Column(column) if isinstance(column, str) else Column(column[0], width=column[1])


@dataclass(frozen=True)
class ChartBlock:
    """A chart with a description for screen readers."""

    key: str
    chart: Drawing
    alt: str


def chart_block(chart: Drawing, key: str) -> ChartBlock:
    """A chart with its description; series without values are removed, also from the legend."""
    if isinstance(chart, Chart):
        chart = replace(
            chart,
            lines=tuple(line for line in chart.lines if not np.isnan(line.y).all()),
            points=tuple(points for points in chart.points if len(points.x)),
            spans=tuple(span for span in chart.spans if not math.isnan(span.start)),
            limits=tuple(limit for limit in chart.limits if not math.isnan(limit.level)),
        )
    return ChartBlock(f"{key}-chart-{chart.key}", chart, f"{chart.title}. {in_words(chart)} {chart.knowledge}")


@dataclass(frozen=True)
class Text:
    """A paragraph."""

    text: str


@dataclass(frozen=True)
class Bullets:
    """A list under its caption, if it has one."""

    items: tuple[str, ...]
    caption: str = ""


@dataclass(frozen=True)
class Equations:
    """Equations in order, each under its mark."""

    items: tuple[Equation, ...]


@dataclass(frozen=True)
class Symbols:
    """The table of symbols."""

    items: tuple[Symbol, ...]


@dataclass(frozen=True)
class Approval:
    """Lines for signatures; ``subjects`` say what is signed."""

    roles: tuple[str, ...]
    subjects: tuple[str, ...]


@dataclass(frozen=True)
class Answer:
    """The answer to a question: one word with its sign, how it is set (good, bad, warn, open), and why.

    On a page the word may be empty: a message of one sentence. ``tip`` explains the word there.
    """

    word: str
    tone: str
    sentences: tuple[str, ...]
    tip: str = ""

    def more(self, *sentences: str) -> Self:
        """Copy of the answer with further sentences; empty ones are left out."""
        return replace(self, sentences=(*self.sentences, *filter(None, sentences)))


@dataclass(frozen=True)
class KeyFigure:
    """One figure with its unit; ``detail`` says which.

    ``state`` is that of the check of its ``limit`` ("met", "not met", "open", "refused"; empty: it has none, and a
    tile says under it what ``limit`` says). ``amount`` is the value as a number, to compare it by; ``used`` is the
    part of the limit it takes; None: none. ``beside`` is what stands beside the limit, such as the straight leg's
    value. ``last``: the value is that of the last flight, of other inputs.
    """

    label: str
    value: str
    detail: str = ""
    limit: str = ""
    state: str = ""
    amount: float | None = None
    used: float | None = None
    beside: str = ""
    last: bool = False

    @property
    def met(self) -> bool | None:
        """True where it is known to keep its limit; None where that is not known, or there is none."""
        return {"met": True, "not met": False}.get(self.state)


@dataclass(frozen=True)
class KeyFigures:
    """The few figures that decide; ``caption`` names them together."""

    caption: str
    items: tuple[KeyFigure, ...]


Block = Answer | TableBlock | ChartBlock | Text | Bullets | Equations | Symbols | Approval


@dataclass(frozen=True)
class Section:
    """A headed part of a chapter; ``references`` are the literature it adds to the report's."""

    key: str
    title: str
    blocks: tuple[Block, ...]
    references: tuple[str, ...] = ()


@dataclass(frozen=True)
class Chapter:
    """One design, or the comparison of several.

    ``running`` is what the head of a page says; ``facts`` are label and value pairs under the title;
    ``source`` is the design file, which travels with the report.
    """

    key: str
    kind: str
    title: str
    running: str
    facts: tuple[tuple[str, str], ...]
    sections: tuple[Section, ...]
    description: str = ""
    verdict: Answer | None = None
    source: str = ""


@dataclass(frozen=True)
class Report:
    """A report: chapters, then the sections they share."""

    title: str
    written: str
    version: str
    chapters: tuple[Chapter, ...]
    sections: tuple[Section, ...]

    def blocks(self) -> tuple[Block, ...]:
        """Every block, in order."""
        sections = [section for chapter in self.chapters for section in chapter.sections] + list(self.sections)
        return tuple(block for section in sections for block in section.blocks)

    def charts(self) -> tuple[ChartBlock, ...]:
        """Every chart, in order."""
        return tuple(block for block in self.blocks() if isinstance(block, ChartBlock))
