"""What a file is, by its first bytes."""

import codecs
import re
from collections import deque
from collections.abc import Mapping
from typing import Final

_SIGNATURES: Final[Mapping[bytes, str]] = {
    b"\x1f\x8b": "a gzip archive", b"BZh": "a bzip2 archive", b"7z\xbc\xaf\x27\x1c": "a 7-Zip archive",
    b"\xfd7zXZ\x00": "an XZ archive", b"Rar!": "a RAR archive", b"\x89PNG": "a PNG image",
    b"\xff\xd8\xff": "a JPEG image", b"GIF8": "a GIF image", b"II*\x00": "a TIFF image", b"%PDF": "a PDF document",
    b"\xd0\xcf\x11\xe0": "an Office document of before 2007", b"ULog\x01\x12\x35": "a PX4 log (ULog)",
    b"\xa3\x95\x80\x80": "an ArduPilot log (DataFlash)", b"#ROSBAG V": "a ROS bag",
    b"\x89MCAP": "an MCAP recording", b"SQLite format 3": "an SQLite database", b"\x89HDF": "an HDF5 file",
    b"MATLAB 5.0 MAT-file": "a MATLAB file", b"\x93NUMPY": "a single NumPy array", b"PAR1": "a Parquet table",
    b"\xb5\x62": "a stream of u-blox messages",
}  # fmt: skip
_TEXTS: Final = (
    (r"<(!doctype )?html", "an HTML page"),
    ("<", "XML"),
    (r"(\{\s*[\"}]|\[\s*[\[{\"\d-])", "JSON"),
    (r"\$[A-Z]{2,5},", "NMEA sentences"),
    (r"A[A-Z0-9]{3}[^,;\t\n]*\nHF", "an IGC file of a flight recorder"),
    (r"[#%](RAW|CORR|INS|BEST|IMU)[A-Z]+A,", "messages of a NovAtel receiver"),
)
_START = 4096
_PIECE = 1 << 20
_ZIPPED: Final[Mapping[bytes, str]] = {
    b".npy": "an NPZ archive", b"xl/": "an Excel workbook", b".kml": "a KMZ archive",
}  # fmt: skip


def kind_of(content: bytes) -> str | None:
    """What a file is, with its article, such as "a PNG image"; None for plain text, such as a table.

    >>> kind_of(b"%PDF-1.7"), kind_of(b'{"gyro": []}'), kind_of(b"time,gyro_x")
    ('a PDF document', 'JSON', None)
    """
    start = content[:_START]
    if start.startswith(b"PK\x03\x04"):
        names = start + content[-_START:]  # the first entry, and the list of all at the end
        return next((kind for part, kind in _ZIPPED.items() if part in names), "a ZIP archive")
    for signature, kind in _SIGNATURES.items():
        if start.startswith(signature):
            return kind
    encoding = text_encoding(content)
    if encoding is None:
        return "not text"
    bare = start.decode(encoding, "replace").lstrip("\ufeff \t\r\n")
    return next((kind for pattern, kind in _TEXTS if re.match(pattern, bare, re.IGNORECASE)), None)


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
