"""Column names and a table of floats from delimited text; errors name the line."""

import io
import math
import re
from dataclasses import dataclass
from typing import BinaryIO

import numpy as np

from nav_model.allan.noise_terms import FloatArray
from nav_model.base.errors import InputError

_CHUNK = 1_000_000  # characters
_MOST_COLUMNS = 100
_HEADER_LINES = 200
_LONGEST_LINE = 10_000


@dataclass(frozen=True)
class CsvTable:
    """`names` (None without a header), the file's line of row 0, and the rate a comment states or None."""

    names: tuple[str, ...] | None
    data: FloatArray
    first_line: int
    rate_hz: float | None


def read_csv_table(stream: BinaryIO, file_name: str, most_rows: int, most_bytes: int) -> CsvTable:
    """Read comma, semicolon, tab or blank separated numbers, with or without header and #/% comment lines.

    Between semicolons or tabs a comma is a decimal comma, as long as no point is one too.

    Nothing but decimal numbers is accepted below the header. Raises InputError with the line number for
    text, empty fields, a changed number of columns, NaN or infinity, more than `most_rows` rows, a table of more
    than `most_bytes`, or text that is not UTF-8. Memory is at most twice `most_bytes` and 100 MB.
    """
    text = io.TextIOWrapper(stream, encoding="utf-8-sig", newline=None)
    try:
        return _read(text, file_name, most_rows, most_bytes)
    except UnicodeDecodeError as error:
        raise InputError(file_name, "This does not look like a CSV or NPZ log: it is not text.") from error
    finally:
        text.detach()


def _read(text: io.TextIOWrapper, file_name: str, most_rows: int, most_bytes: int) -> CsvTable:
    header: list[str] = []
    first = ""
    for _ in range(_HEADER_LINES):
        line = text.readline(_LONGEST_LINE)
        if line == "":
            raise InputError(file_name, "No numbers found. The file does not look like a CSV or NPZ log.")
        if len(line) >= _LONGEST_LINE:
            raise InputError(file_name, f"line {len(header) + 1}: longer than {_LONGEST_LINE} characters")
        if _is_data(line):
            first = line
            break
        header.append(line)
    if not first:
        raise InputError(file_name, f"The first {_HEADER_LINES} lines hold no numbers; this is not a log.")
    delimiter = next((mark for mark in ";\t," if mark in first), None)
    columns = len(_fields(first, delimiter))
    if columns > _MOST_COLUMNS:
        raise InputError(file_name, f"{columns} columns; a log has at most {_MOST_COLUMNS}")
    names = _names(header, delimiter, columns)
    first_line = len(header) + 1
    blocks: list[FloatArray] = []
    line_number, rows = first_line, 0
    pending = [first, *_lines(text, file_name)]
    while pending:
        block = _parse(pending, delimiter, columns, file_name, line_number)
        rows += len(block)
        if rows > most_rows:
            raise InputError(file_name, f"The log has more than {most_rows} rows. Cut it.")
        if rows * columns * block.itemsize > most_bytes:
            raise InputError(file_name, f"More than {most_bytes / 1e6:.0f} MB of numbers. Leave out columns.")
        blocks.append(block)
        line_number += len(pending)
        pending = _lines(text, file_name)
    return CsvTable(names, np.concatenate(blocks), first_line, _rate(header))


def _lines(text: io.TextIOWrapper, file_name: str) -> list[str]:
    lines = text.readlines(_CHUNK)
    if any(len(line) > _LONGEST_LINE for line in lines):
        raise InputError(file_name, f"a line is longer than {_LONGEST_LINE} characters; not an inertial log")
    return lines


def _fields(line: str, delimiter: str | None) -> list[str]:
    fields = [field.strip() for field in line.strip().split(delimiter)]
    return fields[:-1] if delimiter and len(fields) > 1 and fields[-1] == "" else fields


def _is_number(field: str) -> bool:
    try:
        float(field)
    except ValueError:
        return False
    return True


def _is_data(line: str) -> bool:
    stripped = line.strip()
    if not stripped or stripped[0] in "#%":
        return False
    fields = [field for field in re.split(r"[,;\s]+", stripped) if field]
    return bool(fields) and _is_number(fields[0])


def _names(header: list[str], delimiter: str | None, columns: int) -> tuple[str, ...] | None:
    for line in reversed(header):
        bare = line.strip().lstrip("#%").strip()
        fields = [bare] if columns == 1 else _fields(bare, delimiter)  # a name may have blanks: "gyro_x [deg/s]"
        if len(fields) == columns and not all(_is_number(field) for field in fields):
            return tuple(fields)
    return None


def _rate(header: list[str]) -> float | None:
    for line in header:
        match = re.search(
            r"\b(?:rate|fs|frequency|sampling)\w*\s*[:=]?\s*([0-9.]+(?:e[-+]?\d+)?)\s*(k?)hz", line.lower()
        )
        if match:
            return float(match.group(1)) * (1000.0 if match.group(2) else 1.0)
    return None


def _parse(lines: list[str], delimiter: str | None, columns: int, file_name: str, first_line: int) -> FloatArray:
    kept = [line for line in lines if line.strip()]
    if delimiter in (";", "\t") and any("," in line for line in kept):
        place = next(i for i, line in enumerate(lines) if "," in line)
        if any("." in line for line in kept):
            raise InputError(file_name, f"line {first_line + place}: decimal commas, but decimal points elsewhere")
        kept = [line.replace(",", ".") for line in kept]
        lines = [line.replace(",", ".") for line in lines]
    if delimiter is not None and kept and kept[0].rstrip().endswith(delimiter):
        kept = [line.rstrip().removesuffix(delimiter) for line in kept]
    if not kept:
        return np.empty((0, columns))
    try:
        block = np.loadtxt(kept, delimiter=delimiter, comments=None, ndmin=2, dtype=np.float64)
    except ValueError as error:
        raise _complaint(lines, delimiter, columns, file_name, first_line) or InputError(
            file_name, f"{error}"
        ) from error
    if block.shape[1] != columns or not np.all(np.isfinite(block)):
        raise _complaint(lines, delimiter, columns, file_name, first_line) or InputError(
            file_name, f"{block.shape[1]} columns from line {first_line}, {columns} before"
        )
    return np.asarray(block)


def _complaint(
    lines: list[str], delimiter: str | None, columns: int, file_name: str, first_line: int
) -> InputError | None:
    """The error of the first bad line, found by a slow search after the fast parser has failed."""
    for offset, line in enumerate(lines):
        if not line.strip():
            continue
        where = f"line {first_line + offset}"
        fields = _fields(line, delimiter)
        if len(fields) != columns:
            return InputError(file_name, f"{where}: {len(fields)} columns, {columns} in the lines before")
        for column, field in enumerate(fields, start=1):
            if not _is_number(field):
                shown = field[:40] or "nothing"
                return InputError(file_name, f"{where}, column {column}: {shown!r} is not a number")
            if not math.isfinite(float(field)):
                return InputError(
                    file_name, f"{where}, column {column}: {field[:40]!r}; only finite numbers are allowed"
                )
    return None
