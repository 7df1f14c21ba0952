"""Every numbered equation of the product and its symbols, read from `equations.toml` and `symbols.toml`.

Each equation is written once, in Typst's math notation; the PDF sets it and the HTML carries it as MathML.
"""

import re
from collections.abc import Collection

from nav_model.base.text.toml_text import shipped
from nav_model.equations.entry import Equation, Symbol

_CITED = re.compile(r"\[([TSBP]-\d+)\]")
_ONLY_WHERE_CITED = ("T-14", "T-16", "T-19", "T-20", "T-21", "T-22", "S-4", "S-7", "S-9", "S-10")


ALL_EQUATIONS: tuple[Equation, ...] = tuple(Equation(**row) for row in shipped(__name__, "equations")["equation"])

EQUATIONS: tuple[Equation, ...] = tuple(
    e for e in ALL_EQUATIONS if e.mark[0] in "TS" and e.mark not in _ONLY_WHERE_CITED
)
"""Equations of every report; the others are in a report that cites them."""

ALL_SYMBOLS: tuple[Symbol, ...] = tuple(
    Symbol(**row | {"marks": tuple(row.get("marks", ()))}) for row in shipped(__name__, "symbols")["symbol"]
)

SYMBOLS: tuple[Symbol, ...] = tuple(symbol for symbol in ALL_SYMBOLS if not symbol.marks)
"""Symbols of every report."""


def with_cited(marks: Collection[str]) -> tuple[tuple[Equation, ...], tuple[Symbol, ...]]:
    """Equations and symbols of a report that cites `marks`, in order: those of every report, and the cited ones.

    What a cited equation itself cites is included.
    """
    wanted, cited = {equation.mark for equation in EQUATIONS}, set(marks)
    while not cited <= wanted:
        wanted |= cited
        cited = {mark for e in ALL_EQUATIONS if e.mark in wanted for mark in _CITED.findall(e.says)}
    equations = tuple(equation for equation in ALL_EQUATIONS if equation.mark in wanted)
    symbols = tuple(symbol for symbol in ALL_SYMBOLS if not symbol.marks or not wanted.isdisjoint(symbol.marks))
    return equations, symbols
