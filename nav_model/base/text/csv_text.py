"""Tables as CSV text that a spreadsheet shows as it is."""

import csv
import io
import unicodedata
from collections.abc import Iterable, Mapping
from typing import Any


def csv_text(rows: Iterable[Iterable[Any]]) -> str:
    """Rows as CSV, numbers in full precision; a name that a spreadsheet would compute, as somebody's catalogue may
    hold, is marked as text.

    >>> csv_text([("=1+1", "-1.5", -2.0)])
    "'=1+1,-1.5,-2.0\\n"
    """
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(map(_cell, row) for row in rows)
    return text.getvalue()


def csv_of(records: Iterable[Mapping[str, Any]]) -> str:
    """Records with the same keys as CSV, the keys at the head."""
    rows = [*records]
    return csv_text((*rows[:1], *(row.values() for row in rows)))


def _cell(value: Any) -> Any:
    """As it is, or with an apostrophe if it begins as a formula does and is no number."""
    if not isinstance(value, str):
        return float(value) if isinstance(value, float) else value  # NumPy's own is not written as Python's
    value = value.replace("\r", " ")  # it would end the row, unquoted
    first = unicodedata.normalize("NFKC", value.lstrip()[:1])  # some take the signs in full width too
    if first not in ("=", "+", "-", "@") and not value.startswith("\t"):
        return value
    try:
        float(value)
    except ValueError:
        return f"'{value}"
    return value
