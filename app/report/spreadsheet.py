"""The budget as a spreadsheet whose real-time values are live formulas of its input cells.

Formulas are the model's own (`app.report.workings`), each written with its value, so that a viewer that does
not recalculate shows the right numbers. What has no formula is a value that says so, and goes grey beside other
inputs.
"""

from collections.abc import Mapping
from dataclasses import replace
from importlib.metadata import version
from io import BytesIO
from typing import Any, cast

import numpy as np
from xlsxwriter import Workbook
from xlsxwriter.utility import xl_rowcol_to_cell

from app.document.numbers import percent
from app.document.verdict import SAID
from app.document.wording import printable, title_of
from app.report.inputs import shown_value
from app.report.workings import CHOICE, RULE, STATES, Sum, Traces, followed, own_key, symbol_of
from nav_model.analytic.refined_coast import longest_rule
from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.traced import Traced
from nav_model.base.units import from_si
from nav_model.budget import Budget
from nav_model.budget.figures import FIGURES, figures
from nav_model.budget.inputs import inputs_of
from nav_model.budget.result import Check
from nav_model.budget.verdict import limit_on
from nav_model.design import Design
from nav_model.design.contributors import UNSCALED, label_of
from nav_model.design.declaration import BaseQuantity
from nav_model.design.parts import INPUTS, declaration_of
from nav_model.design.processing import POST_PROCESSED, REAL_TIME

LIVE, OTHER, TAKEN = "live formula", "from other inputs", "value, not a formula"
"""What the column "State" says."""

_CHANGED, _NOT_FOLLOWED = "inputs_changed", "fixed_inputs_changed"


def workbook_bytes(budget: Budget) -> bytes:
    """The workbook of one design."""
    file = BytesIO()
    # Texts are never taken for formulas, numbers or links, whatever a name begins with.
    options = {"in_memory": True, "strings_to_formulas": False, "strings_to_urls": False, "strings_to_numbers": False}
    with Workbook(file, options) as book:
        book.set_properties(
            {"title": printable(title_of(budget.design)), "comments": f"NavBudget {version('navbudget')}"}
        )
        book.set_calc_mode("auto")
        _Sheets(book, budget).write()
    return file.getvalue()


class _Sheets:
    """The sheets of a workbook, written one after the other."""

    def __init__(self, book: Workbook, budget: Budget) -> None:
        self.book, self.budget, self.design = book, budget, budget.design
        self.traces = Traces(budget.design)
        self.values = {row.symbol: row for row in self.traces.workings.rows if row.symbol}
        self.bold = book.add_format({"bold": True})
        self.head = book.add_format({"bold": True, "bottom": 1, "text_wrap": True, "valign": "top"})
        self.number = book.add_format({"num_format": "0.000E+00"})
        self.figure = book.add_format({"num_format": "[>=100]0.0;[>=1]0.000;General"})
        self.percent = book.add_format({"num_format": "+0.0%;-0.0%"})
        self.entry = book.add_format({"bg_color": "#FFF8DC", "border": 1, "border_color": "#BBBBBB", "locked": False})
        self.grey = book.add_format({"font_color": "#8A8A8A", "italic": True})
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

    def _start(self, sheet: Any, title: str, columns: Mapping[str, float], said: tuple[str, ...] = ()) -> int:
        """Title, sentences and heads of the columns; the row after them."""
        sheet.write_string(0, 0, title, self.bold)
        for row, sentence in enumerate(said, 1):
            sheet.write_string(row, 0, sentence)
        at = len(said) + 2
        for column, (head, width) in enumerate(columns.items()):
            sheet.write_string(at, column, head, self.head)
            sheet.set_column(column, column, width)
        sheet.freeze_panes(at + 1, 1)
        sheet.set_landscape()
        sheet.fit_to_pages(1, 0)
        return at + 1

    def _name(self, symbol: str, sheet: str, row: int, column: int) -> None:
        self.book.define_name(symbol, f"='{sheet}'!{xl_rowcol_to_cell(row, column, True, True)}")

    # -- inputs -----------------------------------------------------------------------------------------------------

    def _inputs(self, sheet: Any) -> None:
        columns = {
            "Input": 38,
            "Value": 14,
            "Unit": 12,
            "In SI": 14,
            "As computed": 14,
            "Changed": 10,
            "What it is": 60,
        }
        row = self._start(
            sheet, f"Inputs of {printable(title_of(self.design))}", columns,
            ("Change the yellow cells. The formulas of the other sheets follow them.",
             "An empty cell is an input that is not given, or a limit that is not checked."),
        )  # fmt: skip
        keys = followed(self.design)
        first = row
        for section, names in INPUTS.items():
            for name in names:
                key = f"{section}.{name}"
                if key in keys or (section == "requirements" and key != CHOICE.replace("_", ".", 1)):
                    self._input(sheet, row, key)
                    if section != "requirements":
                        self._counts(sheet, row)
                    row += 1
        for number, limit in enumerate(self.design.limits, 1):
            unit, doc = _usual(limit.unit, limit.dimension), "Requirement of your own"
            self._entry(sheet, row, own_key(number), limit.name, limit.value, unit, limit.dimension, doc)
            row += 1
        self._choice(sheet, row)
        self._name_formula(sheet, row + 2, "Inputs changed", _CHANGED, f"SUM(F{first + 1}:F{row})>0")
        row += 5
        sheet.write_string(
            row, 0, "Fixed here: the formulas do not follow these. Change them in NavBudget.", self.bold
        )
        row = fixed = row + 1
        for section, names in INPUTS.items():
            if section == "requirements" or not getattr(self.design, section).given():
                continue
            for name in (name for name in names if f"{section}.{name}" not in keys):
                text = shown_value(self.design, section, name)
                sheet.write_string(row, 0, str(names[name].label))
                sheet.write_string(row, 1, text)
                sheet.write_string(row, 4, text)
                self._counts(sheet, row)
                row += 1
        self._name_formula(sheet, row + 1, "Fixed inputs changed", _NOT_FOLLOWED, f"SUM(F{fixed + 1}:F{row})>0")

    def _name_formula(self, sheet: Any, row: int, label: str, symbol: str, formula: str) -> None:
        sheet.write_string(row, 0, label)
        sheet.write_formula(row, 1, f"={formula}", None, False)
        self._name(symbol, "Inputs", row, 1)

    def _input(self, sheet: Any, row: int, key: str) -> None:
        declaration = declaration_of(key)
        assert isinstance(declaration, BaseQuantity)
        unit, doc = _unit(self.design, key), str(declaration.doc or "").split(". ")[0]
        low, high = (_in_unit(bound, unit, declaration.dimension) for bound in declaration.limits)
        sheet.data_validation(row, 1, row, 1, {
            "validate": "decimal", "criteria": "between", "minimum": low, "maximum": high,
            "error_title": "Not allowed", "error_message": declaration.allowed(unit)[:255],
        })  # fmt: skip
        value = cast("float | None", self.design[key])
        self._entry(sheet, row, symbol_of(key), str(declaration.label), value, unit, declaration.dimension, doc)

    def _entry(
        self, sheet: Any, row: int, symbol: str, label: str, value: float | None, unit: str, dimension: str, doc: str
    ) -> None:
        """A cell to change, in SI under its name, and what it is as computed."""
        shown, cell = None if value is None else _in_unit(value, unit, dimension), f"B{row + 1}"
        sheet.write_string(row, 0, label)
        sheet.write(row, 1, shown, self.entry)
        sheet.write_string(row, 2, unit)
        in_si = f'=IF({cell}="","",{_to_si(cell, unit, dimension)})'
        sheet.write_formula(row, 3, in_si, self.number, "" if value is None else value)
        sheet.write(row, 4, shown)
        sheet.write_string(row, 6, doc)
        self._name(symbol, "Inputs", row, 3)

    def _counts(self, sheet: Any, row: int) -> None:
        """Whether an input is another than as computed."""
        sheet.write_formula(row, 5, f"=IF(B{row + 1}=E{row + 1},0,1)", None, 0)

    def _choice(self, sheet: Any, row: int) -> None:
        sheet.write_string(row, 0, str(declaration_of("requirements.steady_state").label))
        sheet.write_string(row, 1, self.design.requirements.steady_state, self.entry)
        sheet.data_validation(row, 1, row, 1, {"validate": "list", "source": [*STATES]})
        sheet.write_formula(row, 3, f"=B{row + 1}", None, self.design.requirements.steady_state)
        sheet.write_string(row, 6, "; ".join(f"{state}: {when}" for state, when in STATES.items()))
        self._name(CHOICE, "Inputs", row, 3)

    # -- what formulas make of them ---------------------------------------------------------------------------------

    def _workings(self, sheet: Any) -> None:
        for column, width in enumerate((46, 30, 16, 10, 16, 22)):
            sheet.set_column(column, column, width)
        for column, head in enumerate(("Quantity", "Name", "Value", "Unit", "Equation", "State")):
            sheet.write_string(0, column, head, self.head)
        sheet.freeze_panes(1, 1)
        for row, line in enumerate(self.traces.workings.rows, self.traces.workings.first - 1):
            if not line.text:
                sheet.write_string(row, 0, line.label, self.bold)
                continue
            sheet.write_string(row, 0, line.label)
            sheet.write_string(row, 1, line.symbol)
            sheet.write_string(row, 3, line.unit)
            sheet.write_string(row, 4, line.mark)
            if line.taken and _is_number(line.text):
                sheet.write_number(row, 2, line.value, self.number)
            else:
                sheet.write_formula(row, 2, f"={line.text}", self.number, line.value)
            if line.symbol:
                self._name(line.symbol, "Workings", row, 2)
                self._state(sheet, row, 5, taken=line.taken)
        self._greyed(sheet, f"A2:F{row + 1}", "$F2")

    def _rule(self, sheet: Any) -> None:
        nodes, weights = longest_rule()
        sheet.write_string(
            0, 0, "Nodes and weights that integrate the squared responses of the outage [T-17]", self.bold
        )
        for column, (symbol, values) in enumerate(zip(RULE, (nodes, weights), strict=True)):
            sheet.write_string(1, column, symbol, self.head)
            for row, value in enumerate(values, 2):
                sheet.write_number(row, column, value)
            letter = "AB"[column]
            self.book.define_name(symbol, f"=Rule!${letter}$3:${letter}${len(values) + 2}")

    def _state(self, sheet: Any, row: int, column: int, *, taken: bool) -> None:
        """Whether a value follows the inputs; in words, since grey alone is not enough."""
        otherwise, changed = (TAKEN, f"OR({_CHANGED},{_NOT_FOLLOWED})") if taken else (LIVE, _NOT_FOLLOWED)
        sheet.write_formula(row, column, f'=IF({changed},"{OTHER}","{otherwise}")', None, otherwise)

    def _greyed(self, sheet: Any, cells: str, state: str) -> None:
        sheet.conditional_format(cells, {"type": "formula", "criteria": f'={state}="{OTHER}"', "format": self.grey})

    def _sources(self, sheet: Any) -> None:
        parts = ("quadratic", "cubic", "detrended")
        columns = {"Source": 30} | {f"{part.capitalize()} phase, 1σ [°]": 16 for part in parts}
        columns |= {f"Share of {part}": 14 for part in parts} | {"Equation": 16, "State": 22}
        first = self._start(sheet, "Phase over the aperture by source, in real time", columns)
        to_phase = self._cell("to_phase")
        for row, (source, line) in enumerate(self.traces.sources.items(), first):
            variances = [getattr(line, part) for part in parts]
            sheet.write_string(row, 0, source)
            for column, (part, variance) in enumerate(zip(parts, variances, strict=True), 1):
                self._part_of(sheet, row, column, f"{part}_phase", to_phase * np.sqrt(variance))
            sheet.write_string(row, 7, "[S-5], [S-6]")
            self._state(sheet, row, 8, taken=any(variance.taken for variance in variances))
        row = first + len(self.traces.sources)
        for column, part in enumerate(parts, 1):
            for own in self.traces.contributors.get(f"{part}_phase", ()):
                sheet.write_string(row, 0, own.name)
                self._part_of(sheet, row, column, f"{part}_phase", own.size, systematic=own.systematic)
                self._state(sheet, row, 8, taken=False)
                row += 1
        sheet.write_string(row, 0, "Sum", self.bold)
        for column, part in enumerate(parts, 1):
            whole = np.degrees(self._cell(f"real_time_{part}_phase"))
            sheet.write_formula(row, column, f"={whole.text}", self.figure, float(whole.value))
        self._greyed(sheet, f"A{first + 1}:I{row + 1}", f"$I{first + 1}")

    def _cell(self, symbol: str) -> Any:
        """A cell of the workings, to make formulas of."""
        row = self.values[symbol]
        return Traced(symbol, np.float64(row.value), self.traces.workings, row.taken)

    def _part_of(self, sheet: Any, row: int, at: int, figure: str, size: Any, *, systematic: bool = False) -> None:
        """The 1σ of a source or a contributor of a phase, and its share: a systematic one adds linearly to the root
        of what is random."""
        shown, whole = np.degrees(size), self._cell(f"real_time_{figure}")
        root = self._cell(f"root_{figure}") if figure in self.traces.contributors else whole
        sheet.write_formula(row, at, f"={shown.text}", self.figure, float(shown.value))
        with np.errstate(invalid="ignore"):  # of a phase that is zero
            share = size / whole if systematic else size**2 / (whole * root)
        formula = f"=IF({whole.text}=0,0,{share.text})"
        sheet.write_formula(row, at + 3, formula, self.percent, float(share.value) if whole.value else 0.0)

    def _sums(self, sheet: Any) -> None:
        columns = {"Figure, in real time, 1σ": 62, "Value": 16, "Unit": 10, "Equation": 16, "State": 22}
        first = row = self._start(sheet, "Every figure of the budget in real time", columns)
        for row, total in enumerate(self.traces.sums, first):
            unit = _usual_unit(self.design, total)
            cell = self.values[total.symbol]
            sheet.write_string(row, 0, total.label)
            sheet.write_formula(
                row, 1, f"={_from_si(total.symbol, unit, total.dimension)}", self.figure,
                _in_unit(float(cell.value), unit, total.dimension),
            )  # fmt: skip
            sheet.write_string(row, 2, unit)
            sheet.write_string(row, 3, total.mark)
            self._state(sheet, row, 4, taken=cell.taken)
        self._greyed(sheet, f"A{first + 1}:E{row + 1}", f"$E{first + 1}")

    # -- limits and margins -----------------------------------------------------------------------------------------

    def _verdict(self, sheet: Any, *, live: bool) -> None:
        processing = REAL_TIME if live else POST_PROCESSED
        verdicts = self.budget.verdict, self.budget.other_verdict
        verdict = next(verdict for verdict in verdicts if verdict.processing == processing)
        names = (*FIGURES, *(limit.name for limit in self.design.limits))
        fixed = {} if live else figures(replace(inputs_of(self.design), post_processed=True), names)
        columns = {
            "Requirement": 38, "Value, 1σ": 14, "Factor": 8, "Value checked": 14, "Limit": 12, "Unit": 8,
            "Margin": 10, "Met": 10, "Equation": 16, "State": 22, "Main error source (as computed)": 40,
        }  # fmt: skip
        said = (
            "",
            "Values are live formulas of the sheet Inputs, unless the column State says otherwise."
            if live
            else "NavBudget computed these values from the column As computed of Inputs; no formula does.",
        )
        first = row = self._start(sheet, f"{printable(title_of(self.design))}, {SAID[processing]}", columns, said)
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
        sheet.conditional_format(
            letters, {"type": "cell", "criteria": "==", "value": '"not met"', "format": self.bad}
        )

    def _check(self, sheet: Any, row: int, name: str, check: Check | None, fixed: Any) -> None:
        """One requirement: its limit is a cell of Inputs, its value that of real time or a `fixed` number."""
        at = row + 1
        if name in FIGURES:
            key = f"requirements.{FIGURES[name]}"
            unit, dimension = _unit(self.design, key), limit_on(name).dimension
            symbol, limit, given = f"real_time_{name}", symbol_of(key), cast("float | None", self.design[key])
        else:
            number, own = next((n, one) for n, one in enumerate(self.design.limits, 1) if one.name == name)
            unit, dimension = _usual(own.unit, own.dimension), own.dimension
            symbol, limit, given = f"real_time_{own_key(number)}", own_key(number), own.value
            if symbol not in self.values:  # a figure that has a cell already
                symbol = f"real_time_{own.on}"
        usual = self.design.requirements.confidence
        confidence = check.confidence if check else None if name in UNSCALED else usual
        sheet.write_string(row, 0, label_of(name))
        if fixed is not None:
            sigma, taken = float(fixed), True
            sheet.write_number(row, 1, _in_unit(sigma, unit, dimension), self.figure)
        else:
            sigma, taken = float(self.values[symbol].value), self.values[symbol].taken
            shown = _in_unit(sigma, unit, dimension)
            sheet.write_formula(row, 1, f"={_from_si(symbol, unit, dimension)}", self.figure, shown)
        factor = confidence or 1.0
        follows = name in FIGURES or own.confidence is None
        said = "=1" if confidence is None else "=requirements_confidence" if follows else f"={factor!r}"
        sheet.write_formula(row, 2, said, self.figure, factor)
        checked = factor * sigma
        sheet.write_formula(row, 3, f"=B{at}*C{at}", self.figure, _in_unit(checked, unit, dimension))
        allowed = "" if given is None else _in_unit(given, unit, dimension)
        sheet.write_formula(row, 4, f'=IF({limit}="","",{_from_si(limit, unit, dimension)})', self.figure, allowed)
        sheet.write_string(row, 5, unit)
        one, other = (_to_si(f"{letter}{at}", unit, dimension) for letter in "DE")
        margin: Any = "" if given is None else 1 - checked / given
        sheet.write_formula(row, 6, f'=IF({limit}="","",1-{one}/({other}))', self.percent, margin)
        met = "not checked" if given is None else "met" if checked <= given else "not met"
        sheet.write_formula(row, 7, f'=IF({limit}="","not checked",IF(G{at}>=0,"met","not met"))', None, met)
        total = next(item for item in self.traces.sums if item.symbol == symbol)
        sheet.write_string(row, 8, check.equation if check else total.mark if fixed is None else "")
        self._state(sheet, row, 9, taken=taken)
        if check is not None:
            sheet.write_string(row, 10, f"{check.sensor}, {percent(check.sensor_share)} of the variance")


def _unit(design: Design, key: str) -> str:
    """The unit of an input's cell: the one it is written in, where that is a factor."""
    declaration = declaration_of(key)
    assert isinstance(declaration, BaseQuantity)
    if not declaration.dimension:
        return ""
    unit = design.unit(key)
    return unit if unit in DIMENSIONS[declaration.dimension].units else declaration.unit


def _usual(unit: str, dimension: str) -> str:
    """The unit of a limit of the user's own, where that is a factor."""
    return unit if unit in DIMENSIONS[dimension].units else DIMENSIONS[dimension].default_unit


def _usual_unit(design: Design, total: Sum) -> str:
    """The unit that a figure's sum is shown in."""
    figure = total.symbol.removeprefix("real_time_")
    if figure in FIGURES:
        return _unit(design, f"requirements.{FIGURES[figure]}")
    return {"length": "m", "speed": "m/s", "angle": "°", "level": "dB"}.get(total.dimension, "")


def _in_unit(value: Any, unit: str, dimension: str) -> float:
    return from_si(value, unit, dimension) if unit else float(value)


def _to_si(cell: str, unit: str, dimension: str) -> str:
    if not unit:
        return cell
    if decibels := DIMENSIONS[dimension].decibels:
        return f"10^({cell}/{decibels})"
    return f"{cell}*{float(DIMENSIONS[dimension].units[unit])!r}".replace("e", "E")


def _from_si(symbol: str, unit: str, dimension: str) -> str:
    if not unit:
        return symbol
    if decibels := DIMENSIONS[dimension].decibels:
        return f"{decibels}*LOG10({symbol})"
    return symbol if unit in ("m", "m/s") else f"{symbol}/{float(DIMENSIONS[dimension].units[unit])!r}"


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
