"""Flights of XML, alone or in an archive: KML with DJI's missions in it (WPML), and GPX.

What is read is bounded in size, tags, depth, the length of namespaces and the number of shapes, and has no entities.
Only the root is searched to any depth; of what may be inside itself, such as a folder, children are looked at.
"""

import io
import math
import zipfile
from collections import Counter
from collections.abc import Iterable, Iterator
from itertools import islice, pairwise
from typing import NamedTuple
from xml.etree.ElementTree import Element, ParseError, TreeBuilder

import numpy as np

from nav_model.base.errors import InputError, quoted, reason_of
from nav_model.base.text.npz_arrays import DAMAGED
from nav_model.base.text.number_table import seconds_of
from nav_model.trajectory.files.heights import MOST_WAYPOINTS, Heights, Reference, counted, plain_name
from nav_model.trajectory.files.recorded import RecordedSegment
from nav_model.trajectory.waypoints import Waypoint

_MOST_XML = 5_000_000  # bytes
_MOST_TAGS = 400_000
_DEEPEST = 40
_LONGEST_NAMESPACE = 200  # characters: the parser makes each tag's name of it anew
_MOST_SHAPES = 20_000
_MOST_ENTRIES = 2000  # of an archive
_ENTRY = b"PK\x01\x02"

_RECORDED = "recorded track"
_CHOSEN = (_RECORDED, "DJI mission", "route", "track", "path", "point")
"""Kinds of shape in the order in which one is flown of a file that has several."""
_KML = {"Track": _RECORDED, "LineString": "path", "Point": "point", "Polygon": "area"}
_REFERENCES: dict[str, Reference] = {
    "absolute": "sea", "relativeToGround": "ground", "relativeToSeaFloor": "ground",
    # of WPML
    "WGS84": "ellipsoid", "EGM96": "sea", "relativeToStartPoint": "ground", "aboveGroundLevel": "ground",
    "realTimeFollowSurface": "ground",
}  # fmt: skip
"""By altitude mode; any other, and none, is clampToGround."""
Text = str | None


class Place(NamedTuple):
    """Latitude, longitude and height, and the time, as the file has them; line: what begins here, None: that of its
    shape."""

    place: tuple[Text, Text, Text]
    time: Text = None
    line: Text = None


class Shape(NamedTuple):
    """Drawing or recording of a file: its noun, its name, its places, and the zero of their heights."""

    noun: str
    name: str
    places: Iterable[Place]
    reference: Reference


def unpack(content: bytes, heights: Heights) -> bytes | None:
    """The flight in an archive (KMZ, or DJI's WPML in one); None where it holds none.

    Raises InputError under the file's name: damaged, encrypted, too many entries, more than 5 MB when expanded.
    """
    if content.count(_ENTRY) > _MOST_ENTRIES:
        raise heights.refuse(f"is a ZIP archive of more than {_MOST_ENTRIES} files. Give the flight alone.")
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            names = [entry for entry in archive.infolist() if entry.filename.lower().endswith((".wpml", ".kml"))]
            if not names:
                return None
            # What a drone executes comes before the template it was made of; else the first, which is doc.kml.
            entry = min(names, key=lambda entry: not entry.filename.lower().endswith(".wpml"))
            if entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
                raise NotImplementedError(f"{quoted(entry.filename)} is compressed in a way that is not read")
            with archive.open(entry) as file:
                inside = file.read(_MOST_XML + 1)
    except DAMAGED as error:
        raise heights.refuse(f"is a ZIP archive that cannot be read: {reason_of(error)}") from error
    if len(inside) > _MOST_XML:
        raise heights.refuse(f"holds more than {_MOST_XML // 1_000_000} MB of XML. Keep only the flight.")
    heights.note(f"{plain_name(entry.filename)} in the archive")
    return inside


def read_markup(content: bytes, heights: Heights) -> tuple[Waypoint, ...] | list[RecordedSegment]:
    """The waypoints of a KML or GPX file, or the segments that it recorded.

    Recorded tracks come before what is planned, paths before single points. Each leg of a path is a line of its name;
    in GPX a line begins where a place has a name. Raises InputError under the file's name.
    """
    root = _xml(content, heights)
    kind = _local_name(root)
    if kind not in ("gpx", "kml"):
        raise heights.refuse(f"is XML of the kind {quoted(kind)}. Give the flight as KML or GPX.")
    shapes = [*islice(_gpx(root) if kind == "gpx" else _kml(root, heights), _MOST_SHAPES + 1)]
    if len(shapes) > _MOST_SHAPES:
        raise heights.refuse(f"holds more than {_MOST_SHAPES} paths and points. Keep only the flight.")
    count = Counter(shape.noun for shape in shapes)
    chosen = next((noun for noun in _CHOSEN if count[noun]), "")
    if count["area"] and (not chosen or (chosen == "point" and count["point"] < 2)):
        raise heights.refuse(
            "holds an area and no path. Draw the lines to be flown as a path, or plan parallel lines."
        )
    if not chosen:
        tour = " but a tour of the camera" if root.find(".//{*}Tour") is not None else ""
        raise heights.refuse(f"holds no path, route, track or point{tour}")
    taken = [shape for shape in shapes if shape.noun == chosen]
    flight: tuple[Waypoint, ...] | list[RecordedSegment]
    if chosen == _RECORDED:
        flight = [_segment(shape, heights) for shape in taken]
        number = sum(len(part.rows) for part in flight)
    else:
        flight = tuple(
            heights.waypoint(
                point.place, shape.reference, f"{shape.name or shape.noun}, place {at}",
                (shape.name or f"line {number}") if point.line is None else point.line,
            )
            for number, shape in enumerate(taken, 1) for at, point in enumerate(shape.places, 1)
        )  # fmt: skip
        if not flight:
            raise heights.refuse(f"has a {chosen} without a place. Give one with places.")
        # A path that goes on where the one before ends has that place once.
        ends = [a.line == "" and (a.latitude, a.longitude) == (b.latitude, b.longitude) for a, b in pairwise(flight)]
        flight = tuple(point for point, end in zip(flight, [*ends, False], strict=True) if not end)
        number = len(flight)
    no_path = "no path, so single points in their order: " if chosen == "point" else ""
    heights.note(f"{no_path}{counted(len(taken), chosen)}, {counted(number, 'place')}")
    if unused := [counted(number, noun) for noun, number in count.items() if noun != chosen]:
        heights.note(f"not used: {', '.join(unused)}")
    return flight


def _xml(content: bytes, heights: Heights) -> Element:
    """The root of an XML document, bounded in size and tags and without entities."""
    from defusedxml.common import DefusedXmlException
    from defusedxml.ElementTree import XMLParser

    if len(content) > _MOST_XML:
        raise heights.refuse(f"has more than {_MOST_XML // 1_000_000} MB of XML. Keep only the flight.")
    if content.count(b"<") > _MOST_TAGS:
        raise heights.refuse(f"has more than {_MOST_TAGS} tags")
    try:
        parser = XMLParser(target=_Bounded(heights), forbid_dtd=True)
        parser.feed(content)
        root: Element = parser.close()
    except InputError:
        raise
    except DefusedXmlException as error:
        raise heights.refuse("declares entities or a document type, which are not read") from error
    except (ParseError, ValueError, LookupError) as error:
        raise heights.refuse(f"is not XML: {reason_of(error)}") from error
    return root


class _Bounded(TreeBuilder):
    """Builds the tree of a document, and refuses tags too deep and namespaces too long as they come."""

    def __init__(self, heights: Heights) -> None:
        super().__init__()
        self._heights, self._depth = heights, 0

    def start_ns(self, _: str, namespace: str) -> None:
        if len(namespace) > _LONGEST_NAMESPACE:
            raise self._heights.refuse(f"has a namespace of more than {_LONGEST_NAMESPACE} characters")

    def start(self, tag: str, attributes: dict[str, str], /) -> Element:
        self._depth += 1
        if self._depth > _DEEPEST:
            raise self._heights.refuse(f"has tags nested more than {_DEEPEST} deep")
        return super().start(tag, attributes)

    def end(self, tag: str, /) -> Element:
        self._depth -= 1
        return super().end(tag)


def _segment(shape: Shape, heights: Heights) -> RecordedSegment:
    """Recording of a shape, with its times."""
    rows = []
    for number, point in enumerate(shape.places, 1):
        where = f"{shape.name or 'track'}, place {number}"
        if math.isnan(time := seconds_of(point.time or "")):
            raise heights.refuse(f"{where}: {quoted(point.time)} is not a date and time")
        rows.append((time, *heights.place(point.place, shape.reference, where)))
    return RecordedSegment(shape.name, np.array(rows).reshape(-1, 4))


def _gpx(root: Element) -> Iterator[Shape]:
    def places(parent: Element, tag: str) -> list[Place]:
        return [
            Place((at.get("lat"), at.get("lon"), at.findtext("{*}ele")), at.findtext("{*}time"), _name(at))
            for at in parent.iterfind(tag)
        ]

    for track in root.iterfind(".//{*}trk"):
        name = _name(track)
        for part in track.iterfind("{*}trkseg"):
            if points := places(part, "{*}trkpt"):
                timed = len({point.time for point in points} - {None}) > 1
                yield Shape(_RECORDED if timed else "track", name, points, "sea")
    for route in root.iterfind(".//{*}rte"):
        yield Shape("route", _name(route), places(route, "{*}rtept"), "sea")
    for point in places(root, "{*}wpt"):
        yield Shape("point", point.line or "", [point], "sea")


def _kml(root: Element, heights: Heights) -> Iterator[Shape]:
    """Missions of DJI, else the geometries of placemarks in the order of the file."""
    if root.find(".//{*}executeHeight") is not None:
        folders = root.findall(".//{*}Folder")
        if any(root.find(f".//{{*}}{speed}") is not None for speed in ("autoFlightSpeed", "waypointSpeed")):
            heights.note("flown at the design's speed, not the mission's")
        for number, folder in enumerate(folders, 1):
            yield _mission(folder, f"line {number}." if len(folders) > 1 else "line ", heights)
        return
    for mark in root.iterfind(".//{*}Placemark"):
        name = _name(mark)
        for element in mark.iter():
            kind = _local_name(element)
            if kind == "Placemark" and element is not mark:
                raise heights.refuse("has a placemark within a placemark, which KML does not allow")
            if noun := _KML.get(kind):
                reference = _REFERENCES.get((element.findtext("{*}altitudeMode") or "").strip(), "none")
                places = _track(element, heights) if kind == "Track" else _path(element, "{*}coordinates", heights)
                yield Shape(noun, name, places, reference)


def _path(element: Element, tag: str, heights: Heights) -> Iterator[Place]:
    """The places in a tag; each but the last begins a leg."""
    texts = (element.findtext(tag) or "").split(None, MOST_WAYPOINTS + 1)[: MOST_WAYPOINTS + 1]
    for number, text in enumerate(texts, 1):
        parts = text.split(",")
        if len(parts) not in (2, 3):
            raise heights.refuse(f"{quoted(text)} is not longitude,latitude,height")
        yield Place((parts[1], parts[0], "".join(parts[2:])), line=None if number < len(texts) else "")


def _track(track: Element, heights: Heights) -> Iterator[Place]:
    """A gx:Track: as many times as places."""
    times = [time.text for time in track.iterfind("{*}when")]
    places = [(place.text or "").split() for place in track.iterfind("{*}coord")]
    if len(times) != len(places) or any(len(place) not in (2, 3) for place in places):
        counts = f"{len(times)} times and {len(places)} places"
        raise heights.refuse(f"has a track of {counts}; each time needs a place of longitude latitude height")
    for time, place in zip(times, places, strict=True):
        yield Place((place[1], place[0], "".join(place[2:])), time)


def _mission(folder: Element, line: str, heights: Heights) -> Shape:
    """Mission that a drone executes; lines are where its camera is triggered again and again, else each leg."""
    marks = [mark for mark in folder.iterfind("{*}Placemark") if mark.find("{*}executeHeight") is not None]
    turns = np.zeros(len(marks) + 1, int)  # groups that begin at a place, less those that end there
    for group in folder.iterfind("{*}Placemark/{*}actionGroup"):
        if group.findtext("{*}actionTrigger/{*}actionTriggerType", "").startswith("multiple"):
            ends = (group.findtext(f"{{*}}actionGroup{end}Index", "") for end in ("Start", "End"))
            start, stop = (int(heights.number(end, "action group")) for end in ends)
            if (start := max(start, 0)) < (stop := min(stop, len(marks))):
                turns[[start, stop]] += 1, -1
    legs = {*np.flatnonzero(np.cumsum(turns)).tolist()} or range(len(marks) - 1)
    places = [
        Place((*at[:2], mark.findtext("{*}executeHeight")), line=f"{line}{number + 1}" if number in legs else "")
        for number, mark in enumerate(marks) for at, *_ in _path(mark, "{*}Point/{*}coordinates", heights)
    ]  # fmt: skip
    reference = _REFERENCES.get(folder.findtext("{*}executeHeightMode") or "", "none")
    return Shape("DJI mission", _name(folder), places, reference)


def _name(element: Element) -> str:
    return plain_name(element.findtext("{*}name"))


def _local_name(element: Element) -> str:
    """The tag without its namespace."""
    return str(element.tag).rpartition("}")[2]
