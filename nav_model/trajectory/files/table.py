"""Flights as columns of a text: the product's own trajectory file, and what other programs record and name."""

import math
import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.constants import MEAN_RADIUS
from nav_model.base.text.column_names import listed, parted, size_of_unit, vocabulary
from nav_model.base.text.number_table import NumberTable
from nav_model.earth.trajectory_file import has_trajectory, trajectory_of
from nav_model.simulation.trajectory import FILE_BOUNDS, flight_through
from nav_model.trajectory.files.heights import Heights, Reference, counted
from nav_model.trajectory.files.recorded import RecordedSegment, unrolled
from nav_model.trajectory.plan import PlannedFlight

_KEYS = vocabulary("flight")
_ATTITUDE = ("roll", "pitch", "yaw")
_USUAL = {"time": ("time", "s"), **dict.fromkeys(("latitude", "longitude", *_ATTITUDE), ("angle", "°"))}
_ABOVE: dict[str, Reference] = {"ellipsoid": "ellipsoid", "sea": "sea", "height": "ellipsoid", "ground": "ground"}
"""Columns of heights, the one that is taken first before the others -> the zero of their heights."""
_PREFIX = re.compile(r"(osd|gps|field|position|pos|nav|ins|custom)[._ ](?=.)")
_NO_UNIT = ("", "360", "180", "local", "utc", "gps", "wgs84", "msl", "agl", "true")
_FINER = {"ms": 1e-3, "µs": 1e-6, "ns": 1e-9}
_HIGHEST = 20_000.0  # m
_PAIR = re.compile(rb'"\s*([+-]?\d+\.\d+)\s*,\s*([+-]?\d+\.\d+)\s*"')
_FAR_APART = 5.0  # s
_SLOWEST = 0.02, 1.0  # m/s; slower than the first nothing flies, the second is seldom


class _Column(NamedTuple):
    """Where a column of a flight is, how well its name fits (0: best), the size of its unit in SI, whether its name
    says the unit, and its name in the file."""

    rank: int
    by_convention: bool
    place: int
    size: float
    header: str


def read_columns(table: NumberTable, heights: Heights) -> list[RecordedSegment] | PlannedFlight:
    """The flight of a table: with the names of `COLUMNS` as it is, else places that were recorded.

    Raises InputError under the file's name: a column that is missing, a unit that is not known, what is no number.
    """
    if not any(map(has_trajectory, table.headers)):
        return [_recorded(table, heights)]
    samples, lines = trajectory_of(table, FILE_BOUNDS)
    heights.note(f"trajectory file, {counted(len(samples), 'row')}")
    return PlannedFlight(flight_through(samples, lines, heights.file_name), float(samples[-1, 0]), ())


def in_two_columns(content: bytes, heights: Heights) -> bytes:
    """A table whose places stand in one field, as Flightradar24 writes them, with latitude and longitude apart."""
    end = content.find(b"\n")
    head = content[: max(end, 0)]
    named = re.sub(rb"(?i)\bposition\b", b"latitude,longitude", head)
    if named == head or not _PAIR.search(content, end):
        return content
    heights.note("position taken as latitude, longitude")
    if b"callsign" in head.lower():
        named = re.sub(rb"(?i)\baltitude\b", b"altitude_ft", named)
        heights.note("altitude taken as feet, as Flightradar24 writes it")
    return named + _PAIR.sub(rb"\1,\2", content[end:])


def _recorded(table: NumberTable, heights: Heights) -> RecordedSegment:
    columns, reference, others = _columns(table, heights)
    places, times = [column.place for column in columns.values()], [columns["time"].place]
    read = table.columns(places, FILE_BOUNDS.most_rows, FILE_BOUNDS.most_bytes, times)
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
    latitude, longitude = (np.degrees(values[key]) for key in ("latitude", "longitude"))
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
    if others:
        heights.note(f"not used: {listed(others)}")
    return RecordedSegment("", np.column_stack([unrolled(time, heights), latitude, longitude, up, *attitude]))


def _columns(table: NumberTable, heights: Heights) -> tuple[dict[str, _Column], Reference, Sequence[str]]:
    """The columns of a recorded flight, what its heights are above, and the names of the other columns.

    Roll, pitch and yaw are taken together or not at all."""
    for header in [*table.names()] or [("no names",)]:
        known = [named for place, cell in enumerate(header) if (named := _meaning(cell, place, heights))]
        columns = dict(sorted(known, reverse=True))  # the best of a key is the last
        if {"latitude", "longitude"} <= columns.keys():
            break
    else:
        raise heights.refuse(f"columns latitude and longitude are missing; found {listed(header)}")
    if "time" not in columns:
        raise heights.refuse("has no column with the time, such as time_s. Give a path as KML or GPX.")
    up = [key for key in _ABOVE if key in columns][:1]
    attitude = _ATTITUDE if columns.keys() >= {*_ATTITUDE} else ()
    keys = ("time", "latitude", "longitude", *up, *attitude)
    taken = {"height" if key in up else key: columns[key] for key in keys}
    reference = _ABOVE[up[0]] if up else "none"
    if up == ["height"] and taken["height"].header.lower().startswith("osd"):  # DJI's is above the place of take-off
        reference = "ground"
    places = {column.place for column in taken.values()}
    return taken, reference, [cell for place, cell in enumerate(header) if place not in places and cell]


def _meaning(cell: str, place: int, heights: Heights) -> tuple[str, _Column] | None:
    """Quantity and column of a flight, where the name is known."""
    for name, unit, sure in parted(cell.strip()):
        plain = re.sub(r"[\W\d_]", "", _PREFIX.sub("", name.lower()))
        key, rank = _KEYS.get(plain, ("", 0))
        if not key:
            continue
        dimension, usual = _USUAL.get(key, ("length", "m"))
        stated = unit.lower() not in _NO_UNIT
        size = size_of_unit(unit if stated else "ms" if plain == "itow" else usual, dimension)
        if size is None and sure:
            raise heights.refuse(f"column {cell}: {unit!r} is not a unit of {dimension}. Write for example {usual}.")
        if size is not None:
            return key, _Column(rank, not stated and plain != "itow", place, size, cell)
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
