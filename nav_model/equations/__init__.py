"""Every numbered equation of the product and its symbols: tables of data.

Each equation is written once, in Typst's math notation; the PDF sets it and the HTML carries it as MathML. The letter
of a mark says which file has it: T `navigation`, S `radar`, P `processing`, B `suborbital`.
"""

from __future__ import annotations

import re
from collections.abc import Collection

from nav_model.equations.entry import Equation, Symbol
from nav_model.equations.navigation import NAVIGATION
from nav_model.equations.processing import PROCESSING
from nav_model.equations.radar import RADAR
from nav_model.equations.suborbital import SUBORBITAL
from nav_model.equations.symbols import SYMBOLS, SYMBOLS_OF_CITED

_CITED = re.compile(r"\[([TSBP]-\d+)\]")
_ONLY_WHERE_CITED = ("T-14", "T-16", "S-4", "S-7")

ALL_EQUATIONS: tuple[Equation, ...] = (*NAVIGATION, *RADAR, *PROCESSING, *SUBORBITAL)

EQUATIONS: tuple[Equation, ...] = tuple(e for e in (*NAVIGATION, *RADAR) if e.mark not in _ONLY_WHERE_CITED)
"""Those of every report; the others are in a report that cites them."""

ALL_SYMBOLS: tuple[Symbol, ...] = (*SYMBOLS, *SYMBOLS_OF_CITED)


def with_cited(marks: Collection[str]) -> tuple[tuple[Equation, ...], tuple[Symbol, ...]]:
    """Equations and symbols of a report that cites `marks`, in order: those of every report, and the cited ones.

    What a cited equation itself cites is included.
    """
    wanted, found = {equation.mark for equation in EQUATIONS}, set(marks)
    while not found <= wanted:
        wanted |= found
        found = {mark for e in ALL_EQUATIONS if e.mark in wanted for mark in _CITED.findall(e.says)}
    equations = tuple(equation for equation in ALL_EQUATIONS if equation.mark in wanted)
    more = tuple(symbol for symbol in SYMBOLS_OF_CITED if not set(symbol.marks).isdisjoint(wanted))
    return equations, (*SYMBOLS, *more)
