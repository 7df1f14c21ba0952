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

_PLANS = (".gpx", ".kml")
_SBET = 17  # doubles in a record
_MOST_WAYPOINTS = 2000
_MOST_NAME = 80


def read_flight(path: str | Path, like: Plan, height: float | None = None) -> PlannedFlight:
    """The flight of a file, by the end of its name.

    Parameters
    ----------
    path : str or Path
    like : Plan
        Speed, bank, climb and ground for waypoints.
    height : float, optional
        For the places of a plan that have none, m above the ellipsoid.

    Raises
    ------
    InputError
        Under the file's name, with what is wrong and where.
    OSError
        Where the file cannot be read.
    """
    path = Path(path)
    with path.open("rb") as file:
        content = file.read(FILE_BOUNDS.most_bytes + 1)
    return parse_flight(content, path.name, like, height)


def parse_flight(content: bytes, name: str, like: Plan, height: float | None = None) -> PlannedFlight:
    """The flight of a file's content, otherwise as `read_flight`."""
    if points := waypoints_of(content, name, height):
        try:
            return fly(replace(like, waypoints=points))
        except InputError as error:
            raise InputError(name, str(error)) from error
    spec = (parse_sbet if name.lower().endswith(".out") else parse_trajectory)(content, name)
    return PlannedFlight(spec, file_duration(spec), ())


def waypoints_of(content: bytes, name: str, height: float | None = None) -> tuple[Waypoint, ...]:
    """The waypoints of a GPX or KML file; none of a file that is flown as it is. Raises as `read_flight`."""
    kind = Path(name).suffix.lower()
    return {".gpx": gpx_waypoints, ".kml": kml_waypoints}[kind](content, name, height) if kind in _PLANS else ()


def gpx_waypoints(content: bytes, name: str, height: float | None = None) -> tuple[Waypoint, ...]:
    """Waypoints of a GPX file: its routes, tracks or single points; a line begins where one has a name."""
    root = _xml(content, name)
    for kind in ("rtept", "trkpt", "wpt"):
        found = []
        for number, element in enumerate(_all(root, kind), 1):
            latitude, longitude = (_number(element.get(axis), name, f"{kind} {number}") for axis in ("lat", "lon"))
            text = _text(element, "ele")
            up = _height(text, name, f"{kind} {number}", height)
            found.append(_waypoint(latitude, longitude, up, _plain(_text(element, "name")), name, number))
        if found:
            return _checked(found, name)
    raise InputError(name, "holds no route, track or point")


def kml_waypoints(content: bytes, name: str, height: float | None = None) -> tuple[Waypoint, ...]:
    """Waypoints of a KML file: the places of its placemarks in turn; each leg of a path is a line of that name."""
    root = _xml(content, name)
    found: list[Waypoint] = []
    for mark in _all(root, "Placemark"):
        label = _plain(_text(mark, "name"))
        for coordinates in _all(mark, "coordinates"):
            places = (coordinates.text or "").split()
            for number, place in enumerate(places):
                parts = place.split(",")
                where = f"{shown(label or 'placemark')}, point {number + 1}"
                if len(parts) not in (2, 3):
                    raise InputError(name, f"{where}: {shown(place)} is not longitude,latitude,height")
                longitude, latitude = (_number(part, name, where) for part in parts[:2])
                up = _height(parts[2] if len(parts) == 3 else "", name, where, height)
                line = label or f"line {len(found) + 1}" if number < len(places) - 1 else ""
                found.append(_waypoint(latitude, longitude, up, line, name, len(found) + 1))
    if not found:
        raise InputError(name, "holds no placemark with coordinates")
    return _checked(found, name)


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


def _all(root: Element, tag: str) -> Iterator[Element]:
    """Elements of this name, in any namespace."""
    return (element for element in root.iter() if isinstance(element.tag, str) and element.tag.split("}")[-1] == tag)


def _text(element: Element, tag: str) -> str:
    return next(((child.text or "").strip() for child in _all(element, tag)), "")


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


def _height(text: str, name: str, where: str, height: float | None) -> float:
    if text:
        return _number(text, name, where)
    if height is None:
        raise InputError(name, f"{where} has no height; give one for all (--height)")
    return height


def _waypoint(latitude: float, longitude: float, height: float, line: str, name: str, number: int) -> Waypoint:
    if abs(latitude) > 90.0 or abs(longitude) > 360.0:
        raise InputError(name, f"point {number}: {latitude:g}, {longitude:g} is no place on the Earth")
    return Waypoint(math.radians(latitude), math.radians(longitude), height, line)


def _checked(points: list[Waypoint], name: str) -> tuple[Waypoint, ...]:
    if len(points) > _MOST_WAYPOINTS:
        raise InputError(name, f"{len(points)} points are too many for a plan; at most {_MOST_WAYPOINTS}")
    return tuple(points)
