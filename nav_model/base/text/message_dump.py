"""Text dumps of flight logs: lines of mixed messages, each kind with columns that FMT lines name (DataFlash)."""

import re
from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

from nav_model.base.errors import InputError

_FORMAT = re.compile(rb"(?m)^FMT *, *\d+ *, *\d+ *, *([A-Z0-9]{1,16}) *, *\w+ *, *(\w[\w, ]*)\r?$")
_START = 65_536  # bytes that have the first of them
_MOST_LISTED = 8


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
    columns = {match[1].decode(): match[2].strip() for match in _FORMAT.finditer(content)}
    rows = content.splitlines(keepends=True)
    counts = Counter(row.partition(b",")[0].strip() for row in rows)
    kind = next((kind for kind in kinds if kind in columns and counts[kind.encode()]), "")
    if not kind:
        first = ", ".join(f"{name.decode('utf-8', 'replace')[:16]}" for name, _ in counts.most_common(_MOST_LISTED))
        wanted = " or ".join(kinds)
        raise InputError(
            file_name, f"The file is a text dump of a flight log without {wanted} messages; it has {first}."
        )
    chosen = [row.partition(b",")[2] for row in rows if row.partition(b",")[0].strip() == kind.encode()]
    table = b",".join(columns[kind].split(b",")) + b"\n" + b"".join(chosen)
    return Dump(table, f"{len(chosen)} {kind} messages of {sum(counts.values())} lines")
