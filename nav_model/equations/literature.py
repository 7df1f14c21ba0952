"""The literature: works, which equation comes from which, and which work describes a method (`literature.toml`)."""

from collections.abc import Mapping
from types import MappingProxyType

from nav_model.base.toml_text import shipped
from nav_model.equations import ALL_EQUATIONS

_LITERATURE = shipped("nav_model.equations", "literature")

WORKS: Mapping[str, str] = MappingProxyType(_LITERATURE["works"])
"""Short name -> full reference."""

METHODS: tuple[tuple[str, str], ...] = tuple(_LITERATURE["methods"].items())
"""What the product does beside its equations, and the work that describes it."""

REFERENCES: tuple[str, ...] = (
    f"{WORKS['A']} Source of [T-1] to [T-7] and [T-9] to [T-12].",
    f"{WORKS['C']} Source of [T-13] and of the correction limits.",
    "[T-8], [T-15], [T-17], [T-18] and [S-1] to [S-6] are derived in NavBudget and verified against Riccati and "
    "covariance solutions and Monte Carlo runs in its test suite.",
    "The table of inputs gives the source of each sensor and radar value.",
)
"""What every report cites."""


def source_of(mark: str) -> str:
    """Where an equation comes from."""
    source = next(equation.source for equation in ALL_EQUATIONS if equation.mark == mark)
    return WORKS[source].partition(". ")[0] if source in WORKS else f"derived here {source}".rstrip()
