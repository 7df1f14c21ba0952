"""The budget as a spreadsheet whose real-time values are live formulas of its input cells.

Formulas are the model's own (`app.report.workings`), each written with its value, so that a viewer that does
not recalculate shows the right numbers. What has no formula is a value that says so, and goes grey beside other
inputs.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from importlib.metadata import version
from io import BytesIO
from typing import Any, NamedTuple, cast

import numpy as np
from xlsxwriter import Workbook
from xlsxwriter.utility import xl_rowcol_to_cell

from app.document.numbers import percent
from app.document.verdict import SAID
from app.document.wording import printable, title_of
from app.report.inputs import shown_value
from app.report.workings import RULE, Traces, own_key, symbol_of
from nav_model.analytic.refined_coast import longest_rule
from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.units import from_si
from nav_model.budget import Budget
from nav_model.budget.figures import figures
from nav_model.budget.inputs import inputs_of
from nav_model.budget.verdict import Check
from nav_model.design import Design
from nav_model.design.declaration import BaseQuantity, Choice
from nav_model.design.figures import FIGURES, REQUIRED, label_of
from nav_model.design.parts import INPUTS, declaration_of
from nav_model.design.processing import POST_PROCESSED, REAL_TIME

LIVE, OTHER, TAKEN = "live formula", "from other inputs", "value, not a formula"
"""What the column "State" says."""

_CHANGED = "inputs_changed"


def workbook_bytes(budget: Budget) -> bytes:
    """The workbook of one design."""
    file = BytesIO()
    # Texts are never taken for formulas, numbers or links, whatever a name begins with.
    options = {"in_memory": True, "strings_to_formulas": False, "strings_to_urls": False, "strings_to_numbers": False}
    with Workbook(file, options) as book:
        book.set_properties(
            {"title": printable(title_of(budget.design)), "comments": f"NavBudget {version('navbudget')}"}
        )
        _Sheets(book, budget).write()
    return file.getvalue()


class _Sheets:
    """The sheets of a workbook, written one after the other."""

    def __init__(self, book: Workbook, budget: Budget) -> None:
        self.book, self.budget, self.design = book, budget, budget.design
        self.traces = Traces(budget.design)
        self.cells = self.traces.workings
        self.bold = book.add_format({"bold": True})
        self.head = book.add_format({"bold": True, "bottom": 1, "text_wrap": True, "valign": "top"})
        self.number = book.add_format({"num_format": "0.000E+00"})
        self.figure = book.add_format({"num_format": "[<0.01]0.00E+00;0.000"})
        self.level = book.add_format({"num_format": "0.00"})
        self.percent = book.add_format({"num_format": "+0.0%;-0.0%"})
        self.share = book.add_format({"num_format": "0.0%"})
        self.apart = book.add_format({"indent": 1})
        self.entry = book.add_format({"bg_color": "#FFF8DC", "border": 1, "border_color": "#BBBBBB", "locked": False})
        self.grey = book.add_format({"font_color": "#8A8A8A", "italic": True})
        self.title = book.add_format({"bold": True, "font_size": 16, "font_color": "#FFFFFF", "bg_color": "#1A5580"})
        self.good = book.add_format({"font_color": "#00654A", "bold": True})
        self.bad = book.add_format({"font_color": "#B00020", "bold": True})

    def write(self) -> None:
        names = ("Budget", "Inputs", "Sources", "Sums", "Post-processed", "Workings", "Rule")
        sheets = {name: self.book.add_worksheet(name) for name in names}
        self._inputs(sheets["Inputs"])
        self._workings(sheets["Workings"])
        self._rule(sheets["Rule"])
        self._sources(sheets["Sources"])
        self._sums(sheets["Sums"])
        self._verdict(sheets["Budget"], live=True)
        self._verdict(sheets["Post-processed"], live=False)
        sheets["Budget"].activate()

    def _start(self, sheet: Any, title: str, columns: Mapping[str, float], lines: Sequence[str] = ()) -> int:
        """Title, sentences and heads of the columns; the row after them."""
        sheet.set_row(0, 24)
        sheet.write_row(0, 0, (title, *[""] * (len(columns) - 1)), self.title)
        sheet.write_column(1, 0, lines)
        sheet.set_landscape()
        sheet.repeat_rows(len(lines) + 2)
        sheet.fit_to_pages(1, 0)
        row = len(lines) + 2
        sheet.set_row(row, 30)  # two lines, which not every program finds out
        sheet.write_row(row, 0, columns, self.head)
        for column, (name, width) in enumerate(columns.items()):
            sheet.set_column(
                column, column, width, self.apart if name in ("Unit", "Met", "Equation", "What it is") else None
            )
        sheet.freeze_panes(row + 1, 1)
        return row + 1

    def _name(self, symbol: str, sheet: str, row: int, column: int) -> None:
        self.book.define_name(symbol, f"='{sheet}'!{xl_rowcol_to_cell(row, column, True, True)}")

    # -- inputs -----------------------------------------------------------------------------------------------------

    def _inputs(self, sheet: Any) -> None:
        columns = {
            "Input": 38, "Value": 14, "Unit": 12, "In SI": 14, "As computed": 14, "Changed": 10, "What it is": 60,
        }  # fmt: skip
        row = first = self._start(
            sheet, f"Inputs of {printable(title_of(self.design))}", columns,
            ("Change the yellow cells. The formulas of the other sheets follow them.",
             "An empty cell is an input that is not given, or a limit that is not checked."),
        )  # fmt: skip
        fixed = []
        for section, names in INPUTS.items():
            for name, declared in names.items():
                key = f"{section}.{name}"
                if key in self.traces.followed or section == "requirements":
                    self._input(sheet, row, key)
                    if section != "requirements":  # another than as computed
                        sheet.write_formula(row, 5, f"=IF(B{row + 1}=E{row + 1},0,1)", None, 0)
                    row += 1
                elif getattr(self.design, section).given():
                    fixed.append((str(declared.label), shown_value(self.design, section, name)))
        for number, limit in enumerate(self.design.limits, 1):
            unit = _Unit.of(limit.unit, limit.dimension)
            self._entry(sheet, row, own_key(number), limit.name, limit.value, unit, "Requirement of your own")
            row += 1
        sheet.write(row + 1, 0, "Inputs changed")
        sheet.write_formula(row + 1, 1, f"=SUM(F{first + 1}:F{row})>0", None, False)
        self._name(_CHANGED, "Inputs", row + 1, 1)
        sheet.write(row + 3, 0, "Fixed here: the formulas do not follow these. Change them in NavBudget.", self.bold)
        for at, line in enumerate(fixed, row + 4):
            sheet.write_row(at, 0, line)

    def _input(self, sheet: Any, row: int, key: str) -> None:
        declaration, unit = declaration_of(key), _unit_of(self.design, key)
        if isinstance(declaration, Choice):
            allowed: dict[str, Any] = {"validate": "list", "source": [*declaration.options]}
            doc = "; ".join(f"{option}: {label}" for option, label in declaration.options.items())
        else:
            assert isinstance(declaration, BaseQuantity)
            low, high = map(unit.number, declaration.limits)
            allowed = {
                "validate": "decimal", "criteria": "between", "minimum": low, "maximum": high,
                "error_title": "Not allowed", "error_message": declaration.allowed(unit.symbol)[:255],
            }  # fmt: skip
            doc = str(declaration.doc or "").split(". ")[0]
        sheet.data_validation(row, 1, row, 1, allowed)
        self._entry(sheet, row, symbol_of(key), str(declaration.label), self.design[key], unit, doc)

    def _entry(self, sheet: Any, row: int, symbol: str, label: str, value: Any, unit: "_Unit", doc: str) -> None:
        """A cell to change, in SI under its name, and what it is as computed."""
        number, cell = None if value is None else unit.number(value), f"B{row + 1}"
        sheet.write_row(row, 0, (label, None, unit.symbol, None, number, None, doc))
        sheet.write(row, 1, number, self.entry)
        in_si = f'=IF({cell}="","",{unit.to_si(cell)})'
        sheet.write_formula(row, 3, in_si, self.number, "" if value is None else value)
        self._name(symbol, "Inputs", row, 3)

    # -- what formulas make of them ---------------------------------------------------------------------------------

    def _workings(self, sheet: Any) -> None:
        columns = {"Quantity": 46, "Name": 30, "Value": 16, "Unit": 10, "Equation": 16, "State": 22}
        first = self._start(sheet, "From the inputs to every figure, step by step", columns)
        for row, line in enumerate(self.cells.rows, first):
            if not line.text:
                sheet.write(row, 0, line.label, self.bold)
                continue
            sheet.write_row(row, 0, (line.label, line.symbol, None, line.unit, line.mark))
            if line.taken and line.text == repr(line.value):
                sheet.write(row, 2, line.value, self.number)
            else:
                sheet.write_formula(row, 2, f"={line.text}", self.number, line.value)
            if line.symbol:
                self._name(line.symbol, "Workings", row, 2)
                self._state(sheet, row, 5, taken=line.taken)
        self._greyed(sheet, f"A{first + 1}:F{row + 1}", f"$F{first + 1}")

    def _rule(self, sheet: Any) -> None:
        sheet.write(0, 0, "Nodes and weights that integrate the squared responses of the outage [T-17]", self.bold)
        for letter, symbol, values in zip("AB", RULE, longest_rule(), strict=True):
            sheet.write(f"{letter}2", symbol, self.head)
            sheet.write_column(f"{letter}3", values)
            self.book.define_name(symbol, f"=Rule!${letter}$3:${letter}${len(values) + 2}")

    def _state(self, sheet: Any, row: int, column: int, *, taken: bool) -> None:
        """Whether a value follows the inputs; in words, since grey alone is not enough."""
        if taken:
            sheet.write_formula(row, column, f'=IF({_CHANGED},"{OTHER}","{TAKEN}")', None, TAKEN)
        else:
            sheet.write(row, column, LIVE)

    def _greyed(self, sheet: Any, cells: str, state: str) -> None:
        sheet.conditional_format(cells, {"type": "formula", "criteria": f'={state}="{OTHER}"', "format": self.grey})

    def _sources(self, sheet: Any) -> None:
        parts, cell = ("quadratic", "cubic", "detrended"), self.cells.cell
        columns = {"Source": 30} | {f"{part.capitalize()} phase, 1σ [°]": 16 for part in parts}
        columns |= {f"Share of {part}": 14 for part in parts} | {"Equation": 16, "State": 22}
        first = self._start(sheet, "Phase over the aperture by source, in real time", columns)
        for row, (source, line) in enumerate(self.traces.sources.items(), first):
            variances = [getattr(line, part) for part in parts]
            sheet.write(row, 0, source)
            for column, (part, variance) in enumerate(zip(parts, variances, strict=True), 1):
                self._part_of(sheet, row, column, f"{part}_phase", cell("to_phase") * np.sqrt(variance))
            sheet.write(row, 7, "[S-5], [S-6]")
            self._state(sheet, row, 8, taken=any(variance.taken for variance in variances))
        row = first + len(self.traces.sources)
        for column, part in enumerate(parts, 1):
            for entry in self.traces.contributors.get(f"{part}_phase", ()):
                sheet.write(row, 0, entry.name)
                self._part_of(sheet, row, column, f"{part}_phase", entry.size, systematic=entry.systematic)
                self._state(sheet, row, 8, taken=False)
                row += 1
        sheet.write(row, 0, "Sum", self.bold)
        for column, part in enumerate(parts, 1):
            whole = np.degrees(cell(f"real_time_{part}_phase"))
            sheet.write_formula(row, column, f"={whole.text}", self.figure, float(whole.value))
        self._greyed(sheet, f"A{first + 1}:I{row + 1}", f"$I{first + 1}")

    def _part_of(self, sheet: Any, row: int, at: int, figure: str, size: Any, *, systematic: bool = False) -> None:
        """The 1σ of a source or a contributor of a phase, and its share: a systematic one adds linearly to the root
        of what is random."""
        degrees, whole = np.degrees(size), self.cells.cell(f"real_time_{figure}")
        root = self.cells.cell(f"root_{figure}") if figure in self.traces.contributors else whole
        sheet.write_formula(row, at, f"={degrees.text}", self.figure, float(degrees.value))
        with np.errstate(invalid="ignore"):  # of a phase that is zero
            share = size / whole if systematic else size**2 / (whole * root)
        formula = f"=IF({whole.text}=0,0,{share.text})"
        sheet.write_formula(row, at + 3, formula, self.share, float(share.value) if whole.value else 0.0)

    def _sums(self, sheet: Any) -> None:
        columns = {"Figure, in real time, 1σ": 62, "Value": 16, "Unit": 10, "Equation": 16, "State": 22}
        first = row = self._start(sheet, "Every figure of the budget in real time", columns)
        for row, (symbol, dimension) in enumerate(self.traces.sums.items(), first):
            line, figure = self.cells.named[symbol], symbol.removeprefix("real_time_")
            key = REQUIRED.get(figure)
            unit = _unit_of(self.design, f"requirements.{key}") if key else _Unit.of("", dimension)
            sheet.write_row(row, 0, (line.label, None, unit.symbol, line.mark))
            look = self.level if unit.symbol == "dB" else self.figure
            sheet.write_formula(row, 1, f"={unit.from_si(symbol)}", look, unit.number(line.value))
            self._state(sheet, row, 4, taken=line.taken)
        self._greyed(sheet, f"A{first + 1}:E{row + 1}", f"$E{first + 1}")

    # -- limits and margins -----------------------------------------------------------------------------------------

    def _verdict(self, sheet: Any, *, live: bool) -> None:
        processing = REAL_TIME if live else POST_PROCESSED
        both = self.budget.verdict, self.budget.other_verdict
        verdict = next(verdict for verdict in both if verdict.processing == processing)
        names = (*REQUIRED, *(limit.name for limit in self.design.limits))
        fixed = {} if live else figures(replace(inputs_of(self.design), processing=POST_PROCESSED), names)
        columns = {
            "Requirement": 38, "Value, 1σ": 14, "Factor": 8, "Value checked": 14, "Limit": 12, "Unit": 8,
            "Margin": 10, "Met": 12, "Equation": 16, "State": 22, "Main error source (as computed)": 40,
        }  # fmt: skip
        lines = (
            "",
            "Values are live formulas of the sheet Inputs, unless the column State says otherwise."
            if live
            else "NavBudget computed these values from the column As computed of Inputs; no formula does.",
        )
        first = row = self._start(sheet, f"{printable(title_of(self.design))}, {SAID[processing]}", columns, lines)
        checks = {check.name: check for check in verdict.checks}
        for row, name in enumerate(names, first):
            self._check(sheet, row, name, checks.get(name), fixed.get(name))
        letters = f"H{first + 1}:H{row + 1}"
        otherwise = f'IF(COUNTIF({letters},"met")>0,"Closes","Not checked")'
        closes = f'IF(COUNTIF({letters},"not met")>0,"Does not close",{otherwise})'
        cached = ("Closes" if verdict.closes else "Does not close") if checks else "Not checked"
        sheet.write_formula(1, 0, f"={closes}", self.bold, cached)
        if live:
            self._name("verdict_in_real_time", "Budget", 1, 0)
        self._greyed(sheet, f"A{first + 1}:K{row + 1}", f"$J{first + 1}")
        for word, form in (("not met", self.bad), ("met", self.good)):  # the margin beside it too
            rule = {"type": "formula", "criteria": f'=$H{first + 1}="{word}"', "format": form}
            sheet.conditional_format(f"G{first + 1}:H{row + 1}", rule)
        for word, form in (("Does not close", self.bad), ("Closes", self.good)):
            sheet.conditional_format("A2", {"type": "formula", "criteria": f'=$A$2="{word}"', "format": form})
        sheet.print_area(0, 0, row, len(columns) - 1)

    def _check(self, sheet: Any, row: int, name: str, check: Check | None, fixed: Any) -> None:
        """One requirement: its limit is a cell of Inputs, its value that of real time or a `fixed` number."""
        at = row + 1
        if name in REQUIRED:
            key = f"requirements.{REQUIRED[name]}"
            unit, limit, given = _unit_of(self.design, key), symbol_of(key), cast("float | None", self.design[key])
            symbol, follows = f"real_time_{name}", True
        else:
            number, limit_of = next((n, item) for n, item in enumerate(self.design.limits, 1) if item.name == name)
            unit, limit, given = _Unit.of(limit_of.unit, limit_of.dimension), own_key(number), limit_of.value
            symbol, follows = f"real_time_{limit}", limit_of.confidence is None
            if symbol not in self.cells.named:  # a figure that has a cell already
                symbol = f"real_time_{limit_of.on}"
        line = self.cells.named[symbol]
        usual = self.design.requirements.confidence
        confidence = check.confidence if check else usual if name not in FIGURES or FIGURES[name].scaled else None
        factor = confidence or 1.0
        formula = "=1" if confidence is None else "=requirements_confidence" if follows else f"={factor!r}"
        sigma = float(line.value if fixed is None else fixed)
        checked = factor * sigma
        look = self.level if unit.symbol == "dB" else self.figure
        sheet.write(row, 0, label_of(name))
        if fixed is None:
            sheet.write_formula(row, 1, f"={unit.from_si(symbol)}", look, unit.number(sigma))
        else:
            sheet.write(row, 1, unit.number(sigma), look)
        sheet.write_formula(row, 2, formula, None, factor)
        sheet.write_formula(row, 3, f"=B{at}*C{at}", look, unit.number(checked))
        allowed = "" if given is None else unit.number(given)
        sheet.write_formula(row, 4, f'=IF({limit}="","",{unit.from_si(limit)})', look, allowed)
        sheet.write(row, 5, unit.symbol)
        margin: Any = "" if given is None else 1 - checked / given
        of_limit = f"{unit.to_si(f'D{at}')}/({unit.to_si(f'E{at}')})"
        sheet.write_formula(row, 6, f'=IF({limit}="","",1-{of_limit})', self.percent, margin)
        met = "not checked" if given is None else "met" if checked <= given else "not met"
        sheet.write_formula(row, 7, f'=IF({limit}="","not checked",IF(G{at}>=0,"met","not met"))', None, met)
        sheet.write(row, 8, check.equation if check else line.mark if fixed is None else "")
        self._state(sheet, row, 9, taken=line.taken or fixed is not None)
        if check is not None:
            sheet.write(row, 10, f"{check.sensor}, {percent(check.sensor_share)} of the variance")


class _Unit(NamedTuple):
    """The unit of a cell, none without a dimension: numbers in it, and formulas from it and to it."""

    symbol: str
    dimension: str

    @classmethod
    def of(cls, written: str, dimension: str, otherwise: str = "") -> "_Unit":
        """The unit that is written where it is a factor; else `otherwise`, or the dimension's usual one."""
        if not dimension:
            return cls("", "")
        kind = DIMENSIONS[dimension]
        return cls(written if written in kind.units else otherwise or kind.default_unit, dimension)

    def number(self, value: Any) -> Any:
        return from_si(value, *self) if self.symbol else value

    def to_si(self, cell: str) -> str:
        if not self.symbol:
            return cell
        if decibels := DIMENSIONS[self.dimension].decibels:
            return f"10^({cell}/{decibels})"
        return f"{cell}*{self._factor!r}".replace("e", "E")

    def from_si(self, cell: str) -> str:
        if not self.symbol:
            return cell
        if decibels := DIMENSIONS[self.dimension].decibels:
            return f"{decibels}*LOG10({cell})"
        return cell if self.symbol in ("m", "m/s") else f"{cell}/{self._factor!r}"

    @property
    def _factor(self) -> float:
        return float(DIMENSIONS[self.dimension].units[self.symbol])


def _unit_of(design: Design, key: str) -> _Unit:
    """The unit of an input's cell."""
    declaration = declaration_of(key)
    if isinstance(declaration, BaseQuantity):
        return _Unit.of(design.unit(key), declaration.dimension, declaration.unit)
    return _Unit("", "")
