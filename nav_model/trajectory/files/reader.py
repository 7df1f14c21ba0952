"""Flights from files of any kind, told by what they hold: plans are flown, recordings are as they were flown."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from nav_model.base.errors import InputError
from nav_model.base.text.file_kind import kind_of
from nav_model.simulation.trajectory import FILE_BOUNDS
from nav_model.trajectory.files.ground_station import WAYPOINT_LIST, read_ground_station
from nav_model.trajectory.files.heights import Heights
from nav_model.trajectory.files.markup import read_markup, unpack
from nav_model.trajectory.files.messages import read_messages
from nav_model.trajectory.files.recorded import RecordedSegment, fly_recorded
from nav_model.trajectory.files.sbet import name_of, read_sbet
from nav_model.trajectory.files.table import read_columns, table_of
from nav_model.trajectory.plan import PlannedFlight, fly
from nav_model.trajectory.waypoints import Plan, Waypoint

KINDS = "KML, KMZ, GPX, .plan, .waypoints, CSV, SBET, NovAtel ASCII, NMEA or PX4 log"
_GIVE = f"Give a {KINDS} file."


@dataclass(frozen=True)
class FlightFile:
    """Content of a file: the waypoints of a plan, or a flight as it was flown; and what was read, in a sentence."""

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


def read_file(
    path: str | Path, height: float | None = None, ground: float | None = None, columns: Sequence[str] = ()
) -> FlightFile:
    """`parse_file` of a file; OSError where it cannot be read.

    Parameters
    ----------
    path : path
    height, ground, columns
        As `parse_file`.
    """
    with Path(path).open("rb") as file:
        return parse_file(file.read(FILE_BOUNDS.most_bytes + 1), Path(path).name, height, ground, columns)


def parse_file(
    content: bytes,
    name: str,
    height: float | None = None,
    ground: float | None = None,
    columns: Sequence[str] = (),
) -> FlightFile:
    """Read a flight or a plan from the bytes of a file.

    Parameters
    ----------
    content : bytes
        The file.
    name : str
        For messages alone.
    height : float, optional
        Of places that have none, m above the ellipsoid.
    ground : float, optional
        Of the ground, or of the take-off, of places whose heights are above it, m above the ellipsoid.

    columns : sequence of str, optional
        Names of a table's columns in place of those in the file; "-" for one that is not used.

    Raises
    ------
    InputError
        Under the file's name: what is wrong and where, or what the file is when it is no flight.
    """
    heights = Heights(name, height, ground)
    read = _read(content, heights, columns)
    if isinstance(read, list):
        read = fly_recorded(read, heights)
    note = "; ".join(heights.notes)
    return FlightFile(name, read, None, note) if isinstance(read, tuple) else FlightFile(name, (), read, note)


def _read(
    content: bytes, heights: Heights, columns: Sequence[str]
) -> tuple[Waypoint, ...] | list[RecordedSegment] | PlannedFlight:
    if len(content) > FILE_BOUNDS.most_bytes:
        raise heights.refuse(f"larger than {FILE_BOUNDS.most_bytes // 1_000_000} MB. Cut it.")
    if not content.strip():
        raise heights.refuse("the file is empty")
    if content.startswith(b"PK"):
        inside = unpack(content, heights)
        if inside is None:
            raise heights.refuse(f"is {kind_of(content)} without a flight in it. Unpack it. {_GIVE}")
        content = inside
    if (records := name_of(content)) == "smrmsg":
        raise heights.refuse("is smrmsg, the accuracies that belong to an SBET file. Give the SBET file itself.")
    if records:
        return read_sbet(content, heights)
    if epochs := read_messages(content, heights):
        return [epochs.in_order(heights).segment(heights)]
    kind = kind_of(content)
    if kind == "XML":
        return read_markup(content, heights)
    if kind == "JSON" or content.startswith(WAYPOINT_LIST):
        return read_ground_station(content, heights)
    if kind is not None:
        raise heights.refuse(f"is {'no text and no SBET' if kind == 'not text' else kind}. {_GIVE}")
    table = table_of(content, heights, _GIVE)
    return read_columns(table.named(columns) if columns else table, heights)
