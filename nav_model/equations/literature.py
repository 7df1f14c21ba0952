"""The literature: works, which equation comes from which, and which work describes a method (`literature.toml`)."""

from collections.abc import Collection, Mapping
from types import MappingProxyType

from nav_model.base.text.toml_text import shipped
from nav_model.equations import ALL_EQUATIONS
from nav_model.equations.entry import Equation

_LITERATURE = shipped("nav_model.equations", "literature")

WORKS: Mapping[str, str] = MappingProxyType(_LITERATURE["works"])
"""Short name -> full reference."""

METHODS: tuple[tuple[str, str], ...] = tuple(_LITERATURE["methods"].items())
"""Methods of the product beside its equations, and the work that describes each."""


def references_of(equations: Collection[Equation]) -> tuple[str, ...]:
    """Works that a report with these equations cites: each that their sources name, with the equations' marks."""

    def marks(short: str) -> list[str]:
        named = short if len(short) > 1 else f"[{short}]"  # as within a sentence
        return [equation.mark for equation in equations if equation.source == short or named in equation.source]

    derived = [equation.mark for equation in equations if equation.source not in WORKS]
    return (
        *(f"{work} Used for {_listed(cited)}." for short, work in WORKS.items() if (cited := marks(short))),
        f"{_listed(derived)} are derived in NavBudget and verified against Riccati and covariance solutions and "
        "Monte Carlo runs in its test suite.",
        "The table of inputs gives the source of each sensor and radar value.",
    )


def _listed(marks: Collection[str]) -> str:
    return ", ".join(f"[{mark}]" for mark in marks)


def source_of(mark: str) -> str:
    """Where an equation comes from."""
    source = next(equation.source for equation in ALL_EQUATIONS if equation.mark == mark)
    return WORKS[source].partition(". ")[0] if source in WORKS else f"derived here {source}".rstrip()
