"""Design files: TOML text <-> `Design`, without losing anything.

The format is fixed by the contract: sections of quantity strings. Reading names the first key that is wrong;
writing states every value in the unit it was read in, with the fewest digits that give the same float back.
"""

import re
import tomllib
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import tomli_w

from nav_model.base.errors import InputError, quoted
from nav_model.base.text.toml_text import read_toml
from nav_model.design import Design, Value
from nav_model.design.declaration import BASE_LINE, BaseQuantity
from nav_model.design.notes import noted_origins
from nav_model.design.parts import INPUTS, OUTDATED, PRESET_KEYS, RENAMED, TOP_KEYS, Input
from nav_model.design.presets import SHEET_KEYS, entry_of, preset_fill, preset_of, sheet_origins
from nav_model.design.table import Table
from nav_model.design.user_entries import ENTRY_KEYS, read_entries

ORIGINS = "origins"
"""The table of a design file that says where values came from, each under its dotted key in quotes."""
MAX_BYTES = 250_000  # a design is two kilobytes; a quarter of a second is the most that any text of this size takes
KEY_VALUE = 'KEY=VALUE, for example imu.angle_random_walk="0.3 °/√h"'
"""Form of a change on top of a file."""
_MAX_TEXT = 10_000


def read_design(path: str | Path) -> Design:
    """Read a design file.

    Raises
    ------
    InputError
        Naming the file or key, what was given and what is allowed.
    """
    return parse_design(read_bytes(path), str(path))


def read_bytes(path: str | Path, most: int = MAX_BYTES) -> bytes:
    """Content of a file, up to one byte more than it may have (by default, than a design may).

    Raises
    ------
    InputError
        If the file cannot be read.
    """
    try:
        with Path(path).open("rb") as file:
            return file.read(most + 1)
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError(str(path), f"cannot be read: {reason}") from error


def parse_design(data: bytes | str, where: str = "design", changes: Iterable[str] = ()) -> Design:
    """Design from the text of a file.

    Parameters
    ----------
    data : bytes or str
        TOML.
    where : str
        Name used when the text as a whole is wrong.
    changes : iterable of str
        Assignments such as ``'imu.angle_random_walk=0.3 °/√h'`` that override the file.

    Raises
    ------
    InputError
        As `read_design`.
    """
    return _build(_with_changes(_load(data, where), changes))


def _load(data: bytes | str, where: str) -> dict[str, Any]:
    try:
        tables = read_toml(data, where, "a design file", MAX_BYTES)
    except InputError as error:
        if isinstance(error.__cause__, tomllib.TOMLDecodeError):
            text = data if isinstance(data, str) else data.decode("utf-8-sig")
            raise _toml_error(str(error.__cause__), text, where) from error.__cause__
        raise
    for old, key in RENAMED.items():
        _rename(tables, old, key)
    if not tables:
        raise InputError(where, f"is empty; a design has sections {', '.join(f'[{s}]' for s in INPUTS)}")
    return tables


def _rename(tables: dict[str, Any], old: str, key: str) -> None:
    """Move an input under a name of before, and where it came from, to its key."""
    (section, _, name), (target, _, new) = old.rpartition("."), key.rpartition(".")
    if section in INPUTS and isinstance(table := tables.get(section), dict) and name in table:
        of_target = tables.setdefault(target, {})
        if isinstance(of_target, dict):
            if new in of_target:
                raise InputError(old, f"means the same as {key}. Give one of them.")
            of_target[new] = table.pop(name)
    if isinstance(origins := tables.get(ORIGINS), dict) and old in origins:
        origins[key] = origins.pop(old)


def _toml_error(message: str, text: str, where: str) -> InputError:
    """The parser's message with the line of the error, and the key if one was given twice."""
    place = re.search(r"\(at line (\d+), column \d+\)", message)
    lines = text.splitlines()
    number = int(place[1]) if place else len(text.rstrip().splitlines())
    line = lines[number - 1].strip() if 0 < number <= len(lines) else ""
    if message.startswith("Cannot overwrite"):
        headers = [header[1] for header in re.finditer(r"(?m)^\s*\[\s*([\w.]+)\s*\]", "\n".join(lines[:number]))]
        key = line.partition("=")[0].strip()
        return InputError(".".join((*headers[-1:], key)), f"is given twice (line {number} of {where}). Remove one.")
    excerpt = line if len(line) <= 60 else line[:57] + "..."
    return InputError(where, f"not a design file (TOML): {message}: {excerpt!r}")


def _with_changes(tables: dict[str, Any], changes: Iterable[str]) -> dict[str, Any]:
    stated: dict[str, str] = {}
    for change in changes:
        key, equals, text = change.partition("=")
        if not equals:
            raise InputError(change, f'has no "=". Write {KEY_VALUE}.')
        text = text.strip()  # in quotes as in a file, where the shell has left them
        key = key.strip()
        stated[RENAMED.get(key, key)] = text[1:-1].strip() if len(text) > 1 and text[0] == text[-1] == '"' else text
    # Presets first: a value stated beside a preset comes on top of it, whatever the order.
    for key, text in sorted(stated.items(), key=lambda change: change[0] not in PRESET_KEYS):
        section, _, name = key.rpartition(".")
        if key in TOP_KEYS:
            tables[key] = text
            continue
        if section not in INPUTS or not (key in (*PRESET_KEYS, *OUTDATED) or _input_named(section, name)):
            raise InputError(key, _unknown(section if section in INPUTS else ""))
        table = tables.setdefault(section, {})
        if not isinstance(table, dict):
            raise InputError(section, f"must be a section, [{section}]")
        if key in PRESET_KEYS:  # the new unit's values replace the file's
            for filled in preset_fill(section, text)[0].keys() - {key, BASE_LINE}:
                _drop(tables, section, filled.rpartition(".")[2])
            if section == "imu" and _whole_sheet(table):
                for key_of_sheet in SHEET_KEYS:
                    of_sensor, _, error = key_of_sheet.rpartition(".")
                    if isinstance(tables.get(of_sensor), dict):
                        _drop(tables, of_sensor, error)
        elif key not in OUTDATED:
            declared = _input_named(section, name)
            _drop(tables, section, declared[0] if declared else name)
        table[name] = text
    return tables


def _drop(tables: dict[str, Any], section: str, name: str) -> None:
    """Forget what the file states for an input, and where it says the value came from."""
    declaration = INPUTS[section][name]
    table = tables[section]
    table.pop(name, None)
    if isinstance(declaration, BaseQuantity) and declaration.alternative:
        table.pop(declaration.alternative.key, None)
    if isinstance(tables.get(ORIGINS), dict):
        tables[ORIGINS].pop(f"{section}.{name}", None)


def _build(tables: dict[str, Any]) -> Design:
    values: dict[str, Value] = {}
    written: dict[str, str] = {}
    entries = read_entries(tables)
    for key, content in tables.items():
        if key in ENTRY_KEYS:
            continue
        if key in TOP_KEYS:
            values[key] = _text(key, content)
        elif key not in (*INPUTS, ORIGINS):
            raise InputError(key, _unknown(""))
        elif not isinstance(content, dict):
            raise InputError(key, f"must be a section, [{key}], not {quoted(content)}", content)
    for section in INPUTS:
        _read_section(section, tables.get(section, {}), values, written)
    outdated = tuple(key for key in OUTDATED if key.partition(".")[2] in tables.get(key.partition(".")[0], {}))
    design = Design(values, written, outdated=outdated, entries=entries)
    origins = tables.get(ORIGINS) or noted_origins(design)
    if design.imu.sheet and isinstance(origins, dict) and (entry := entry_of(design, "imu")):
        given = {f"{section}.{name}" for section in ("gyro", "accelerometer") for name in tables.get(section, {})}
        origins = {k: v for k, v in sheet_origins(entry).items() if k not in given} | origins
    if isinstance(origins, dict):
        origins = {key: origin for key, origin in origins.items() if key not in OUTDATED}
    return design.replace({}, origins=origins) if origins else design


def _read_section(section: str, table: dict[str, Any], values: dict[str, Value], written: dict[str, str]) -> None:
    given: dict[str, str] = {}
    baseline = None
    if section == "gnss" and "baseline" in table:
        baseline = INPUTS[section]["baseline"].read(table["baseline"]).value
    for name, content in table.items():
        key = f"{section}.{name}"
        if key in (*PRESET_KEYS, *OUTDATED):
            continue
        declared = _input_named(section, name)
        if declared is None:
            raise InputError(key, _unknown(section))
        target, declaration = declared
        if target in given:
            raise InputError(key, f"means the same as {section}.{given[target]}. Give one of them.")
        given[target] = name
        if isinstance(declaration, BaseQuantity):
            parsed = declaration.read(content, name, baseline)
            values[f"{section}.{target}"], written[f"{section}.{target}"] = parsed
        else:
            values[f"{section}.{target}"] = declaration.read(content)
    if f"{section}.preset" in PRESET_KEYS and "preset" in table:
        name = _text(f"{section}.preset", table["preset"])
        preset_values, preset_written = preset_fill(section, name, baseline, sheet=_whole_sheet(table))
        for key, value in preset_values.items():
            if key.rpartition(".")[2] not in given or key in SHEET_KEYS:
                values[key], written[key] = value, preset_written.get(key, "")
        if section == "imu":
            _refuse_gap(name, values)
        values[f"{section}.preset"] = preset_values[f"{section}.preset"]


def _whole_sheet(table: Mapping[str, Any]) -> bool:
    """True if a section [imu] has its catalogue's unit fill what its sheet prints beside the random walks."""
    return "sheet" in table and bool(INPUTS["imu"]["sheet"].read(table["sheet"]))


def _refuse_gap(preset: str, values: Mapping[str, Value]) -> None:
    """Refuse a sensor whose data sheet lacks a required value: it must not silently take a default."""
    for name in ("velocity_random_walk", "angle_random_walk"):
        if f"imu.{name}" not in values:
            raise InputError(f"imu.{name}", f"The catalogue has no value for {preset!r}. Give it in the file.")


def _text(key: str, content: Any) -> str:
    if not isinstance(content, str):
        raise InputError(key, f"{quoted(content)} is not text in quotes", content)
    if len(content) > _MAX_TEXT:
        raise InputError(key, f"longer than {_MAX_TEXT} characters")
    try:
        content.encode()
    except UnicodeEncodeError as error:  # bytes of a command line that are no text
        raise InputError(key, f"{quoted(content)} is not Unicode text", content) from error
    return content


def _input_named(section: str, name: str) -> tuple[str, Input] | None:
    for target, declaration in INPUTS[section].items():
        if target == name:
            return target, declaration
        if isinstance(declaration, BaseQuantity) and declaration.alternative and declaration.alternative.key == name:
            return target, declaration
    return None


def _unknown(section: str) -> str:
    if not section:
        sections = (f"[{name}]" for name in (*INPUTS, ORIGINS, "[contributors]", "[limits]", "allocation"))
        return f"unknown key; allowed are {', '.join((*TOP_KEYS, *sections))}"
    preset = ["preset"] if f"{section}.preset" in PRESET_KEYS else []
    return f"unknown key; [{section}] has {', '.join((*preset, *INPUTS[section]))}"


def format_design(design: Design) -> str:
    """TOML text of a design: every value stated, in the unit it was given in, with its origin if it has one."""
    tables: dict[str, Any] = {key: design[key] for key in TOP_KEYS if design[key]}
    for section, declarations in INPUTS.items():
        if not getattr(design, section).given():
            continue
        table: dict[str, Any] = {}
        if design_preset := preset_of(design, section):
            table["preset"] = design_preset
        for name, declaration in declarations.items():
            value = design[f"{section}.{name}"]
            if value is None or value == ():
                continue
            if isinstance(declaration, BaseQuantity):
                assert isinstance(value, float | int)
                name, value = declaration.write(
                    float(value), design.written.get(f"{section}.{name}", ""), design.baseline
                )
            elif isinstance(declaration, Table):
                assert isinstance(value, tuple)
                table[name] = declaration.write(value)
                continue
            table[name] = value
        tables[section] = table
    if design.origins:
        tables[ORIGINS] = dict(design.origins)
    return tomli_w.dumps(tables | design.entries.tables())
