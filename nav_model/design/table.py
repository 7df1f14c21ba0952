"""A table as one input: rows of the same columns, such as the waypoints of a plan."""

import re
from collections.abc import Iterator, Mapping
from typing import Any

import param

from nav_model.base.errors import InputError, quoted, under
from nav_model.design.declaration import BaseQuantity, Declared

MOST_ROWS = 60
_MOST_TEXT = 10_000
_LONGEST_NAME = 80
_BARE = re.compile(r"[-+−]?[\d.]+(e[-+]?\d+)?")


class Table(Declared, param.Parameter[Any]):
    """A tuple of rows, empty when the table is not given; a row has a cell for each column, SI or text.

    Parameters
    ----------
    columns : mapping
        Name -> declaration of a quantity, or None for a text, which may be empty. As text a quantity that may be left
        out is written with its name, ``tilt=0.01°``; the others are in the order of the columns.
    short : str
        Name in links.
    example : str
        A text that `read` takes.
    since : str
        As `Declared`.
    most : int
        Rows at most.
    """

    __slots__ = ["columns", "example", "most", "short", "since"]

    columns: Mapping[str, BaseQuantity[Any] | None]
    short: str
    example: str
    most: int

    def __init__(
        self, *, columns: Mapping[str, BaseQuantity[Any] | None], short: str, example: str, since: str = "",
        most: int = MOST_ROWS, **params: Any,
    ) -> None:  # fmt: skip
        self.columns, self.short, self.example, self.since, self.most = columns, short, example, since, most
        super().__init__(default=(), constant=True, **params)

    def _validate(self, val: Any) -> None:
        width = len(self.columns)
        if not isinstance(val, tuple) or not all(isinstance(row, tuple) and len(row) == width for row in val):
            raise InputError(self.key, f"{quoted(val)} is not a table. Write for example {self.example}.", val)
        if len(val) > self.most:
            raise InputError(self.key, f"{len(val)} rows are too many. Give at most {self.most}.", val)
        self._check(val)

    def _check(self, val: tuple[tuple[Any, ...], ...]) -> None:
        for number, row in enumerate(val, 1):
            for (name, column), cell in zip(self.columns.items(), row, strict=True):
                with under(f"{self.key}[{number}].{name}"):
                    _check_name(name, cell) if column is None else column._validate(cell)
            if not any(cell not in (None, "") for cell in row[1:]):
                raise InputError(f"{self.key}[{number}]", f"has one cell only. Write for example {self.example}.")

    def identity(self, value: Any) -> Any:
        """A value for a design's hash: columns that came after the table count where they have a cell."""
        columns = self.columns.values()
        later = [column is not None and column.since > self.since for column in columns]
        return tuple(
            tuple(cell for cell, new in zip(row, later, strict=True) if not new or cell is not None) for row in value
        )

    def read(self, text: Any) -> Any:
        """Rows as text or as a design file has them -> the value.

        Text: rows separated by semicolons or line ends, their cells by commas, or by tabs as spreadsheets copy them.
        Or a list of rows, each a list of texts in the order of the columns. A number without a unit has the column's.
        A file: a list of tables, ``{start = "200 s", stop = "300 s"}``.

        Raises
        ------
        InputError
            Naming the key, what was given and what is allowed.
        """
        rows = text
        if isinstance(text, str):
            if len(text) > _MOST_TEXT * max(1, self.most // MOST_ROWS):
                raise InputError(self.key, f"The table is longer than {_MOST_TEXT} characters. Shorten it.")
            rows = [part for part in re.split(r"[;\n]", text) if part.strip()]
        if not isinstance(rows, list):
            raise InputError(self.key, f"{quoted(text)} is not a table. Write for example {self.example}.", text)
        if len(rows) > self.most:
            raise InputError(self.key, f"{len(rows)} rows are too many. Give at most {self.most}.")
        value = tuple(self._row(row, number) for number, row in enumerate(rows, 1))
        self._validate(value)
        return value

    def _row(self, row: Any, number: int) -> tuple[Any, ...]:
        where = f"{self.key}[{number}]"
        cells = row
        if isinstance(row, str):
            cells = self._with_units(self._named(row, where))
        elif isinstance(row, list) and len(row) == len(self.columns) and all(isinstance(cell, str) for cell in row):
            cells = self._with_units(dict(zip(self.columns, row, strict=True)))
        if not isinstance(cells, dict):
            raise InputError(where, f"{quoted(row)} is not a row. Write for example {self.example}.", row)
        for name, cell in cells.items():
            if name not in self.columns:
                raise InputError(f"{where}.{name}", f"unknown key; a row has {', '.join(self.columns)}", cell)
        value: list[Any] = []
        for name, column in self.columns.items():
            cell = cells.get(name, "")
            if column is None:
                value.append(cell)
            elif cell == "" and column.allow_None:
                value.append(None)
            else:
                with under(f"{where}.{name}"):
                    value.append(column.read(cell).value)
        return tuple(value)

    def _named(self, row: str, where: str) -> dict[str, str]:
        """The cells of a row written as text, by column."""
        cells: dict[str, str] = {}
        places = [name for name, column in self.columns.items() if column is None or not column.allow_None]
        for place, text in enumerate(row.split("\t" if "\t" in row else ",")):
            name, equals, cell = (part.strip() for part in text.partition("="))
            if not equals:
                if place >= len(places):
                    reason = f"{quoted(row)} has too many cells. Write for example {self.example}."
                    raise InputError(where, reason, row)
                name, cell = places[place], name
            cells[name] = cell
        return cells

    def _with_units(self, cells: dict[str, str]) -> dict[str, str]:
        return {
            name: f"{cell} {column.unit}" if (column := self.columns.get(name)) and _BARE.fullmatch(cell) else cell
            for name, cell in ((name, cell.strip()) for name, cell in cells.items())
        }

    def write(self, value: Any) -> Any:
        """A value as a design file has it, which `read` takes back exactly."""
        return [
            {name: cell for name, cell in zip(self.columns, cells, strict=True) if cell}
            for cells in self.cells(value, bare=False)
        ]

    def show(self, value: Any, digits: int | None = None) -> str:
        """A value as text that `read` takes back; without `digits` to exactly the same value."""
        return "; ".join(map(", ".join, self._written(self.cells(value, digits, bare=False))))

    def link(self, value: Any) -> str:
        """Text for a link, shorter than in a file: numbers in their usual units, without them."""
        return ";".join(map(",".join, self._written(self.cells(value))))

    def cells(self, value: Any, digits: int | None = None, *, bare: bool = True) -> list[list[str]]:
        """Rows of texts, one for each column; `bare`: numbers in their usual units, without them."""

        def cell_text(column: BaseQuantity[Any] | None, cell: Any) -> str:
            if column is None or cell is None:
                return cell or ""
            text = column.show(cell, digits)
            return text.removesuffix(column.unit).strip() if bare else text

        return [[cell_text(*pair) for pair in zip(self.columns.values(), row, strict=True)] for row in value]

    def _written(self, rows: list[list[str]]) -> Iterator[list[str]]:
        """Rows as text has them: what may be left out with its name, and no empty cells at the end."""
        for row in rows:
            named = list(zip(self.columns.items(), row, strict=True))
            cells = [f"{name}={cell}" if column is not None and column.allow_None else cell
                     for (name, column), cell in named if cell or column is None]  # fmt: skip
            while cells and not cells[-1]:
                cells.pop()
            yield cells


def _check_name(name: str, text: object) -> None:
    if not isinstance(text, str) or text != text.strip() or set(text) & set(",;=\t") or not text.isprintable():
        raise InputError(name, f"{quoted(text)} is not a name. Give a text without , ; and =.", text)
    if len(text) > _LONGEST_NAME:
        raise InputError(name, f"longer than {_LONGEST_NAME} characters", text)
