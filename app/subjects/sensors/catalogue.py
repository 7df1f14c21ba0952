"""The catalogue as tables: every value in one unit per column, as printed where that differs, with its source."""

import re

from app.document.blocks import Cell, Column, Row, TableBlock, numbers, table
from app.document.numbers import number
from nav_model.base.units import from_si
from nav_model.design.catalogue import Entry, Kind, SourcedValue, catalogue

# Key, heading, dimension, unit of the column.
_COLUMNS: dict[Kind, tuple[tuple[str, str, str, str], ...]] = {
    "imu": (
        ("angle_random_walk", "Angle random walk", "angle random walk", "°/√h"),
        ("velocity_random_walk", "Velocity random walk", "velocity random walk", "m/s/√h"),
        ("gyro_bias", "Gyro bias", "angular rate", "°/h"),
        ("accelerometer_bias", "Accelerometer bias", "acceleration", "mg"),
    ),
    "radar": (
        ("frequency", "Frequency", "frequency", "GHz"),
        ("azimuth_resolution", "Azimuth resolution", "length", "m"),
        ("slant_range", "Slant range", "length", "km"),
        ("speed", "Speed", "speed", "m/s"),
        ("altitude", "Altitude", "length", "km"),
    ),
}
_CAPTIONS: dict[Kind, str] = {"imu": "IMUs of the catalogue", "radar": "Radars of the catalogue"}
_DIGITS = 4  # as many as data sheets print
_STATUS = (
    "Values marked ⚠ were not checked at the maker. ⚠ secondary: read in a source that quotes the maker. ⚠ "
    "assumed: a "
    "typical value chosen here. ⚠ unconfirmed: no source found. Press a heading to sort."
)


def catalogue_table(kind: Kind, chosen: str) -> TableBlock:
    """The catalogue of a kind; the row named `chosen` is marked."""
    columns = _COLUMNS[kind]
    graded = (Column("Grade", sortable=True),) if kind == "imu" else ()
    return table(
        f"catalogue-{kind}",
        _CAPTIONS[kind],
        (
            Column("IMU" if kind == "imu" else "Radar", sortable=True),
            *graded,
            *numbers(*(f"{heading} [{unit}]" for _, heading, _, unit in columns), sortable=True),
            "Source",
        ),
        (_row(entry, columns, entry.name == chosen) for entry in catalogue(kind).values()),
        _STATUS,
    )


def _row(entry: Entry, columns: tuple[tuple[str, str, str, str], ...], chosen: bool) -> Row:
    values = {**entry.values, **entry.extra}
    return (
        Cell(entry.name.replace(" ", "\u00a0"), "● in the design" if chosen else "", sort=entry.name),
        *((entry.grade.replace(" ", "\u00a0"),) if entry.kind == "imu" else ()),
        *(_value(values.get(key), dimension, unit) for key, _, dimension, unit in columns),
        _source(values, columns, entry.note),
    )


def _value(item: SourcedValue | None, dimension: str, unit: str) -> Cell:
    if item is None:
        return Cell("not given", tone="quiet", sort="")
    digits = _DIGITS if item.unit == unit else _digits_of(item.text)
    text = f"{number(from_si(item.value, unit, dimension), digits, given=True)} {item.kind}".rstrip()
    return Cell(text, "" if item.confirmed else "⚠", "" if item.confirmed else "warn", item.value)


def _source(values: dict[str, SourcedValue], columns: tuple[tuple[str, str, str, str], ...], note: str) -> Cell:
    """The worst status; unfolded, each source, what is printed in other units than the column's, and the note."""
    printed = (
        f"{heading}: printed {values[key].text}"
        for key, heading, _, unit in columns
        if key in values and values[key].unit != unit
    )
    doubtful = [item.status for item in values.values() if not item.confirmed]
    status = f"⚠\u00a0{doubtful[0]}" if doubtful else "confirmed"
    return Cell(status, more="\n".join(filter(None, (*_sources(values), *printed, note))))


def _digits_of(text: str) -> int:
    """Digits of a value brought to another unit: as many as it is printed with, two at least."""
    printed = re.match(r"[0.]*([\d.]*)", text)
    return min(max(2, len(printed[1].replace(".", "")) if printed else 0), _DIGITS)


def _sources(values: dict[str, SourcedValue]) -> list[str]:
    """One line per source, with the values read in it when there are several."""
    keys_of: dict[tuple[str, str], list[str]] = {}
    for key, item in values.items():
        keys_of.setdefault((item.status, item.source), []).append(key.replace("_", " "))
    return [
        f"{'' if status == 'confirmed' else '⚠ '}{status}: {source}"
        + (f" ({', '.join(keys)})" if len(keys_of) > 1 else "")
        for (status, source), keys in keys_of.items()
    ]
