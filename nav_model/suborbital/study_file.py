"""A suborbital study as a file and as a link: every input, and the trajectory where one was flown from a file.

    study = "suborbital"
    [gyros]
    bias = "3, 4, 2 °/h"
    [trajectory]            # only where the flight came from a file: its name and its text
    name = "flight.csv"
    csv = "time_s,latitude_deg,..."

A study has its own inputs and so its own file; a design contributes its inertial unit (`from_design`).
Reading names the first key that is wrong; writing states every value in the shortest text that gives the same
number back. A key that is not stated has its GP-1 value.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any
from urllib.parse import urlencode

import tomli_w

from nav_model.base.errors import InputError, quoted
from nav_model.base.text.toml_text import read_toml
from nav_model.design.declaration import BaseQuantity
from nav_model.design.link import STUDY_PREFIX, pairs_of
from nav_model.suborbital.flight_file import BOUNDS
from nav_model.suborbital.input_table import INPUTS
from nav_model.suborbital.settings import (
    DEFAULTS,
    OF_DESIGN,
    Settings,
    Value,
    follows_design,
    from_design,
    read_value,
)

if TYPE_CHECKING:
    from nav_model.design import Design

KIND = "suborbital"
_IMU = "imu"  # in a link: whose inertial unit the study has, where it is the design's
MAX_BYTES = BOUNDS.most_bytes + 1_000_000

_SECTIONS = tuple(dict.fromkeys(key.rpartition(".")[0] for key in INPUTS if "." in key))


@dataclass(frozen=True)
class StudyFile:
    """Content of a study file: the inputs, and name and content of the trajectory (None: the reference flight)."""

    settings: Settings
    trajectory: tuple[str, bytes] | None = field(default=None, repr=False)


def is_study(data: bytes) -> bool:
    """True if a file says it is a study (a design does not); it may still be a wrong one."""
    try:
        return "study" in read_toml(data, "study", "a study file", MAX_BYTES)
    except InputError:
        return False


def parse_study(data: bytes, where: str = "study") -> StudyFile:
    """The study a file holds.

    Raises
    ------
    InputError
        Naming the file or key, what was given and what is allowed.
    """
    tables = read_toml(data, where, "a study file", MAX_BYTES)
    if tables.get("study") != KIND:
        reason = "is missing" if "study" not in tables else f"{quoted(tables['study'])} is not allowed"
        raise InputError("study", f'{reason}; a study of a suborbital flight says study = "{KIND}"')
    values: dict[str, Value] = {}
    for key, content in tables.items():
        if key in ("study", "trajectory"):
            continue
        if key in INPUTS:
            values[key] = read_value(key, content)
            continue
        if key not in _SECTIONS:
            raise InputError(key, f"unknown key; a study has seed, {_sections()} and [trajectory]")
        if not isinstance(content, dict):
            raise InputError(key, f"must be a section, [{key}], not {quoted(content)}")
        for name, inner in content.items():
            full = f"{key}.{name}"
            if full not in INPUTS:
                allowed = (k.rpartition(".")[2] for k in INPUTS if k.rpartition(".")[0] == key)
                raise InputError(full, f"unknown key; [{key}] has {', '.join(allowed)}")
            values[full] = read_value(full, inner)
    return StudyFile(_settings(values, f"file {where}"), _trajectory(tables.get("trajectory")))


def _settings(values: dict[str, Value], origin: str) -> Settings:
    """Only what differs from GP-1 comes from elsewhere."""
    return DEFAULTS.change({k: v for k, v in values.items() if v != DEFAULTS[k]}, origin)


def _sections() -> str:
    return ", ".join(f"[{section}]" for section in _SECTIONS)


def _trajectory(content: Any) -> tuple[str, bytes] | None:
    if content is None:
        return None
    if not isinstance(content, dict):
        raise InputError("trajectory", f"must be a section, [trajectory], not {quoted(content)}")
    unknown = [key for key in content if key not in ("name", "csv")]
    if unknown:
        raise InputError(f"trajectory.{unknown[0]}", "unknown key; [trajectory] has name, csv")
    for key in ("name", "csv"):
        if not isinstance(content.get(key), str) or not content[key].strip():
            reason = "is missing" if key not in content else f"{quoted(content[key])} is not text in quotes"
            raise InputError(f"trajectory.{key}", reason)
    return content["name"][:200], content["csv"].encode("utf-8")


def format_study(settings: Settings, trajectory: tuple[str, bytes] | None = None) -> str:
    """TOML text of a study: every input stated, and the trajectory whole.

    Raises
    ------
    InputError
        If the trajectory is not text, which no run would have taken either.
    """
    tables: dict[str, Any] = {"study": KIND}
    for key, declared in INPUTS.items():
        section, _, name = key.rpartition(".")
        plain = isinstance(declared, BaseQuantity) and not declared.dimension
        table = tables.setdefault(section, {}) if section else tables
        table[name] = _number(settings[key]) if plain else settings.show(key, None)
    if trajectory is not None:
        name, content = trajectory
        try:
            tables["trajectory"] = {"name": name, "csv": content.decode("utf-8-sig")}
        except UnicodeDecodeError as error:
            raise InputError(name, f"not a text file (byte {error.start} is not UTF-8)") from error
    return tomli_w.dumps(tables, multiline_strings=True)


def _number(value: Any) -> float | int:
    return int(value) if float(value).is_integer() else float(value)


def to_link(settings: Settings) -> str:
    """The part of a link's query that gives the study's inputs: what differs from GP-1, and that the inertial unit is
    the design's where it is. A trajectory from a file does not fit into an address."""
    of_user = [key for key in INPUTS if not settings.origin[key].startswith(OF_DESIGN)]
    changed = [(STUDY_PREFIX + key, settings.show(key, None)) for key in of_user if settings[key] != DEFAULTS[key]]
    if follows_design(settings):
        changed.append((STUDY_PREFIX + _IMU, OF_DESIGN))
    return urlencode(changed or [(f"{STUDY_PREFIX}seed", settings.show("seed", None))])


def from_link(query: str, design: Design | None = None) -> Settings:
    """The inputs that the study's part of a link gives; of ``design`` those that it says are a design's.

    Raises
    ------
    InputError
        Naming the key that is wrong; nothing of a wrong link is used.
    """
    values: dict[str, Value] = {}
    of_design = False
    for name, text in pairs_of(query):
        key = name.removeprefix(STUDY_PREFIX)
        if key in values:
            raise InputError(key, "is given twice in the link")
        if key == _IMU:
            if text != OF_DESIGN or design is None:
                raise InputError(key, f"{quoted(text)} is not allowed. It must be {OF_DESIGN!r}.")
            of_design = True
            continue
        values[key] = read_value(key, text)
    start = from_design(DEFAULTS, design) if of_design and design is not None else DEFAULTS
    return start.change({key: value for key, value in values.items() if value != DEFAULTS[key]}, "link")
