"""Flights from files: GPX and KML as plans, SBET and CSV as they were flown."""

from __future__ import annotations

import html
import math
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from nav_model.base.errors import InputError, shown
from nav_model.simulation.specification import TrajectorySpec
from nav_model.simulation.trajectory import FILE_BOUNDS, file_duration, flight_through, parse_trajectory
from nav_model.trajectory.plan import Plan, PlannedFlight, Waypoint, fly

if TYPE_CHECKING:
    from xml.etree.ElementTree import Element

_SBET = 17  # doubles in a record
_MOST_WAYPOINTS = 2000
_MOST_NAME = 80


def parse_flight(content: bytes, name: str, like: Plan, height: float | None = None) -> PlannedFlight:
    """The flight of a file's content, by the end of its name.

    like: speed, bank, climb and ground for waypoints. height: of the places of a plan that have none [m above the
    ellipsoid]. Raises InputError under the file's name, with what is wrong and where.
    """
    if points := waypoints_of(content, name, height):
        try:
            return fly(replace(like, waypoints=points))
        except InputError as error:
            raise InputError(name, str(error)) from error
    spec = (parse_sbet if name.lower().endswith(".out") else parse_trajectory)(content, name)
    return PlannedFlight(spec, file_duration(spec), ())


def waypoints_of(content: bytes, name: str, height: float | None = None) -> tuple[Waypoint, ...]:
    """The waypoints of a GPX or KML file; none of a file that is flown as it is. Raises as `parse_flight`."""
    read = {".gpx": _gpx_waypoints, ".kml": _kml_waypoints}.get(Path(name).suffix.lower())
    found = tuple(read(_xml(content, name), name, height)) if read else ()
    if len(found) > _MOST_WAYPOINTS:
        raise InputError(name, f"{len(found)} points are too many for a plan; at most {_MOST_WAYPOINTS}")
    return found


def _gpx_waypoints(root: Element, name: str, height: float | None) -> Iterator[Waypoint]:
    """Waypoints of a GPX file: its routes, tracks or single points; a line begins where one has a name."""
    kinds = ("rtept", "trkpt", "wpt")
    kind = next((kind for kind in kinds if root.find(f".//{{*}}{kind}") is not None), None)
    if kind is None:
        raise InputError(name, "holds no route, track or point")
    for number, element in enumerate(root.iterfind(f".//{{*}}{kind}"), 1):
        place = element.get("lat"), element.get("lon"), element.findtext(".//{*}ele", "").strip()
        line = _plain(element.findtext(".//{*}name", ""))
        yield _waypoint(*place, line, name, f"{kind} {number}", height)


def _kml_waypoints(root: Element, name: str, height: float | None) -> Iterator[Waypoint]:
    """Waypoints of a KML file: the places of its placemarks in turn; each leg of a path is a line of that name."""
    count = 0
    for mark in root.iterfind(".//{*}Placemark"):
        label = _plain(mark.findtext(".//{*}name", ""))
        for coordinates in mark.iterfind(".//{*}coordinates"):
            places = (coordinates.text or "").split()
            for number, place in enumerate(places, 1):
                count += 1
                where, parts = f"{shown(label or 'placemark')}, point {number}", place.split(",")
                if len(parts) not in (2, 3):
                    raise InputError(name, f"{where}: {shown(place)} is not longitude,latitude,height")
                line = label or f"line {count}" if number < len(places) else ""
                up = parts[2] if len(parts) == 3 else ""
                yield _waypoint(parts[1], parts[0], up, line, name, where, height)
    if not count:
        raise InputError(name, "holds no placemark with coordinates")


def parse_sbet(content: bytes, name: str) -> TrajectorySpec:
    """The flight of an SBET file: records of 17 doubles, heading less the wander angle.

    Raises InputError under the file's name: not whole records, no finite numbers, time that runs backwards, and what
    `parse_trajectory` refuses of a motion.
    """
    if len(content) > FILE_BOUNDS.most_bytes or len(content) % (8 * _SBET) or not content:
        raise InputError(name, f"is not an SBET file: records of {8 * _SBET} bytes, at most 200 MB")
    records = np.frombuffer(content, dtype="<f8").reshape(-1, _SBET)
    if not np.all(np.isfinite(records[:, :11])) or np.abs(records[:, 1]).max() > math.pi / 2:
        raise InputError(name, "is not an SBET file: latitudes beyond the poles, or no finite numbers")
    back = np.flatnonzero(np.diff(records[:, 0]) <= 0.0)
    if back.size:
        raise InputError(name, f"record {back[0] + 2}: time runs backwards")
    if len(records) < FILE_BOUNDS.fewest_rows:
        raise InputError(name, f"{len(records)} records; at least {FILE_BOUNDS.fewest_rows} are needed")
    samples = records[:, [0, 1, 2, 3, 7, 8, 9]].copy()
    samples[:, 0] -= samples[0, 0]
    samples[:, 6] -= records[:, 10]
    return flight_through(samples, list(range(1, len(samples) + 1)), name)


def _xml(content: bytes, name: str) -> Element:
    """The root of an XML document without entities or a document type."""
    from xml.etree.ElementTree import ParseError

    from defusedxml.common import DefusedXmlException
    from defusedxml.ElementTree import fromstring

    try:
        root: Element = fromstring(content, forbid_dtd=True)
    except DefusedXmlException as error:
        raise InputError(name, "declares entities or a document type, which are not read") from error
    except (ParseError, ValueError, LookupError) as error:
        raise InputError(name, f"is not XML: {error}") from error
    return root


def _plain(text: str) -> str:
    """A name without the HTML that some programs put into it."""
    return " ".join(html.unescape(re.sub(r"<[^<>]*>", " ", html.unescape(text))).split())[:_MOST_NAME]


def _number(text: str | None, name: str, where: str) -> float:
    try:
        value = float(text or "")
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        raise InputError(name, f"{where}: {shown(text)} must be a finite number")
    return value


def _waypoint(
    latitude: str | None, longitude: str | None, up: str, line: str, name: str, where: str, height: float | None
) -> Waypoint:
    """A place of a plan from its texts, in degrees; `height` where `up` is empty."""
    if not up and height is None:
        raise InputError(name, f"{where} has no height; give one for all (--height)")
    north, east = (_number(text, name, where) for text in (latitude, longitude))
    if abs(north) > 90.0 or abs(east) > 360.0:
        raise InputError(name, f"{where}: {north:g}, {east:g} is no place on the Earth")
    metres = _number(up, name, where) if up else height
    return Waypoint(math.radians(north), math.radians(east), metres or 0.0, line)
