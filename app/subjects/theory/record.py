"""The record of what results were compared with: `make validation` writes it, the Theory page shows it."""

import json
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Final

INDEPENDENT: Final = {
    "published figure": "published figures",
    "real data": "real data",
    "another program": "other programs",
    "solver written by others": "solvers written by others",
}
"""Kinds of comparison that count as independent references -> their plural.

A solver written by others counts where the equations it solves were set up without the product's code; the row
says what was."""

OURS: Final = "our own derivation"
"""The kind of every other comparison: two parts of our own work, or a second derivation written in the test."""


@dataclass(frozen=True)
class Comparison:
    """A result, what it was compared with, and how far apart the two were.

    equation: the equation's mark, or nothing; kind: `OURS` or one of `INDEPENDENT`; oracle: what the result was
    compared with, in words; figure, limit: the largest deviation found and allowed, both of what measure says;
    test: the test's file and function.
    """

    result: str
    equation: str
    kind: str
    oracle: str
    limit: float
    measure: str
    test: str
    figure: float


@dataclass(frozen=True)
class Difference:
    """A result with a different published figure: theirs, ours, which one is right and why."""

    result: str
    equation: str
    printed: str
    ours: str
    holds: str
    why: str
    test: str


@dataclass(frozen=True)
class Record:
    """All comparisons and differences, with the version, commit and date of the run that wrote them."""

    version: str
    commit: str
    date: str
    rows: tuple[Comparison, ...]
    differences: tuple[Difference, ...]


@cache
def record() -> Record:
    """The committed record."""
    text = files("app.subjects.theory").joinpath("validation.json").read_text(encoding="utf-8")
    data = json.loads(text)
    return Record(
        data["version"],
        data["commit"],
        data["date"],
        tuple(Comparison(**row) for row in data["rows"]),
        tuple(Difference(**row) for row in data["differences"]),
    )
