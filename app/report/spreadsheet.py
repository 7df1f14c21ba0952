"""The budget as a spreadsheet whose real-time values and shares are live formulas of its input cells.

Formulas are the model's own (`app.report.workings`), each written with its value, so that a viewer that does
not recalculate shows the right numbers. What has no formula is a value that says so, and goes grey beside other
inputs.
"""

import math
from collections.abc import Mapping, Sequence
from importlib.metadata import version
from io import BytesIO
from typing import Any, NamedTuple, cast

import numpy as np
from xlsxwriter import Workbook
from xlsxwriter.utility import xl_rowcol_to_cell

from app.document.numbers import NONE
from app.document.verdict import SAID
from app.document.wording import printable, title_of
from app.report.inputs import input_text
from app.report.workings import RULE, Traces, contributor_key, limit_key, symbol_of
from nav_model.analytic.refined_coast import longest_rule
from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.units import from_si
from nav_model.budget import Budget
from nav_model.budget.verdict import STRAIGHT_LEG, Check, limits_of_autofocus
from nav_model.design import Design
from nav_model.design.declaration import BaseQuantity, Choice
from nav_model.design.figures import FIGURES, REQUIRED, figure_in_sentence, label_of, of_kind
from nav_model.design.parts import INPUTS, declaration_of
from nav_model.design.processing import POST_PROCESSED, REAL_TIME

LIVE, OTHER, TAKEN = "live formula", "from other inputs", "value, not a formula"
"""Words of the column "State"."""

_TEXTS, _APART = ("State", "Name", "Processing", "Main error source"), ("Unit", "Met", "Equation", "What it is")
"""Columns of texts beside the first; those that stand apart from a number before them."""

_FLIGHT_DECIDES = "Judged on the flight, whose values are fixed and not known once a cell is changed"
_CHANGED, _ENTERING_CHANGED = "inputs_changed", "contributors_changed"


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
        self.checks: list[tuple[Check, str, str]] = []  # in the order of their rows of Shares
        self.bold = book.add_format({"bold": True})
        head = {"bold": True, "bottom": 1, "text_wrap": True, "valign": "top"}
        self.head, self.of_texts = book.add_format(head | {"align": "right"}), book.add_format(head)
        self.apart_head = book.add_format(head | {"align": "left", "indent": 1})
        self.changed = book.add_format({"num_format": '"changed";;""', "align": "right"})
        self.number = book.add_format({"num_format": "0.00E+00"})
        self.level = book.add_format({"num_format": '[<=-299]"none";[<0]-0.00;0.00'})
        self.digits: dict[str, Any] = {}
        self.percent = book.add_format({"num_format": "+0.0%;-0.0%"})
        self.share = book.add_format({"num_format": "0.0%"})
        self.apart = book.add_format({"indent": 1})
        self.entry = book.add_format({"bg_color": "#FFF8DC", "border": 1, "border_color": "#BBBBBB", "locked": False})
        self.grey = book.add_format({"font_color": "#8A8A8A", "italic": True})
        self.title = book.add_format({"bold": True, "font_size": 16, "font_color": "#FFFFFF", "bg_color": "#1A5580"})
        self.good = book.add_format({"font_color": "#00654A", "bold": True})
        self.bad = book.add_format({"font_color": "#B00020", "bold": True})

    def write(self) -> None:
        names = "Budget", "Post-processed", "Inputs", "Shares", "Sources", "Workings", "Steps", "Rule"
        sheets = {name: self.book.add_worksheet(name) for name in names}
        self._inputs(sheets["Inputs"])
        self._sources(sheets["Sources"])
        for name, processing in (("Budget", REAL_TIME), ("Post-processed", POST_PROCESSED)):
            self._verdict(sheets[name], processing)
        self._shares(sheets["Shares"])
        self._workings(sheets["Workings"])
        self._steps(sheets["Steps"])
        self._rule(sheets["Rule"])
        for name in ("Steps", "Rule"):  # nobody prints them
            sheets[name].hide()
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
        for column, (name, width) in enumerate(columns.items()):
            apart = name in _APART
            head = self.of_texts if not column or name in _TEXTS else self.apart_head if apart else self.head
            sheet.write(row, column, name, head)
            sheet.set_column(column, column, width, self.apart if apart else None)
        sheet.freeze_panes(row + 1, 1)
        return row + 1

    def _end(self, sheet: Any, first: int, row: int, columns: Sequence[str]) -> None:
        """Set the print area, and grey for what belongs to other inputs."""
        sheet.print_area(0, 0, row, len(columns) - 1)
        if "State" in columns:
            state = xl_rowcol_to_cell(first, [*columns].index("State"), col_abs=True)
            form = {"type": "formula", "criteria": f'={state}="{OTHER}"', "format": self.grey}
            sheet.conditional_format(first, 0, row, len(columns) - 1, form)

    def _format(self, value: float, unit: str = "") -> Any:
        """Three digits of a value, and of those about as large; a level has two places."""
        if unit == "dB":
            return self.level
        places = 0 if not value or not math.isfinite(value) else 2 - math.floor(math.log10(abs(value)))
        if places <= 2:
            form = "[>=99.95]0;[>=9.995]0.0;0.00"
        else:
            form = f"[<{10.0 ** (2 - places) if places < 5 else 0.01}]0.00E+00;[>=1]0.00;0.{'0' * min(places, 4)}"
        return self.digits.setdefault(form, self.book.add_format({"num_format": form}))

    def _name(self, symbol: str, sheet: str, row: int, column: int) -> None:
        self.book.define_name(symbol, f"='{sheet}'!{xl_rowcol_to_cell(row, column, True, True)}")

    # -- inputs -----------------------------------------------------------------------------------------------------

    def _inputs(self, sheet: Any) -> None:
        columns = {
            "Input": 38, "Value": 14, "Unit": 12, "In SI": 14, "As computed": 14, "Changed": 10, "What it is": 96,
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
                    if section != "requirements":
                        self._compared(sheet, row)
                    row += 1
                elif getattr(self.design, section).given():
                    fixed.append((str(declared.label), input_text(self.design, section, name)))
        for number, limit in enumerate(self.design.limits, 1):
            unit = _Unit.of(limit.unit, limit.dimension)
            doc = f"Your requirement on {figure_in_sentence(limit.on)}"
            self._entry(sheet, row, limit_key(number), limit.name, limit.value, unit, doc)
            row += 1
        model = row
        for number, entry in enumerate(self.design.contributors, 1):
            key, words = contributor_key(number), f"Contributor to {figure_in_sentence(entry.enters)}, {entry.kind}"
            doc = ", ".join(text for text in (words, entry.owner and f"owner {entry.owner}", entry.source) if text)
            unit, allowance = _Unit.of(entry.unit, entry.dimension), f"{entry.name}, allowance"
            self._entry(sheet, row, key, entry.name, entry.value, unit, doc, empty="0")
            unit = _Unit.of("%", "ratio")
            self._entry(sheet, row + 1, f"{key}_allowance", allowance, entry.allowance, unit, "", empty="0")
            self._compared(sheet, row)
            self._compared(sheet, row + 1)
            row += 2
        for label, symbol, begin, end in (
            ("Inputs changed", _CHANGED, first, model),
            ("Contributors changed", _ENTERING_CHANGED, model, row),
        ):
            row += 1
            sheet.write(row, 0, label)
            sheet.write_formula(row, 1, f"=SUM(F{begin + 1}:F{max(end, begin + 1)})>0", None, False)
            self._name(symbol, "Inputs", row, 1)
        sheet.write(row + 2, 0, "Fixed here: the formulas do not follow these. Change them in NavBudget.", self.bold)
        for at, line in enumerate(fixed, row + 3):
            sheet.write_row(at, 0, line)
        self._end(sheet, first, row + 2 + len(fixed), (*columns,))

    def _compared(self, sheet: Any, row: int) -> None:
        """Write a formula that tells whether a cell holds another value than that computed with."""
        sheet.write_formula(row, 5, f"=IF(B{row + 1}=E{row + 1},0,1)", self.changed, 0)

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

    def _entry(
        self, sheet: Any, row: int, symbol: str, label: str, value: Any, unit: "_Unit", doc: str, empty: str = '""'
    ) -> None:
        """A cell to change, in SI under its name, and what it is as computed."""
        number, cell = None if value is None else unit.number(value), f"B{row + 1}"
        sheet.write_row(row, 0, (label, None, unit.symbol, None, number, None, doc))
        sheet.write(row, 1, number, self.entry)
        in_si = f'=IF({cell}="",{empty},{unit.to_si(cell)})'
        sheet.write_formula(row, 3, in_si, self.number, "" if value is None else value)
        self._name(symbol, "Inputs", row, 3)

    # -- what formulas make of them ---------------------------------------------------------------------------------

    def _workings(self, sheet: Any) -> None:
        columns = {"Quantity": 46, "Name": 30, "Value": 16, "Unit": 10, "Equation": 16, "State": 22}
        lines = ("The steps between these quantities are on the hidden sheet Steps.",)
        first = self._start(sheet, "From the inputs to every figure", columns, lines)
        for row, line in enumerate(self.cells.rows, first):
            if not line.text:
                sheet.write(row, 0, line.label, self.bold)
                continue
            sheet.write_row(row, 0, (line.label, line.symbol, None, line.unit, line.mark))
            if line.taken and line.text == repr(line.value):
                sheet.write(row, 2, line.value, self.number)
            else:
                sheet.write_formula(row, 2, f"={line.text}", self.number, line.value)
            self._name(line.symbol, "Workings", row, 2)
            self._state(sheet, row, 5, taken=line.taken, symbol=line.symbol)
        self._end(sheet, first, row, (*columns,))

    def _steps(self, sheet: Any) -> None:
        first = self._start(sheet, "Steps to the quantities of the sheet Workings", {"Step": 70, "Value": 16})
        for row, line in enumerate(self.cells.steps.values(), first):
            sheet.write(row, 0, line.label)
            sheet.write_formula(row, 1, f"={line.text}", self.number, line.value)

    def _rule(self, sheet: Any) -> None:
        sheet.write(0, 0, "Nodes and weights that integrate the squared responses of the outage [T-17]", self.bold)
        for letter, symbol, values in zip("AB", RULE, longest_rule(), strict=True):
            sheet.write(f"{letter}2", symbol, self.head)
            sheet.write_column(f"{letter}3", values)
            self.book.define_name(symbol, f"=Rule!${letter}$3:${letter}${len(values) + 2}")

    def _state(self, sheet: Any, row: int, column: int, *, taken: bool, symbol: str = "") -> None:
        """Write whether a value follows the inputs; in words, since grey alone is not enough."""
        if taken:
            changed = f"OR({_CHANGED},{_ENTERING_CHANGED})" if symbol in self.traces.responses else _CHANGED
            sheet.write_formula(row, column, f'=IF({changed},"{OTHER}","{TAKEN}")', None, TAKEN)
        else:
            sheet.write(row, column, LIVE)

    def _sources(self, sheet: Any) -> None:
        parts, cell = ("quadratic", "cubic", "detrended"), self.cells.cell
        columns = {"Source": 30} | {f"{part.capitalize()} phase, 1σ [°]": 16 for part in parts}
        columns |= {f"Share of {part}": 14 for part in parts} | {"Equation": 16, "State": 22}
        first = self._start(sheet, "Phase along the line of sight of mid-aperture by source, in real time", columns)
        for row, (source, line) in enumerate(self.traces.sources.items(), first):
            variances = [getattr(line, part) for part in parts]
            sheet.write(row, 0, source)
            for column, (part, variance) in enumerate(zip(parts, variances, strict=True), 1):
                self._part_of(sheet, row, column, f"line_of_sight_{part}_phase", cell("to_phase") * np.sqrt(variance))
            sheet.write(row, 7, "[S-5], [S-6]")
            self._state(sheet, row, 8, taken=any(variance.taken for variance in variances))
        row = first + len(self.traces.sources)
        for column, part in enumerate(parts, 1):
            for entry in self.traces.contributors.get((REAL_TIME, f"line_of_sight_{part}_phase"), ()):
                sheet.write(row, 0, entry.name)
                self._part_of(
                    sheet, row, column, f"line_of_sight_{part}_phase", entry.size, systematic=entry.systematic
                )
                self._state(sheet, row, 8, taken=False)
                row += 1
        sheet.write(row, 0, "Sum", self.bold)
        for column, part in enumerate(parts, 1):
            whole = np.degrees(cell(f"real_time_line_of_sight_{part}_phase"))
            sheet.write_formula(row, column, f"={whole.text}", self._format(whole.value), float(whole.value))
        self._end(sheet, first, row, (*columns,))

    def _part_of(self, sheet: Any, row: int, at: int, figure: str, size: Any, *, systematic: bool = False) -> None:
        """The 1σ of a source or a contributor of a phase, and its share: a systematic one adds linearly to the root
        of what is random."""
        degrees, whole = np.degrees(size), self.cells.cell(f"real_time_{figure}")
        root = self.cells.cell(f"root_{figure}") if (REAL_TIME, figure) in self.traces.contributors else whole
        sheet.write_formula(row, at, f"={degrees.text}", self._format(degrees.value), float(degrees.value))
        with np.errstate(invalid="ignore"):  # of a phase that is zero
            share = size / whole if systematic else size**2 / (whole * root)
        formula = f"=IF({whole.text}=0,0,{share.text})"
        sheet.write_formula(row, at + 3, formula, self.share, float(share.value) if whole.value else 0.0)

    # -- limits and margins -----------------------------------------------------------------------------------------

    def _verdict(self, sheet: Any, processing: str) -> None:
        verdict = self.budget.judged(processing)
        of_flight = {check.name: check for check in verdict.checks if check.judged != STRAIGHT_LEG}
        names = (*REQUIRED, *(limit.name for limit in self.design.limits if limit.on not in of_kind("flight")))
        alone = [name for name in of_flight if name not in names]  # what a straight leg does not tell
        columns = {
            "Requirement": 38, "Value, 1σ": 14, "Factor": 8, "Value checked": 14, "Limit": 12, "Unit": 8,
            "Margin": 10, "Met": 12, "Equation": 16, "State": 22, "Main error source": 40,
        }  # fmt: skip
        if of_flight:
            columns |= {"Along the flight": 14, "Judged": 16}
        lines: tuple[str, ...] = (
            "",
            "Values are live formulas of the sheet Inputs, unless the column State says otherwise."
            if processing == REAL_TIME
            else "A smoother has no formula: its values are NavBudget's, for the column As computed of Inputs. "
            "Contributors, limits and confidence may change.",
        )
        if of_flight:
            lines = (*lines, f"{_FLIGHT_DECIDES}: {', '.join(figure_in_sentence(name) for name in of_flight)}.")
        first = row = self._start(sheet, f"{printable(title_of(self.design))}, {SAID[processing]}", columns, lines)
        checks = {check.name: check for check in self.budget.straight_leg(processing).checks}
        for row, name in enumerate(names, first):
            self._check(sheet, row, name, checks.get(name), processing)
            if name in of_flight:
                self._of_flight(sheet, row, of_flight[name])
        for name in alone:
            row += 1
            self._of_flight(sheet, row, of_flight[name])
        letters = f"H{first + 1}:H{row + 1}"
        closes = f'IF(COUNTIF({letters},"met")>0,"Closes","Not checked")'
        for word, text in (("refused", "Open"), ("open", "Open"), ("not known", "Not known for these inputs"),
                            ("not met", "Does not close")):  # fmt: skip
            closes = f'IF(COUNTIF({letters},"{word}")>0,"{text}",{closes})'
        words = {"fails": "Does not close", "open": "Open", "closes": "Closes" if verdict.checks else "Not checked"}
        sheet.write_formula(1, 0, f"={closes}", self.bold, words[verdict.state])
        if processing == REAL_TIME:
            self._name("verdict_in_real_time", "Budget", 1, 0)
        self._end(sheet, first, row, (*columns,))
        for word, form in (("not met", self.bad), ("met", self.good)):  # the margin beside it too
            rule = {"type": "formula", "criteria": f'=$H{first + 1}="{word}"', "format": form}
            sheet.conditional_format(f"G{first + 1}:H{row + 1}", rule)
        for word, form in (("Does not close", self.bad), ("Closes", self.good)):
            sheet.conditional_format("A2", {"type": "formula", "criteria": f'=$A$2="{word}"', "format": form})

    def _check(self, sheet: Any, row: int, name: str, check: Check | None, processing: str) -> None:
        """One requirement: its limit is a cell of Inputs, its value a cell of Workings."""
        at = row + 1
        if name in REQUIRED:
            key = f"requirements.{name}"
            unit, limit, given = _unit_of(self.design, key), symbol_of(key), cast("float | None", self.design[key])
            on, symbol, follows = name, name, True
        else:
            number, limit_of = next((n, item) for n, item in enumerate(self.design.limits, 1) if item.name == name)
            unit, limit, given = _Unit.of(limit_of.unit, limit_of.dimension), limit_key(number), limit_of.value
            on, symbol, follows = limit_of.on, limit, limit_of.confidence is None
        of_autofocus = limits_of_autofocus(self.design).get(name, ()) if name in REQUIRED else ()
        if check is not None and of_autofocus:
            (own_limit,) = of_autofocus
            limit, of_factor = self._tighter(name, limit, *own_limit)
            given = check.limit
        cells = [f"real_time_{symbol}", f"real_time_{on}"]  # a figure that has a cell already needs no other
        if processing == POST_PROCESSED:
            cells = [f"post_processed_{symbol}", *cells]
        symbol = next(cell for cell in cells if cell in self.cells.named)
        line = self.cells.named[symbol]
        usual = self.design.requirements.confidence
        confidence = check.confidence if check else usual if FIGURES[name].scaled else None
        factor = confidence or 1.0
        formula = "=1" if confidence is None else "=requirements_confidence" if follows else f"={factor!r}"
        if of_autofocus:
            formula = f"={of_factor}"
        value = unit.number(line.value)
        checked = unit.number(factor * line.value)
        allowed: Any = "" if given is None else unit.number(given)
        look = self._format(value, unit.symbol)
        sheet.write(row, 0, label_of(name))
        sheet.write_formula(row, 1, f"={unit.from_si(symbol)}", look, value)
        sheet.write_formula(row, 2, formula, None, factor)
        sheet.write_formula(row, 3, f"=B{at}*C{at}", look, checked)
        in_unit = f'=IF({limit}="","",{unit.from_si(limit)})'
        sheet.write_formula(row, 4, in_unit, self._format(allowed or 0.0, unit.symbol), allowed)
        sheet.write(row, 5, unit.symbol)
        of_limit = f"{unit.to_si(f'D{at}')}/({unit.to_si(f'E{at}')})"
        margin: Any = "" if given is None else 1 - factor * line.value / given
        sheet.write_formula(row, 6, f'=IF({limit}="","",1-{of_limit})', self.percent, margin)
        met = f'IF(J{at}="{OTHER}","not known",IF(G{at}>=0,"met","not met"))'
        cached = "not checked" if given is None else "met" if margin >= 0 else "not met"
        sheet.write_formula(row, 7, f'=IF({limit}="","not checked",{met})', None, cached)
        sheet.write(row, 8, check.equation if check else line.mark)
        self._state(sheet, row, 9, taken=line.taken, symbol=symbol)
        if check is not None:
            self.checks.append((check, processing, symbol))
            self._cause(sheet, row, len(self.checks) + 3, check)

    def _tighter(self, name: str, cell: str, own: float, confidence: float | None) -> tuple[str, str]:
        """Formulas of limit and factor where an autofocus has a limit itself: that or the cell's, at one sigma the
        lower."""
        limit, factor = repr(own), repr(confidence or 1.0)
        if name == "path_before_autofocus":
            factor = "requirements_confidence"
            if self.design.radar.range_resolution is None:
                limit = f"{symbol_of('radar.azimuth_resolution')}/2"
        entered = "requirements_confidence" if FIGURES[name].scaled else "1"
        lower = f'IF({cell}="",FALSE,{cell}/{entered}<{limit}/{factor})'
        return f"IF({lower},{cell},{limit})", f"IF({lower},{entered},{factor})"

    def _of_flight(self, sheet: Any, row: int, check: Check) -> None:
        """A requirement that the flight judges: NavBudget's value, not known once a cell is changed."""
        at, unit = row + 1, _Unit.of(check.unit, check.dimension)
        number, own_limit = next(
            ((n, limit) for n, limit in enumerate(self.design.limits, 1) if limit.name == check.name), (0, None)
        )
        key = f"requirements.{check.on}"
        given = cast("float | None", own_limit.value if own_limit else self.design[key])
        limit = limit_key(number) if own_limit else symbol_of(key)
        usual = self.design.requirements.confidence
        other = f'{limit}<>""' if given is None else f'IF({limit}="",TRUE,ABS({limit}/{given!r}-1)>1E-9)'
        changed = f"OR({_CHANGED},{_ENTERING_CHANGED},requirements_confidence<>{usual!r},{other})"

        def fixed(column: int, value: Any, look: Any = None) -> None:
            text = f'"{value}"' if isinstance(value, str) else repr(value)
            sheet.write_formula(row, column, f'=IF({changed},"not known",{text})', look, value)

        known, name = check.known, label_of(check.name)
        sheet.write(row, 0, name)
        sheet.write(row, 5, unit.symbol)
        if check.straight is None or check.limit != given:
            sheet.write(row, 4, unit.number(check.limit), self._format(unit.number(check.limit), unit.symbol))
        fixed(6, check.margin if known else NONE, self.percent)
        fixed(7, check.state)
        sheet.write(row, 8, check.equation)
        sheet.write_formula(row, 9, f'=IF({changed},"{OTHER}","{TAKEN}")', None, TAKEN)
        fixed(10, _cause_words(check) if check.shares and known else NONE)
        value = unit.number(check.value) if known else 0.0
        fixed(11, value if known else NONE, self._format(value, unit.symbol))
        sheet.write(row, 12, printable(check.judged))
        sheet.conditional_format(row, 6, row, 12, {
            "type": "formula", "criteria": f'=$J{at}="{OTHER}"', "format": self.grey,
        })  # fmt: skip

    def _cause(self, sheet: Any, row: int, at: int, check: Check) -> None:
        """The source with the largest share, in row `at` of Shares."""
        shares, heads = f"Shares!$D{at}:$AZ{at}", "Shares!$D$3:$AZ$3"
        largest = f'INDEX({heads},MATCH(MAX({shares}),{shares},0))&", "&TEXT(100*MAX({shares}),"0")'
        cause = _cause_words(check)
        formula = f'=IF(Shares!$C{at}="{OTHER}","not known",{largest}&" % of the variance")'
        sheet.write_formula(row, 10, formula, None, cause)

    def _shares(self, sheet: Any) -> None:
        """The share of each source in every requirement."""
        rows = [self.traces.shares_of(check, processing) for check, processing, _ in self.checks]
        sources = [*dict.fromkeys(source for shares in rows for source in shares)]
        columns = {"Requirement": 38, "Processing": 16, "State": 22} | dict.fromkeys(sources, 14.0)
        first = row = self._start(sheet, "Shares of the sources in each requirement's variance", columns)
        for row, ((check, processing, symbol), shares) in enumerate(zip(self.checks, rows, strict=True), first):
            sheet.write_row(row, 0, (check.label, processing))
            self._state(sheet, row, 2, taken=any(share.taken for share in shares.values()), symbol=symbol)
            for source, share in shares.items():
                value = float(np.nan_to_num(share.value))
                sheet.write_formula(row, 3 + sources.index(source), f"=IFERROR({share.text},0)", self.share, value)
        self._end(sheet, first, row, (*columns,))


def _cause_words(check: Check) -> str:
    """The source with the largest share."""
    return f"{check.dominant}, {100 * check.dominant_share:.0f} % of the variance"


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
