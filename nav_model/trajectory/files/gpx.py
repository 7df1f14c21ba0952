"""Flights of GPX: routes, and tracks without times, as plans; tracks with times as recorded."""

from collections.abc import Iterator
from xml.etree.ElementTree import Element

import numpy as np

from nav_model.trajectory.files.heights import ABOVE_SEA, Heights, counted, plain_name
from nav_model.trajectory.files.markup import local_name, seconds_of
from nav_model.trajectory.files.recorded import Segment
from nav_model.trajectory.plan import Waypoint

_NOUNS = {"trkpt": "track point", "rtept": "route point", "wpt": "waypoint"}


def read_gpx(root: Element, heights: Heights) -> tuple[tuple[Waypoint, ...], list[Segment]]:
    """The waypoints of a GPX file, or the segments that it recorded. A recorded track comes before routes, these
    before tracks without times, these before single points; a line begins where a place has a name.

    Raises InputError under the file's name.
    """
    points: dict[str, list[Element]] = {kind: [] for kind in _NOUNS}
    segments: list[tuple[str, list[Element]]] = []
    label = ""
    for element in root.iter():
        kind = local_name(element)
        if kind == "trk":
            label = plain_name(element.findtext("{*}name"))
        elif kind == "trkseg":
            segments.append((label, [point for point in element if local_name(point) == "trkpt"]))
        elif kind in _NOUNS:
            points[kind].append(element)
    timed = [[point.findtext("{*}time") for point in track] for _, track in segments]
    recorded = len({time for times in timed for time in times if time}) > 1
    chosen = "trkpt" if recorded else next((kind for kind in ("rtept", "trkpt", "wpt") if points[kind]), None)
    if chosen is None:
        raise heights.refuse("holds no route, track or point")
    unused = [counted(len(points[kind]), noun) for kind, noun in _NOUNS.items() if points[kind] and kind != chosen]
    if recorded:
        tracks = [_segment(*segment, heights) for segment in segments if segment[1]]
        heights.note(f"{counted(len(points[chosen]), 'recorded place')}, {counted(len(tracks), 'segment')}")
    else:
        waypoints = heights.bounded(_waypoints(chosen, points[chosen], heights))
        heights.note(counted(len(waypoints), _NOUNS[chosen]))
    if unused:
        heights.note(f"not used: {', '.join(unused)}")
    return ((), tracks) if recorded else (waypoints, [])


def _waypoints(kind: str, points: list[Element], heights: Heights) -> Iterator[Waypoint]:
    for number, point in enumerate(points, 1):
        place = point.get("lat"), point.get("lon"), point.findtext("{*}ele")
        yield heights.waypoint(*place, ABOVE_SEA, f"{kind} {number}", plain_name(point.findtext("{*}name")))


def _segment(label: str, track: list[Element], heights: Heights) -> Segment:
    rows = np.empty((len(track), 4))
    for row, point in enumerate(track):
        where = f"{label or 'track'}, point {row + 1}"
        rows[row, 0] = seconds_of(point.findtext("{*}time"), heights.file_name, where)
        rows[row, 1:] = heights.place(point.get("lat"), point.get("lon"), point.findtext("{*}ele"), ABOVE_SEA, where)
    return Segment(label, rows)
