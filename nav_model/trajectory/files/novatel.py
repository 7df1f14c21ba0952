"""ASCII messages of NovAtel receivers: INSPVAX, INSPVA, BESTPOS and BESTVEL, each line by its own checksum."""

import math
import re
import zlib
from array import array
from collections.abc import Collection
from dataclasses import replace
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from nav_model.base.arrays import Array
from nav_model.trajectory.files.epochs import Epochs, at_times, coded
from nav_model.trajectory.files.heights import Heights, counted

_LINE = re.compile(rb"[#%]((INSPVAX|INSPVA|BESTPOS|BESTVEL)S?A,[^#%*\r\n]*)(?:\*([0-9a-fA-F]{8}))?")
NAMES = re.compile(rb"[#%](INSPVAX|INSPVA|BESTPOS)S?A,")
_WEEK = 604_800.0
_DEGREE = math.pi / 180.0
_FIELDS: dict[str, tuple[tuple[int, ...], tuple[slice, ...]]] = {
    "INSPVAX": ((0, 1), (slice(2, 21),)),
    "INSPVA": ((11,), (slice(2, 11),)),
    "BESTPOS": ((0, 1), (slice(2, 6), slice(7, 10))),
    "BESTVEL": ((0, 1), (slice(2, 7),)),
}
"""Message -> fields of it that are words (the status first), and those that are numbers."""
_ALIGNED = frozenset(
    f"INS_{status}" for status in (
        "SOLUTION_GOOD", "SOLUTION_FREE", "SOLUTION_NOT_GOOD", "ALIGNMENT_COMPLETE", "HIGH_VARIANCE",
    )
)  # fmt: skip
_SOLVED = frozenset(("SOL_COMPUTED",))
_FIXES = (
    (r"RTKFIXED|(L1|WIDE|NARROW)_INT", "fixed"), (r".*FLOAT", "float"), (r"SINGLE|PSRSP", "single"),
    (r"PSRDIFF", "dgps"), (r"WAAS|SBAS", "sbas"), (r"PPP(_BASIC)?", "ppp"),
)  # fmt: skip


class _Message(NamedTuple):
    """Words of each line of a kind, and its numbers (n, k), the time first."""

    words: list[tuple[str, ...]]
    numbers: Array

    def with_status(self, known: Collection[str]) -> "_Message":
        """The lines whose status is known."""
        good = [word[0] in known for word in self.words]
        return _Message([word for word, fits in zip(self.words, good, strict=True) if fits], self.numbers[good])


def read_novatel(content: bytes, heights: Heights) -> Epochs:
    """The epochs of a receiver's log: of its inertial messages, else of its fixes.

    Raises InputError under the file's name where no line has a place and the right checksum.
    """
    messages, wrong = _messages(content)
    if wrong:
        heights.note(f"{counted(wrong, 'line')} with a wrong checksum, or cut off, left out")
    inertial = max(("INSPVAX", "INSPVA"), key=lambda kind: len(messages[kind].words))
    if messages[inertial].words:
        epochs = _inertial(messages[inertial], inertial, heights)
        if inertial == "INSPVA" and messages["INSPVAX"].words:
            slow = messages["INSPVAX"].with_status(_ALIGNED)
            sigmas = at_times(epochs.time, slow.numbers[:, 0], _sigmas(slow, heights), heights, "INSPVAX")
            epochs = epochs.claiming(sigmas)
    elif messages["BESTPOS"].words:
        epochs = _fixes(messages["BESTPOS"], messages["BESTVEL"], heights)
    else:
        raise heights.refuse("holds no INSPVAXA, INSPVAA or BESTPOSA message with the right checksum")
    return replace(epochs, format="novatel", clock="gps", kind="real-time")


def _messages(content: bytes) -> tuple[dict[str, _Message], int]:
    """The messages by kind, and the count of lines that are damaged."""
    words: dict[str, list[tuple[str, ...]]] = {kind: [] for kind in _FIELDS}
    numbers = {kind: array("d") for kind in _FIELDS}
    same: dict[tuple[str, ...], tuple[str, ...]] = {}  # thousands of lines have the same words
    wrong = 0
    for match in _LINE.finditer(content):
        if match[3] is None or int(match[3], 16) != zlib.crc32(match[1], 0xFFFFFFFF) ^ 0xFFFFFFFF:
            wrong += 1
            continue
        head, _, body = match[1].decode("latin-1").partition(";")
        kind, fields, header = match[2].decode(), body.split(","), head.split(",")
        stamp = header[5:7] if len(header) > 6 else header[1:3]  # of a short header, behind %
        texts, slices = _FIELDS[kind]
        try:
            time = _WEEK * int(stamp[0]) + float(stamp[1])
        except (ValueError, IndexError, OverflowError):  # a week of hundreds of digits
            time = math.nan
        if math.isnan(time) or len(fields) < max(slices[-1].stop, texts[-1] + 1):
            wrong += 1
            continue
        word = tuple(fields[at] for at in texts)
        words[kind].append(same.setdefault(word, word))
        values = [text for part in slices for text in fields[part]]
        numbers[kind].append(time)
        try:
            numbers[kind].extend([*map(float, values)])
        except ValueError:
            numbers[kind].extend([*map(_number, values)])
    return {kind: _Message(words[kind], _rows(numbers[kind], len(words[kind]))) for kind in _FIELDS}, wrong


def _rows(numbers: "array[float]", count: int) -> Array:
    return np.array(numbers, dtype=np.float64).reshape(count, -1) if count else np.empty((0, 20))


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return np.nan


def _inertial(message: _Message, kind: str, heights: Heights) -> Epochs:
    """Epochs of INSPVAX, whose heights are above the sea beside the undulation, or of INSPVA, above the ellipsoid."""
    aligned = message.with_status(_ALIGNED)
    noun = f"{kind} message"
    if not aligned.words:
        raise heights.refuse(f"holds {counted(len(message.words), noun)}, none of an INS that is aligned")
    if early := len(message.words) - len(aligned.words):
        heights.note(f"{counted(early, noun)} before the alignment left out")
    heights.note(f"{counted(len(aligned.words), noun)}")
    rows = aligned.numbers
    up, rest = rows[:, 3], rows[:, 4:]
    if kind == "INSPVAX":
        up, rest = up + rows[:, 4], rows[:, 5:]
        heights.note("heights above the sea with the undulation added")
    epochs = Epochs(
        "", "", rows[:, 0], np.column_stack([np.radians(rows[:, 1:3]), up]),
        rest[:, :3] * (1.0, 1.0, -1.0), np.radians(rest[:, 3:6]),
    )  # fmt: skip
    if kind == "INSPVA":
        return epochs
    fix, names = coded([_fix(words[1]) for words in aligned.words])
    return replace(epochs.claiming(_sigmas(aligned, heights)), fix=fix, fix_names=names)


def _sigmas(message: _Message, heights: Heights) -> Array:
    """Sigmas (n, 9) of INSPVAX; NaN before the solution is good for the first time."""
    sigmas = message.numbers[:, 11:20] * ([1.0] * 6 + [_DEGREE] * 3)
    good = [words[0] == "INS_SOLUTION_GOOD" for words in message.words]
    if early := good.index(True) if any(good) else len(good):
        heights.note(f"sigmas of {counted(early, 'message')} before INS_SOLUTION_GOOD are no claim")
        sigmas[:early] = np.nan
    return sigmas


def _fixes(message: _Message, velocity: _Message, heights: Heights) -> Epochs:
    """Epochs of BESTPOS, with velocities of BESTVEL at the times that they are valid for."""
    solved, noun = message.with_status(_SOLVED), "BESTPOS message"
    if not solved.words:
        raise heights.refuse(f"holds {counted(len(message.words), noun)}, none with a solution")
    if lost := len(message.words) - len(solved.words):
        heights.note(f"{counted(lost, noun)} without a solution left out")
    heights.note(f"{counted(len(solved.words), noun)}; heights above the sea with the undulation added")
    time, latitude, longitude, up, undulation = solved.numbers[:, :5].T
    fix, names = coded([_fix(words[1]) for words in solved.words])
    epochs = Epochs(
        "", "", time, np.column_stack([np.radians(latitude), np.radians(longitude), up + undulation]),
        sigma_position=solved.numbers[:, 5:8], fix=fix, fix_names=names,
    )  # fmt: skip
    stamps, latency, _, speed, course, up = velocity.with_status(_SOLVED).numbers[:, :6].T
    if not len(stamps):
        return epochs
    if latency.any():
        heights.note(f"velocities are {np.median(latency):g} s older than their stamps (latency)")
    course = np.radians(course)
    north_east_down = np.column_stack([speed * np.cos(course), speed * np.sin(course), -up])
    return replace(epochs, velocity=at_times(time, stamps - latency, north_east_down, heights, "BESTVEL"))


@lru_cache(maxsize=256)
def _fix(kind: str) -> str:
    """Name of a kind of position, in the words of other receivers where they have one."""
    bare = kind.removeprefix("INS_")
    return next((name for pattern, name in _FIXES if re.fullmatch(pattern, bare)), bare.lower().replace("_", " "))
