"""Presets: the inputs that a catalogue entry fills in a design, and where a design differs from its entry."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import cast

from nav_model.design import Design, Value
from nav_model.design.catalogue import Entry, Kind, SourcedValue, catalogue, find
from nav_model.design.declaration import BASE_LINE, ON_BASE_LINE, BaseQuantity
from nav_model.design.parts import PRESET_KEYS, Accelerometer, Gyro, declaration_of
from nav_model.design.processing import REAL_TIME

SHEET_KEYS = tuple(f"{part.section}.{name}" for part in (Gyro, Accelerometer) for name in part.inputs())
"""Inputs of the sensors beside those of the section [imu]."""


def values_of(entry: Entry, baseline: float | None = None) -> Mapping[str, SourcedValue]:
    """Name of an input -> the entry's value. Noise that grows with the baseline is that at `baseline` [m], and the
    distance then is not the entry's."""
    if baseline is None or entry.kind != "gnss":
        return entry.values
    values = {name: item for name, item in entry.values.items() if f"gnss.{name}" != BASE_LINE}
    for name, item in values.items():
        if " + " in item.unit:
            declaration = cast("BaseQuantity[float]", declaration_of(f"gnss.{name}"))
            values[name] = replace(item, value=declaration.read(item.text, baseline=baseline).value)
    return values


def filled(entry: Entry, baseline: float | None = None) -> tuple[dict[str, Value], dict[str, str]]:
    """Dotted keys that an entry fills, in SI, and the units to show them in; noise as `values_of`."""
    items = values_of(entry, baseline)
    values: dict[str, Value] = {"preset": entry.name}
    if "position_noise" in items:  # without a slow error or vertical noise in the entry there is none
        values |= {"vertical_position_noise": None, "correlated": False, "vertical_correlated_noise": None}
    values |= {name: item.value for name, item in items.items()}
    units = {name: item.unit for name, item in items.items() if item.unit}
    section = entry.kind
    return {f"{section}.{k}": v for k, v in values.items()}, {f"{section}.{k}": u for k, u in units.items()}


def preset_fill(
    section: str, name: str, baseline: float | None = None, *, sheet: bool = False
) -> tuple[dict[str, Value], dict[str, str]]:
    """As `filled`, of the entry called `name`.

    Parameters
    ----------
    section : str
        "imu", "gnss" or "radar".
    name : str
        Of the entry.
    baseline : float, optional
        Distance from the base station [m], for noise that grows with it.
    sheet : bool, optional
        True for what else an inertial unit's sheet prints, in the sections of its sensors.

    Raises
    ------
    InputError
        If the catalogue has no such entry.
    """
    entry = find(kind_of(section), name)
    values, units = filled(entry, baseline)
    if sheet and section == "imu":
        more = sheet_filled(entry)
        return values | more[0], units | more[1]
    return values, units


def sheet_filled(entry: Entry) -> tuple[dict[str, Value], dict[str, str]]:
    """Dotted keys that the whole sheet of an inertial unit fills beside its section, in SI, and their units.

    Errors that the sheet does not print are none.
    """
    values: dict[str, Value] = {key: declaration_of(key).default for key in SHEET_KEYS}
    values |= {key: item.value for key, item in entry.sheet.items()}
    return values, {key: item.unit for key, item in entry.sheet.items()}


def sheet_origins(entry: Entry) -> dict[str, str]:
    """Dotted key -> where the whole sheet of an inertial unit has its value from."""
    return {
        key: f"{entry.name}: {item.source}" + ("" if item.confirmed else f" ({item.status})")
        for key, item in entry.sheet.items()
    }


def kind_of(section: str) -> Kind:
    """The kind of catalogue entry that a section takes."""
    return cast("Kind", section)


def preset_of(design: Design, section: str) -> str | None:
    """Name of the section's preset, if it has one."""
    key = f"{section}.preset"
    value = design[key] if key in PRESET_KEYS else None
    return value if isinstance(value, str) else None


def entry_of(design: Design, section: str) -> Entry | None:
    """The catalogue's entry that the section's preset names, if it has one."""
    name = preset_of(design, section)
    return None if name is None else find(kind_of(section), name)


def sheet_of(design: Design, section: str) -> Mapping[str, SourcedValue]:
    """Name of an input -> the value of the section's preset at the design's baseline; empty without a preset."""
    entry = entry_of(design, section)
    return {} if entry is None else values_of(entry, design.baseline)


def nearest_class(design: Design) -> Entry:
    """The receiver class whose whole error is nearest to a design's position noise, as a ratio; in real time of those
    whose fixes come in flight."""

    def off(entry: Entry) -> float:
        whole = math.hypot(*(entry.values[name].value for name in ("position_noise", "correlated_noise")))
        return abs(math.log(whole / design.gnss.position_noise))

    later = design.processing.mode != REAL_TIME
    return min((entry for entry in catalogue("gnss").values() if later or not entry.post_processed), key=off)


def without_class(design: Design) -> dict[str, Value]:
    """Changes that take the receiver class out of a design, with all that it filled and nobody changed since.

    Returns
    -------
    dict
        Dotted key -> None for the class, and the default of each input that has the class's value. The baseline
        stays where noise of the user's own grows with it.
    """
    entry = entry_of(design, "gnss")
    if entry is None:
        return {}
    changed = deviations(design, "gnss")
    changes: dict[str, Value] = {
        key: None if key in PRESET_KEYS else declaration_of(key).default
        for key in filled(entry, design.baseline)[0]
        if key.rpartition(".")[2] not in changed
    }
    grows = any(" + " in design.written.get(key, "") and key not in changes for key in ON_BASE_LINE)
    if (base := entry.values.get("baseline")) and base.value == design.baseline and not grows:
        changes[BASE_LINE] = None
    return changes


def deviations(design: Design, section: str) -> frozenset[str]:
    """Names of the inputs whose value is not the preset's (empty without a preset)."""
    name = preset_of(design, section)
    if name is None:
        return frozenset()
    values, _ = preset_fill(section, name, design.baseline)
    return frozenset(
        key.rpartition(".")[2] for key, value in values.items() if key not in PRESET_KEYS and design[key] != value
    )
