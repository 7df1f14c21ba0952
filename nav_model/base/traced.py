"""Numbers that remember the formula they come from, as a spreadsheet writes it.

A closed form that takes arrays also takes a `Traced`: NumPy hands it every function, and it answers with the value
and the text together. A long part is put into a cell, so that every formula stays readable. Choices by value (``if``)
are refused, since a formula has to make them itself.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NoReturn

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

_LONGEST = 60  # characters of a part that is written out where it is used

_SIGNS = {
    "less": ("<", 0), "less_equal": ("<=", 0), "greater": (">", 0), "greater_equal": (">=", 0), "equal": ("=", 0),
    "add": ("+", 1), "subtract": ("-", 1), "multiply": ("*", 2), "divide": ("/", 2), "power": ("^", 3),
}  # fmt: skip
"""Function -> its sign and how tightly that binds; a sign joins its left part first."""

_WHOLE = 4
_CALLS = {
    "sqrt": "SQRT({})", "sin": "SIN({})", "cos": "COS({})", "tan": "TAN({})", "sinh": "SINH({})",
    "absolute": "ABS({})", "degrees": "DEGREES({})", "cbrt": "(({})^(1/3))", "negative": "(0-({}))",
    "expm1": "(EXP({})-1)", "maximum": "MAX({},{})", "minimum": "MIN({},{})", "matmul": "SUMPRODUCT({},{})",
}  # fmt: skip


@dataclass
class WorkingsRow:
    """A line of the workings: a formula, or a value that no formula has (``taken``).

    ``symbol`` is the name of its cell, empty for a step; a row with a label alone heads those that follow.
    """

    label: str
    symbol: str = ""
    text: str = ""
    value: float | bool = 0.0
    unit: str = ""
    mark: str = ""
    taken: bool = False


@dataclass
class Workings:
    """Quantities in the order in which they are found, ``rows``, and the ``steps`` that lead to them.

    ``named`` are the quantities by the names of their cells. The first step is written to row `first` of the sheet
    "Steps"; steps of the same formula are one.
    """

    first: int = 2
    rows: list[WorkingsRow] = field(default_factory=list)
    steps: dict[str, WorkingsRow] = field(default_factory=dict)
    named: dict[str, WorkingsRow] = field(default_factory=dict)
    _labelled: int = 0

    def head(self, label: str) -> None:
        """Begin a group."""
        self.rows.append(WorkingsRow(label))

    def name(self, symbol: str, of: Any, label: str, unit: str = "", mark: str = "", *, taken: bool = False) -> Any:
        """Give a value a cell with a name, and return it as a `Traced`, which closed forms take for an array.

        Parameters
        ----------
        symbol : str
            Name of the cell.
        of : Traced or float
            The value; a plain number is a constant, or a taken value.
        label, unit, mark : str
            Words, unit and equation in the row.
        taken : bool, optional
            True for a number that no formula has.
        """
        of = self.traced(of, taken=taken)
        self.named[symbol] = WorkingsRow(label, symbol, of.text, np.asarray(of.value).item(), unit, mark, of.taken)
        self.rows.append(self.named[symbol])
        self.label_steps(label)
        return Traced(symbol, of.value, self, of.taken)

    def traced(self, of: Any, *, taken: bool = False) -> Traced:
        """A value as a part of formulas: a plain number is a constant, or ``taken``."""
        of = _bare(of)
        return of if isinstance(of, Traced) else Traced(repr(float(of)), np.float64(of), self, taken)

    def label_steps(self, label: str) -> None:
        """Call the steps since the last quantity after what they lead to."""
        for number, step in enumerate([*self.steps.values()][self._labelled :], 1):
            step.label = f"{label}, step {number}"
        self._labelled = len(self.steps)

    def cell(self, symbol: str) -> Traced:
        """A cell with a name, to make formulas of."""
        row = self.named[symbol]
        return Traced(symbol, np.float64(row.value), self, row.taken)

    def step(self, of: Traced) -> str:
        """Put a part of a formula into a cell without a name."""
        self.steps.setdefault(of.text, WorkingsRow("", "", of.text, np.asarray(of.value).item(), taken=of.taken))
        return f"Steps!$B${self.first + [*self.steps].index(of.text)}"


class Traced(NDArrayOperatorsMixin):
    """A value and its formula; ``taken`` if something in it is a number that no formula has."""

    ndim, dtype = 0, np.dtype(object)

    def __init__(self, text: str, value: Any, workings: Workings, taken: bool = False, binds: int = _WHOLE) -> None:
        self.text, self.value, self.workings, self.taken, self.binds = text, value, workings, taken, binds

    @property
    def real(self) -> Traced:
        """Itself: no complex step goes through a sheet."""
        return self

    def __bool__(self) -> NoReturn:
        raise TypeError(f"a formula cannot branch on {self.text}")

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **_: Any) -> Any:
        """The value and the text of a function of this one and others."""
        if method != "__call__":
            return NotImplemented
        name, inputs = ufunc.__name__, tuple(map(_bare, inputs))
        if name == "multiply" and any(_is(x, 0.0) for x in inputs):
            return np.zeros(())
        if name in ("add", "multiply") and _is(inputs[0], float(name == "multiply")):
            return inputs[1]
        if name in ("add", "multiply", "divide", "power", "subtract") and _is(
            inputs[1], float(name not in ("add", "subtract"))
        ):
            return inputs[0]
        parts, binds = [self._part(x) for x in inputs], _WHOLE
        if name in _CALLS:
            text = _CALLS[name].format(*parts)
        else:
            sign, binds = _SIGNS[name]
            left, right = (
                f"({part})" if isinstance(x, Traced) and x.binds < least else part
                for x, part, least in zip(inputs, parts, (binds, binds + 1), strict=True)
            )
            text = left + sign + right
        return self._of(text, ufunc(*map(_value, inputs)), inputs, binds)

    def __array_function__(self, function: Callable[..., Any], _: Any, inputs: Any, options: Any) -> Any:
        """As `__array_ufunc__`, of the few functions that are none."""
        if function is np.where:
            return self._of("IF({},{},{})".format(*map(self._part, inputs)), np.where(*map(_value, inputs)), inputs)
        if function is np.zeros_like:
            return np.zeros(())
        if function is np.expand_dims:
            return self
        return NotImplemented

    def _of(self, text: str, value: Any, inputs: Any, binds: int = _WHOLE) -> Traced:
        return Traced(text, value, self.workings, any(isinstance(x, Traced) and x.taken for x in inputs), binds)

    def _part(self, x: Any) -> str:
        if not isinstance(x, Traced):
            number = float(x)
            text = "NA()" if np.isnan(number) else repr(number).removesuffix(".0").replace("e", "E")
            return f"({text})" if number < 0 else text
        if len(x.text) > _LONGEST and np.ndim(x.value) == 0:
            x.text, x.binds = self.workings.step(x), _WHOLE
        return x.text


def _bare(x: Any) -> Any:
    """Content of an array of one object; anything else as it is."""
    return x.item() if isinstance(x, np.ndarray) and x.dtype == object else x


def _is(x: Any, number: float) -> bool:
    return not isinstance(x, Traced) and np.ndim(x) == 0 and bool(x == number)


def _value(x: Any) -> Any:
    return x.value if isinstance(x, Traced) else x
