"""Presets: the inputs that a catalogue entry fills in a design, and where a design differs from its entry."""

from nav_model.design import Design, Value
from nav_model.design.catalogue import Entry, Kind, find
from nav_model.design.parts import PRESET_KEYS


def preset_fill(section: str, name: str) -> tuple[dict[str, Value], dict[str, str]]:
    """Dotted keys that a preset fills, in SI, and the units to show them in.

    Raises
    ------
    InputError
        If the catalogue has no such entry.
    """
    entry = find(kind_of(section), name)
    values: dict[str, Value] = {f"{section}.preset": entry.name}
    values |= {f"{section}.{key}": item.value for key, item in entry.values.items()}
    return values, {f"{section}.{key}": item.unit for key, item in entry.values.items()}


def kind_of(section: str) -> Kind:
    """The kind of catalogue entry that a section takes."""
    return "imu" if section == "imu" else "radar"


def preset_of(design: Design, section: str) -> str | None:
    """Name of the section's preset, if it has one."""
    key = f"{section}.preset"
    value = design[key] if key in PRESET_KEYS else None
    return value if isinstance(value, str) else None


def entry_of(design: Design, section: str) -> Entry | None:
    """The catalogue's entry that the section's preset names, if it has one."""
    name = preset_of(design, section)
    return None if name is None else find(kind_of(section), name)


def deviations(design: Design, section: str) -> frozenset[str]:
    """Names of the inputs whose value is not the preset's (empty without a preset)."""
    name = preset_of(design, section)
    if name is None:
        return frozenset()
    values, _ = preset_fill(section, name)
    return frozenset(
        key.rpartition(".")[2] for key, value in values.items() if key not in PRESET_KEYS and design[key] != value
    )
