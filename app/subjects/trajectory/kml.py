"""A flight as KML: its path, and each line in the colour of its verdict."""

import html
from xml.etree import ElementTree

import numpy as np

from app.document.wording import printable
from app.subjects.trajectory.tables import failure
from app.work.flight import Followed
from nav_model.trajectory.result import LineResult

NAMESPACE = "http://www.opengis.net/kml/2.2"
_COLOURS = {"path": "ff8b877b", "closes": "ff4b7f1a", "fails": "ff2f2fc6"}  # alpha, blue, green, red
_NO_TAGS = str.maketrans("<>", "‹›")  # in names, where some viewers would show HTML and others entities


def as_kml(followed: Followed) -> bytes:
    """The path and the lines as placemarks; a line's description says whether it keeps its limits, or why not."""
    result = followed.result
    root = ElementTree.Element("kml", xmlns=NAMESPACE)
    document = _add(root, "Document")
    _add(document, "name", (followed.design.name or "flight").translate(_NO_TAGS))
    for key, colour in _COLOURS.items():
        style = _add(_add(document, "Style", id=key), "LineStyle")
        _add(style, "color", colour)
        _add(style, "width", "2" if key == "path" else "5")
    parts = [("flight", followed.flight, "path", 0.0, float(result.time_s[-1]))]
    for line in result.lines if result.spec.lines else ():
        look = "closes" if line.closes else "fails"
        parts.append((line.name, line_verdict(followed, line), look, line.start_s, line.stop_s))
    for name, description, look, start, stop in parts:
        mark = _add(document, "Placemark")
        _add(mark, "name", name.translate(_NO_TAGS))
        _add(mark, "description", html.escape(description, quote=False))  # which viewers show as HTML
        _add(mark, "styleUrl", f"#{look}")
        drawn = _add(mark, "LineString")
        _add(drawn, "altitudeMode", "absolute")
        places = result.truth.position[(result.time_s >= start) & (result.time_s <= stop)]
        degrees = np.column_stack([np.degrees(places[:, 1]), np.degrees(places[:, 0]), places[:, 2]])
        _add(drawn, "coordinates", " ".join(f"{east:.7f},{north:.7f},{up:.2f}" for east, north, up in degrees))
    return bytes(ElementTree.tostring(root, encoding="utf-8", xml_declaration=True))


def line_verdict(followed: Followed, line: LineResult) -> str:
    """Verdict on a line: that it keeps its limits, or why not."""
    return f"{line.name} keeps its limits." if line.closes else f"{failure(followed, line)}."


def _add(parent: ElementTree.Element, name: str, text: str = "", **attributes: str) -> ElementTree.Element:
    element = ElementTree.SubElement(parent, name, attributes)
    element.text = printable(text) or None
    return element
