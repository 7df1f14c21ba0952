"""The table of inputs: every value with its origin, and a mark on what is not confirmed or was changed."""

from app.document.blocks import Cell, Row, TableBlock, table
from app.document.numbers import number
from app.document.wording import preset_name, printable
from nav_model.design import Design
from nav_model.design.catalogue import Entry, SourcedValue
from nav_model.design.declaration import BaseQuantity, Choice, in_sentence
from nav_model.design.parts import INPUTS, PARTS, declaration_of
from nav_model.design.presets import deviations, entry_of, sheet_of
from nav_model.design.table import Table

_MARKS_EXPLAINED = (
    "secondary: read in a source that quotes the maker. assumed: a typical value chosen for the catalogue. "
    "unconfirmed: no source found. changed: not the value of the preset. noted: the design says "
    "where it comes from, such as a log. Biases and platform figures of the catalogue are listed for information; "
    "they are not used as inputs."
)
_EXTRA_LABELS = {
    "gyro_bias": "Gyro bias on the sheet",
    "accelerometer_bias": "Accelerometer bias on the sheet",
    "speed": "Usual speed of the platform",
    "altitude": "Usual altitude of the platform",
    "longest_baseline": "Longest baseline of the sheet",
}


def input_table(design: Design, aperture_time: float, key: str) -> TableBlock:
    """Name, value and origin of every input, headed by section; aperture_time [s] is the one in force."""
    rows: list[Row] = []
    for part in (part for part in PARTS if getattr(design, part.section).given()):
        entry = entry_of(design, part.section)
        rows.append((part.title if entry is None else f"{part.title}: {_preset(design, part.section, entry)}",))
        named = INPUTS[part.section]
        if part.optional:
            named = {name: q for name, q in named.items() if design[f"{part.section}.{name}"] != q.default}
        rows += (_row(design, part.section, name, aperture_time) for name in named)
        if entry is not None:
            rows += (
                (_EXTRA_LABELS[name], _valued(value.text, value), f"{value.source} (for information)")
                for name, value in entry.extra.items()
            )
            if entry.note:
                rows.append(("Note", "", entry.note))
    return table(
        f"{key}-inputs-table",
        "Every input, with its origin",
        (("Input", 1.25), ("Value", 1), ("Origin", 1.9)),
        rows,
        _MARKS_EXPLAINED,
    )


def doubtful_inputs(design: Design) -> list[str]:
    """Inputs in force whose catalogue value is not confirmed, with their status."""
    return [
        f"{in_sentence(declaration.label)} ({sourced.status})"
        for section, names in INPUTS.items()
        if entry_of(design, section) is not None
        for name, declaration in names.items()
        if (sourced := sourced_value(design, section, name)) is not None and not sourced.confirmed
    ]


def sourced_value(design: Design, section: str, name: str) -> SourcedValue | None:
    """The catalogue's value behind an input, if that is the current value."""
    return None if name in deviations(design, section) else sheet_of(design, section).get(name)


def input_text(design: Design, section: str, name: str) -> str:
    """An input's value, exact, in the unit it was written in; empty when it is not given."""
    key = f"{section}.{name}"
    declaration, value = INPUTS[section][name], design[key]
    if value is None:
        return ""
    if isinstance(declaration, Table):
        return declaration.show(value, 6)
    if isinstance(declaration, Choice):
        return declaration.options[value]
    assert isinstance(value, float | int)
    if not declaration.dimension:
        return f"{value:g}"
    written = design.written.get(key, "")
    if converted := declaration.conversion(float(value), written, design.baseline):
        return converted
    written_as, text = declaration.write(float(value), written)
    if written_as == name:
        return str(text)
    return f"{declaration.show(float(value))} ({written_as} {text})"


def _preset(design: Design, section: str, entry: Entry) -> str:
    if section == "gnss" or deviations(design, section):
        return preset_name(design, section)
    return f"preset {entry.name}" + (f", {entry.grade}" if entry.grade else "")


def _valued(text: str, sourced: SourcedValue) -> Cell:
    kind = f", {sourced.kind}" if sourced.kind else ""
    return Cell(text + kind, "" if sourced.confirmed else sourced.status, "" if sourced.confirmed else "warn")


def _row(design: Design, section: str, name: str, aperture_time: float) -> Row:
    declaration = INPUTS[section][name]
    key = f"{section}.{name}"
    label = str(declaration.label)
    text = input_text(design, section, name)
    if not text:
        return label, Cell("not given", tone="quiet"), Cell(_absent(key, aperture_time), tone="quiet")
    if key in design.origins:
        return label, Cell(text, "noted", "good"), printable(design.origins[key])
    sourced = sourced_value(design, section, name)
    if sourced is not None:
        return label, _valued(text, sourced), sourced.source
    if sheet := sheet_of(design, section).get(name):
        return label, Cell(text, "changed", "warn"), f"stated; the preset has {sheet.text} ({sheet.status})"
    idle = isinstance(declaration, BaseQuantity) and not design.uses(key)
    is_default = key not in design.written and design[key] == declaration.default
    origin = "default" if is_default else "stated in the design"
    return label, text, Cell(f"{origin}; not in use" if idle else origin, tone="quiet" if is_default else "")


def _absent(key: str, aperture_time: float) -> str:
    if key == "radar.aperture_time":
        return f"{number(aperture_time)} s, from range, speed, resolution and window [S-3]"
    declaration = declaration_of(key)
    return declaration.when_empty if isinstance(declaration, BaseQuantity) else "none"
