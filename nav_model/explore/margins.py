"""Value over limit of each requirement, for arrays of designs."""

from collections.abc import Hashable, Iterator, Mapping, Sequence
from typing import cast

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError
from nav_model.budget import verdict
from nav_model.budget.figures import figures
from nav_model.budget.inputs import VARIABLES, VARYING_KEYS, Inputs, Replacement, inputs_of
from nav_model.design import Design, Value
from nav_model.design import figures as declared
from nav_model.design.figures import figure_in_sentence
from nav_model.design.parts import PRESET_KEYS, quantity

ALL = "all requirements"
"""Name of the result that is the largest value over limit of every requirement given."""

_AT_ONCE = 250  # designs in one pass: a slow error takes 0.2 MB for each
_NO_CHOICE = (*PRESET_KEYS, "imu.sheet")  # names of where numbers come from

Columns = Mapping[str, Array | None]
"""Dotted key -> values of an input for several designs, None where it is left out."""


def limits(design: Design) -> dict[str, float]:
    """Limit at one sigma [SI] of every figure with a requirement, in the order of the verdict."""
    return {name: check.at_one_sigma for name, check in verdict.required(design).items()}


def needed_limits(design: Design, purpose: str) -> dict[str, float]:
    """`limits`, of which there is at least one; `purpose`: what they are for, as "close".

    Raises
    ------
    InputError
        Under "requirements": none is given, or a flight alone judges those that are.
    """
    by_figure = limits(design)
    if not by_figure and (names := verdict.flown_names(design)):
        judged = ", ".join(map(figure_in_sentence, names))
        raise InputError(
            "requirements",
            f"a flight alone judges {judged}: ask `manoeuvre` what would meet it, or give a limit that a straight "
            f"leg judges, to {purpose}",
        )
    if not by_figure:
        raise InputError("requirements", f"none is given; give at least one limit to {purpose}")
    return by_figure


def ratios(design: Design, changes: Mapping[str, Replacement] | None = None) -> dict[str, Array]:
    """Value over limit of every requirement given; met at or below one. Margin is one minus it.

    `changes` replaces inputs by numbers or arrays, as in `nav_model.budget.inputs.inputs_of`.
    """
    return ratios_of(design, inputs_of(design, changes))


def ratios_of(design: Design, x: Inputs) -> dict[str, Array]:
    """As `ratios`, from inputs made before."""
    allowed: dict[str, Array | float] = dict(limits(design))
    given = design.requirements.path_before_autofocus
    if x.residual is not None and x.half_cell is not None and design.autofocus.migration == "stays":
        cell = x.half_cell if given is None else np.minimum(x.half_cell, given)  # it may follow the resolution
        allowed["path_before_autofocus"] = cell / design.requirements.confidence
    return {name: sigma / allowed[name] for name, sigma in figures(x, list(allowed)).items()}


def alike(design: Design, trials: Sequence[Mapping[str, Value]]) -> Iterator[tuple[list[int], Design, Columns]]:
    """Changes of a design in groups that one pass through the formulas can take.

    A choice, an input that is left out, and biases that vary are no numbers: what differs in them is apart.

    Parameters
    ----------
    design : Design
    trials : sequence of mapping
        Dotted key -> value in SI, each mapping a change by itself.

    Yields
    ------
    tuple
        Numbers of the trials, at most `_AT_ONCE`, the design with their choices, and their numeric inputs as columns.
    """
    groups: dict[tuple[frozenset[tuple[str, Value]], Hashable], list[int]] = {}
    for n, trial in enumerate(trials):
        choices = frozenset(
            (key, value) for key, value in trial.items() if key not in VARIABLES and key not in _NO_CHOICE
        )
        empty = frozenset(key for key, value in trial.items() if value is None)
        varies = any(trial.get(key, design[key]) for key in VARYING_KEYS if not key.endswith("_time"))
        numeric = frozenset(key for key in trial if key in VARIABLES and design[key] is None)
        groups.setdefault((choices, (empty, numeric, varies)), []).append(n)
    for (choices, _), members in groups.items():
        base = design.replace(dict(choices))
        for start in range(0, len(members), _AT_ONCE):
            chunk = members[start : start + _AT_ONCE]
            keys = dict.fromkeys(key for n in chunk for key in trials[n] if key in VARIABLES)
            yield chunk, base, {key: _column(design, [trials[n] for n in chunk], key) for key in keys}


def _column(design: Design, trials: Sequence[Mapping[str, Value]], key: str) -> Array | None:
    """Values of an input, the design's where a trial leaves it; None where it is left out."""
    values = [trial.get(key, design[key]) for trial in trials]
    return None if values[0] is None else np.array(values, float)


def ratios_of_trials(design: Design, trials: Sequence[Mapping[str, Value]]) -> dict[str, Array]:
    """As `ratios`, of changes of any inputs, each by itself; NaN for a design that would be refused,
    zero where one has no such limit.

    Parameters
    ----------
    design : Design
    trials : sequence of mapping
        Dotted key -> value in SI.
    """
    by_limit: dict[str, Array] = {}
    for members, base, columns in alike(design, trials):
        for name, ratio in ratios(base, columns).items():  # a choice, such as an autofocus, may have its own limits
            by_limit.setdefault(name, np.zeros(len(trials)))[members] = ratio
    return by_limit


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
