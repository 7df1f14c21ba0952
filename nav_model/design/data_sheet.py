"""Rows of an IMU's data sheet, as they are copied from it, as inputs of a design."""

import re
from collections.abc import Iterator
from typing import NamedTuple

from nav_model.base.errors import InputError
from nav_model.base.units import Parsed
from nav_model.design.parts import declaration_of, quantity

_LONGEST = 5000  # characters; a whole table has one or two thousand
_WALKS = ("imu.angle_random_walk", "imu.velocity_random_walk")


def _of_sensors(error: str) -> tuple[str, str]:
    return f"gyro.{error}", f"accelerometer.{error}"


# Words of a row's name -> the inputs that it may be, of which the value's unit decides.
_NAMES = (
    (re.compile(r"temperature", re.I), ()),
    (re.compile(r"(?:rate|acceleration) random", re.I), _of_sensors("rate_random_walk")),
    (re.compile(r"random walk|\b[AV]RW\b|noise", re.I), _WALKS),
    (re.compile(r"bias.*(?:repeatab|turn.?on)|turn.?on.*bias", re.I), _of_sensors("turn_on_bias")),
    (re.compile(r"bias.*(?:instab|stab)|in.?run", re.I), _of_sensors("bias_instability")),
    (re.compile(r"\bg.?sensitiv|linear acceleration", re.I), ("gyro.g_sensitivity",)),
    (re.compile(r"(?:output|sampl|update|data)\w*\s+(?:data\s+)?(?:rate|frequency)|\bODR\b", re.I), ("imu.rate",)),
    (re.compile(r"bandwidth|\bcut.?off\b", re.I), ("imu.bandwidth",)),
)
_OTHER_BIAS = re.compile(r"over\b.*\btemp", re.I)
_TURN_ON = re.compile(r"turn.?on to turn.?on", re.I)  # behind the value of what is called a stability
_START = r"(?:gyro\w*\s+|accel\w*\s+)?(?:ARW|VRW|angle|angular|velocity|bias|in.run|noise|output)\b"
_BETWEEN = re.compile(rf"[;\n]|[,.]\s*(?=(?!typ|max|rms|one|per|each)[A-Za-z]{{2}})|\s+(?={_START})", re.I)
_REMARK = re.compile(r"\s*(?:\([^()]*\)|\b(?:at|over|from|turn.?on)\s.*)$")
_BARE_NUMBER = re.compile(r"(?<![\w(.,-])\d+(?:[.,]\d+)?(?![\w.,%σ-]|\s*(?:σ|sigma|%|°C))(?![^()]*\))")
_ACCURACY = re.compile(r"\d[\d.]*\s*-?\s*(?:σ|sigma|%)|\b(?:peak|p-p|pk)", re.I)


class SheetValues(NamedTuple):
    """Content of the rows: inputs in SI, the units they are written in, the text each came from, and what was not
    understood, with the reason."""

    changes: dict[str, float]
    written: dict[str, str]
    origins: dict[str, str]
    rest: tuple[str, ...]


def read_data_sheet(text: str) -> SheetValues:
    """Values of an IMU from the rows of its data sheet, each a name and a number with its unit.

    "Angle random walk 0.15 °/√h, bias instability 0.5 °/h": rows stand on lines of their own or behind commas.
    Nothing is guessed: a second value of an input, a name that is not known and a value that cannot be read are in
    `rest`.

    Raises InputError for a text longer than a data sheet's table.
    """
    if len(text) > _LONGEST:
        raise InputError("data sheet", f"The text is longer than {_LONGEST} characters. Paste the table alone.")
    values = SheetValues({}, {}, {}, ())
    rest = []
    for row in _rows(text):
        key, parsed, reason = _value_of(row)
        if key in values.changes:
            reason = f"a second value of {declaration_of(key).label}"
        if parsed is None or reason:
            rest.append(f"{row}: {reason}")
        else:
            values.changes[key], values.written[key] = parsed
            values.origins[key] = f"data sheet: {row}"
    return values._replace(rest=tuple(rest))


def _rows(text: str) -> Iterator[str]:
    """The parts of a text that have a number, each with what stands before it since the last one."""
    row = ""
    lines = (" ".join(line.split()) for line in text.replace("|", " ").splitlines())  # a run of blanks is one
    for part in _BETWEEN.split("\n".join(lines)):
        row = " ".join(f"{row} {part}".split())
        if re.search(r"\d", part):
            yield row[:200]
            row = ""
    if row:
        yield row[:200]


def _value_of(row: str) -> tuple[str, Parsed | None, str]:
    """The input that a row has a value of, and the value; or why there is none."""
    reason = ""
    for number in re.finditer(r"[-+±<≤~]?\s*\d[\d.,]*(?:e[-+]?\d+)?", row):
        name, text = row[: number.start()], row[number.start() :]
        named = f"{name} turn-on" if _TURN_ON.search(row) else name
        keys = next((inputs for words, inputs in _NAMES if words.search(named) and not _OTHER_BIAS.search(row)), ())
        if keys and _BARE_NUMBER.search(name):  # the columns of least, typical and largest
            return "", None, "several numbers. Keep the one that holds"
        remark = _REMARK.search(text)
        bare = text[: remark.start()] if remark and not _ACCURACY.search(remark[0]) else text
        column = f"{bare} {name.split()[-1].strip('[]():,')}" if name.split() else bare  # "bias [°/h] 0.5"
        before = _ACCURACY.search(name)  # "bias instability (3σ): 0.3 °/h"
        for key in keys:
            for value in (text, bare, column):
                try:
                    return key, quantity(key).read(f"{value} {before[0]}" if before else value), ""
                except InputError as error:
                    reason = reason or error.reason
    return "", None, reason or "not known"
