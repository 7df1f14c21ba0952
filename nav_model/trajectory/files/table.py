"""Flights as columns of a text: the product's own trajectory file, and what other programs record and name."""

import math
import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from itertools import islice, pairwise
from operator import attrgetter
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import Array
from nav_model.base.constants import MEAN_RADIUS
from nav_model.base.errors import InputError, quoted
from nav_model.base.text.column_names import listed, parted, size_of_unit, vocabulary
from nav_model.base.text.message_dump import lines_of
from nav_model.base.text.number_table import Columns, NumberTable, Reader, angle_of, open_table, seconds_of
from nav_model.earth.trajectory_file import has_trajectory, trajectory_of
from nav_model.earth.wgs84 import geodetic
from nav_model.simulation.trajectory import FILE_BOUNDS, flight_through
from nav_model.trajectory.files.heights import Heights, Reference, counted
from nav_model.trajectory.files.messages import PLACE_MESSAGES
from nav_model.trajectory.files.recorded import USUAL_SHARE, RecordedSegment, unrolled
from nav_model.trajectory.plan import PlannedFlight
from nav_model.trajectory.waypoints import Waypoint

_KEYS = vocabulary("flight")
_ATTITUDE = ("roll", "pitch", "yaw")
_USUAL = {
    "time": ("time", "s"),
    **dict.fromkeys(("latitude", "longitude", *_ATTITUDE), ("angle", "°")),
}
_ABOVE: dict[str, Reference] = {"ellipsoid": "ellipsoid", "sea": "sea", "height": "ellipsoid", "ground": "ground"}
"""Columns of heights, the one that is taken first before the others -> the zero of their heights."""
_PREFIX = re.compile(r"(osd|gps|field|position|pos|nav|ins|custom|lcl|local)[._ ](?=.)")
_NO_UNIT = ("", "dms", "deg min sec", "360", "180", "local", "utc", "gps", "wgs84", "msl", "agl", "true")
_FINER = {"ms": 1e-3, "µs": 1e-6, "ns": 1e-9}
_HIGHEST = 20_000.0  # m
_BOTH = re.compile(rb"(?i)(gps[ _]?)?(position|coordinates?|coords?|location|lat[ _/,-]*(lon|lng)g?)|gps")
_DECIMAL = rb"[+-]?\d{1,3}\.\d+"
_LOOKED_AT = 50  # rows
_ANGLES = ("latitude", "longitude")
_WAYPOINT = re.compile(r"(?i)\W*(way[ _-]?points?|wpt?|wp[ _]?(no|id|number))\b")
_LOCAL = re.compile(r"(?i)\W*(east|north|up|[enu]-baseline|x|y|z)(?![a-z])")
_MOST_QUALITIES = 10
_FAR_APART = 5.0  # s
_SLOWEST = 0.02, 1.0  # m/s; slower than the first nothing flies, the second is seldom


class FlightColumn(NamedTuple):
    """Where a column of a flight is, how well its name fits (0: best), the size of its unit in SI, whether its name
    says the unit, and its name in the file."""

    rank: int
    by_convention: bool
    place: int
    size: float
    header: str


class FlightColumns(NamedTuple):
    """Columns that are read by quantity, what the heights are above, all names, the column of a fix's quality, and
    why units of others cannot be read."""

    taken: Mapping[str, FlightColumn]
    reference: Reference
    header: Sequence[str]
    quality: FlightColumn | None
    unread: Sequence[str]

    def name_unused(self, heights: Heights, also: Collection[int] = ()) -> None:
        """Note the columns that are not used, nor `also` by somebody, and units that cannot be read."""
        used = {column.place for column in (*self.taken.values(), *filter(None, [self.quality]))}.union(also)
        if others := [cell for place, cell in enumerate(self.header) if place not in used and cell.strip(" -")]:
            heights.note(f"not used: {listed(others)}")
        if self.unread:
            heights.note(self.unread[0])


def read_columns(
    table: NumberTable, heights: Heights
) -> tuple[Waypoint, ...] | list[RecordedSegment] | PlannedFlight:
    """The flight of a table: with the names of `COLUMNS` as it is, else places that were recorded, or waypoints.

    Raises InputError under the file's name: a column that is missing, a unit that is not known, what is no number.
    """
    if not any(map(has_trajectory, table.headers)):
        roles = flight_columns(table, heights)
        if "time" not in roles.taken:
            return _waypoints(table, heights, roles)
        rows = recorded_rows(table, heights, roles, _of_one_quality(table, heights, roles))[0]
        roles.name_unused(heights)
        return [rows]
    samples, lines = trajectory_of(table, FILE_BOUNDS)
    heights.note(f"trajectory file, {counted(len(samples), 'row')}")
    return PlannedFlight(flight_through(samples, lines, heights.file_name), float(samples[-1, 0]), ())


def table_of(content: bytes, heights: Heights, give: str) -> NumberTable:
    """The table of a text, or of the places in a text dump of messages.

    Parameters
    ----------
    content : bytes
        The text.
    heights : Heights
        Sentences on how it was read.
    give : str
        Advice behind the reason why it is no table.

    Raises
    ------
    InputError
        Under the file's name.
    """
    if dump := lines_of(content, heights.file_name, PLACE_MESSAGES):
        heights.note(dump.choice)
        content = dump.table
    try:
        return open_table(_in_two_columns(content, heights), heights.file_name)
    except InputError as error:
        raise heights.refuse(f"{error.reason} {give}") from error


def _in_two_columns(content: bytes, heights: Heights) -> bytes:
    """A table whose places stand in one field, "47.2, 8.6" or "47.2 8.6", with latitude and longitude apart."""
    head, _, below = content.partition(b"\n")
    mark = next((mark for mark in (b";", b"\t", b",") if mark in head), None)
    names = [name.strip().strip(b'"') for name in head.split(mark)] if mark else []
    place = next((at for at, name in enumerate(names) if _BOTH.fullmatch(name)), None)
    if mark is None or place is None:
        return content
    field = b'(?:"[^"\\n]*"|[^%s"\\n]*)' % mark
    row = re.compile(b'(?m)^((?:%s%s){%d})(?:"?[ ]*(%s)(?:[ ]*,[ ]*|[ ]+)(%s)[ ]*"?|[ "]*)(?=%s|\\r?$)' % (
        field, mark, place, _DECIMAL, _DECIMAL, mark,
    ))  # fmt: skip
    if not any(match[2] for match in islice(row.finditer(below), _LOOKED_AT)):
        return content
    heights.note(f"{names[place].decode('utf-8', 'replace')[:40]} taken as latitude, longitude")
    named = [b"latitude,longitude".replace(b",", mark) if at == place else name for at, name in enumerate(names)]
    if b"callsign" in head.lower():
        named = [b"altitude_ft" if name.lower() == b"altitude" else name for name in named]
        heights.note("altitude taken as feet, as Flightradar24 writes it")
    return mark.join(named) + b"\n" + row.sub(rb"\1\2" + mark + rb"\3", below)


def recorded_rows(
    table: NumberTable, heights: Heights, roles: FlightColumns, only: tuple[int, str] | None = None
) -> tuple[RecordedSegment, NDArray[np.int32]]:
    """The rows of a recording that have time and place, and their lines in the file.

    Parameters
    ----------
    table : NumberTable
        The table.
    heights : Heights
        Sentences on how it was read.
    roles : FlightColumns
        Its columns, with one of time.
    only : (int, str), optional
        A column and the text that it has in the rows that are read.

    Raises
    ------
    InputError
        Under the file's name: no row with time and place, a unit that may be two, what is no number.
    """
    columns, reference = dict(roles.taken), roles.reference
    read = _read(table, columns, only)
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
    if "x" in columns:
        inside = geodetic(np.column_stack([values.pop(key) for key in "xyz"]))
        values |= dict(zip(("latitude", "longitude", "height"), inside.T, strict=True))
        columns |= {
            key: columns.pop(at)._replace(by_convention=False)
            for key, at in zip(("latitude", "longitude", "height"), "xyz", strict=True)
        }
        heights.note("places from the Earth's centre (ECEF)")
    latitude, longitude = (_degrees(values, key) for key in ("latitude", "longitude"))
    if columns["latitude"].by_convention and np.abs(latitude).max() > 1e4:  # as receivers and autopilots have them
        latitude, longitude = 1e-7 * latitude, 1e-7 * longitude
        heights.note("latitude and longitude in 1e-7 degrees")
        up = values.get("height", np.zeros(1))
        if up.any() and columns["height"].by_convention and np.array_equal(up, np.rint(up)):
            if np.abs(up).max() < _HIGHEST:
                raise heights.refuse("height may be metres or millimetres. Name it height_m or height_mm.")
            values["height"] = 1e-3 * up
            columns["height"] = columns["height"]._replace(by_convention=False)
            heights.note("height in mm, as it is beside them")
    if "height" in columns and columns["height"].by_convention:
        heights.note("heights taken as metres")
    time = values["time"]
    if columns["time"].by_convention:
        time = time * _unit_of_time(time, latitude, longitude, heights)
    if columns["latitude"].by_convention and max(abs(latitude).max(), abs(longitude).max() / 2.0) <= 0.5 * math.pi:
        advice = "Name them latitude_deg or latitude_rad."
        raise heights.refuse(f"latitude and longitude may be degrees or radians. {advice}")
    beyond = np.flatnonzero((np.abs(latitude) > 90.0) | (np.abs(longitude) > 360.0))
    if beyond.size:
        row = beyond[0]
        raise heights.refuse(f"line {lines[row]}: {latitude[row]:g}, {longitude[row]:g} is not a place on the Earth")
    up = values.get("height", np.zeros(len(lines))) + heights.above_ellipsoid(0.0, reference, f"line {lines[0]}")
    attitude = [np.degrees(values[key]) for key in _ATTITUDE if key in values]
    heights.note(f"{counted(len(lines), 'recorded row')} of {', '.join(c.header for c in columns.values())}")
    return RecordedSegment("", np.column_stack([unrolled(time, heights), latitude, longitude, up, *attitude])), lines


def _read(table: NumberTable, columns: Mapping[str, FlightColumn], only: tuple[int, str] | None = None) -> Columns:
    readers: dict[int, Reader] = {column.place: angle_of for key, column in columns.items() if key in _ANGLES}
    if "time" in columns:
        readers[columns["time"].place] = seconds_of
    places = [column.place for column in columns.values()]
    return table.columns(places, FILE_BOUNDS.most_rows, FILE_BOUNDS.most_bytes, readers, only)


def _degrees(values: Mapping[str, Array], key: str) -> Array:
    """An angle [°] with its minutes and seconds, where they are fields of their own."""
    whole = np.abs(values[key]) + sum(values[part] for part in (f"{key}'", f"{key}''") if part in values)
    return np.degrees(np.copysign(whole, values[key]))


def _of_one_quality(table: NumberTable, heights: Heights, roles: FlightColumns) -> tuple[int, str] | None:
    """The column of the quality of a fix and the text of most rows, where others are few: these are pauses."""
    if roles.quality is None:
        return None
    (tally,) = table.tally([roles.quality.place], _MOST_QUALITIES)
    usual = max(tally, key=tally.__getitem__, default="")
    if len(tally) < 2 or tally[usual] < USUAL_SHARE * sum(tally.values()):
        return None
    others = ", ".join(sorted(text for text in tally if text != usual))
    heights.note(f"rows with {roles.quality.header} {usual} alone; those with {others} left out")
    return roles.quality.place, usual


def _waypoints(table: NumberTable, heights: Heights, roles: FlightColumns) -> tuple[Waypoint, ...]:
    """The places of a table without times, in their order; legs that are short beside the longest are no lines."""
    if roles.taken.keys() & {"x", "latitude'"} or not any(map(_WAYPOINT.match, roles.header)):
        advice = "Name a column waypoint if these are places to be flown, else give a path as KML or GPX."
        raise heights.refuse(f"has no column with the time, such as time_s. {advice}")
    read = _read(table, roles.taken)
    points = []
    for row, line in zip(read.values, read.lines, strict=True):
        north, east, *up = (column.size * value for column, value in zip(roles.taken.values(), row, strict=True))
        place = math.degrees(north), math.degrees(east), *(up or [None])
        points.append(heights.waypoint(place, roles.reference, f"line {line}"))
    legs = [
        math.dist((a.latitude, a.longitude * math.cos(a.latitude)), (b.latitude, b.longitude * math.cos(a.latitude)))
        for a, b in pairwise(points)
    ]
    lines = [leg > max(legs) / 3.0 for leg in legs]
    names = iter(range(1, len(points)))
    heights.note(
        f"{counted(len(points), 'waypoint')} of {', '.join(column.header for column in roles.taken.values())}"
    )
    if not all(lines):
        heights.note("legs shorter than a third of the longest are turns between lines")
    roles.name_unused(heights)
    named = [f"line {next(names)}" if line else "" for line in lines]
    return tuple(replace(point, line=name) for point, name in zip(points, [*named, ""], strict=True))


def flight_columns(table: NumberTable, heights: Heights) -> FlightColumns:
    """The columns of a flight. Roll, pitch and yaw are taken together or not at all.

    Raises InputError where the table has no names, or none of a place.
    """
    unread: dict[str, str] = {}
    for header in table.names() if table.headers else ():
        unread.clear()
        known = [named for place, cell in enumerate(header) if (named := _meaning(cell, place, unread))]
        columns = dict(sorted(known, reverse=True))  # the best of a key is the last
        if columns.keys() >= {"latitude", "longitude"} or columns.keys() >= {*"xyz"}:
            break
    else:
        raise heights.refuse(_no_places(table, unread))
    needed = [] if "time" in columns else ["time"]
    if not columns.keys() & _ABOVE.keys() and heights.height is None:
        needed += _ABOVE
    if reason := next((unread[key] for key in needed if key in unread), ""):
        raise heights.refuse(reason)
    up = [key for key in _ABOVE if key in columns][:1]
    attitude = _ATTITUDE if columns.keys() >= {*_ATTITUDE} else ()
    place = ["latitude", "longitude"] if "latitude" in columns else [*"xyz"]
    keys = [*(["time"] if "time" in columns else []), *place, *(up if "latitude" in columns else []), *attitude]
    taken = {"height" if key in up else key: columns[key] for key in keys}
    for key in place:  # minutes and seconds of an angle stand behind its degrees
        parts = [column for other, column in known if other == key and column.place > columns[key].place]
        for mark, part in zip(("'", "''"), sorted(parts, key=attrgetter("place")), strict=False):
            if part.size < columns[key].size / 50.0:
                taken[key + mark] = part
    reference = _ABOVE[up[0]] if up else "none"
    if up == ["height"] and taken["height"].header.lower().startswith("osd"):  # DJI's is above the place of take-off
        reference = "ground"
    return FlightColumns(
        taken, "ellipsoid" if "x" in taken else reference, header, columns.get("quality"), tuple(unread.values())
    )


def _no_places(table: NumberTable, unread: Mapping[str, str]) -> str:
    """Why the columns of a table are no flight, and what to do."""
    if reason := next((unread[key] for key in ("latitude", "longitude", *"xyz") if key in unread), ""):
        return reason
    if not table.headers:
        example = "week,time,latitude,longitude,height,-,-,-,roll,pitch,yaw"
        begins = f"its first row is {quoted(table.first_row)}"
        advice = f"Write them in a line above it, or give --columns, such as {example}."
        return f"has no names of its {table.width} columns; {begins}. {advice}"
    header = table.headers[0]
    missing = f"columns latitude and longitude are missing; found {listed(header)}"
    if any(map(_LOCAL.match, header)):
        return f"{missing}. Metres east and north need their origin. Write the places as latitude and longitude."
    return missing


def _meaning(cell: str, place: int, unread: dict[str, str]) -> tuple[str, FlightColumn] | None:
    """Quantity and column of a flight, where the name is known; why its unit cannot be read into `unread`."""
    for name, unit, sure in parted(cell.strip()):
        plain = re.sub(r"[\W\d_]", "", _PREFIX.sub("", name.lower()))
        key, rank = _KEYS.get(plain, ("", 0))
        if not key:
            continue
        if key == "quality":
            return key, FlightColumn(rank, False, place, 1.0, cell)
        dimension, usual = _USUAL.get(key, ("length", "m"))
        if key == "sea" and re.search("wgs|ellips", unit.lower()):
            key = "ellipsoid"
        unit = re.sub(r"(?i)\b(wgs-?\d*|ellips\w*|a?msl|agl|baro)\b", "", unit).strip() if sure else unit
        stated = unit.lower() not in _NO_UNIT and not (key == "time" and ":" in unit)  # hh:mm:ss
        size = size_of_unit(unit if stated else "ms" if plain == "itow" else usual, dimension)
        if size is None and sure:
            unread[key] = f"column {cell}: {unit!r} is not a unit of {dimension}. Write for example {usual}."
            return None
        if size is not None:
            return key, FlightColumn(rank, not stated and plain != "itow", place, size, cell)
    return None


def _unit_of_time(time: Array, latitude: Array, longitude: Array, heights: Heights) -> float:
    """Size of stamps without a unit: a second, unless a date shows finer ones, or nothing flies in between."""
    for unit, size in _FINER.items():
        if 1e8 < abs(time[0]) * size < 1e10:
            heights.note(f"time taken as {unit}")
            return size
    east = np.diff(longitude) * np.cos(np.radians(latitude[:1]))
    way = np.hypot(np.diff(latitude), east).sum() * math.radians(MEAN_RADIUS)
    step, speed = np.median(np.diff(time, append=time[-1:])), way / max(time[-1] - time[0], 1e-9)
    if step < _FAR_APART or speed > _SLOWEST[1]:
        return 1.0
    if speed > _SLOWEST[0]:
        in_seconds = f"which in seconds is {speed:.2g} m/s"
        raise heights.refuse(f"time goes up by {step:g} a row, {in_seconds}. Name it time_s or time_ms.")
    unit, size = next(((u, s) for u, s in _FINER.items() if _SLOWEST[1] < speed / s), ("s", 1.0))
    heights.note(f"time taken as {unit}")
    return size
