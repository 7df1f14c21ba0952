"""Rows of the tables of equations and symbols."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Equation:
    """A numbered equation.

    Attributes
    ----------
    mark : str
        Its number, such as ``"T-9"``; texts cite it in brackets.
    title : str
        What it gives, in a few words.
    math : str
        The equation in Typst's math notation, which every renderer typesets.
    says : str
        What it means, in a sentence or two; may cite other marks.
    source : str
        The work that has it, or what our own derivation follows.
    """

    mark: str
    title: str
    math: str
    says: str
    source: str = ""


@dataclass(frozen=True)
class Symbol:
    """A row of the table of symbols.

    Attributes
    ----------
    math : str
        The symbol in Typst's math notation.
    meaning, unit : str
        What it denotes, and its SI unit.
    marks : tuple of str
        Marks of the equations that use it; empty for the symbols of every report.
    """

    math: str
    meaning: str
    unit: str
    marks: tuple[str, ...] = ()
