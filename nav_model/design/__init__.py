"""A design: everything a person can set, as immutable, typed, bounded, documented values in SI.

A `Design` is a value. It is never changed in place; `Design.replace` makes the next one, which is what
undo, links and comparisons are built on. Its parts are the Param classes of `nav_model.design.parts`, and the file
reader (`nav_model.design.file`), the link (`nav_model.design.link`) and the widgets are derived from their
declarations: adding an input is adding one declaration there.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any, cast

from nav_model.design.declaration import BaseQuantity
from nav_model.design.parts import (
    INPUTS,
    PARTS,
    PRESET_KEYS,
    TOP_KEYS,
    Coast,
    Flight,
    Gnss,
    Imu,
    Part,
    Radar,
    Requirements,
    all_keys,
    declaration_of,
)
from nav_model.errors import InputError

Value = float | int | bool | str | None


class Design:
    """One design, immutable: a name, a description and six parts.

    Attributes
    ----------
    imu, gnss, flight, coast, radar, requirements
        The parts; every quantity in SI.
    written : mapping
        Dotted key -> unit the value was written in, for showing and saving it the way it came. Not part
        of the design's identity.

    Two designs are equal when every value is, whatever units they were written in.
    """

    imu: Imu
    gnss: Gnss
    flight: Flight
    coast: Coast
    radar: Radar
    requirements: Requirements
    written: Mapping[str, str]
    _values: dict[str, Value]

    def __init__(self, values: Mapping[str, Value] | None = None, written: Mapping[str, str] | None = None) -> None:
        """Make a design from dotted keys in SI; a key not given takes its default.

        Raises
        ------
        InputError
            For an unknown key or a value out of bounds.
        """
        given = dict(values or {})
        texts = {key: str(given.pop(key, "")) for key in TOP_KEYS}
        self._fill(texts, {part.section: part(**own) for part, own in _by_part(given)}, written or {})

    def _fill(self, texts: dict[str, str], parts: Mapping[str, Part], written: Mapping[str, str]) -> None:
        flat: dict[str, Value] = dict(texts)
        for section, part in parts.items():
            if f"{section}.preset" in PRESET_KEYS:
                flat[f"{section}.preset"] = getattr(part, "preset")  # noqa: B009  # only some parts have it
            flat |= {f"{section}.{name}": getattr(part, name) for name in INPUTS[section]}
        self.__dict__.update(parts, written=MappingProxyType(dict(written)), _values=flat)

    def __setattr__(self, name: str, value: object) -> None:
        raise AttributeError("a Design does not change; make another with replace()")

    @property
    def name(self) -> str:
        """Title of the design."""
        return cast("str", self._values["name"])

    @property
    def description(self) -> str:
        """Free text."""
        return cast("str", self._values["description"])

    def __getitem__(self, key: str) -> Value:
        """Value in SI under a dotted key."""
        return self._values[key]

    def __iter__(self) -> Iterator[str]:
        """Every dotted key, in the order of the file."""
        return iter(self._values)

    def items(self) -> Iterator[tuple[str, Value]]:
        """Dotted keys and values in SI."""
        return iter(self._values.items())

    def replace(self, changes: Mapping[str, Value], written: Mapping[str, str] | None = None) -> Design:
        """The design that differs in `changes` (dotted keys, SI); `written` updates the units remembered.

        Raises
        ------
        InputError
            For an unknown key or a value out of bounds.
        """
        given = dict(changes)
        texts = {key: str(given.pop(key, self._values[key])) for key in TOP_KEYS}
        touched = {key.partition(".")[0] for key in given}
        parts: dict[str, Part] = {part.section: getattr(self, part.section) for part in PARTS}
        kept = {key: value for key, value in self._values.items() if key.partition(".")[0] in touched}
        for part, own in _by_part(kept | given):
            if part.section in touched:
                parts[part.section] = part(**own)
        new = Design.__new__(Design)
        new._fill(texts, parts, {**self.written, **(written or {})})
        return new

    def unit(self, key: str) -> str:
        """Unit symbol in which the value under `key` is shown."""
        written = self.written.get(key, "")
        declaration = declaration_of(key)
        assert isinstance(declaration, BaseQuantity)
        return declaration.unit if not written or ":" in written else written

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Design) and self._values == other._values

    def __hash__(self) -> int:
        return hash(tuple(self._values.items()))

    def __repr__(self) -> str:
        return f"Design({self.name!r}, {self.content_hash[:12]})"

    @property
    def content_hash(self) -> str:
        """SHA-256 over every key and value, in hexadecimal; stable across runs, machines and units."""
        lines = (
            # Adding zero makes -0.0 the 0.0 it is equal to.
            f"{key}={(value + 0.0).hex() if isinstance(value, float | int) else repr(value)}"
            for key, value in self._values.items()
        )
        return hashlib.sha256("\n".join(lines).encode()).hexdigest()


def _by_part(values: Mapping[str, Value]) -> list[tuple[type[Part], dict[str, Any]]]:
    """Values sorted into the keyword arguments of each part."""
    own: dict[str, dict[str, Any]] = {part.section: {} for part in PARTS}
    for key, value in values.items():
        section, _, name = key.rpartition(".")
        if key not in PRESET_KEYS and name not in INPUTS.get(section, {}):
            raise InputError(key, f"unknown key; allowed are {', '.join(all_keys())}")
        own[section][name] = value
    return [(part, own[part.section]) for part in PARTS]
