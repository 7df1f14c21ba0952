"""Value over limit of each requirement, for arrays of designs."""

from collections.abc import Mapping
from typing import cast

import numpy as np

from nav_model.base.arrays import Array
from nav_model.budget import verdict
from nav_model.budget.figures import figures
from nav_model.budget.inputs import Inputs, Replacement, inputs_of
from nav_model.design import Design, Value
from nav_model.design import figures as declared
from nav_model.design.parts import quantity

ALL = "all requirements"
"""Name of the result that is the largest value over limit of every requirement given."""


def limits(design: Design) -> dict[str, float]:
    """Limit at one sigma [SI] of every figure with a requirement, in the order of the verdict."""
    return {name: check.at_one_sigma for name, check in verdict.required(design).items()}


def ratios(design: Design, changes: Mapping[str, Replacement] | None = None) -> dict[str, Array]:
    """Value over limit of every requirement given; met at or below one. Margin is one minus it.

    `changes` replaces inputs by numbers or arrays, as in `nav_model.budget.inputs.inputs_of`.
    """
    return ratios_of(design, inputs_of(design, changes))


def ratios_of(design: Design, x: Inputs) -> dict[str, Array]:
    """As `ratios`, from inputs made before."""
    allowed = limits(design)
    return {name: sigma / allowed[name] for name, sigma in figures(x, list(allowed)).items()}


def worst(by_requirement: Mapping[str, Array]) -> Array:
    """The largest of the ratios, NaN where one is: that design is not allowed.

    Raises
    ------
    ValueError
        If there is no requirement.
    """
    if not by_requirement:
        raise ValueError("requirements: none is given; give at least one limit")
    largest: Array = np.maximum.reduce(np.broadcast_arrays(*by_requirement.values()))
    return largest


def label_of(result: str) -> str:
    """A figure's label, or that of `ALL`."""
    return "All requirements" if result == ALL else declared.label_of(result)


def value_of(values: Mapping[str, Value] | Design, key: str) -> Value:
    """The value of a numeric input, or what holds where it is left out."""
    declaration, section = quantity(key), key.partition(".")[0]
    if (value := values[key]) is None and declaration.instead:
        value = value_of(values, f"{section}.{declaration.instead}")
        if declaration.in_ratio:
            over, under = (value_of(values, f"{section}.{name}") for name in declaration.in_ratio)
            value = cast("float", value) * cast("float", over) / cast("float", under)
    return value


def least(key: str, now: float) -> float:
    """The least of an input [SI] that can be bought or flown, where the design has `now`.

    Zero where that is allowed; else the lower end of what people explore, or what the design has if that is less.
    """
    low = quantity(key).limits[0]
    return low if low == 0 else min(usual_range(key)[0], now)


def usual_range(key: str) -> tuple[float, float]:
    """The range of an input that people explore, SI."""
    low, high = cast("tuple[float, float]", quantity(key).softbounds)
    return float(low), float(high)
