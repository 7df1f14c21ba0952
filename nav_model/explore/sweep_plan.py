"""The contents of a sweep file: a design, the inputs to vary, and how they combine.

    design = "baseline.toml"               # beside this file; or a whole design under [design]
    combine = "grid"                       # grid (default): every combination; together: the lists side by side
    results = ["tilt"]                     # figures, limits of the design's own; default: what requirements limit
    rows_per_part = 2000                   # how much a crash can cost

    [vary]
    imu.preset = ["LN-200", "STIM300"]
    imu.angle_random_walk = { from = "0.01 °/√h", to = "1 °/√h", points = 50, spacing = "log" }
    gnss.position_noise = ["2 cm", "1 m"]
    requirements.tilt = ["0.01°", "0.1°"]

Presets come first: an input varied by itself overrides what a preset fills. With a section [simulate]
(`nav_model.explore.sweep_flight`) every design is also flown.
"""

import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w

from nav_model.base.errors import InputError, not_a_choice
from nav_model.base.text.toml_text import read_toml
from nav_model.design import Design, Value
from nav_model.design.declaration import BaseQuantity, Choice
from nav_model.design.figures import OF_BUDGET, REQUIRED, of_kind
from nav_model.design.file import parse_design, read_bytes
from nav_model.design.parts import PRESET_KEYS, RENAMED, declaration_of, quantity
from nav_model.design.presets import preset_fill
from nav_model.design.table import Table
from nav_model.explore.sweep_flight import SweepFlight, check_flight, read_flight

_MAX_BYTES = 1_000_000
MOST_ROWS = 50_000_000
MOST_POINTS = 100_000  # of all lists and ranges of a sweep
_ROWS_PER_PART = 2000
_FLIGHTS_PER_PART = 1  # a flight takes seconds
_FORMAT = 2  # of the parts; part of a plan's identity
_KEYS = ("design", "combine", "results", "rows_per_part", "simulate", "vary")


@dataclass(frozen=True)
class SweepAxis:
    """One input varied: what its column shows, and the changes (SI) each value makes."""

    key: str
    values: tuple[Value, ...]
    changes: tuple[Mapping[str, Value], ...]


@dataclass(frozen=True)
class SweepPlan:
    """A sweep, plain data so that it travels to any worker.

    Row n of a grid runs through the last axis fastest. ``flight`` says how every design
    is flown, None when the closed forms are enough. ``results`` are figures, and limits of the design's own.
    ``files`` are what it was made from, beside the sweep file.
    """

    design: Design
    axes: tuple[SweepAxis, ...]
    together: bool
    results: tuple[str, ...]
    rows_per_part: int
    flight: SweepFlight | None = None
    files: tuple[Path, ...] = ()

    @property
    def rows(self) -> int:
        """Number of designs."""
        lengths = [len(axis.values) for axis in self.axes]
        return lengths[0] if self.together else math.prod(lengths)

    @property
    def parts(self) -> int:
        """Number of pieces of work."""
        return -(-self.rows // self.rows_per_part)

    @property
    def identity(self) -> str:
        """SHA-256 of everything that decides the output."""
        content = {
            "format": _FORMAT,
            "design": self.design.content_hash,
            "axes": [[axis.key, axis.values, [dict(change) for change in axis.changes]] for axis in self.axes],
            "together": self.together,
            "results": self.results,
            "rows_per_part": self.rows_per_part,
        }
        if self.flight is not None:
            content["flight"] = self.flight.identity
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()

    def indices(self, start: int, stop: int) -> tuple[np.ndarray[Any, np.dtype[np.intp]], ...]:
        """For rows `start` to `stop`, the place on every axis."""
        rows = np.arange(start, stop)
        if self.together:
            return tuple(rows for _ in self.axes)
        return tuple(np.unravel_index(rows, [len(axis.values) for axis in self.axes]))


def read_plan(path: str | Path) -> SweepPlan:
    """Read a sweep file.

    Raises
    ------
    InputError
        Naming the file or key, what was given and what is allowed.
    """
    where = Path(path)
    return parse_plan(read_bytes(where, _MAX_BYTES), str(where), where.parent)


def parse_plan(data: bytes, where: str = "sweep", folder: Path = Path()) -> SweepPlan:
    """As `read_plan`, from the file's bytes; a design it names is looked for in `folder`."""
    tables = read_toml(data, where, "a sweep file", _MAX_BYTES)
    unknown = set(tables) - set(_KEYS)
    if unknown:
        raise InputError(sorted(unknown)[0], f"unknown key; a sweep file has {', '.join(_KEYS)}")
    design = _design(tables.get("design"), folder)
    combine = tables.get("combine", "grid")
    if combine not in ("grid", "together"):
        raise InputError("combine", not_a_choice(combine, ("grid", "together")), combine)
    vary = tables.get("vary")
    if not isinstance(vary, dict) or not vary:
        raise InputError("vary", 'gives no input. Try gnss.position_noise = ["2 cm", "1 m"]')
    varied = _flat(vary)
    _check_size(varied)
    axes = tuple(_axis(key, spec, design) for key, spec in varied)
    for i, axis in enumerate(axes):
        if axis.key in {other.key for other in axes[:i]}:
            raise InputError(axis.key, "is varied twice; give it one list or range")
    lengths = {axis.key: len(axis.values) for axis in axes}
    if combine == "together" and len(set(lengths.values())) > 1:
        raise InputError("combine", f"together needs lists of one length; they have {lengths}")
    flight = read_flight(tables["simulate"], folder) if "simulate" in tables else None
    size = _part_size(tables, _FLIGHTS_PER_PART if flight else _ROWS_PER_PART)
    named = (tables["design"], tables.get("simulate", {}).get("trajectory"))
    files = tuple(folder / name for name in named if isinstance(name, str))
    plan = SweepPlan(design, axes, combine == "together", _results(tables, design), size, flight, files)
    if plan.rows > MOST_ROWS:
        asked = plan.rows if plan.rows < 10**12 else f"more than 1e{len(str(plan.rows)) - 1}"
        raise InputError("vary", f"asks for {asked} designs; at most {MOST_ROWS} go in one sweep")
    if flight is not None:
        check_flight(flight, design)
    return plan


def _design(content: Any, folder: Path) -> Design:
    if isinstance(content, str):
        return parse_design(read_bytes(folder / content), content)
    if isinstance(content, dict):
        return parse_design(tomli_w.dumps(content), "design")
    raise InputError("design", "must name a design file, or hold a design's sections")


def _results(tables: Mapping[str, Any], design: Design) -> tuple[str, ...]:
    given = tables.get("results", list(REQUIRED))
    allowed = (*OF_BUDGET, *(limit.name for limit in design.limits if limit.on not in of_kind("flight")))
    if not isinstance(given, list) or not given:
        raise InputError("results", f"must be a list out of {', '.join(allowed)}")
    for name in given:
        if name not in allowed:
            raise InputError("results", not_a_choice(name, allowed), name)
    return tuple(name for name in allowed if name in given)


def _part_size(tables: Mapping[str, Any], usual: int) -> int:
    size = tables.get("rows_per_part", usual)
    if not isinstance(size, int) or isinstance(size, bool) or not 1 <= size <= 100_000:
        raise InputError("rows_per_part", f"{size!r} is not a whole number from 1 to 100000", size)
    return size


def _flat(table: Mapping[str, Any], prefix: str = "") -> list[tuple[str, Any]]:
    """Dotted keys, whether the file quotes them or nests them; those of before as they are named now."""
    pairs: list[tuple[str, Any]] = []
    for key, content in table.items():
        if isinstance(content, dict) and "from" not in content:
            pairs += _flat(content, f"{prefix}{key}.")
        else:
            pairs.append((RENAMED.get(f"{prefix}{key}", f"{prefix}{key}"), content))
    return pairs


def _check_size(varied: Sequence[tuple[str, Any]]) -> None:
    """Refuse a sweep whose lists and ranges alone would take much memory, before they are made."""
    count = 0
    for key, spec in varied:
        points = spec.get("points") if isinstance(spec, dict) else len(spec) if isinstance(spec, list) else 0
        count += points if isinstance(points, int) and points > 0 else 0
        if count > MOST_POINTS:
            raise InputError(key, f"more than {MOST_POINTS} values in all lists and ranges; give at most that many")


def _axis(key: str, spec: Any, design: Design) -> SweepAxis:
    if isinstance(spec, dict):
        return _numbers(key, _range(key, spec))
    if not isinstance(spec, list) or not spec:
        raise InputError(key, "must be a list of values, or { from = ..., to = ..., points = ... }")
    if key in PRESET_KEYS:
        section, whole = key.partition(".")[0], design.imu.sheet
        fills = [preset_fill(section, str(name), design.baseline, sheet=whole)[0] for name in spec]
        return SweepAxis(key, tuple(fill[key] for fill in fills), tuple(fills))
    declaration = _declaration(key)
    if isinstance(declaration, Choice):
        options = [declaration.read(item) for item in spec]
        return SweepAxis(key, tuple(options), tuple({key: option} for option in options))
    return _numbers(key, [declaration.read(item).value for item in spec])


def _declaration(key: str) -> BaseQuantity[Any] | Choice:
    try:
        declaration = declaration_of(key)
    except KeyError as error:
        raise InputError(key, "unknown key; an input is named as in a design file, section.name") from error
    if isinstance(declaration, Table):
        raise InputError(key, "is a table, which a sweep cannot vary; give it in the design")
    return declaration


def _numbers(key: str, values: list[float]) -> SweepAxis:
    return SweepAxis(key, tuple(values), tuple({key: value} for value in values))


def _range(key: str, spec: Mapping[str, Any]) -> list[float]:
    wrong = set(spec) - {"from", "to", "points", "spacing"}
    if wrong or not {"from", "to", "points"} <= set(spec):
        raise InputError(key, 'a range is { from = ..., to = ..., points = ..., spacing = "log" or "linear" }')
    declaration = quantity(key)
    low, high = declaration.read(spec["from"]).value, declaration.read(spec["to"]).value
    points, spacing = spec["points"], spec.get("spacing", "linear")
    if not isinstance(points, int) or isinstance(points, bool) or not 2 <= points <= MOST_POINTS:
        raise InputError(key, f"points = {points!r} is not a whole number from 2 to {MOST_POINTS}", points)
    if spacing not in ("log", "linear"):
        raise InputError(key, f"spacing {not_a_choice(spacing, ('log', 'linear'))}", spacing)
    if spacing == "log" and min(low, high) <= 0:
        raise InputError(key, "a log range must stay above zero")
    space = np.geomspace if spacing == "log" else np.linspace
    return [float(value) for value in space(low, high, points)]
