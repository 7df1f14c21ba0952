"""Columns of numbers from a table in a text file: only those that are asked for are read.

NumPy's parser reads whole pieces of text; a piece that it refuses is read field by field, which takes empty fields,
dates and decimal commas, and finds the first thing that is wrong. (pandas reads as fast, but takes 90 MB to load.)
"""

import csv
import io
import math
import re
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError, quoted
from nav_model.base.text.file_kind import text_encoding
from nav_model.base.text.unit_text import plain_signs, product_of

_PIECE = 1_000_000  # characters
_MOST_COLUMNS = 1000
_HEAD_LINES = 200
_SAMPLE_LINES = 50
_TALLIED_LINES = 1000
_LONGEST_LINE = 100_000
_LONGEST_FIELD = 100  # characters of an angle or a date
LONGEST_NAME = 200
"""Characters of a column's name, which is compared with patterns; what is behind them is not looked at."""
_MOST_OF_HEADERS = 250_000  # characters of the lines that may name the columns
_EMPTY = frozenset(("", "nan", "-nan", "na", "n/a", "#n/a", "null", "none", "nat"))
_TIME_OF_DAY = re.compile(r"(?:.*[ T])?(\d{1,2})[:.](\d\d)[:.](\d\d(?:[.,]\d*)?)")
_DURATION = re.compile(r"\s*([-+]?\d+(?:[.,]\d*)?(?:[eE][-+]?\d+)?)\s*s(?:ec)?\s*")
_SPANS_TWO = re.compile(r"gps|gpst|utc|jst|time|date", re.IGNORECASE)
_COMMA_NUMBER = re.compile(r"\s*[-+]?\d*,\d+(?:[eE][-+]?\d+)?\s*")
_IN_THREE = re.compile(r"""(.+?)\s*[\[({]\s*(?:d[^\w']*'|dms|d\W+m\W+s|°[^\w']*'.*)\W*""", re.IGNORECASE)
"""A name of an angle in degrees, minutes and seconds, which are three fields."""
_ANGLE = re.compile(
    r"""\s*([NSEW])?\s*([+-])?(\d{1,3}(?:\.\d+)?)\s*[°d:\s]?\s*(?:(\d{1,2}(?:\.\d+)?)\s*[':m]?\s*
    (?:(\d{1,2}(?:\.\d+)?)\s*["s]?)?)?\s*([NSEW])?\s*""",
    re.VERBOSE | re.IGNORECASE,
)
_WHOLE = re.compile(r"\s*[-+]?\d+\s*")


Reader = Callable[[str], float]
"""A field that is no plain number -> its value, NaN where it is none."""


class Columns(NamedTuple):
    """Values (rows, columns), NaN where a field is empty; the line of the file that each row is in; whether the last
    line ends too early, as where a recording was broken off, and was left out."""

    values: Array
    lines: NDArray[np.int32]
    cut: bool


@dataclass(frozen=True)
class NumberTable:
    """A table whose rows are not read yet.

    comments: all lines above the first row; headers: those that have a text for each of `width` columns, the nearest
    first. ends_open: rows end with a delimiter, so that the last column is empty and has no name.
    """

    file_name: str
    headers: tuple[tuple[str, ...], ...]
    comments: tuple[str, ...]
    width: int
    delimiter: str | None
    ends_open: bool
    encoding: str
    content: bytes = field(repr=False)

    def names(self) -> Iterator[tuple[str, ...]]:
        """Candidates for the columns' names, the likeliest first: with units from a line of units above them, from
        the line between names and rows, or as they are; at last the nearest header once more."""
        none = ("",) * self.width
        for header, below, above in zip(self.headers, [none, *self.headers], [*self.headers[1:], none], strict=False):
            for units in ([above] if _are_units(above) and not _are_units(header) else []) + [
                none if _numeric(below) else below
            ]:
                pairs = zip(header, units, strict=True)
                yield tuple(f"{name} [{unit.strip('[]()')}]" if unit else name for name, unit in pairs)
            yield header
        yield from self.headers[:1]

    @property
    def first_row(self) -> str:
        """Text of the first row."""
        return next((line for piece in self._pieces() for line in piece.splitlines() if line.strip()), "").strip()

    def named(self, names: Sequence[str]) -> "NumberTable":
        """The table with names that somebody gave for its columns.

        Raises InputError under the file's name where they are too many or too few.
        """
        names = [*names, "-"] if self.ends_open and len(names) == self.width - 1 else names
        if len(names) != self.width:
            reason = f"{len(names)} column names are given, but the file has {self.width} columns."
            raise InputError(self.file_name, reason)
        return replace(self, headers=(tuple(name[:LONGEST_NAME] for name in names),))

    def tally(self, places: Sequence[int], most: int) -> list[dict[str, int]]:
        """Texts of columns and how many rows have each; nothing of a column with more than `most` texts.

        Of every million characters the first thousand lines are looked at.
        """
        counts = {place: Counter[str]() for place in places}
        for piece in self._pieces():
            lines = piece.removesuffix("\n").split("\n", _TALLIED_LINES)[:_TALLIED_LINES]
            for place in [*counts]:
                counts[place].update(self._texts(piece, lines, place))
                counts[place].pop("", None)
                if len(counts[place]) > most:
                    del counts[place]
            if not counts:
                break
        return [dict(counts.get(place, ())) for place in places]

    def columns(
        self,
        places: Sequence[int],
        most_rows: int,
        most_bytes: int,
        readers: Mapping[int, Reader] = MappingProxyType({}),
        only: tuple[int, str] | None = None,
    ) -> Columns:
        """Read columns as numbers, (rows,) each.

        Parameters
        ----------
        places : sequence of int
            Columns, counted from zero.
        most_rows, most_bytes : int
            Bounds of what is read: rows, and bytes of numbers.
        readers : mapping, optional
            Places of columns whose fields may be no plain number, such as a date -> what reads one.
        only : (int, str), optional
            A column and the text that it has in the rows that are read; others are passed over.

        Raises
        ------
        InputError
            Under the file's name, with line and column: text or an infinity where a number belongs, another number of
            fields than in the rows before, decimal commas beside decimal points, more than `most_rows` rows, or more
            than `most_bytes` of numbers.
        """
        allowed = min(most_rows, most_bytes // (8 * max(1, len(places))))
        possible = 1 + max((self.content.count(end) for end in (b"\n", b"\r") if end in self.content), default=0)
        values = np.empty((min(allowed, possible), len(places)))
        line_of = np.empty(len(values), dtype=np.int32)
        pieces = self._pieces()
        row, line, cut = 0, len(self.comments) + 1, False
        following = next(pieces, "")
        while piece := following:
            following = next(pieces, "")
            lines = piece.removesuffix("\n").split("\n")
            count = len(lines)
            offsets = np.arange(count, dtype=np.int32)
            if only:
                offsets = np.flatnonzero(np.array(self._texts(piece, lines, only[0])) == only[1]).astype(np.int32)
                passed, lines = lines, [lines[at] for at in offsets]
                piece = "\n".join(lines)
            block = None if not piece or piece.isspace() else self._at_once(piece, lines, places)
            if block is None:
                if only:  # at their lines, between empty ones
                    lines = [""] * count
                    for at in offsets:
                        lines[at] = passed[at]
                block, offsets, cut = self._by_field(lines, line, places, readers, last=not following)
            end = row + len(block)
            if end > allowed:
                many = f"The file has more than {most_rows} rows. Cut it."
                much = f"More than {most_bytes / 1e6:.0f} MB of numbers. Leave out columns."
                raise InputError(self.file_name, many if allowed == most_rows else much)
            values[row:end], line_of[row:end] = block, line + offsets
            row, line = end, line + count
        return Columns(values[:row], line_of[:row], cut)

    def _texts(self, piece: str, lines: Sequence[str], place: int) -> list[str]:
        """Text of a column in each line of a piece, empty where a line has none."""
        try:
            if '"' not in piece:
                texts = [line.split(self.delimiter, place + 1)[place] for line in lines]
                return [text.strip() for text in texts] if self.delimiter else texts
        except IndexError:  # an empty line, or one that ends too early
            pass
        rows = (_fields(line, self.delimiter) for line in lines)
        return [cells[place].strip() if len(cells) > place else "" for cells in rows]

    def _pieces(self) -> Iterator[str]:
        """Text below the comments, a million characters after the other."""
        text = _text(self.content, self.encoding)
        for _ in self.comments:
            text.readline()
        while piece := self._piece(text):
            yield piece

    def _piece(self, text: io.TextIOWrapper) -> str:
        """The next million characters, to the end of a line."""
        piece = text.read(_PIECE)
        end = text.readline(_LONGEST_LINE)
        if len(end) == _LONGEST_LINE:
            raise InputError(self.file_name, f"A line is longer than {_LONGEST_LINE} characters. This is no table.")
        return piece + end

    def _at_once(self, piece: str, lines: list[str], places: Sequence[int]) -> Array | None:
        """The rows by NumPy's parser, a line each; None where it does not know a field, or lines differ in theirs."""
        if self.delimiter != "," and "," in piece:
            if "." in piece:
                return None
            lines = [line.replace(",", ".") for line in lines]
        # Asked for some columns, the parser does not count the others, but text among them does no harm.
        some = places if self.delimiter and len(places) < self.width else None
        if some and piece.count(self.delimiter or "") != len(lines) * (self.width - 1):
            return None
        try:  # a list of lines takes half the time of a file
            block = np.loadtxt(lines, delimiter=self.delimiter, comments=None, quotechar='"', ndmin=2, usecols=some)
        except ValueError:
            return None
        # It passes over empty lines, which are counted.
        if len(block) != len(lines) or block.shape[1] != len(some or range(self.width)) or np.isinf(block).any():
            return None
        return block if some else block[:, places]

    def _by_field(
        self, piece: list[str], first: int, places: Sequence[int], readers: Mapping[int, Reader], *, last: bool
    ) -> tuple[Array, NDArray[np.int32], bool]:
        """The rows one field at a time, the lines they are in, and whether the last line ends too early."""
        bare = ((at, line) for at, line in enumerate(piece) if line.strip() and line[0] not in "#%")
        rows = {at: _fields(line, self.delimiter) for at, line in bare}
        if cut := last and bool(rows) and len(rows[max(rows)]) < self.width:
            rows.popitem()
        block, marks = np.empty((len(rows), len(places))), dict[str, int]()
        for row, (at, fields) in enumerate(rows.items()):
            if len(fields) != self.width:
                reason = f"line {first + at}: {len(fields)} columns, {self.width} in the lines before"
                raise InputError(self.file_name, reason)
            block[row] = [
                self._number(fields[place], first + at, readers.get(place), place, marks) for place in places
            ]
            if len(marks) == 2:
                reason = f"line {marks[',']}: a decimal comma, but line {marks['.']} has a decimal point."
                raise InputError(self.file_name, reason)
        return block, np.array([*rows], dtype=np.int32), cut

    def _number(self, text: str, line: int, reader: Reader | None, place: int, marks: dict[str, int]) -> float:
        """A field as a number, NaN where it is empty, with the first line of its decimal mark into `marks`."""
        if text.strip().lower() in _EMPTY:
            return math.nan
        comma = self.delimiter != "," and _COMMA_NUMBER.fullmatch(text)
        try:
            number = float(text.replace(",", ".") if comma else text.replace("_", "x"))  # 1_0 is no number
        except ValueError:
            number = reader(text) if reader and len(text) <= _LONGEST_FIELD else math.nan
            wrong = "a number" if math.isnan(number) else ""
        else:
            wrong = "finite" if math.isinf(number) else ""
            if comma or "." in text:
                marks.setdefault("," if comma else ".", line)
        if wrong:
            raise InputError(self.file_name, f"line {line}, column {place + 1}: {quoted(text)} is not {wrong}")
        return number


def open_table(content: bytes, file_name: str) -> NumberTable:
    """The table of a text file: UTF-8, UTF-16 or Windows-1252, between commas, semicolons, tabs or blanks.

    Lines above the first row, and lines that begin with # or %, are comments. Between anything but commas, a comma
    may be a decimal comma.

    Raises InputError under the file's name: it is no text, holds no numbers, has very long lines or more than
    1000 columns, or has decimal commas between commas.
    """
    encoding = text_encoding(content)
    if encoding is None:
        raise InputError(file_name, "The file is not text.")
    text = _text(content, encoding)
    head: list[str] = []
    while len(head) < _HEAD_LINES + _SAMPLE_LINES and (line := text.readline(_LONGEST_LINE)):
        if len(line) >= _LONGEST_LINE:
            raise InputError(file_name, f"Line {len(head) + 1} is longer than {_LONGEST_LINE} characters.")
        head.append(line)
    # What most of the last lines look like is a row; the first line like it is the first row.
    lines = [(at, line) for at, line in enumerate(head) if line.strip() and line[0] not in "#%"]
    rows = [(mark := _delimiter(line), _fields(line, mark)) for _, line in lines[-5:]]
    shapes = Counter((mark, len(cells)) for mark, cells in rows)
    (delimiter, width), _ = shapes.most_common(1)[0] if shapes else ((None, 0), 0)
    amounts = [_numeric(cells) for mark, cells in rows if (mark, len(cells)) == (delimiter, width)]
    if not any(amounts):
        reason = f"The first {len(head)} lines hold no numbers" if len(head) > _HEAD_LINES else "No numbers found"
        raise InputError(file_name, f"{reason}. This is not a table.")
    if width > _MOST_COLUMNS:
        raise InputError(file_name, f"{width} columns; a table has at most {_MOST_COLUMNS}.")
    first = next(
        at for at, line in lines
        if len(cells := _fields(line, delimiter)) == width and 2 * _numeric(cells) > max(amounts)
    )  # fmt: skip
    headers = _headers(head[:first], delimiter, width)
    ends_open = not headers and width > 1 and not any(cells[-1].strip() for _, cells in rows)
    if ends_open:
        headers = tuple((*names, "") for names in _headers(head[:first], delimiter, width - 1))
    names = len(head[first - 1].split(",")) if first else 0
    numbers = head[first].split(",") if delimiter == "," and not headers else []
    if 1 < names < len(numbers) <= 2 * names and all(map(_WHOLE.fullmatch, numbers)):
        counts = f"line {first + 1}: {len(numbers)} numbers under {names} names"
        advice = "Write the file with semicolons or tabs between the columns, or with decimal points."
        raise InputError(file_name, f"{counts}. These are decimal commas between commas. {advice}")
    return NumberTable(file_name, headers, tuple(head[:first]), width, delimiter, ends_open, encoding, content)


def _text(content: bytes, encoding: str) -> io.TextIOWrapper:
    return io.TextIOWrapper(io.BytesIO(content), encoding=encoding, errors="replace", newline=None)


def _delimiter(line: str) -> str | None:
    """The mark between the fields of a row; None: blanks."""
    mark = next((mark for mark in ";\t," if mark in line), None)
    words = line.split()
    if mark == "," and len(words) > 1 and all(map(_COMMA_NUMBER.fullmatch, words)):
        return None  # decimal commas between blanks
    return mark


def _fields(line: str, delimiter: str | None) -> list[str]:
    if delimiter is None:
        return line.split()
    line = line.rstrip("\r\n ") if delimiter == "\t" else line.strip()
    return next(csv.reader([line], delimiter=delimiter), []) if '"' in line else line.split(delimiter)


def _numeric(fields: Sequence[str]) -> int:
    """Count of the fields that are numbers, with a point or a comma."""
    count = 0
    for text in fields:
        with suppress(ValueError):
            float(text.replace(",", "."))
            count += 1
    return count


def _headers(lines: Sequence[str], delimiter: str | None, width: int) -> tuple[tuple[str, ...], ...]:
    """Of each line above the rows, the nearest first, a text for each column; none of those with more, fewer, or only
    numbers. Each name is compared with many patterns, so that long lines far above the rows are not looked at."""
    headers, room = [], _MOST_OF_HEADERS
    for line in reversed(lines):
        bare = line.strip().lstrip("#%/").strip()
        room -= len(bare)
        if room < 0:
            break
        glued = re.sub(r"(?<![\s)\]])\s+(?=[\[(])", "", bare)  # a blank between name and unit parts nothing
        for mark in (delimiter, ",", ";", "\t", None) if width > 1 else ("\n",):
            fields = _fields((bare if mark else glued).rstrip(mark), mark)
            names = tuple(name.strip()[:LONGEST_NAME] for name in fields)
            if len(names) < width:
                names = tuple(part for name in names for part in _in_three(name))
            if delimiter is None and len(names) == width - 1 and _SPANS_TWO.fullmatch(names[0]):
                names = ("date", *names)  # a blank between date or week, and time
            if len(names) == width and _numeric(names) < width:
                headers.append(names)
                break
    return tuple(headers)


def angle_of(text: str) -> float:
    """Degrees of 47°12'30"N, N47 12.5, 47:12:30 or 47.2°; NaN: none."""
    match = _ANGLE.fullmatch(" ".join(plain_signs(text).split()))  # a run of blanks is one
    if match is None or (match[1] and match[6]):
        return math.nan
    minutes, seconds = float(match[4] or 0), float(match[5] or 0)
    if not (minutes < 60.0 and seconds < 60.0):
        return math.nan
    whole = float(match[3]) + minutes / 60.0 + seconds / 3600.0
    return -whole if match[2] == "-" or (match[1] or match[6] or "").upper() in ("S", "W") else whole


def _in_three(name: str) -> Sequence[str]:
    """Names of the three fields of an angle in degrees, minutes and seconds; of another column its own."""
    match = _IN_THREE.fullmatch(name)
    return [f"{match[1]} [{unit}]" for unit in ("deg", "arcmin", "arcsec")] if match else [name]


def _are_units(cells: Sequence[str]) -> bool:
    """True for a line that has units of columns: a quarter of what stands there, and two at least."""
    stated = [words[0].strip("[](),") for cell in cells if (words := cell.split())]
    units = 0
    for text in stated:
        with suppress(ValueError):
            units += bool(product_of(text))
    return units >= max(2, len(stated) / 4)


def seconds_of(text: str) -> float:
    """Seconds of a date with a time, UTC unless it says otherwise, of a time of day, or of "0.1 sec"; NaN: none."""
    if duration := _DURATION.fullmatch(text):
        return float(duration[1].replace(",", "."))
    try:
        moment = datetime.fromisoformat(text.strip().replace(",", "."))
        return (moment if moment.tzinfo else moment.replace(tzinfo=UTC)).timestamp()
    except (ValueError, OverflowError):
        match = _TIME_OF_DAY.fullmatch(text.strip())
    if match is None:
        return math.nan
    return int(match[1]) * 3600.0 + int(match[2]) * 60.0 + float(match[3].replace(",", "."))
