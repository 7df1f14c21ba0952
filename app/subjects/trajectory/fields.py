"""The design's plan on the page: boxes and tables that follow it and change it."""

from collections.abc import Callable
from typing import Any

from app.document.wording import entered
from app.session import Session
from app.ui.fields import TextInput
from app.ui.row_editor import Field, RowEditor, Rows
from nav_model.base.errors import InputError
from nav_model.design.figures import FIGURES, figure_in_sentence
from nav_model.design.parts import declaration_of, labelled
from nav_model.design.table import Table
from nav_model.design.trajectory import LIMITED, line_names

_LIMIT = "line", "quantity", "limit"


def _limit_fields(lines: tuple[str, ...]) -> tuple[Field, ...]:
    """The columns of limits of single lines; a line is chosen where the plan names any."""
    quantities = tuple((name, FIGURES[name].label) for name in LIMITED)
    return (
        Field("line", "Line", choices=tuple((name, name) for name in lines), needed=True),
        Field("quantity", "Quantity", choices=quantities, needed=True),
        Field("limit", "Limit", "10°", needed=True),
    )


def _table(name: str) -> Table:
    declared = declaration_of(f"trajectory.{name}")
    assert isinstance(declared, Table)
    return declared


class PlanFields:
    """Widgets of inputs of the section [trajectory], by name. A refused text stays where it was typed, marked.

    Parameters
    ----------
    session : Session
    changed : callable
        Called when somebody has changed one, also when it is refused.
    """

    def __init__(self, session: Session, changed: Callable[[], object]) -> None:
        self._session, self._changed = session, changed
        self._boxes: dict[str, TextInput] = {}
        self._tables: dict[str, RowEditor] = {}
        self._texts: dict[str, str] = {}
        self._refused: dict[str, InputError] = {}

    def box(self, name: str, *, explained: bool = False, **look: Any) -> TextInput:
        """A box for a number, or for a table in one line; `explained` below it."""
        declared = declaration_of(f"trajectory.{name}")
        empty = "none" if getattr(declared, "allow_None", False) else getattr(declared, "example", "")
        if explained:
            look["sx"] = {"& .MuiFormHelperText-root": {"margin": "2px 0 6px"}}
            look["helper_text"] = declared.doc
        box = TextInput(label=str(declared.label), placeholder=empty, **look)
        self._boxes[name] = box
        self._show(name)

        def typed(event: Any) -> None:
            if event.new != self._texts[name] or name in self._refused:
                self._take(name, event.new)

        box.param.watch(typed, "value")
        return box

    def table(self, name: str, noun: str, more: str = "") -> RowEditor:
        """The table of an input that is one; a row of it is a `noun`; `more` to say above it."""
        declared = _table(name)
        columns = []
        for place, (key, column) in enumerate(declared.columns.items()):
            label = f"{column.label} [{column.unit}]" if column else key
            needed = not column.allow_None if column else not place
            columns.append(Field(key, f"{label[:1].upper()}{label[1:]}", needed=needed))

        def replaced(rows: Rows) -> InputError | None:
            self._take(name, [[row.get(key, "") for key in declared.columns] for row in rows])
            return self._refused.get(name)

        made = RowEditor(tuple(columns), replaced, caption=f"{declared.doc}{more}", noun=noun, ordered=True)
        self._tables[name] = made
        self._show(name)
        return made

    def limits(self) -> RowEditor:
        """The limits of single lines: a row is a line, a quantity and its limit."""

        def replaced(rows: Rows) -> InputError | None:
            of_lines: dict[str, dict[str, str]] = {}
            for number, (line, quantity, limit) in enumerate(
                ([row.get(key, "") for key in _LIMIT] for row in rows), 1
            ):
                if quantity in of_lines.setdefault(line, {}):
                    again = f"{line} has a limit on {figure_in_sentence(quantity)} already. Change or remove one."
                    return InputError(f"row {number}", again)
                of_lines[line][quantity] = limit
            keys = list(_table("limits").columns)[1:]
            self._take("limits", [[line, *(given.get(key, "") for key in keys)] for line, given in of_lines.items()])
            return self._refused.get("limits")

        made = RowEditor((), replaced, caption=_table("limits").doc, noun="limit", ordered=True)
        self._tables["limits"] = made
        self._show("limits")
        return made

    def show(self) -> None:
        """Follow the design; what was refused is forgotten where the design has another value now."""
        for name in (*self._boxes, *self._tables):
            self._show(name)

    @property
    def refused(self) -> str:
        """Why the first input that is wrong is refused; empty where all are right."""
        return str(next(iter(self._refused.values()), ""))

    def _show(self, name: str) -> None:
        design, key = self._session.design, f"trajectory.{name}"
        text = entered(design, key)
        if text != self._texts.get(name):
            self._texts[name] = text
            self._refused.pop(name, None)
            if name in self._boxes:
                self._boxes[name].value = text
        if name in self._boxes:
            self._boxes[name].error_state = name in self._refused
        if name in self._tables:
            declared, changed = _table(name), {}
            rows = [dict(zip(declared.columns, row, strict=True)) for row in declared.cells(design[key])]
            if name == "limits":
                rows = [
                    {"line": row["line"], "quantity": of, "limit": limit}
                    for row in rows
                    for of, limit in row.items()
                    if of != "line" and limit
                ]
                lines = dict.fromkeys([*line_names(design), *(row["line"] for row in rows)])
                changed["columns"] = [field._asdict() for field in _limit_fields(tuple(lines))]
            self._tables[name].param.update(rows=rows, refused=str(self._refused.get(name, "")), **changed)

    def _take(self, name: str, given: Any) -> None:
        key = f"trajectory.{name}"
        self._refused.pop(name, None)
        problem = self._session.enter(key, given)
        if problem is not None:
            self._refused[name] = labelled(problem)
        self._show(name)
        self._changed()
