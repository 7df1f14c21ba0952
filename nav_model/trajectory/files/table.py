"""Flights as columns of a text: the product's own trajectory file, and what other programs record and name."""

import math
import re
from typing import NamedTuple

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.errors import InputError
from nav_model.base.number_table import NumberTable
from nav_model.earth.trajectory_file import has_trajectory, trajectory_of
from nav_model.simulation.trajectory import FILE_BOUNDS, flight_through
from nav_model.trajectory.files.heights import ABOVE_ELLIPSOID, ABOVE_GROUND, ABOVE_SEA, NO_HEIGHT, Heights, counted
from nav_model.trajectory.files.recorded import Segment, unrolled
from nav_model.trajectory.plan import PlannedFlight

_NAMES = {
    "time": "time t timestamp gpstime gpsseconds timeofweek tow sow utctime utc seconds flytime flighttime "
    "elapsedtime datetime updatetime date",
    "latitude": "latitude lat",
    "longitude": "longitude lon long lng",
    ABOVE_ELLIPSOID: "ellipsoidheight ellipsoidalheight heightellipsoid heightaboveellipsoid hell hae",
    ABOVE_SEA: "altitude alt elevation ele msl amsl altitudemsl altmsl altitudeamsl altitudeabovesealevel heightmsl "
    "orthometricheight",
    "height": "height h",
    ABOVE_GROUND: "heightabovetakeoff relativealtitude relalt relativeheight relheight agl altitudeagl heightagl",
    "roll": "roll bank",
    "pitch": "pitch",
    "yaw": "yaw heading hdg azimuth trueheading compassheading",
}
"""In the order in which they are taken; without unit, prefix, blanks and marks."""
_DIMENSIONS = {"time": "time", **dict.fromkeys(("latitude", "longitude", "roll", "pitch", "yaw"), "angle")}
_USUAL = {"time": "s", "angle": "°", "length": "m"}
_UNIT = re.compile(r"(.*?)\s*[\[(]([^\])]*)[\])]\s*|(.*)_(degrees|deg|radians|rad|meters|m|feet|ft|sec|s|ms|us|ns)")
_PREFIX = re.compile(r"(osd|gps|field|position|pos|nav|ins|custom)[._ ](?=.)")
_NO_UNIT = ("", "360", "180", "local", "utc", "gps", "wgs84", "msl", "agl", "true")
_EPOCHS = (1e-3, 1e-6, 1e-9)


class _Column(NamedTuple):
    """Place of a column, its name in the file, the size of its unit in SI, and whether the name says it."""

    place: int
    header: str
    size: float
    stated: bool


def read_columns(table: NumberTable, heights: Heights) -> list[Segment] | PlannedFlight:
    """The flight of a table: with the names of `COLUMNS` as it is, else places that were recorded.

    Raises InputError under the file's name: a column that is missing, a unit that is not known, what is no number.
    """
    if any(map(has_trajectory, table.headers)):
        trajectory = trajectory_of(table, FILE_BOUNDS)
        heights.note(f"trajectory file, {counted(len(trajectory.samples), 'row')}")
        flight = flight_through(trajectory.samples, trajectory.lines, heights.file_name)
        return PlannedFlight(flight, float(trajectory.samples[-1, 0]), ())
    return [_recorded(table, heights)]


def _recorded(table: NumberTable, heights: Heights) -> Segment:
    columns, reference = _columns(table, heights)
    read = table.columns(
        [column.place for column in columns.values()], FILE_BOUNDS.most_rows, FILE_BOUNDS.most_bytes,
        times=[columns["time"].place],
    )  # fmt: skip
    whole = np.isfinite(read.values).all(axis=1)
    if empty := int(np.sum(~whole)):
        heights.note(f"{counted(empty, 'row')} with empty fields left out")
    unfixed = whole & (read.values[:, 1] == 0.0) & (read.values[:, 2] == 0.0)
    if unfixed.any() and not unfixed[whole].all():  # what receivers write before they know where they are
        heights.note(f"{counted(int(unfixed.sum()), 'row')} at latitude and longitude 0 left out")
        whole &= ~unfixed
    lines = read.lines[whole]
    if not len(lines):
        raise heights.refuse("holds no row with time and place")
    values = {key: column.size * read.values[whole, number] for number, (key, column) in enumerate(columns.items())}
    time = values["time"]
    if not columns["time"].stated:  # a date in milliseconds or finer is known by its size
        time = time * next((size for size in _EPOCHS if 1e8 < abs(time[0]) * size < 1e10), 1.0)
    time, note = unrolled(time)
    if note:
        heights.note(note)
    latitude, longitude = (_degrees(columns[key], values[key], heights) for key in ("latitude", "longitude"))
    if not columns["latitude"].stated and max(np.abs(latitude).max(), np.abs(longitude).max() / 2.0) <= 0.5 * math.pi:
        raise heights.refuse(
            "latitude and longitude may be degrees or radians. Name them latitude_deg or latitude_rad."
        )
    beyond = (np.abs(latitude) > 90.0) | (np.abs(longitude) > 360.0)
    if beyond.any():
        row = int(np.argmax(beyond))
        raise heights.refuse(f"line {lines[row]}: {latitude[row]:g}, {longitude[row]:g} is no place on the Earth")
    up = values.get("height", np.zeros(len(lines)))
    up = up + heights.above_ellipsoid(0.0, reference, f"line {lines[0]}")
    attitude = [np.degrees(values[key]) for key in ("roll", "pitch", "yaw") if key in values]
    heights.note(
        f"{counted(len(lines), 'recorded row')} of {', '.join(column.header for column in columns.values())}"
    )
    return Segment("", np.column_stack([time, latitude, longitude, up, *attitude]))


def _columns(table: NumberTable, heights: Heights) -> tuple[dict[str, _Column], str]:
    """The columns of a recorded flight, and what its heights are above.

    Roll, pitch and yaw are taken together or not at all."""
    for header in table.headers:
        names = [_name_and_unit(cell) for cell in header]
        columns: dict[str, _Column] = {}
        for key, wanted in _NAMES.items():
            places = [
                (wanted.split().index(name), not unit, place)
                for place, (name, unit) in enumerate(names) if name in wanted.split()
            ]  # fmt: skip
            if places:
                place = min(places)[2]
                dimension = _DIMENSIONS.get(key, "length")
                unit = names[place][1]
                try:
                    size = float(DIMENSIONS[dimension].scale(unit or _USUAL[dimension]).size)
                except InputError as error:
                    raise heights.refuse(f"column {header[place]}: {error.reason}") from error
                columns[key] = _Column(place, header[place], size, bool(unit))
        if {"latitude", "longitude"} <= columns.keys():
            break
    else:
        header_names = ", ".join(table.headers[0])[:120] if table.headers else "no names"
        raise heights.refuse(f"columns latitude and longitude are missing; found {header_names}")
    if "time" not in columns:
        raise heights.refuse("has no column with the time, such as time_s. Give a path as KML or GPX.")
    references = [key for key in (ABOVE_ELLIPSOID, ABOVE_SEA, "height", ABOVE_GROUND) if key in columns]
    reference = references[0] if references else NO_HEIGHT
    taken = {key: columns[key] for key in ("time", "latitude", "longitude")}
    if references:
        taken["height"] = columns[reference]
        if reference == "height":  # DJI's is above the place of take-off
            relative = columns["height"].header.lower().startswith("osd")
            reference = ABOVE_GROUND if relative else ABOVE_ELLIPSOID
    if {"roll", "pitch", "yaw"} <= columns.keys():
        taken |= {key: columns[key] for key in ("roll", "pitch", "yaw")}
    return taken, reference


def _name_and_unit(cell: str) -> tuple[str, str]:
    """The name of a column in small letters without marks, and its unit; empty where it has none."""
    text = cell.strip().lower()
    match = _UNIT.fullmatch(text)
    name, unit = (match[1] or match[3] or "", match[2] or match[4] or "") if match else (text, "")
    return re.sub(r"[^a-z]", "", _PREFIX.sub("", name)), "" if unit in _NO_UNIT else unit


def _degrees(column: _Column, radians: Array, heights: Heights) -> Array:
    """Degrees of a place, which drones write as whole numbers of 1e-7 as well."""
    degrees: Array = np.degrees(radians)
    if not column.stated and np.abs(degrees).max() > 1e4:
        heights.note("latitude and longitude in 1e-7 degrees")
        degrees = 1e-7 * degrees
    return degrees
