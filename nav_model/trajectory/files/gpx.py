"""Flights of GPX: routes, and tracks without times, as plans; tracks with times as recorded."""

from xml.etree.ElementTree import Element

from nav_model.trajectory.files.heights import ABOVE_SEA, Heights, counted, plain_name
from nav_model.trajectory.files.recorded import Segment, segment
from nav_model.trajectory.plan import Waypoint

_NOUNS = {"trkpt": "track point", "rtept": "route point", "wpt": "waypoint"}


def read_gpx(root: Element, heights: Heights) -> tuple[Waypoint, ...] | list[Segment]:
    """The waypoints of a GPX file, or the segments that it recorded. A recorded track comes before routes, these
    before tracks without times, these before single points; a line begins where a place has a name.

    Raises InputError under the file's name.
    """
    points: dict[str, list[Element]] = {kind: [*root.iterfind(f".//{{*}}{kind}")] for kind in _NOUNS}
    times = {point.findtext("{*}time") for point in points["trkpt"]} - {None}
    recorded = len(times) > 1
    chosen = "trkpt" if recorded else next((kind for kind in ("rtept", "trkpt", "wpt") if points[kind]), None)
    if chosen is None:
        raise heights.refuse("holds no route, track or point")
    content: tuple[Waypoint, ...] | list[Segment]
    if recorded:
        content = [
            segment(
                plain_name(track.findtext("{*}name")),
                [(point.findtext("{*}time"), *_place(point)) for point in part.iterfind("{*}trkpt")],
                ABOVE_SEA,
                heights,
            )
            for track in root.iterfind(".//{*}trk")
            for part in track.iterfind("{*}trkseg")
            if part.find("{*}trkpt") is not None
        ]
        heights.note(f"{counted(len(points[chosen]), 'recorded place')}, {counted(len(content), 'segment')}")
    else:
        content = tuple(
            heights.waypoint(*_place(point), ABOVE_SEA, f"{chosen} {number}", plain_name(point.findtext("{*}name")))
            for number, point in enumerate(points[chosen], 1)
        )
        heights.note(counted(len(content), _NOUNS[chosen]))
    unused = [counted(len(points[kind]), noun) for kind, noun in _NOUNS.items() if points[kind] and kind != chosen]
    if unused:
        heights.note(f"not used: {', '.join(unused)}")
    return content


def _place(point: Element) -> tuple[str | None, str | None, str | None]:
    return point.get("lat"), point.get("lon"), point.findtext("{*}ele")
