"""XML of flights: bounded in size, depth and elements, without entities; and that inside an archive."""

import io
import zipfile
import zlib
from typing import Any
from xml.etree.ElementTree import Element, ParseError, TreeBuilder

from nav_model.base.errors import InputError, quoted

MOST_XML = 5_000_000  # bytes
_DEEPEST = 100
_MOST_ELEMENTS = 200_000
_MOST_ENTRIES = 2000  # of an archive
_ENTRY = b"PK\x01\x02"


class _BoundedTree(TreeBuilder):
    """Counts while it reads, so that nothing is built which is refused."""

    def __init__(self, file_name: str) -> None:
        super().__init__()
        self._file_name, self._depth, self._elements = file_name, 0, 0

    def start(self, tag: str, attrs: dict[Any, Any], /) -> Element:
        self._depth += 1
        self._elements += 1
        if self._depth > _DEEPEST:
            raise InputError(self._file_name, f"has elements more than {_DEEPEST} deep in each other")
        if self._elements > _MOST_ELEMENTS:
            raise InputError(self._file_name, f"has more than {_MOST_ELEMENTS} elements")
        return super().start(tag, attrs)

    def end(self, tag: str, /) -> Element:
        self._depth -= 1
        return super().end(tag)


def read_xml(content: bytes, file_name: str) -> Element:
    """The root of an XML document.

    Raises InputError under the file's name: larger than 5 MB, elements 100 deep, a document type or entities, no XML.
    """
    from defusedxml.common import DefusedXmlException
    from defusedxml.ElementTree import DefusedXMLParser

    if len(content) > MOST_XML:
        raise InputError(file_name, f"has more than {MOST_XML // 1_000_000} MB of XML. Keep only the flight.")
    parser = DefusedXMLParser(target=_BoundedTree(file_name), forbid_dtd=True)
    try:
        parser.feed(content)
        root: Element = parser.close()
    except DefusedXmlException as error:
        raise InputError(file_name, "declares entities or a document type, which are not read") from error
    except (ParseError, ValueError, LookupError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(file_name, f"is not XML: {error}") from error
    return root


def unpack(content: bytes, file_name: str) -> tuple[str, bytes] | None:
    """Name and content of the flight in an archive (KMZ, or DJI's WPML in one); None where it holds none.

    Raises InputError under the file's name: damaged, encrypted, too many entries, more than 5 MB when expanded.
    """
    if content.count(_ENTRY) > _MOST_ENTRIES:
        raise InputError(file_name, f"is a ZIP archive of more than {_MOST_ENTRIES} files. Give the flight alone.")
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            entries = [entry for entry in archive.infolist() if entry.filename.lower().endswith((".wpml", ".kml"))]
            if not entries:
                return None
            # What a drone executes comes before the template it was made of; else the first, which is doc.kml.
            entry = min(entries, key=lambda entry: not entry.filename.lower().endswith(".wpml"))
            if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                raise InputError(file_name, f"{quoted(entry.filename)} in it is compressed in a way that is not read")
            with archive.open(entry) as file:
                inside = file.read(MOST_XML + 1)
            if len(inside) > MOST_XML:
                raise InputError(
                    file_name, f"holds more than {MOST_XML // 1_000_000} MB of XML. Keep only the flight."
                )
            return entry.filename, inside
    except (zipfile.BadZipFile, zlib.error, RuntimeError, NotImplementedError, EOFError, OSError) as error:
        raise InputError(file_name, f"is a ZIP archive that cannot be read: {error}") from error


def local_name(element: Element) -> str:
    """The tag without its namespace."""
    return str(element.tag).rpartition("}")[2]
