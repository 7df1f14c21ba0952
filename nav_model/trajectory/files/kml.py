"""Flights of KML: paths as plans, gx:Track as recorded, and the missions of DJI (WPML)."""

import re
from collections import Counter
from collections.abc import Iterator
from xml.etree.ElementTree import Element

from nav_model.base.errors import quoted
from nav_model.trajectory.files.heights import (
    ABOVE_ELLIPSOID,
    ABOVE_GROUND,
    ABOVE_SEA,
    NO_HEIGHT,
    Heights,
    counted,
    plain_name,
)
from nav_model.trajectory.files.markup import local_name
from nav_model.trajectory.files.recorded import Segment, segment
from nav_model.trajectory.plan import Waypoint

_NOUNS = {"Track": "track", "LineString": "path", "Point": "point", "Polygon": "area", "LinearRing": "area"}
_REFERENCES = {
    "absolute": ABOVE_SEA, "relativeToGround": ABOVE_GROUND, "relativeToSeaFloor": ABOVE_GROUND,
    # of WPML
    "WGS84": ABOVE_ELLIPSOID, "EGM96": ABOVE_SEA, "relativeToStartPoint": ABOVE_GROUND,
    "aboveGroundLevel": ABOVE_GROUND, "realTimeFollowSurface": ABOVE_GROUND,
}  # fmt: skip
"""By altitude mode; any other, and none, is clampToGround."""
Shape = tuple[Element, Element]
"""A placemark, and one geometry in it."""


def read_kml(root: Element, heights: Heights) -> tuple[Waypoint, ...] | list[Segment]:
    """The waypoints of the paths of a KML file, or the segments that its tracks recorded.

    Each leg of a path is a line of its placemark's name. Single points are flown where there is no path.
    Raises InputError under the file's name.
    """
    shapes = [(local_name(shape), mark, shape) for mark, shape in _shapes(root, heights)]
    count = Counter(_NOUNS[kind] for kind, _, _ in shapes)
    chosen = next((noun for noun in ("track", "path", "point") if count[noun]), None)
    if chosen is None or (count["area"] and chosen == "point" and count["point"] < 2):
        if count["area"]:
            raise heights.refuse(
                "holds an area and no path. Draw the lines to be flown as a path, or plan parallel lines."
            )
        raise heights.refuse("holds no placemark with coordinates")
    taken = [(mark, shape) for kind, mark, shape in shapes if _NOUNS[kind] == chosen]
    content: tuple[Waypoint, ...] | list[Segment]
    if chosen == "track":
        content = [_track(mark, shape, heights) for mark, shape in taken]
        heights.note(counted(len(content), "recorded track"))
    elif chosen == "point" and any(mark.find("{*}executeHeight") is not None for mark, _ in taken):
        content = tuple(_mission(root, taken, heights))
        heights.note(f"DJI mission, {counted(len(content), 'waypoint')}")
    else:
        content = tuple(_places(taken, heights))
        no_path = "no path, so single points in their order, " if chosen == "point" else ""
        heights.note(f"{no_path}{counted(count[chosen], chosen)}, {counted(len(content), 'waypoint')}")
    unused = [counted(number, noun) for noun, number in count.items() if noun != chosen]
    if unused:
        heights.note(f"not used: {', '.join(unused)}")
    return content


def _shapes(root: Element, heights: Heights) -> Iterator[Shape]:
    """Placemarks and their geometries in the order of the file, in one walk."""
    stack: list[tuple[Element, Element | None]] = [(root, None)]
    while stack:
        element, mark = stack.pop()
        kind = local_name(element)
        if kind == "Placemark":
            if mark is not None:
                raise heights.refuse("has a placemark within a placemark, which KML does not allow")
            mark = element
        if mark is not None and kind in _NOUNS:
            yield mark, element
        else:
            stack.extend((child, mark) for child in reversed(element))


def _places(shapes: list[Shape], heights: Heights) -> Iterator[Waypoint]:
    """The places of geometries in turn; a leg of a path has its placemark's name."""
    for path, (mark, shape) in enumerate(shapes, 1):
        label, reference = plain_name(mark.findtext("{*}name")), _reference(shape)
        before: tuple[str, str] | None = None  # a place is a waypoint once it is known whether a leg begins there
        texts = re.finditer(r"\S+", shape.findtext("{*}coordinates") or "")
        for number, match in enumerate(texts, 1):
            if before is not None:
                yield _place(*before, reference, label or f"line {path}", heights)
            before = match[0], f"{quoted(label or 'placemark')}, point {number}"
        if before is not None:
            yield _place(*before, reference, "", heights)


def _place(text: str, where: str, reference: str, line: str, heights: Heights, up: str | None = None) -> Waypoint:
    parts = text.split(",")
    if len(parts) not in (2, 3):
        raise heights.refuse(f"{where}: {quoted(text)} is not longitude,latitude,height")
    return heights.waypoint(parts[1], parts[0], up or "".join(parts[2:]), reference, where, line)


def _track(mark: Element, shape: Element, heights: Heights) -> Segment:
    """A gx:Track: as many times as places."""
    label = plain_name(mark.findtext("{*}name"))
    times = [time.text for time in shape.iterfind("{*}when")]
    places = [(place.text or "").split() for place in shape.iterfind("{*}coord")]
    if len(times) != len(places) or any(len(place) not in (2, 3) for place in places):
        raise heights.refuse(
            f"{quoted(label or 'track')} has {len(times)} times and {len(places)} places; each time needs a place of "
            "longitude latitude height"
        )
    rows = [(time, place[1], place[0], "".join(place[2:])) for time, place in zip(times, places, strict=True)]
    return segment(label, rows, _reference(shape), heights)


def _mission(root: Element, shapes: list[Shape], heights: Heights) -> Iterator[Waypoint]:
    """The waypoints that a drone executes; lines are where its camera is triggered again and again, else each leg."""
    modes = {local_name(element): element.text or "" for element in root.iter() if "Mode" in element.tag}
    reference = _REFERENCES.get(modes.get("executeHeightMode", ""), NO_HEIGHT)
    shooting: set[int] = set()
    for group in root.iterfind(".//{*}actionGroup"):
        if group.findtext("{*}actionTrigger/{*}actionTriggerType", "").startswith("multiple"):
            ends = (group.findtext(f"{{*}}actionGroup{end}Index", "") for end in ("Start", "End"))
            start, stop = (int(heights.number(end, "action group")) for end in ends)
            shooting.update(range(max(start, 0), min(stop, len(shapes))))
    legs = shooting or range(len(shapes) - 1)
    for number, (mark, shape) in enumerate(shapes):
        place = (shape.findtext("{*}coordinates") or "").strip()
        line = f"line {number + 1}" if number in legs else ""
        up = mark.findtext("{*}executeHeight")
        yield _place(place, f"waypoint {number + 1}", reference, line, heights, up)


def _reference(shape: Element) -> str:
    return _REFERENCES.get((shape.findtext("{*}altitudeMode") or "").strip(), NO_HEIGHT)
