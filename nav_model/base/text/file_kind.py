"""Kind of a file, told by its first bytes."""

import codecs
import re
from collections import deque

from nav_model.base.text.toml_text import shipped

KINDS = shipped("nav_model.base.text", "file_kinds")
"""Of `file_kinds.toml`: what files begin with, and what to do with a log of a kind."""
_START = 4096
_PIECE = 1 << 20


def kind_of(content: bytes) -> str | None:
    """Kind of a file with its article, such as "a PNG image"; None for plain text, such as a table.

    >>> kind_of(b"%PDF-1.7"), kind_of(b'{"gyro": []}'), kind_of(b"time,gyro_x")
    ('a PDF document', 'JSON', None)
    """
    start = content[:_START]
    if start.startswith(b"PK\x03\x04"):
        names = start + content[-_START:]  # the first entry, and the list of all at the end
        return next((kind for part, kind in KINDS["zipped"].items() if part.encode() in names), "a ZIP archive")
    for signature, kind in KINDS["bytes"].items():
        if start.startswith(signature.encode("latin-1")):
            return str(kind)
    encoding = text_encoding(content)
    if encoding is None:
        return "not text"
    bare = start.decode(encoding, "replace").lstrip("\ufeff \t\r\n")
    return next((kind for pattern, kind in KINDS["texts"].items() if re.match(pattern, bare, re.IGNORECASE)), None)


def text_encoding(content: bytes) -> str | None:
    """Encoding of a text: UTF-8 with or without its mark, UTF-16, else Windows-1252; None for what is no text."""
    start = content[:_START]
    if start.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    even, odd = start[0::2].count(0), start[1::2].count(0)
    if max(even, odd) > 0.4 * len(start) and not min(even, odd):  # Latin letters in 16 bits, without a mark
        return "utf-16-be" if even else "utf-16-le"
    if re.search(rb"[\x00-\x08\x0e-\x1a]", start):
        return None
    if content.isascii():
        return "utf-8"
    pieces = (content[at : at + _PIECE] for at in range(0, len(content), _PIECE))
    try:
        deque(codecs.iterdecode(pieces, "utf-8"), maxlen=0)
    except UnicodeDecodeError:
        return "cp1252"
    return "utf-8-sig"
