"""Random designs, and tables for their inputs that are tables."""

from typing import Any

from hypothesis import strategies as st

from nav_model.base.dimensions import DIMENSIONS
from nav_model.design import Design
from nav_model.design.catalogue import catalogue
from nav_model.design.declaration import BaseQuantity
from nav_model.design.parts import INPUTS
from nav_model.design.presets import preset_fill
from nav_model.design.rows import Rows
from nav_model.design.table import MOST_ROWS, Table

_NAMES = st.text(st.characters(exclude_categories=["C", "Z"], exclude_characters=",;="), max_size=12)


def rows_of(declaration: Table, most: int = MOST_ROWS) -> st.SearchStrategy[tuple[tuple[Any, ...], ...]]:
    """Strategy: any value of a table, up to this many rows."""
    most = min(most, declaration.most)
    if not isinstance(declaration, Rows):
        row = (_cell(column) for column in declaration.columns.values())
        rows = st.tuples(*row).filter(lambda cells: any(cell not in (None, "") for cell in cells[1:]))
        return st.lists(rows, max_size=most).map(tuple)
    frequency, amount = st.floats(1e-3, 1e6), st.floats(1e-12, 10.0)
    if not declaration.curve:
        kinds = st.sampled_from(declaration.dimensions)
        return st.lists(st.tuples(frequency, amount | st.just(0.0), kinds), max_size=most).map(tuple)

    def table(kind: str, rows: dict[float, float]) -> tuple[tuple[float, float, str], ...]:
        return tuple((at, rows[at], kind) for at in sorted(rows)) if len(rows) > 1 else ()

    rows = st.dictionaries(frequency, amount, max_size=most)
    return st.builds(table, st.sampled_from(declaration.dimensions), rows)


def _cell(column: Any) -> st.SearchStrategy[Any]:
    """A cell of a column: a text, or a number within its bounds; perhaps none where it may be left out."""
    if column is None:
        return _NAMES.map(lambda text: " ".join(text.split())) | st.sampled_from(["line 1", "<b>é & co</b>"])
    number = st.floats(*column.limits)
    return st.none() | number if column.allow_None else number


@st.composite
def any_design(draw: st.DrawFn, reciprocals: bool = False) -> Design:
    """Any design at all, on presets or none, its values in any of their units, or as the reciprocal input."""
    values: dict[str, Any] = {"name": draw(st.text(max_size=30)), "description": draw(st.text(max_size=60))}
    written: dict[str, str] = {}
    for section in ("imu", "radar"):
        names = [n for n, e in catalogue(section).items() if section == "radar" or len(e.values) == 2]
        if name := draw(st.none() | st.sampled_from(names)):
            values |= preset_fill(section, name)[0]
    for section, inputs in INPUTS.items():
        for name, declaration in inputs.items():
            key = f"{section}.{name}"
            if isinstance(declaration, Table):
                values[key] = draw(rows_of(declaration, 9))
            elif not isinstance(declaration, BaseQuantity):
                values[key] = draw(st.sampled_from(declaration.objects))
            elif draw(st.booleans()):
                low, high = declaration.limits
                include_low, include_high = declaration.inclusive_bounds
                values[key] = draw(st.floats(low, high, exclude_min=not include_low, exclude_max=not include_high))
                if declaration.dimension:
                    units = list(DIMENSIONS[declaration.dimension].units)
                    if reciprocals and declaration.alternative:
                        other = declaration.alternative
                        units += [f"{other.key}:{unit}" for unit in DIMENSIONS[other.dimension].units]
                    written[key] = draw(st.sampled_from(units))
    return Design(values, written)
