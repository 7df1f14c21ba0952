"""A design: all inputs as immutable, typed, bounded, documented values in SI.

A `Design` is a value: it can be sent to other processes and is never changed in place. `Design.replace`
makes the next one, which is what undo, links and comparisons are built on. Its parts are Param classes in the files
beside this one, gathered in `nav_model.design.parts`. The file reader (`nav_model.design.file`), the link
(`nav_model.design.link`) and the page are derived from their declarations, the only place that describes an input.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping
from typing import Any, cast

from nav_model.base.errors import InputError, quoted
from nav_model.base.frozen import FrozenMapping
from nav_model.design.contributors import Contributor
from nav_model.design.declaration import BASE_LINE, ON_BASE_LINE
from nav_model.design.parts import (
    INPUTS,
    INPUTS_SINCE,
    LONGEST_ORIGIN,
    PARTS,
    PRESET_KEYS,
    TOP_KEYS,
    Accelerometer,
    Autofocus,
    Coast,
    Filter,
    Flight,
    Gnss,
    Gyro,
    Imu,
    Motion,
    Oscillator,
    Part,
    Processing,
    Radar,
    Requirements,
    Trajectory,
    all_keys,
    declaration_of,
    quantity,
)
from nav_model.design.table import Table
from nav_model.design.user_entries import Allotment, Limit, UserEntries

_NOTHING = UserEntries()

Value = float | int | bool | str | tuple[tuple[Any, ...], ...] | None

_KEYS = {
    section: tuple(
        key
        for key in (f"{section}.preset", *(f"{section}.{name}" for name in names))
        if key in PRESET_KEYS or not key.endswith(".preset")
    )
    for section, names in INPUTS.items()
}
"""Section -> dotted keys of its values, the catalogue's entry first."""


# Inputs that have moved since designs were saved: their name in a hash, and the key that they stand before there.
_HASHED_AS = {"imu.bandwidth": ("motion.imu_bandwidth", "motion.delay")}


class Design:
    """One design, immutable: a name, a description and its parts.

    Attributes
    ----------
    imu, gyro, accelerometer, gnss, filter, flight, coast, radar, autofocus, motion, oscillator, processing, \
    trajectory, requirements
        The parts; every quantity in SI.
    written : mapping
        Dotted key -> unit the value was written in, for showing and saving it the way it came.
    origins : mapping
        Dotted key -> where the value came from, such as a log or a data sheet: one line.
    outdated : tuple of str
        Keys of a file or link of before that have no effect any more.
    entries : UserEntries
        Contributors, limits and an allocation of the user's own, beside the inputs.

    Two designs are equal when their values and texts are, whatever units they were written in and wherever the
    values came from: `written` and `origins` are not part of a design's identity, nor of its hash.
    """

    imu: Imu
    gyro: Gyro
    accelerometer: Accelerometer
    gnss: Gnss
    filter: Filter
    flight: Flight
    coast: Coast
    radar: Radar
    autofocus: Autofocus
    motion: Motion
    oscillator: Oscillator
    processing: Processing
    trajectory: Trajectory
    requirements: Requirements
    written: Mapping[str, str]
    origins: Mapping[str, str]
    outdated: tuple[str, ...]
    entries: UserEntries
    _values: dict[str, Value]

    def __init__(
        self,
        values: Mapping[str, Value] | None = None,
        written: Mapping[str, str] | None = None,
        origins: Mapping[str, str] | None = None,
        outdated: tuple[str, ...] = (),
        entries: UserEntries = _NOTHING,
    ) -> None:
        """Make a design from dotted keys in SI; a key not given takes its default.

        Raises
        ------
        InputError
            For an unknown key, a value out of bounds, an origin that is not one line of text.
        """
        given = dict(values or {})
        texts = {key: str(given.pop(key, "")) for key in TOP_KEYS}
        parts = {part.section: part(**content) for part, content in _by_part(given)}
        self.__dict__.update(outdated=outdated, entries=entries)
        self._fill(dict(texts), parts, dict(written or {}), dict(origins or {}))

    def _fill(
        self,
        flat: dict[str, Value],
        parts: Mapping[str, Part],
        written: Mapping[str, str],
        origins: Mapping[str, str],
    ) -> None:
        for section, part in parts.items():
            flat |= {key: getattr(part, key.rpartition(".")[2]) for key in _KEYS[section]}
        if not isinstance(origins, FrozenMapping):  # of another design, which has checked them
            for key, origin in origins.items():
                _check_origin(key, origin)
        self.__dict__.update(parts, written=_frozen(written), origins=_frozen(origins), _values=flat)

    def __reduce__(self) -> tuple[type[Design], tuple[Any, ...]]:
        """Unpickle through the constructor, so that the copy is checked and immutable too."""
        return type(self), (self._values, dict(self.written), dict(self.origins), self.outdated, self.entries)

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

    @property
    def contributors(self) -> tuple[Contributor, ...]:
        """Errors of the user's own that enter figures beside those of the model."""
        return self.entries.contributors

    @property
    def limits(self) -> tuple[Limit, ...]:
        """Requirements of the user's own, beside those of the inputs."""
        return self.entries.limits

    @property
    def allocation(self) -> Allotment | None:
        """Split of the limits among sources, where the design has one."""
        return self.entries.allocation

    def __getitem__(self, key: str) -> Value:
        """Value in SI under a dotted key."""
        return self._values[key]

    def __iter__(self) -> Iterator[str]:
        """Every dotted key, in the order of the file."""
        return iter(self._values)

    def items(self) -> Iterator[tuple[str, Value]]:
        """Dotted keys and values in SI."""
        return iter(self._values.items())

    def replace(
        self,
        changes: Mapping[str, Value],
        written: Mapping[str, str] | None = None,
        origins: Mapping[str, str] | None = None,
        entries: UserEntries | None = None,
    ) -> Design:
        """The design with some inputs, or its entries, replaced.

        Parts, units and origins in which nothing changes are the same objects. Noise written as "1 cm + 1 ppm"
        follows the baseline.

        Parameters
        ----------
        changes : mapping
            Dotted key -> value, SI.
        written : mapping, optional
            Key -> unit to remember.
        origins : mapping, optional
            Key -> where the value came from; a value that changes loses the origin it had.
        entries : UserEntries, optional
            Contributors, limits and allocation.

        Raises
        ------
        InputError
            As the constructor.
        """
        plain = {key: self.unit(key) for key in ON_BASE_LINE if key in changes and " + " in self.written.get(key, "")}
        written = {**plain, **(written or {})}
        if BASE_LINE in changes:
            others = [key for key in ON_BASE_LINE if key not in changes]
            changes = {**changes, **self._on_base_line(cast("float | None", changes[BASE_LINE]), others)}
        given = dict(changes)
        texts = {key: str(given.pop(key)) for key in TOP_KEYS if key in given}
        touched = {key.partition(".")[0] for key in given}
        same = {key: self._values[key] for section in touched for key in _KEYS.get(section, ())}
        parts = {part.section: part(**values) for part, values in _by_part(same | given) if part.section in touched}
        units: Mapping[str, str] = self.written
        if any(units.get(key) != unit for key, unit in written.items()):
            units = {**units, **written}
        held: Mapping[str, str] = self.origins
        if origins or any(key in held and value != self[key] for key, value in changes.items()):
            held = {key: origin for key, origin in held.items() if changes.get(key, self[key]) == self[key]}
            held = {**held, **(origins or {})}
        new = Design.__new__(Design)
        new.__dict__.update(self.__dict__)
        if entries is not None:
            new.__dict__["entries"] = entries
        new._fill({**self._values, **texts}, parts, units, held)
        return new

    def uses(self, key: str) -> bool:
        """True if the number under `key` is given and counts beside the other inputs."""
        return quantity(key).used_in(getattr(self, key.partition(".")[0]))

    def unit(self, key: str) -> str:
        """Unit symbol in which the value under `key` is shown."""
        return quantity(key).plain_unit(self.written.get(key, ""))

    def scale(self, key: str) -> str:
        """The part after the number under `key` as a person writes it: its unit, or "m CEP"."""
        written = self.written.get(key, "")
        return written if written and ":" not in written else self.unit(key)

    @property
    def baseline(self) -> float | None:
        """Distance from the base station [m], if it is given."""
        return cast("float | None", self._values[BASE_LINE])

    def _on_base_line(self, baseline: float | None, keys: Iterable[str]) -> dict[str, Value]:
        """Values, at another baseline, of the inputs that are written as growing with it."""
        moved: dict[str, Value] = {}
        for key in keys:
            value, written = self[key], self.written.get(key, "")
            if " + " in written:
                text = quantity(key).write(cast("float", value), written, self.baseline)[1]
                moved[key] = quantity(key).read(text, baseline=baseline).value
        return moved

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Design) and self._values == other._values and self.entries == other.entries

    def __hash__(self) -> int:
        return hash((tuple(self._values.items()), self.entries))

    def __repr__(self) -> str:
        return f"Design({self.name!r}, {self.content_hash[:12]})"

    @property
    def content_hash(self) -> str:
        """SHA-256 over every key and value, in hexadecimal; stable across runs, machines and units."""
        keys = [key for key in self._values if key not in _HASHED_AS]
        for key, (_, next_key) in _HASHED_AS.items():
            keys.insert(keys.index(next_key), key)
        lines = [
            f"{_HASHED_AS.get(key, (key,))[0]}="
            f"{(value + 0.0).hex() if isinstance(value, float | int) else repr(_identity(key, value))}"
            for key, value in ((key, self._values[key]) for key in keys)
            if key not in INPUTS_SINCE or value != (None if key in PRESET_KEYS else declaration_of(key).default)
        ]
        return hashlib.sha256("\n".join(lines + self.entries.identity()).encode()).hexdigest()

    @property
    def input_hash(self) -> str:
        """SHA-256 like `content_hash`, without name and description, from which no figure follows."""
        return self.replace({"name": "", "description": ""}).content_hash


def _identity(key: str, value: Any) -> Any:
    """Value of a text or a table in a hash."""
    if not isinstance(value, tuple):
        return value
    declaration = declaration_of(key)
    assert isinstance(declaration, Table)
    return _without_sign(declaration.identity(value))


def _without_sign(value: Any) -> Any:
    """A value whose zeros, also those of rows, are 0.0, which -0.0 is equal to."""
    if isinstance(value, tuple):
        return tuple(map(_without_sign, value))
    return value + 0.0 if isinstance(value, float) else value


def _frozen(given: Mapping[str, str]) -> FrozenMapping[str, str]:
    return given if isinstance(given, FrozenMapping) else FrozenMapping(given)


def _check_origin(key: str, origin: object) -> None:
    where = f"origins.{key}"
    if key not in all_keys():
        raise InputError(where, 'unknown key; write in quotes one of the design, such as "imu.rate"', origin)
    if not isinstance(origin, str) or not origin.strip() or len(origin.splitlines()) != 1:
        raise InputError(where, f"{quoted(origin)} is not a line of text in quotes", origin)
    if len(origin) > LONGEST_ORIGIN:
        raise InputError(where, f"longer than {LONGEST_ORIGIN} characters")


def _by_part(values: Mapping[str, Value]) -> list[tuple[type[Part], dict[str, Any]]]:
    """Values sorted into the keyword arguments of each part."""
    by_section: dict[str, dict[str, Any]] = {part.section: {} for part in PARTS}
    for key, value in values.items():
        section, _, name = key.rpartition(".")
        if key not in PRESET_KEYS and name not in INPUTS.get(section, {}):
            raise InputError(key, f"unknown key; allowed are {', '.join(all_keys())}", value)
        by_section[section][name] = value
    return [(part, by_section[part.section]) for part in PARTS]
