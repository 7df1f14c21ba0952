"""A solution of a navigation system from a file of any kind, told by what it holds."""

import mmap
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from nav_model.base.errors import InputError
from nav_model.base.text.file_kind import kind_of
from nav_model.earth.wgs84 import metres_per_radian
from nav_model.flown.files.rtklib import is_pos, read_pos
from nav_model.flown.files.sbet import add_accuracies, read_sbet
from nav_model.flown.files.table import read_table
from nav_model.flown.solution import Claims, Solution, wrapped
from nav_model.simulation.trajectory import FILE_BOUNDS
from nav_model.trajectory.files.epochs import Epochs
from nav_model.trajectory.files.heights import Heights, counted
from nav_model.trajectory.files.markup import read_markup
from nav_model.trajectory.files.messages import read_messages
from nav_model.trajectory.files.sbet import ACCURACIES, Buffer, name_of
from nav_model.trajectory.files.table import table_of

_GIVE = "Give SBET, RTKLIB .pos, NovAtel ASCII, NMEA, a PX4 log, a GPX or KML track, or a table with named columns."
_START = 4096  # bytes
_AT_REST = 5.0  # m
_WHOLE = 0.95  # of the times
Source = str | Path | bytes


def read_solution(
    source: Source,
    companions: Sequence[Source] = (),
    columns: Sequence[str] = (),
    name: str = "",
    heights: tuple[float | None, float | None] = (None, None),
) -> Solution:
    r"""Read a solution from a file, or from its content.

    Parameters
    ----------
    source : path or bytes
        The file: a path, of which an SBET may have any size, or the bytes of it.
    companions : sequence of path or bytes, optional
        Files that belong to it: the smrmsg of an SBET, in any order with it.
    columns : sequence of str, optional
        Names of a table's columns in place of those in the file; "-" for one that is not used.
    name : str, optional
        Of bytes, for messages.
    heights : (float, float), optional
        Of places without a height, and of the ground where heights are above it [m above the ellipsoid].

    Returns
    -------
    Solution
        Times, places and what else the file has.

    Raises
    ------
    InputError
        Under the file's name: what is wrong and where, or what the file is when it is no solution.
    OSError
        Where it cannot be read.

    Examples
    --------
    >>> from nav_model import read_solution
    >>> table = b"time [s],latitude [deg],longitude [deg],height [m]\n0,46.0,7.0,900\n1,46.001,7.0,900\n"
    >>> solution = read_solution(table)
    >>> solution.format, solution.rate_hz
    ('table', 1.0)
    """
    files = [_File(source, name or "solution"), *(_File(c, f"companion {n}") for n, c in enumerate(companions, 1))]
    if len(files) > 1 and files[0].is_smrmsg:  # the two in the other order
        files.sort(key=lambda file: file.is_smrmsg)
    file, *beside = files
    notes = Heights(file.name, *heights)
    epochs = _epochs(file, notes, columns).in_order(notes)
    for other in beside:
        if not other.is_smrmsg or epochs.format != "sbet":
            reason = f"does not belong to {file.name}. Only an SBET has a second file, its smrmsg."
            raise InputError(other.name, reason)
        epochs = add_accuracies(epochs, other.content, notes, other.name)
    return _solution(epochs, notes)


class _File:
    """A file's name and content; of a path, content stays on the disk until it is read."""

    def __init__(self, source: Source, name: str) -> None:
        self.name = name
        self.content: Buffer = source if isinstance(source, bytes) else b""
        if not isinstance(source, bytes):
            path = Path(source)
            self.name = path.name
            if path.exists() and not path.is_file():
                raise InputError(self.name, f"is no file. {_GIVE}")
            with path.open("rb") as file:
                if path.stat().st_size:
                    self.content = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
        self.size = len(self.content)
        # A smrmsg that was cut off is one still.
        whole = self.size // (8 * ACCURACIES) * 8 * ACCURACIES
        self.is_smrmsg = name_of(memoryview(self.content)[:whole]) == "smrmsg"


def _epochs(file: _File, heights: Heights, columns: Sequence[str]) -> Epochs:
    if not file.size:
        raise heights.refuse("the file is empty")
    if file.is_smrmsg:
        raise heights.refuse("is smrmsg, the accuracies that belong to an SBET file. Give the SBET file with it.")
    for order in "<>":
        if name_of(file.content, order) == "SBET":
            return read_sbet(file.content, heights, order)
    if file.size > FILE_BOUNDS.most_bytes:
        raise heights.refuse(f"larger than {FILE_BOUNDS.most_bytes // 1_000_000} MB. Cut it.")
    content = bytes(file.content)
    if not content.strip():
        raise heights.refuse("the file is empty")
    if epochs := read_messages(content, heights):
        return epochs
    if (kind := kind_of(content)) == "XML":
        return _track(content, heights)
    if kind is not None:
        raise heights.refuse(f"is {'no text and no SBET' if kind == 'not text' else kind}. {_GIVE}")
    table = table_of(content, heights, _GIVE)
    if is_pos(content):
        return read_pos(table, heights)
    return read_table(table.named(columns) if columns else table, heights)


def _track(content: bytes, heights: Heights) -> Epochs:
    """The epochs of a recorded track of GPX or KML."""
    read = read_markup(content, heights)
    if isinstance(read, tuple):
        raise heights.refuse("holds places without times, which are a plan. Give what was recorded.")
    rows = np.vstack([segment.rows[:, :4] for segment in read])
    kind = "gpx" if b"<gpx" in content[:_START] else "kml"
    return Epochs(kind, "utc", rows[:, 0], np.column_stack([np.radians(rows[:, 1:3]), rows[:, 3]]))


def _solution(epochs: Epochs, notes: Heights) -> Solution:
    for member in ("velocity", "attitude"):
        values = getattr(epochs, member)
        if values is None:
            continue
        whole = np.isfinite(values).all(axis=1)
        if whole.mean() < _WHOLE:
            notes.note(f"{member} at {whole.mean():.0%} of the times, which is not used")
            unused: dict[str, Any] = {member: None}
            epochs = replace(epochs, **unused)
        elif not whole.all():
            notes.note(f"{counted(int(np.sum(~whole)), 'record')} without {member} left out")
            epochs = epochs.at(whole)
    longitude = np.unwrap(epochs.place[:, 1])
    longitude += wrapped(longitude[:1]) - longitude[:1]  # of files from 0° to 360°, too
    place = np.column_stack([epochs.place[:, 0], longitude, epochs.place[:, 2]])
    north, east = metres_per_radian(place[0, 0], place[0, 2])
    way = (np.ptp(place, axis=0) * (north, east, 1.0)).max()
    attitude = epochs.attitude
    if attitude is not None:
        attitude = np.column_stack([np.unwrap(attitude[:, 0]), attitude[:, 1], np.unwrap(attitude[:, 2])])
    still = [f"this is no flight: all places are within {way:.2g} m"] if way < _AT_REST else []
    return Solution(
        epochs.format, epochs.kind, epochs.time, epochs.clock, place, epochs.velocity, attitude,
        _claims(epochs, notes), epochs.fix, epochs.fix_names, epochs.smoothing, (*still, *notes.notes),
    )  # fmt: skip


def _claims(epochs: Epochs, notes: Heights) -> Claims | None:
    """The claims of epochs; rows of zeros are none, nor are sigmas below zero."""
    members = {}
    for name in ("position", "velocity", "attitude"):
        sigma = getattr(epochs, f"sigma_{name}")
        if sigma is None:
            continue
        with np.errstate(invalid="ignore"):
            empty = ~(sigma >= 0.0).all(axis=1) | (sigma == 0.0).all(axis=1)
        if empty.all():
            notes.note(f"the sigmas of the {name} are zero, which is no claim")
        else:
            members[name] = np.where(empty[:, None], np.nan, sigma)
    return Claims(epochs.accuracy, **members) if members else None
