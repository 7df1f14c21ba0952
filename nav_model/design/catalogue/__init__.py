"""The catalogue of inertial units, radars and receiver classes: values, sources and reliability."""

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache
from importlib.resources import files
from typing import Any, Literal

from nav_model.base.errors import InputError, not_a_choice, quoted, under
from nav_model.base.text.toml_text import read_toml
from nav_model.base.units import Parsed, parse_quantity
from nav_model.design.catalogue.brought import entries_of
from nav_model.design.declaration import BaseQuantity
from nav_model.design.parts import INPUTS
from nav_model.design.processing import POST_PROCESSED, REAL_TIME

Kind = Literal["imu", "radar", "gnss"]
STATUSES = ("confirmed", "secondary", "assumed", "unconfirmed")
"""Reliability of a value, from best to worst; anything but the first is marked wherever it is shown."""


@dataclass(frozen=True)
class SourcedValue:
    """One value of the catalogue.

    Attributes
    ----------
    text : str
        As printed in the source, with its unit.
    value : float
        SI.
    unit : str
        Unit to show it in (``"wavelength:cm"`` when given as the reciprocal input).
    status : str
        One of `STATUSES`.
    source : str
        Where it was read.
    kind : str
        For biases: in-run, repeatability, rms.
    """

    text: str
    value: float
    unit: str
    status: str
    source: str
    kind: str = ""

    @property
    def confirmed(self) -> bool:
        """True if the value was read in the source named."""
        return self.status == "confirmed"


@dataclass(frozen=True)
class Entry:
    """One unit of the catalogue.

    `values` fill the inputs of the same section of a design; `extra` is only shown
    (data-sheet biases of an inertial unit; speed and altitude of a radar's platform; the baseline to which a
    receiver's sheet holds). `offer` has what an offer adds, of `OFFERED`: a price in its currency, kg, W.
    `post_processed`: of a receiver whose fixes are computed after the flight.
    """

    kind: Kind
    name: str
    grade: str
    note: str
    values: Mapping[str, SourcedValue]
    extra: Mapping[str, SourcedValue]
    offer: Mapping[str, SourcedValue]
    post_processed: bool = False

    @property
    def sheet(self) -> Mapping[str, SourcedValue]:
        """Dotted key of a design -> what an inertial unit's sheet prints beside its random walks.

        A bias instability has a correlation time, which is assumed by the kind of sensor: no sheet here prints it.
        """
        inputs: dict[str, SourcedValue] = {}
        for name, item in self.extra.items() if self.kind == "imu" else ():
            sensor = name.removesuffix("_bias")
            if error := _ERRORS.get(item.kind):
                inputs[f"{sensor}.{error}"] = item
            if error == "bias_instability":
                time, what = (300.0, "MEMS") if "MEMS" in self.grade else (3600.0, "fibre and laser")
                inputs[f"{sensor}.correlation_time"] = SourcedValue(
                    f"{time:g} s", time, "s", "assumed", f"usual for {what}; no sheet prints it"
                )
        return inputs

    @property
    def in_run(self) -> Mapping[str, SourcedValue]:
        """Values of `extra` that may serve as residual biases."""
        return {name: item for name, item in self.extra.items() if item.kind == "in-run"}


OFFERED: dict[str, dict[str, float]] = {
    "price": {},
    "mass": {"g": 1e-3, "kg": 1.0, "lb": 0.45359237, "oz": 0.028349523125},
    "power": {"mW": 1e-3, "W": 1.0},
}
"""Values of an offer beside its errors, and the units in SI; a price has its currency's three letters (ISO 4217)."""

_AMOUNT = re.compile(r"\s*(\d+(?:\.\d+)?(?:[eE][+-]?\d{1,2})?)\s*(\S*)\s*")
_LONGEST_NAME = 100
_MOST_BYTES = 1_000_000  # the product's own have ten thousand
_EXTRA: dict[str, dict[str, str]] = {
    "imu": {"gyro_bias": "angular rate", "accelerometer_bias": "acceleration"},
    "radar": {"speed": "speed", "altitude": "length"},
    "gnss": {"longest_baseline": "length"},
}


_ERRORS = {"in-run": "bias_instability", "repeatability": "turn_on_bias"}
"""Kind of a bias that a sheet prints -> the input that it is; an rms is neither."""


@cache
def catalogue(kind: Kind) -> Mapping[str, Entry]:
    """Name -> entry of the catalogue shipped with the product, in the order of its file.

    Examples
    --------
    >>> from nav_model import catalogue
    >>> catalogue("imu")["STIM300"].values["angle_random_walk"].text
    '0.15 °/√h'
    """
    text = files("nav_model.design.catalogue").joinpath(f"{kind}.toml").read_text(encoding="utf-8")
    return read_catalogue(text, kind)


def read_catalogue(text: str, kind: Kind) -> Mapping[str, Entry]:
    """Entries of a catalogue file's text, also of a user's own sensors, or of a table of IMUs or an imu.yaml.

    Raises
    ------
    InputError
        Naming the entry and the key that is wrong.
    """
    tables: Any = entries_of(text, kind)
    if tables is None:
        tables = read_toml(text, f"{kind} catalogue", "a catalogue file", _MOST_BYTES).get(kind, [])
    if not isinstance(tables, list) or not all(isinstance(table, dict) for table in tables):
        raise InputError(f"{kind} catalogue", f"entries must be [[{kind}]] tables")
    entries: dict[str, Entry] = {}
    for table in tables:
        entry = _entry(kind, table)
        if any(entry.name.casefold() == name.casefold() for name in entries):
            raise InputError(f"{kind}.{entry.name}", "is the name of two entries; give each its own")
        entries[entry.name] = entry
    return entries


def _entry(kind: Kind, table: dict[str, Any]) -> Entry:
    name = table.get("name")
    if not isinstance(name, str) or not name:
        raise InputError(f"{kind} catalogue", "an entry has no name")
    if len(name) > _LONGEST_NAME or not name.isprintable() or name != name.strip():
        reason = f"the name {quoted(name)} is not one line of at most {_LONGEST_NAME} characters without outer spaces"
        raise InputError(f"{kind} catalogue", reason)
    if (processing := table.get("processing", REAL_TIME)) not in (REAL_TIME, POST_PROCESSED):
        reason = not_a_choice(processing, (REAL_TIME, POST_PROCESSED))
        raise InputError(f"{kind}.{name}.processing", reason, processing)
    values: dict[str, SourcedValue] = {}
    extra: dict[str, SourcedValue] = {}
    offer: dict[str, SourcedValue] = {}
    base = table.get("baseline")
    baseline = (
        _input(kind, "baseline", f"{kind}.{name}")[1].read(base.get("value")).value
        if isinstance(base, dict)
        else None
    )
    for key, item in table.items():
        if key in {"name", "grade", "note"} or (key, kind) == ("processing", "gnss"):
            continue
        where = f"{kind}.{name}.{key}"
        if not isinstance(item, dict) or not isinstance(item.get("value"), str):
            raise InputError(where, 'must be a table such as { value = "1 m", status = ..., source = ... }')
        if item.get("status") not in STATUSES:
            raise InputError(where, f"status {not_a_choice(item.get('status'), STATUSES)}")
        if not isinstance(item.get("source"), str) or not item["source"]:
            raise InputError(where, "has no source")
        if key in OFFERED:
            parsed, target = _offered(key, item["value"], where), offer
        elif key in _EXTRA[kind]:
            with under(where):
                parsed, target = parse_quantity(item["value"], _EXTRA[kind][key]), extra
        else:
            name_of_input, declaration = _input(kind, key, where)
            parsed, target = declaration.read(item["value"], key, baseline), values
            key = name_of_input
        target[key] = SourcedValue(
            item["value"], parsed.value, parsed.unit, item["status"], item["source"], item.get("kind", "")
        )
    if slow := values.get("correlated_noise"):
        values["correlated"] = replace(slow, text="yes", value=True, unit="")
    grade, note = str(table.get("grade", "")), str(table.get("note", ""))
    return Entry(kind, name, grade, note, values, extra, offer, processing == POST_PROCESSED)


def _offered(key: str, text: str, where: str) -> Parsed:
    """A price, mass or power with its unit."""
    units = OFFERED[key]
    match = _AMOUNT.fullmatch(text)
    number, unit = match.groups() if match else ("", "")
    if not units and (price := re.fullmatch("([kM]?)([A-Z]{3})", unit)):
        return Parsed(float(number) * {"": 1.0, "k": 1e3, "M": 1e6}[price[1]], price[2])
    if unit in units:
        return Parsed(float(number) * units[unit], unit)
    choice = ", ".join(units) or "the three letters of a currency, as in 4200 EUR or 4.2 kEUR"
    raise InputError(where, f"{quoted(text)} is not a {key}. Write a number and a unit: {choice}.", text)


def _input(kind: Kind, key: str, where: str) -> tuple[str, BaseQuantity[Any]]:
    for name, declaration in INPUTS[kind].items():
        if isinstance(declaration, BaseQuantity) and (
            name == key or (declaration.alternative and declaration.alternative.key == key)
        ):
            return name, declaration
    raise InputError(where, "unknown key")


def find(kind: Kind, name: str) -> Entry:
    """The entry called `name` (letter case and outer spaces do not matter).

    Raises
    ------
    InputError
        Listing the names there are.
    """
    entries = catalogue(kind)
    for entry in entries.values():
        if entry.name.casefold() == name.strip().casefold():
            return entry
    raise InputError(f"{kind}.preset", f"{name!r} is not in the catalogue; it has {', '.join(entries)}", name)
