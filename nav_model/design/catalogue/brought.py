"""Catalogue entries from what people keep of IMUs: a table with a row for each, and kalibr's imu.yaml."""

import csv
import re
from collections.abc import Mapping
from typing import Any

from nav_model.base.errors import InputError, quoted

_MOST_CHARACTERS, _MOST_ROWS, _MOST_COLUMNS = 1_000_000, 2000, 100
_LONGEST_HEAD, _LONGEST_NAME = 4000, 100
_WALK = r"noise|random walk|\bdensity"
_BIAS = r"bias|in.?run|instab|stabil"
# A column's name -> the key of an entry, and the kind of a bias; the first that fits.
_MEANINGS = tuple(
    (re.compile(pattern, re.IGNORECASE), key, kind)
    for pattern, key, kind in (
        (r"temperature|scale|range|bandwidth", "", ""),
        (rf"\barw\b|ang(le|ular) random walk|(gyr|rate).*({_WALK})", "angle_random_walk", ""),
        (rf"\bvrw\b|velocity random walk|acc.*({_WALK})", "velocity_random_walk", ""),
        (r"gyr.*(repeatab|turn.?on)", "gyro_bias", "repeatability"),
        (r"acc.*(repeatab|turn.?on)", "accelerometer_bias", "repeatability"),
        (rf"gyr.*({_BIAS})", "gyro_bias", "in-run"),
        (rf"acc.*({_BIAS})", "accelerometer_bias", "in-run"),
        (r"\bprice|\bcost", "price", ""),
        (r"\bmass|\bweight", "mass", ""),
        (r"\bpower", "power", ""),
        (r"^\W*(type|grade|class|technology)\b", "grade", ""),
    )
)
_NAME = re.compile(r"^\W*(model|name|imu|unit|sensor|product|device|part)\b", re.IGNORECASE)
_IN_BRACKETS = re.compile(r"(.*?)\s*[\[(](.*)[\])]\s*")
_EMPTY = {"", "-", "--", "–", "n/a", "na", "nan", "?", "tbd", "none"}
_YAML = re.compile(r"^[ \t]*(\w+)[ \t]*:[ \t]*[\"']?([^#\n\"']*)", re.MULTILINE)
_KALIBR = {
    "gyroscope_noise_density": ("angle_random_walk", "rad/s/√Hz"),
    "accelerometer_noise_density": ("velocity_random_walk", "m/s²/√Hz"),
}


def entries_of(text: str, kind: str) -> list[dict[str, Any]] | None:
    """Entries of a text that is no catalogue file but a table of IMUs or an imu.yaml; None where it is neither.

    Raises InputError, naming the row, for a number without a unit, and for a table that is too large.
    """
    if re.search(r"^[ \t]*(gyroscope|accelerometer)_noise_density[ \t]*:", text, re.MULTILINE):
        return [_of_kalibr(text)] if kind == "imu" else []
    lines = [line for line in text[:_MOST_CHARACTERS].splitlines() if line.strip() and not line.startswith("#")]
    mark = next((mark for mark in ";\t," if lines and mark in lines[0]), None)
    if mark is None or len(lines[0]) > _LONGEST_HEAD or "=" in lines[0] or lines[0].lstrip().startswith("["):
        return None
    header = [cell[:_LONGEST_NAME] for cell in next(csv.reader([lines[0]], delimiter=mark))]
    meanings = [next(((key, of) for names, key, of in _MEANINGS if names.search(cell)), ("", "")) for cell in header]
    if not any(key.endswith("random_walk") for key, _ in meanings):
        return None
    if len(text) > _MOST_CHARACTERS or len(lines) > _MOST_ROWS or len(header) > _MOST_COLUMNS:
        raise InputError("imu catalogue", f"a table has at most {_MOST_ROWS} rows and {_MOST_COLUMNS} columns")
    place = next((at for at, cell in enumerate(header) if _NAME.search(cell) and not meanings[at][0]), 0)
    try:
        rows = [*csv.reader(lines[1:], delimiter=mark)] if kind == "imu" else []
    except csv.Error as error:
        raise InputError("imu catalogue", f"is a table that cannot be read: {error}") from error
    return [_entry(header, meanings, place, row) for row in rows]


def _entry(header: list[str], meanings: list[tuple[str, str]], place: int, row: list[str]) -> dict[str, Any]:
    """A row as an entry of a catalogue file; what is not used of it is in its note."""
    cells = [cell.strip() for cell in row]
    name = cells[place] if len(cells) > place else ""
    if len(cells) != len(header):
        raise InputError("imu catalogue", f"the row {quoted(name)} has {len(cells)} fields, its head {len(header)}")
    entry: dict[str, Any] = {"name": " ".join(name.split())}
    unused = []
    for column, (key, of), cell in zip(header, meanings, cells, strict=True):
        if cell.lower() in _EMPTY or column == header[place]:
            continue
        if key == "grade":
            entry[key] = cell
        elif key and key not in entry:
            match = _IN_BRACKETS.fullmatch(column)
            unit = match[2] if match and re.fullmatch(r"[-+±<≤.,\d\seE]*", cell) else ""
            if not unit and re.fullmatch(r"[-+±<≤.,\d\seE]*", cell):
                advice = "Write it in the column's name, such as ARW [deg/sqrt(hr)]"
                raise InputError(
                    f"imu.{name}.{key}", f"{quoted(cell)} under {quoted(column)} has no unit. {advice}", cell
                )
            entry[key] = _sourced(f"{cell} {unit}".strip(), f"your table, column {column.strip()}", of)
        else:
            unused.append(f"{column.strip()} {cell}")
    return entry | ({"note": f"Not used: {', '.join(unused)}."} if unused else {})


def _of_kalibr(text: str) -> dict[str, Any]:
    """The entry of a file whose densities are in SI by kalibr's convention."""
    values: Mapping[str, str] = {key: value.strip() for key, value in _YAML.findall(text[:_MOST_CHARACTERS])}
    entry: dict[str, Any] = {"name": f"IMU {values.get('rostopic', '')}".strip()[:80] + " (imu.yaml)"}
    for name, (key, unit) in _KALIBR.items():
        if name in values:
            entry[key] = _sourced(f"{values[name]} {unit}", f"imu.yaml, {name}, in SI by kalibr's convention")
    walks = [f"{name} {value}" for name, value in values.items() if name.endswith("_random_walk")]
    return entry | ({"note": f"Not used: {', '.join(walks)[:200]} (of the biases)."} if walks else {})


def _sourced(value: str, source: str, kind: str = "") -> dict[str, str]:
    return {"value": value, "status": "secondary", "source": source[:200], "kind": kind}
