"""ASCII messages of NovAtel receivers: INSPVAX, INSPVA, BESTPOS and BESTVEL, each line by its own checksum."""

import math
import re
import zlib
from collections import defaultdict
from dataclasses import replace

import numpy as np

from nav_model.base.arrays import Array
from nav_model.trajectory.files.epochs import Epochs, at_times, coded
from nav_model.trajectory.files.heights import Heights, counted

_LINE = re.compile(rb"[#%]((INSPVAX|INSPVA|BESTPOS|BESTVEL)S?A,[^#%*\r\n]*)(?:\*([0-9a-fA-F]{8}))?")
NAMES = re.compile(rb"[#%](INSPVAX|INSPVA|BESTPOS)S?A,")
_WEEK = 604_800.0
_DEGREE = math.pi / 180.0
_FIELDS = {"INSPVAX": 21, "INSPVA": 12, "BESTPOS": 10, "BESTVEL": 7}
_ALIGNED = frozenset(
    f"INS_{status}" for status in (
        "SOLUTION_GOOD", "SOLUTION_FREE", "SOLUTION_NOT_GOOD", "ALIGNMENT_COMPLETE", "HIGH_VARIANCE",
    )
)  # fmt: skip
_FIXES = (
    (r"RTKFIXED|(L1|WIDE|NARROW)_INT", "fixed"), (r".*FLOAT", "float"), (r"SINGLE|PSRSP", "single"),
    (r"PSRDIFF", "dgps"), (r"WAAS|SBAS", "sbas"), (r"PPP(_BASIC)?", "ppp"),
)  # fmt: skip


def read_novatel(content: bytes, heights: Heights) -> Epochs:
    """The epochs of a receiver's log: of its inertial messages, else of its fixes.

    Raises InputError under the file's name where no line has a place and the right checksum.
    """
    lines, wrong = _lines(content)
    if wrong:
        heights.note(f"{counted(wrong, 'line')} with a wrong checksum, or cut off, left out")
    inertial = max(("INSPVAX", "INSPVA"), key=lambda kind: len(lines[kind]))
    if lines[inertial]:
        epochs = _inertial(lines[inertial], inertial, heights)
        if inertial == "INSPVA" and lines["INSPVAX"]:
            stamps, sigmas = _sigmas(lines["INSPVAX"], heights)
            epochs = epochs.claiming(at_times(epochs.time, stamps, sigmas, heights, "INSPVAX"))
    elif lines["BESTPOS"]:
        epochs = _fixes(lines["BESTPOS"], lines["BESTVEL"], heights)
    else:
        raise heights.refuse("holds no INSPVAXA, INSPVAA or BESTPOSA message with the right checksum")
    return replace(epochs, format="novatel", clock="gps", kind="real-time")


def _lines(content: bytes) -> tuple[dict[str, list[list[str]]], int]:
    """Fields of the messages by kind, the time first, and the count of lines that are damaged."""
    lines = defaultdict[str, list[list[str]]](list)
    wrong = 0
    for match in _LINE.finditer(content):
        head, _, body = match[1].partition(b";")
        kind, fields = match[2].decode(), body.decode("latin-1").split(",")
        header = head.decode("latin-1").split(",")
        stamp = header[5:7] if len(header) > 6 else header[1:3]  # of a short header, behind %
        whole = match[3] is not None and int(match[3], 16) == zlib.crc32(match[1], 0xFFFFFFFF) ^ 0xFFFFFFFF
        try:
            time = _WEEK * int(stamp[0]) + float(stamp[1])
        except (ValueError, IndexError):
            whole = False
        if whole and len(fields) >= _FIELDS[kind]:
            lines[kind].append([repr(time), *fields])
        else:
            wrong += 1
    return lines, wrong


def _numbers(lines: list[list[str]], first: int, stop: int) -> Array:
    """Fields of lines as numbers; NaN for what is none."""
    fields = [line[first:stop] for line in lines]
    try:
        return np.array(fields, dtype=np.float64)
    except ValueError:
        return np.array([[_number(text) for text in line] for line in fields])


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return np.nan


def _inertial(lines: list[list[str]], kind: str, heights: Heights) -> Epochs:
    """Epochs of INSPVAX, whose heights are above the sea beside the undulation, or of INSPVA, above the ellipsoid."""
    status = 1 if kind == "INSPVAX" else 12
    aligned = [line for line in lines if line[status] in _ALIGNED]
    if len(lines) > len(aligned):
        heights.note(f"{counted(len(lines) - len(aligned), kind + ' message')} before the alignment left out")
    if not aligned:
        raise heights.refuse(f"holds {counted(len(lines), kind + ' message')}, none of an INS that is aligned")
    heights.note(f"{counted(len(aligned), kind + ' message')}")
    rows = _numbers(aligned, 3, 13 if kind == "INSPVAX" else 12)
    if kind == "INSPVAX":
        rows[:, 2] += rows[:, 3]
        rows = np.delete(rows, 3, axis=1)
        heights.note("heights above the sea with the undulation added")
    epochs = Epochs(
        kind, "gps", _numbers(aligned, 0, 1)[:, 0], rows[:, :3] * (_DEGREE, _DEGREE, 1.0),
        rows[:, 3:6] * (1.0, 1.0, -1.0), np.radians(rows[:, 6:9]),
    )  # fmt: skip
    if kind == "INSPVA":
        return epochs
    fix, names = coded([_fix(line[2]) for line in aligned])
    return replace(epochs.claiming(_sigmas(aligned, heights)[1]), fix=fix, fix_names=names)


def _sigmas(lines: list[list[str]], heights: Heights) -> tuple[Array, Array]:
    """Times and sigmas (n, 9) of INSPVAX; NaN before the solution is good for the first time."""
    sigmas = _numbers(lines, 13, 22) * ([1.0] * 6 + [_DEGREE] * 3)
    good = [line[1] == "INS_SOLUTION_GOOD" for line in lines]
    if early := good.index(True) if any(good) else len(good):
        heights.note(f"sigmas of {counted(early, 'message')} before INS_SOLUTION_GOOD are no claim")
        sigmas[:early] = np.nan
    return _numbers(lines, 0, 1)[:, 0], sigmas


def _fixes(lines: list[list[str]], velocities: list[list[str]], heights: Heights) -> Epochs:
    """Epochs of BESTPOS, with velocities of BESTVEL at the times that they are valid for."""
    solved = [line for line in lines if line[1] == "SOL_COMPUTED"]
    if len(lines) > len(solved):
        heights.note(f"{counted(len(lines) - len(solved), 'BESTPOS message')} without a solution left out")
    if not solved:
        raise heights.refuse(f"holds {counted(len(lines), 'BESTPOS message')}, none with a solution")
    heights.note(f"{counted(len(solved), 'BESTPOS message')}; heights above the sea with the undulation added")
    time, rows, sigmas = _numbers(solved, 0, 1)[:, 0], _numbers(solved, 3, 7), _numbers(solved, 8, 11)
    place = np.column_stack([np.radians(rows[:, :2]), rows[:, 2] + rows[:, 3]])
    fix, names = coded([_fix(line[2]) for line in solved])
    epochs = Epochs("", "gps", time, place, sigma_position=sigmas, fix=fix, fix_names=names)
    velocities = [line for line in velocities if line[1] == "SOL_COMPUTED"]
    if not velocities:
        return epochs
    latency, _, speed, course, up = _numbers(velocities, 3, 8).T
    stamps = _numbers(velocities, 0, 1)[:, 0] - latency
    if latency.any():
        heights.note(f"velocities are {np.median(latency):g} s older than their stamps (latency)")
    course = np.radians(course)
    north_east_down = np.column_stack([speed * np.cos(course), speed * np.sin(course), -up])
    return replace(epochs, velocity=at_times(time, stamps, north_east_down, heights, "BESTVEL"))


def _fix(kind: str) -> str:
    """Name of a kind of position, in the words of other receivers where they have one."""
    bare = kind.removeprefix("INS_")
    return next((name for pattern, name in _FIXES if re.fullmatch(pattern, bare)), bare.lower().replace("_", " "))
