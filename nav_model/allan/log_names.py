"""Names and units of the columns or arrays of an inertial log, in the layouts that are in use.

Understood: `gyro_x [deg/s]`, `gx_dps`, `wx(rad/s)`, `acc_x_g`, `az`, EuRoC's `w_RS_S_x [rad s^-1]`, ROS's
`/imu/data/angular_velocity.x`, PX4's `gyro_rad[0]`, increments `dtheta_x`, `dvel_z`, counts with
`gyro_dps_per_count`. The units are those of `nav_model.base.units`.
"""

import math
import re
from collections.abc import Sequence
from itertools import product
from typing import Final, NamedTuple

from nav_model.base.errors import InputError
from nav_model.base.text.column_names import TABLES, parted, size_of_unit, vocabulary

SENSORS: Final = ("gyro", "accelerometer")
COUNTS: Final = ("counts", "raw", "lsb")


class ColumnScale(NamedTuple):
    """`factor` to SI; `per_sample` when the values are increments over one sample."""

    factor: float
    per_sample: bool


class Meaning(NamedTuple):
    """Role ("time", "gyro", "accelerometer", "temperature"), axis 0..2 or None, unit text or None.

    `convention`: whose convention the unit is, where the name does not say it.
    """

    role: str
    axis: int | None
    unit: str | None
    convention: str = ""


# Dimension of the values of a role, and whether they are increments over one sample.
_DIMENSIONS: Final = {
    "gyro": (("angular rate", False), ("angle", True)),
    "accelerometer": (("acceleration", False), ("speed", True)),
    "time": (("time", False),),
}
_OFFERED: Final = {
    "gyro": ("rad/s", "mrad/s", "deg/s", "mdeg/s", "deg/h", "rad", "mrad", "urad", "deg", "arcsec"),
    "accelerometer": ("m/s2", "g", "mg", "ug", "m/s", "mm/s", "g s", "ug s"),
}
_ROLES: Final = vocabulary("log")
_ONE_OF_SEVERAL: Final = {key: frozenset(words.split()) for key, words in TABLES["one_of_several"].items()}
_NEUTRAL: Final = TABLES["passed_over"]["log"].split()
_MOST_PARTS: Final = 5  # of a name, from the last: "gyro.x" behind topic and message has two
_OF_SOMETHING_ELSE: Final = re.compile(r"bias|cov|std|sigma|err|offset|var")
_AXIS: Final = re.compile("([xyzpqr])(?:[ _]?(?:rot|rate))?")


def units_of(role: str) -> dict[str, bool]:
    """Units that are offered for the values of a role -> whether they are increments over one sample."""
    return {unit: scale_of(role, unit).per_sample for unit in _OFFERED[role]}


def scale_of(role: str, unit: str) -> ColumnScale:
    """Scale of a unit text such as "deg/s", "°/s", "0.05 deg/s" (counts of 0.05 deg/s) or "0.1 arcsec"
    (increments). That a number is of a count may be said: "0.05 deg/s a count", "0.05 deg/s per count".

    Raises InputError under ``gyro_unit``, ``accelerometer_unit`` or ``time_unit``, with units that are allowed.
    """
    of_count = re.sub(r"(\s+a|\s+per|\s*/)\s*count\s*$", "", unit)
    for dimension, per_sample in _DIMENSIONS[role]:
        factor = size_of_unit(of_count, dimension)
        if factor is not None and 0.0 < factor < math.inf:
            return ColumnScale(factor, per_sample)
    allowed = ", ".join(_OFFERED.get(role, ("s", "ms", "us", "ns")))
    reason = f"{unit!r} is not understood; allowed: {allowed}, or a number and one of these per count"
    raise InputError(f"{role}_unit", reason, unit)


def names_sensors(name: str) -> bool:
    """True for the name of a column that numbers or names the sensor that a row is of, such as "imu_id" or "I"."""
    words = {*_words(name)}
    allowed = _ONE_OF_SEVERAL["words"]
    return bool(words & allowed) and words <= allowed | _ONE_OF_SEVERAL["beside"]


def meanings_of(names: Sequence[str]) -> list[Meaning | None]:
    """Meaning of each of the columns of a file, which may show together what unit they are in by convention."""
    meanings = [meaning_of(name) for name in _counted_from_zero(names)]
    plain = ["".join(_words(name)) for name in names]
    for program in TABLES["program"]:
        if not re.search(program["mark"], " ".join(plain)):
            continue
        for (at, name), (pattern, role, unit) in product(enumerate(plain), program["columns"]):
            if match := re.fullmatch(pattern, name):
                axis = "xyz012".index(match[1]) % 3 if match.lastindex else None
                meanings[at] = Meaning(role, axis, unit, program["name"])
    return meanings


def _counted_from_zero(names: Sequence[str]) -> list[str]:
    """The names, where three with one stem count the axes from 0 or 1 with their numbers from 0 in brackets: "gyro_1"
    is gyro[0]."""
    matches = [re.fullmatch(r"(.*?[^\W\d])[\s_.]*[\[(]?([0-3])[\])]?", name.strip(' "')) for name in names]
    digits = {match[1]: [m[2] for m in matches if m and m[1] == match[1]] for match in matches if match}
    first = {stem: int(three[0]) for stem, three in digits.items() if three in (["0", "1", "2"], ["1", "2", "3"])}
    return [
        f"{match[1]}[{int(match[2]) - first[match[1]]}]" if match and match[1] in first else name
        for match, name in zip(matches, names, strict=True)
    ]


def meaning_of(name: str) -> Meaning | None:
    """Meaning of a column or array name, None when it is not one of an inertial log's quantities."""
    text = name.strip().strip('"').lstrip("#%").strip()
    index = re.fullmatch(r"(.*)[\[(.]([0-2])[\])]?(\s*[\[({].*)?", text)  # "gyro[0] (deg/s)"
    text = index[1] + (index[3] or "") if index else text
    # Alone, or behind the names of a topic and its messages: "/imu/data/angular_velocity/x".
    parts = re.split(r"[./]+", text)
    first = max(1, len(parts) - _MOST_PARTS)
    behind = [k for k in range(first, len(parts)) if not _OF_SOMETHING_ELSE.search("".join(parts[:k]).lower())]
    names = (text, *(".".join(parts[start:]) for start in behind))
    meaning = next(filter(None, map(_meaning, names)), None)
    if meaning is None or index is None:
        return meaning
    return meaning._replace(axis=int(index[2])) if meaning.axis is None and meaning.role in SENSORS else None


def _meaning(text: str) -> Meaning | None:
    for name, unit, sure in parted(text):
        meaning = _from_words(_words(name))
        if sure and (axis := _AXIS.fullmatch(name.lower())):  # "x [rad/s]": what it is of, the unit says
            rates = [role for role in SENSORS if size_of_unit(unit, _DIMENSIONS[role][0][0])]
            return Meaning(rates[0], "xyzpqr".index(axis[1]) % 3, unit) if rates else None
        if meaning is None:
            continue
        if (sure and meaning.role in SENSORS) or (unit and _is_unit(meaning.role, unit)):
            return meaning._replace(unit=unit, convention="")
        if not unit or (sure and meaning.role == "time" and len(name) > 1):  # "Time (UTC)", but not "T (°)"
            return meaning
    return None


def _is_unit(role: str, unit: str) -> bool:
    if role == "temperature":
        return unit.lower().strip(" °") in ("c", "degc", "deg c", "celsius")
    return unit.lower() in COUNTS or any(size_of_unit(unit, dimension) for dimension, _ in _DIMENSIONS[role])


def _words(text: str) -> list[str]:
    """Words of a name in small letters: at signs, digits and capitals."""
    return [word.lower() for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+|[^\W\d_A-Za-z]+", text)]


def _from_words(words: list[str]) -> Meaning | None:
    words = words[2:] if words[:1] == ["imu"] and len(words) > 1 and words[1].isdigit() else words
    joined = "".join(word for word in words if word not in _NEUTRAL)
    joined = joined or ("time" if {"epoch", "elapsed"} & {*words} else "")
    stems: list[tuple[str, int | None]] = [(joined, None)]
    if len(joined) > 1 and joined[-1] in "xyz":
        stems.append((joined[:-1], "xyz".index(joined[-1])))
    elif len(joined) > 2 and joined[0] in "xyz":
        stems.append((joined[1:], "xyz".index(joined[0])))
    for stem, axis in stems:
        role, _ = _ROLES.get(stem, ("", 0))
        if role and not (len(stem) == 1 and role in SENSORS and axis is None):
            return Meaning(role, axis, *TABLES["conventions"].get(stem, (None, "")))
    return None
