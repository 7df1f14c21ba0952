"""The catalogue as tables: every value in one unit per column, as printed where that differs, with its source."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape

from nav_model.catalogue import Entry, Kind, SourcedValue, catalogue
from nav_model.units import from_si, plain_number

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
_CAPTIONS: dict[Kind, str] = {"imu": "Inertial units", "radar": "Radars"}
_DIGITS = 4
_MARKS = {"secondary": "", "assumed": "mark", "unconfirmed": "mark"}


def catalogue_table(kind: Kind, chosen: str) -> str:
    """The catalogue of a kind as HTML for a `SortableTable`; the row named `chosen` is marked."""
    columns = _COLUMNS[kind]
    heads = "".join(
        f'<th scope="col" class="num"><button type="button">{heading}</button>'
        f'<br><span class="quiet">[{unit}]</span></th>'
        for _, heading, _, unit in columns
    )
    rows = "".join(_row(entry, columns, entry.name == chosen) for entry in catalogue(kind).values())
    return (
        f'<div class="scroll" tabindex="0" role="region" aria-label="{_CAPTIONS[kind]}"><table class="checks">'
        f'<thead><tr><th scope="col"><button type="button">{"Unit" if kind == "imu" else "Radar"}</button></th>'
        f"{_grade_head(kind)}{heads}<th scope='col' class='source'>Source and status</th></tr></thead>"
        f"<tbody>{rows}</tbody></table></div>"
    )


def _grade_head(kind: Kind) -> str:
    return '<th scope="col"><button type="button">Grade</button></th>' if kind == "imu" else ""


def _row(entry: Entry, columns: Iterable[tuple[str, str, str, str]], chosen: bool) -> str:
    values = {**entry.values, **entry.extra}
    cells = "".join(_cell(values.get(key), dimension, unit) for key, _, dimension, unit in columns)
    grade = f"<td>{escape(entry.grade)}</td>" if entry.kind == "imu" else ""
    mark = ' <span class="mark">● in the design</span>' if chosen else ""
    note = f'<br><span class="quiet">{escape(entry.note)}</span>' if entry.note else ""
    return (
        f'<tr><th scope="row" data-sort="{escape(entry.name)}">{escape(entry.name)}{mark}</th>{grade}{cells}'
        f"<td>{_sources(values)}{note}</td></tr>"
    )


def _cell(item: SourcedValue | None, dimension: str, unit: str) -> str:
    if item is None:
        return '<td class="num quiet" data-sort="">not given</td>'
    number = plain_number(from_si(item.value, unit, dimension), _DIGITS)
    small = [] if item.unit == unit else [escape(f"printed {item.text}")]
    small += [escape(item.kind)] if item.kind else []
    if not item.confirmed:
        small.append(f'<span class="{_MARKS[item.status]}">⚠ {item.status}</span>')
    fine = f'<br><span class="quiet">{"<br>".join(small)}</span>' if small else ""
    return f'<td class="num" data-sort="{item.value!r}">{number}{fine}</td>'


def _sources(values: dict[str, SourcedValue]) -> str:
    """One line per source, with the values read in it when there are several."""
    found: dict[tuple[str, str], list[str]] = {}
    for key, item in values.items():
        found.setdefault((item.status, item.source), []).append(key.replace("_", " "))
    lines = []
    for (status, source), keys in found.items():
        said = escape(status) if status == "confirmed" else f'<span class="mark">⚠ {escape(status)}</span>'
        which = f' <span class="quiet">({escape(", ".join(keys))})</span>' if len(found) > 1 else ""
        lines.append(f"{said}: {escape(source)}{which}")
    return "<br>".join(lines)
