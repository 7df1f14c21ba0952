"""A design as a short URL query and back.

Only what differs from the defaults (or from the presets named) is written, under short names and in ASCII
units: ``imu=LN-200&gn=3cm&f=1.3GHz``. Where a value came from follows under ``origin.`` and its short name:
``origin.arw=datasheet``. Contributors, limits and allocation are JSON of what a design file has. Reading it gives an
equal design with the same origins.
"""

import json
from functools import lru_cache
from typing import Any
from urllib.parse import parse_qsl, quote_plus, unquote_plus, urlencode

from nav_model.base.errors import InputError
from nav_model.design import Design, Value
from nav_model.design.declaration import BaseQuantity
from nav_model.design.notes import noted_origins
from nav_model.design.parts import INPUTS, OUTDATED, PRESET_KEYS, RENAMED, TOP_KEYS, Gnss, Imu
from nav_model.design.presets import preset_fill
from nav_model.design.rows import Rows
from nav_model.design.table import Table
from nav_model.design.user_entries import ENTRY_KEYS, read_entries

_MOST_FIELDS = 500  # there are not half as many names
MAX_QUERY = 16_000  # characters; browsers and proxies cut longer addresses
STUDY_PREFIX = "study."
"""Start of the names of a suborbital study's inputs, where they stand beside a design's."""
SETTINGS = ("simulation", "trajectory", "sar", "explore", "close", "search", "map", "uncertainty", "review")
"""The studies, questions and reviews whose settings stand beside a design's inputs, their names behind a point:
``sar.runs=200``."""
_ORIGIN_PREFIX = "origin."
_NONE = "none"
_BASE_LINE = Gnss.param.baseline
_SHEET = Imu.param.sheet
_SHORT: dict[str, str] = {
    declaration.short: f"{section}.{name}"
    for section, inputs in INPUTS.items()
    for name, declaration in inputs.items()
}
_SHORT_OF = {key: short for short, key in _SHORT.items()}
_ARE_INPUTS = "simulation.states", "trajectory.states", "simulation.added"
"""Settings of studies, in links of before, that are inputs of the design."""
_OUTDATED = {short: key for key, (short, _) in OUTDATED.items()}
_PRESET_SHORT = {key.partition(".")[0]: key for key in PRESET_KEYS}
_TO_ASCII = {"√Hz": "sqrt(Hz)", "√h": "sqrt(h)", "√s": "sqrt(s)", "µ": "u", "°": "deg", "²": "^2", " ": ""}


def to_query(design: Design) -> str:
    """The query of a link to the design, without the question mark."""
    pairs: list[tuple[str, str]] = [(key, str(design[key])) for key in TOP_KEYS if design[key]]
    named = tuple((short, str(design[key])) for short, key in _PRESET_SHORT.items() if isinstance(design[key], str))
    pairs += named
    base = _of_presets(named, design.baseline, sheet=design.imu.sheet)
    for short, key in _SHORT.items():
        value = design[key]
        if value != base[key] or type(value) is not type(base[key]):
            pairs.append((short, _to_text(key, value, design)))
    pairs += [(_ORIGIN_PREFIX + short, design.origins[key]) for short, key in _SHORT.items() if key in design.origins]
    for key, table in design.entries.tables().items():
        pairs.append((key, json.dumps(table, ensure_ascii=False, separators=(",", ":"))))
    return urlencode(pairs, safe="()/^-.:", quote_via=quote_plus)


@lru_cache(maxsize=64)
def _of_presets(named: tuple[tuple[str, str], ...], baseline: float | None, *, sheet: bool) -> Design:
    """The design of these presets, each with its short name, at a baseline, and of defaults."""
    design = Design()
    for short, name in named:
        design = design.replace(preset_fill(short, name, baseline, sheet=sheet)[0])
    return design


def split_link(query: str) -> tuple[str, str]:
    """A link's query in two: the design's part, and the studies' settings. Nothing is validated here."""
    parts = query.removeprefix("?").split("&")
    prefixes = (STUDY_PREFIX, *(f"{kind}." for kind in SETTINGS))
    study = [part for part in parts if part.startswith(prefixes)]
    of_design = [part for part in parts if not part.startswith(prefixes)]
    moved = {key: text for part in study for key, text in _inputs_now(part)}
    names = {part.partition("=")[0] for part in of_design}
    of_design += [urlencode({_SHORT_OF[key]: text}) for key, text in moved.items() if _SHORT_OF[key] not in names]
    return "&".join(of_design), "&".join(part for part in study if part.partition("=")[0] not in _ARE_INPUTS)


def _inputs_now(setting: str) -> list[tuple[str, str]]:
    """Keys and texts of the inputs that a study's setting of before has become."""
    name, _, text = setting.partition("=")
    if name.endswith(".states") and name in _ARE_INPUTS:
        return [("filter.states", text)]
    if name not in _ARE_INPUTS:
        return []
    pairs = ((RENAMED.get(key, key), value) for key, value in parse_qsl(unquote_plus(text)))
    return [(key, value) for key, value in pairs if key in _SHORT_OF]


def pairs_of(query: str) -> list[tuple[str, str]]:
    """Keys and values of a link's query, in its order.

    Raises
    ------
    InputError
        If it is too long or no query.
    """
    if len(query) > MAX_QUERY:
        raise InputError("link", f"longer than {MAX_QUERY} characters")
    try:
        return parse_qsl(
            query.removeprefix("?"), keep_blank_values=True, strict_parsing=True, errors="strict",
            max_num_fields=_MOST_FIELDS,
        )  # fmt: skip
    except (ValueError, UnicodeDecodeError) as error:
        raise InputError("link", "not a query of the form key=value&key=value") from error


def from_query(query: str) -> Design:
    """The design a link's query describes.

    Raises
    ------
    InputError
        Naming the key that is wrong; nothing of a wrong link is used.
    """
    pairs = pairs_of(query)
    values: dict[str, Value] = {}
    written: dict[str, str] = {}
    origins: dict[str, str] = {}
    baseline = None
    entries: dict[str, Any] = {}
    names = [short for short, _ in pairs]
    for short in names:
        if names.count(short) > 1:
            raise InputError(short, "is given twice in the link")
    if (base := dict(pairs).get(_BASE_LINE.short, _NONE)) != _NONE:
        baseline = _BASE_LINE.read(base).value
    whole = bool(_SHEET.read(dict(pairs).get(_SHEET.short, "false")))
    for short, text in pairs:
        if short in _PRESET_SHORT:
            filled, units = preset_fill(short, text, baseline, sheet=whole)
            values |= filled
            written |= units
    for short, text in pairs:
        if short in TOP_KEYS:
            values[short] = text
        elif short in ENTRY_KEYS:
            entries[short] = _tables(short, text)
        elif short.removeprefix(_ORIGIN_PREFIX) in _SHORT and short.startswith(_ORIGIN_PREFIX):
            origins[_SHORT[short.removeprefix(_ORIGIN_PREFIX)]] = text
        elif short not in _PRESET_SHORT and short.removeprefix(_ORIGIN_PREFIX) not in _OUTDATED:
            if short not in _SHORT:
                raise InputError(short, "unknown in a link. Copy the link from its page again.")
            _read(_SHORT[short], text, values, written)
    outdated = tuple(_OUTDATED[short] for short in names if short in _OUTDATED)
    design = Design(values, written, outdated=outdated, entries=read_entries(entries))
    return design.replace({}, origins=origins or noted_origins(design))


def _tables(key: str, text: str) -> Any:
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(key, "is not JSON", text) from error


def _read(key: str, text: str, values: dict[str, Value], written: dict[str, str]) -> None:
    section, _, name = key.rpartition(".")
    declaration = INPUTS[section][name]
    if not isinstance(declaration, BaseQuantity):
        values[key] = declaration.read(text)
    elif text == _NONE and declaration.allow_None:
        values[key] = None
    else:
        values[key], written[key] = declaration.read(text)


def _to_text(key: str, value: Any, design: Design) -> str:
    section, _, name = key.rpartition(".")
    declaration = INPUTS[section][name]
    if value is None:
        return _NONE
    if isinstance(declaration, Rows):
        text = declaration.link(value)
    elif isinstance(declaration, Table):
        return declaration.link(value)  # its names may have spaces
    elif isinstance(declaration, BaseQuantity):
        text = str(declaration.write(float(value), design.unit(key) if declaration.dimension else "")[1])
    else:
        return str(value).lower()
    for symbol, spelling in _TO_ASCII.items():
        text = text.replace(symbol, spelling)
    return text
