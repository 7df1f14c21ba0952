"""Text dumps of flight logs: lines of mixed messages, each kind with columns that FMT lines name (DataFlash)."""

import io
import re
from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

from nav_model.base.errors import InputError

_FORMAT = re.compile(rb"(?m)^FMT *, *\d+ *, *\d+ *, *([A-Z0-9]{1,16}) *, *\w+ *, *(\w[\w, ]*)\r?$")
_START = 65_536  # bytes that have the first of them
_MOST_LISTED = 8
_MOST_KINDS = 1000
_SHORTEST = 16  # bytes of a line on average; a time alone has ten digits


class Dump(NamedTuple):
    """Lines of one kind of message as a table with the names of its columns, and what was taken, in words."""

    table: bytes
    choice: str


def lines_of(content: bytes, file_name: str, kinds: Sequence[str]) -> Dump | None:
    """The messages of the first of `kinds` that a dump has; None where the content is no such dump.

    Raises InputError under the file's name where it has none of them.
    """
    if not _FORMAT.search(content[:_START]):
        return None
    if content.count(b"\n") > len(content) // _SHORTEST + _MOST_KINDS:
        raise InputError(file_name, "The file begins as a text dump, but its lines are too short for one.")
    columns: dict[bytes, bytes] = {}
    for match in _FORMAT.finditer(content):
        if len(columns) < _MOST_KINDS or match[1] in columns:
            columns[match[1]] = match[2].strip()
    counts = Counter[bytes]()
    rows = {kind: io.BytesIO() for kind in map(str.encode, kinds)}
    for row in io.BytesIO(content):
        kind, _, values = row.partition(b",")
        kind = kind.strip()
        counts[kind if kind in counts or len(counts) < _MOST_KINDS else b""] += 1
        if kind in rows:
            rows[kind].write(values)
    chosen = next((kind for kind in rows if kind in columns and counts[kind]), b"")
    total = sum(counts.values())
    if not chosen:
        del counts[b""]
        first = ", ".join(name.decode("utf-8", "replace")[:16] for name, _ in counts.most_common(_MOST_LISTED))
        wanted = " or ".join(kinds)
        raise InputError(
            file_name, f"The file is a text dump of a flight log without {wanted} messages; it has {first}."
        )
    table = columns[chosen] + b"\n" + rows[chosen].getvalue()
    return Dump(table, f"{counts[chosen]} {chosen.decode()} messages of {total} lines")
