"""Flights from files of any kind, told by what they hold: plans are flown, recordings are as they were flown."""

from dataclasses import dataclass, replace
from pathlib import Path

from nav_model.base.errors import InputError
from nav_model.base.file_kind import kind_of
from nav_model.base.number_table import open_table
from nav_model.simulation.trajectory import FILE_BOUNDS, file_duration
from nav_model.trajectory.files.gpx import read_gpx
from nav_model.trajectory.files.ground_station import MOST_TEXT, WAYPOINT_LIST, read_plan, read_waypoint_list
from nav_model.trajectory.files.heights import Heights
from nav_model.trajectory.files.kml import read_kml
from nav_model.trajectory.files.markup import local_name, read_xml, unpack
from nav_model.trajectory.files.recorded import Content, fly_recorded
from nav_model.trajectory.files.sbet import is_accuracies, is_sbet, parse_sbet
from nav_model.trajectory.files.table import read_columns
from nav_model.trajectory.plan import Plan, PlannedFlight, Waypoint, fly

KINDS = "KML, KMZ, GPX, .plan, .waypoints, CSV or SBET"


@dataclass(frozen=True)
class FlightFile:
    """What a file holds: the waypoints of a plan, or a flight as it was flown; and what was read, in a sentence."""

    name: str
    waypoints: tuple[Waypoint, ...]
    flight: PlannedFlight | None
    note: str

    def flown(self, like: Plan) -> PlannedFlight:
        """The flight; waypoints at speed, bank, climb, ground of `like`. Raises InputError under the file's name."""
        try:
            return replace(self.flight or fly(replace(like, waypoints=self.waypoints)), note=self.note)
        except InputError as error:
            raise InputError(self.name, str(error)) from error


def read_file(path: str | Path, height: float | None = None, ground: float | None = None) -> FlightFile:
    """`parse_file` of a file; OSError where it cannot be read."""
    with Path(path).open("rb") as file:
        return parse_file(file.read(FILE_BOUNDS.most_bytes + 1), Path(path).name, height, ground)


def parse_file(content: bytes, name: str, height: float | None = None, ground: float | None = None) -> FlightFile:
    """What a file holds.

    Parameters
    ----------
    content, name : bytes, str
        Of the file; the name only for messages.
    height : float, optional
        Of places that have none [m above the ellipsoid].
    ground : float, optional
        Height of the ground, or of the take-off, of places whose heights are above it [m above the ellipsoid].

    Raises
    ------
    InputError
        Under the file's name: what is wrong and where, or what the file is when it is no flight.
    """
    heights = Heights(name, height, ground)
    read = _read(content, name, heights)
    flight = fly_recorded(read, heights) if isinstance(read, list) else None if isinstance(read, tuple) else read
    return FlightFile(name, read if isinstance(read, tuple) else (), flight, "; ".join(heights.notes))


def _read(content: bytes, name: str, heights: Heights) -> Content:
    if len(content) > FILE_BOUNDS.most_bytes:
        raise heights.refuse(f"larger than {FILE_BOUNDS.most_bytes // 1_000_000} MB. Cut it.")
    if not content.strip():
        raise heights.refuse("the file is empty")
    if content.startswith(b"PK"):
        entry = unpack(content, name)
        if entry is None:
            raise heights.refuse(f"is {kind_of(content)} without a flight in it. Unpack it and give a {KINDS} file.")
        heights.note(f"{entry[0]} in the archive")
        content = entry[1]
    if is_accuracies(content):
        raise heights.refuse("is smrmsg, the accuracies that belong to an SBET file. Give the SBET file itself.")
    if is_sbet(content):
        spec, notes = parse_sbet(content, name)
        heights.notes += notes
        return PlannedFlight(spec, file_duration(spec), ())
    kind = kind_of(content)
    if kind == "XML":
        root = read_xml(content, name)
        read = {"gpx": read_gpx, "kml": read_kml}.get(local_name(root))
        if read is None:
            raise heights.refuse(f"is XML of the kind {local_name(root)!r}. Give a {KINDS} file.")
        return read(root, heights)
    if kind == "JSON" or content.startswith(WAYPOINT_LIST):
        if len(content) > MOST_TEXT:
            raise heights.refuse(f"has more than {MOST_TEXT // 1_000_000} MB, which is too much for a plan")
        return (read_plan if kind == "JSON" else read_waypoint_list)(content, heights)
    if kind is None:
        try:
            table = open_table(content, name)
        except InputError as error:
            raise heights.refuse(f"{error.reason} Give a {KINDS} file.") from error
        return read_columns(table, heights)
    reason = "is no text and no SBET" if kind == "not text" else f"is {kind}"
    raise heights.refuse(f"{reason}. Give a {KINDS} file.")
