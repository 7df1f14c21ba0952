"""Solutions as columns of a text: places, velocities, attitude, and accuracies by the words that are printed."""

import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import Array
from nav_model.base.text.column_names import parted, size_of_unit, vocabulary
from nav_model.base.text.number_table import NumberTable
from nav_model.earth.rotation import matrix_of
from nav_model.simulation.trajectory import FILE_BOUNDS
from nav_model.trajectory.files.epochs import Epochs
from nav_model.trajectory.files.heights import Heights
from nav_model.trajectory.files.nmea import FIXES
from nav_model.trajectory.files.table import FlightColumns, flight_columns, recorded_rows

_AXES = vocabulary("solution")
_VELOCITIES = ("vn", "ve", "vu", "vd", "vx", "vy", "vz")
_ANGLES = ("roll", "pitch", "heading")
_WORD = "standarddeviations?|stddev|stdev|std|sd|sigma|σ|rmse?|accuracy|uncertainty|h?cep|drms"
_ACCURACY = re.compile(rf"(?:{_WORD})(?P<behind>\w*)|(?P<before>\w*?)(?:{_WORD}|acc)(?:m|error)?")
_KIND = re.compile(r"(?i)(?<![a-z])(\d?DRMS|[CS]EP\s?\d*|R\d\d|CE\d\d|MRSE|3D[\s_]?RMS)(?![a-z])")
_IN_A_WEEK = frozenset(("gpsseconds", "timeofweek", "tow", "itow", "sow", "gpst"))
_WEEK = frozenset(("week", "gpsweek", "wn", "weekno", "weeknumber"))
_DATED = 1e8  # s; later stamps count from 1970
_RTKLIB = {0: "none", 1: "fixed", 2: "float", 3: "sbas", 4: "dgps", 5: "single", 6: "ppp", 7: "dead reckoning"}
_MOST_KINDS = 100
_FIRST_TEXT = 1000.0


class _Beside(NamedTuple):
    """A column of a velocity or, if `kind` is not empty, of an accuracy: its place, size in SI of one."""

    place: int
    size: float
    kind: str


def read_table(table: NumberTable, heights: Heights) -> Epochs:
    """The epochs of a table whose columns have names.

    Raises InputError under the file's name: no times or places, a unit that is not known, what is no number.
    """
    roles = flight_columns(table, heights)
    if "time" not in roles.taken:
        raise heights.refuse("has no column with the time, such as time_s. A solution has a time for each place.")
    segment, lines = recorded_rows(table, heights, roles)
    return epochs_of(table, heights, roles, segment.rows, lines)


def epochs_of(
    table: NumberTable, heights: Heights, roles: FlightColumns, rows: Array, lines: NDArray[np.int32]
) -> Epochs:
    """The epochs of rows, with what the table has beside time and place.

    Parameters
    ----------
    table, heights
        As `read_table`.
    roles : FlightColumns
        Columns of time and place.
    rows : array (n, 4) or (n, 7)
        As `RecordedSegment.rows`.
    lines : array of int (n,)
        Of the rows in the file.
    """
    taken = {column.place for column in roles.taken.values()}
    named = (_meaning(cell, at) for at, cell in enumerate(roles.header) if at not in taken)
    beside = dict(filter(None, named))
    week = next((at for at, cell in enumerate(roles.header) if _plain(cell) in _WEEK), None)
    also = [*(column.place for column in beside.values()), *([] if week is None else [week])]
    roles.name_unused(heights, [*also, *(at for at, cell in enumerate(roles.header) if cell == "date")])
    places = [column.place for column in beside.values()]
    read = table.columns(places, FILE_BOUNDS.most_rows, FILE_BOUNDS.most_bytes) if places else None
    values = {}
    if read:
        at_rows = np.searchsorted(read.lines, lines)
        values = {key: c.size * read.values[at_rows, at] for at, (key, c) in enumerate(beside.items())}
    place = np.column_stack([np.radians(rows[:, 1:3]), rows[:, 3]])
    fix, names = _fixes(table, roles, lines)
    kinds = {column.kind for column in beside.values() if column.kind}
    accuracy = next((kind for kind in ("cep", "drms") if kind in kinds), "sigma")
    if accuracy != "sigma":
        heights.note(f"horizontal accuracies taken as {accuracy.upper()}, brought to one sigma per axis")
    clock, start = _clock(table, roles, rows[0, 0], week)
    return Epochs(
        "table", clock, rows[:, 0] + start, place,
        _vectors(values, "vn ve vd vu", "vx vy vz", place), np.radians(rows[:, 4:]) if rows.shape[1] > 4 else None,
        _sigmas(values, "north east down up", "x y z xy yz zx", place),
        _sigmas(values, "vn ve vd vu", "vx vy vz vxy vyz vzx", place),
        _columns(values, [f"sigma {angle}" for angle in _ANGLES]), accuracy, fix, names,
    )  # fmt: skip


def _plain(name: str) -> str:
    return re.sub(r"[\W\d_]", "", name.lower())


def _meaning(cell: str, place: int) -> tuple[str, _Beside] | None:
    """Quantity, behind "sigma " if it is an accuracy, and column; None for any other column."""
    for name, unit, _ in parted(cell.strip()):
        plain = _plain(name)
        match = _ACCURACY.fullmatch(plain) or (_ACCURACY.fullmatch(f"{plain}sd") if _KIND.search(unit) else None)
        bare = (match["behind"] or match["before"] or "") if match else plain
        if match and plain.endswith("acc"):  # of u-blox
            bare = {"h": "horizontal", "v": "up"}.get(bare, "")
        word = next(iter(_KIND.findall(f"{name} {unit}")), "")
        key = _AXES.get(bare, ("", 0))[0] or ("horizontal" if match and word and not bare else "")
        if not key or not (match or key in _VELOCITIES):
            continue
        if match and key == "horizontal" and not word:
            word = "DRMS"
        unit = _KIND.sub("", unit).strip(" ,;()")
        dimension = "speed" if key.startswith("v") else "angle" if key in _ANGLES else "length"
        usual = {"speed": "m/s", "angle": "°", "length": "m"}[dimension]
        unit = usual if re.fullmatch(r"(?i)|1?\s*(sigma|σ)|rms|std|sd", unit) else unit
        size = size_of_unit(f"{unit} {word}".strip(), dimension)
        if size is None and word:
            continue
        if size is not None:
            kind = ("cep" if "EP" in word.upper() else "drms" if word else "sigma") if match else ""
            return f"sigma {key}" if match else key, _Beside(place, size, kind)
    return None


def _columns(values: Mapping[str, Array], keys: Sequence[str]) -> Array | None:
    return np.column_stack([values[key] for key in keys]) if values.keys() >= {*keys} else None


def _vectors(values: Mapping[str, Array], local: str, central: str, place: Array) -> Array | None:
    """Vectors north, east, down, from columns of them, of up, or of axes at the Earth's centre."""
    north, east, down, up = local.split()
    if values.keys() >= {north, east} and values.keys() & {down, up}:
        return np.column_stack([values[north], values[east], values[down] if down in values else -values[up]])
    inside = _columns(values, central.split())
    return None if inside is None else np.einsum("nij,nj->ni", local_axes(place), inside)


def _sigmas(values: Mapping[str, Array], local: str, central: str, place: Array) -> Array | None:
    """Sigmas north, east, down; those along ECEF axes with their covariances, which are signed roots."""
    sigmas = {key.removeprefix("sigma "): value for key, value in values.items() if key.startswith("sigma ")}
    north, east, down, up = local.split()
    if north == "north" and "horizontal" in sigmas:
        sigmas = {north: sigmas["horizontal"], east: sigmas["horizontal"]} | sigmas
    if sigmas.keys() >= {north, east} and sigmas.keys() & {down, up}:
        return np.column_stack([sigmas[north], sigmas[east], sigmas[down if down in sigmas else up]])
    x, y, z, *mixed = central.split()
    if not sigmas.keys() >= {x, y, z}:
        return None
    covariance = np.zeros((len(place), 3, 3))
    for key, i, j in zip((x, y, z, *mixed), (0, 1, 2, 0, 1, 2), (0, 1, 2, 1, 2, 0), strict=True):
        root = sigmas.get(key, np.zeros(len(place)))
        covariance[:, i, j] = covariance[:, j, i] = root * np.abs(root)
    axes = local_axes(place)
    variances: Array = np.einsum("nij,njk,nik->ni", axes, covariance, axes)
    return np.asarray(np.sqrt(np.maximum(variances, 0.0)))


def local_axes(place: Array) -> Array:
    """Rotations (n, 3, 3) from axes at the Earth's centre (ECEF) to north, east, down at latitudes and longitudes."""
    (sl, sm), (cl, cm) = np.sin(place[:, :2].T), np.cos(place[:, :2].T)
    return matrix_of(-sl * cm, -sl * sm, cl, -sm, cm, 0.0, -cl * cm, -cl * sm, -sl)


def _clock(table: NumberTable, roles: FlightColumns, first: float, week: int | None) -> tuple[str, float]:
    """The clock of the times, and what is added to them."""
    column = roles.taken["time"]
    if first > _DATED:
        return "utc", 0.0
    if week is not None and 0.0 <= first < 604_800.0:
        number = float(table.columns([week], FILE_BOUNDS.most_rows, FILE_BOUNDS.most_bytes).values[0, 0])
        if np.isfinite(number) and number == np.rint(number):
            return "gps", 604_800.0 * number
    text = re.split(r"[;\t,]" if table.delimiter else r"\s+", table.first_row)
    if len(text) > column.place and ":" in text[column.place]:
        return "day seconds", 0.0
    named = {_plain(name) for name, _, _ in parted(column.header.strip())}
    return ("gps week seconds" if named & _IN_A_WEEK else ""), 0.0


def _fixes(
    table: NumberTable, roles: FlightColumns, lines: NDArray[np.int32]
) -> tuple[NDArray[np.int8] | None, tuple[str, ...]]:
    """The kind of fix in each row, and names of all."""
    if roles.quality is None:
        return None, ()
    texts: dict[str, float] = {}
    place = roles.quality.place
    reader = {place: lambda text: texts.setdefault(text.strip().lower()[:40], _FIRST_TEXT + len(texts))}
    read = table.columns([place], FILE_BOUNDS.most_rows, FILE_BOUNDS.most_bytes, reader)
    numbers, codes = np.unique(read.values[np.searchsorted(read.lines, lines), 0], return_inverse=True)
    if len(numbers) > _MOST_KINDS:
        return None, ()
    plain = _plain(roles.quality.header)
    known = _RTKLIB if plain == "q" else FIXES if plain in ("fixquality", "gpsquality") else {}
    text_of = {number: text for text, number in texts.items()}
    names = [text_of.get(number) or known.get(number) or f"{number:g}" for number in numbers.tolist()]
    return codes.astype(np.int8), tuple(names)
