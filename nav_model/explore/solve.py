"""The largest value of one input that still meets each requirement, with the other inputs fixed.

Every figure grows with every input solved for, so each answer is one root. All roots are bracketed and found
together, in the logarithm of the input, through the broadcasting closed forms; each answer is then verified by
`analyse`, which must find a margin of zero.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from nav_model.aperture.geometry import WINDOW_WIDTH, cell_length
from nav_model.base.arrays import Array
from nav_model.base.errors import InputError
from nav_model.budget import analyse
from nav_model.budget.fast import LEVELS
from nav_model.budget.inputs import inputs_of
from nav_model.design import Design
from nav_model.design.processing import REAL_TIME
from nav_model.explore.margins import ALL, limits, quantity, ratios

SOLVED = (
    "imu.angle_random_walk",
    "imu.velocity_random_walk",
    "imu.vibration_factor",
    "gnss.position_noise",
    "gnss.vertical_position_noise",
    "gnss.interval",
    "coast.duration",
    "coast.before_aperture",
    "radar.aperture_time",
)
"""Inputs solved for; a vertical fix noise only where the design states one."""

_SMALLEST = 1e-12  # of the upper bound: used as zero where an input may approach zero
_SAMPLES = 25
_STEPS = 60
_CLOSE = 1e-13  # of log(value/limit)

Outcome = Literal["limited", "any value", "no value"]
Verify = Literal["every", "together", "none"]
"""Which answers are put back through `analyse`: every one, those that hold for all requirements together, none."""


@dataclass(frozen=True)
class Answer:
    """How far one input may go for one requirement, or for all.

    ``outcome`` is "limited" when ``value`` [SI] is the largest that meets it; "any value" when every allowed
    value does; "no value" when none does, even as the input goes to zero. ``margin`` is what `analyse` finds
    with ``value`` put back. ``binding`` names the requirement that limits (for "no value": one that stays
    unmet); ``depends`` says whether the input enters that requirement at all.
    """

    key: str
    requirement: str
    outcome: Outcome
    value: float | None
    margin: float | None
    binding: str
    depends: bool


@dataclass(frozen=True)
class Solution:
    """Answers of one input: one for each requirement, and for all together."""

    key: str
    current: float
    each: tuple[Answer, ...]
    together: Answer


def solve(design: Design, verify: Verify = "every") -> tuple[Solution, ...]:
    """The largest value of every input of `SOLVED` that meets each requirement and all of them.

    Parameters
    ----------
    design : Design
    verify : {"every", "together", "none"}
        Which answers are put back through `analyse`, 1 ms each; the others' ``margin`` is None.

    Raises
    ------
    InputError
        If the design gives no requirement.
    ArithmeticError
        If an answer put back does not give a margin of zero in real time, to 1e-9 or with velocity fixes to 1e-7: a
        defect.
    """
    names = list(limits(design))
    if not names:
        raise InputError("requirements", "none is given; give at least one limit to solve for")
    keys = [key for key in SOLVED if key != "gnss.vertical_position_noise" or design[key] is not None]
    roots, outcomes, depends = _roots(design, keys, names)
    solutions = []
    for i, key in enumerate(keys):
        each = tuple(
            Answer(
                key,
                name,
                outcomes[i][j],
                float(roots[i, j]) if outcomes[i][j] == "limited" else None,
                None,
                name,
                bool(depends[i, j]),
            )
            for j, name in enumerate(names)
        )
        if verify == "every":
            each = tuple(_verified(design, answer) for answer in each)
        together = _together(key, each)
        if verify == "together":
            together = _verified(design, together)
        solutions.append(Solution(key, _current(design, key), each, together))
    return tuple(solutions)


def _current(design: Design, key: str) -> float:
    if key == "radar.aperture_time":
        return float(inputs_of(design).aperture)
    return float(design[key])  # type: ignore[arg-type]


def _together(key: str, each: tuple[Answer, ...]) -> Answer:
    """The least of the answers; a requirement that cannot be met decides for all."""
    stuck = [answer for answer in each if answer.outcome == "no value"]
    if stuck:
        return Answer(key, ALL, "no value", None, None, stuck[0].binding, any(a.depends for a in stuck))
    limited = [answer for answer in each if answer.value is not None]
    if not limited:
        return Answer(key, ALL, "any value", None, None, each[0].binding, any(a.depends for a in each))
    least = min(limited, key=lambda answer: answer.value or 0.0)
    return Answer(key, ALL, "limited", least.value, least.margin, least.binding, True)


def _verified(design: Design, answer: Answer) -> Answer:
    if answer.value is None:
        return answer
    margin = _margin(design, answer, answer.value)
    # Some figures are discontinuous: a smoother's where one more fix enters the leg, an echo where its line leaves
    # the main lobe. The answer is then the step, on the side that meets the limit if one does, with its own margin.
    steps = design.processing.mode != REAL_TIME or bool(inputs_of(design).fast)
    # Where fixes tell nearly nothing of the position beside those of velocity, the filter's doubling loses digits.
    exact = 1e-9 if design.gnss.velocity_noise is None else 1e-7
    if not abs(margin) <= exact and not steps:
        raise ArithmeticError(f"{answer.key} = {answer.value!r} gives {answer.binding} a margin of {margin:.3g}")
    if margin < -1e-9 and answer.binding in LEVELS:
        sides = [(answer.value * factor) for factor in (1 - 1e-9, 1 + 1e-9)]
        met = [(side, found) for side in sides if (found := _margin(design, answer, side)) >= 0]
        if met:
            return replace(answer, value=met[0][0], margin=met[0][1])
    return replace(answer, margin=margin)


def _margin(design: Design, answer: Answer, value: float) -> float:
    checks = analyse(design.replace({answer.key: value}), times=[0.0]).verdict.checks
    return next(check.margin for check in checks if check.name == answer.binding)


def _bounds(key: str) -> tuple[float, float]:
    """Range of an input on a log scale: zero is replaced by a value far below any sensor."""
    low, high = quantity(key).limits
    return (max(low, _SMALLEST * high), high)


def _roots(design: Design, keys: list[str], names: list[str]) -> tuple[Array, list[list[Outcome]], Array]:
    """Root, outcome and dependence for every input (rows) and requirement (columns)."""
    low, high = (np.log(np.array(ends)) for ends in zip(*map(_bounds, keys), strict=True))
    grid = low[:, None] + (high - low)[:, None] * np.linspace(0, 1, _SAMPLES)
    rows = np.repeat(np.arange(len(keys)), _SAMPLES)
    excess = _excess(design, keys, names, rows, grid.ravel()).reshape(len(names), len(keys), _SAMPLES)
    excess = np.moveaxis(excess, 0, 1)  # input, requirement, sample
    over: NDArray[np.bool_] = np.greater(excess, 0)
    first = np.argmax(over, axis=-1)  # of the samples that break the limit
    none, every = over[..., 0], np.logical_not(over.any(axis=-1))
    outcomes: list[list[Outcome]] = [
        ["no value" if none[i, j] else "any value" if every[i, j] else "limited" for j in range(len(names))]
        for i in range(len(keys))
    ]
    with np.errstate(invalid="ignore"):
        depends = np.ptp(excess, axis=-1) > 0
    i, j = np.nonzero(~none & ~every)
    k = first[i, j]
    roots = np.full(none.shape, np.nan)
    if i.size:
        bracket = (grid[i, k - 1], grid[i, k], excess[i, j, k - 1], excess[i, j, k])
        roots[i, j] = np.exp(_bracketed(lambda x: _excess(design, keys, names, i, x)[j, np.arange(len(i))], *bracket))
    return roots, outcomes, depends


def _excess(design: Design, keys: list[str], names: list[str], rows: NDArray[np.intp], log_values: Array) -> Array:
    """log(value/limit), shape (requirements, points); point n has input keys[rows[n]] at exp(log_values[n])."""
    changes = {key: np.where(rows == i, np.exp(log_values), _current(design, key)) for i, key in enumerate(keys)}
    found = ratios(design, changes)
    excess: Array = np.log(np.stack(np.broadcast_arrays(*(found[name] for name in names), log_values)[:-1]))
    return excess


def _bracketed(function: Callable[[Array], Array], a: Array, b: Array, at_a: Array, at_b: Array) -> Array:
    """Roots of increasing functions, one in each bracket: Chandrupatla's method on all of them together.

    Source: Chandrupatla, Advances in Engineering Software 28(3), 1997.
    """
    c, at_c = a, at_a
    fraction = np.full_like(a, 0.5)
    best = np.where(np.abs(at_a) < np.abs(at_b), a, b)
    for _ in range(_STEPS):
        x = a + fraction * (b - a)
        at_x = function(x)
        same = np.sign(at_x) == np.sign(at_a)
        c, at_c = np.where(same, a, b), np.where(same, at_a, at_b)
        b, at_b = np.where(same, b, a), np.where(same, at_b, at_a)
        a, at_a = x, at_x
        best = np.where(np.abs(at_a) < np.abs(at_b), a, b)
        width = np.abs(b - a)
        tolerance = 4 * np.spacing(np.abs(best)) + 1e-300
        if np.all((np.minimum(np.abs(at_a), np.abs(at_b)) <= _CLOSE) | (width <= tolerance)):
            break
        with np.errstate(divide="ignore", invalid="ignore"):
            xi, phi = (a - b) / (c - b), (at_a - at_b) / (at_c - at_b)
            inverse = (phi**2 < xi) & ((1 - phi) ** 2 < 1 - xi)
            step = at_a / (at_b - at_a) * at_c / (at_b - at_c) + (c - a) / (b - a) * at_a / (at_c - at_a) * at_b / (
                at_c - at_b
            )
            least = np.minimum(tolerance / np.maximum(width, tolerance), 0.5)
        fraction = np.where(inverse & np.isfinite(step), np.clip(step, least, 1 - least), 0.5)
    return best


def resolution_for(design: Design, aperture: float) -> float:
    """Azimuth resolution [m], across the line of sight, that an aperture of so many seconds gives. [S-3]"""
    x = inputs_of(design)
    cell = cell_length(x.wavelength, x.slant_range, x.speed, aperture, x.squint)
    return float(WINDOW_WIDTH[design.radar.window] * cell)


def remedies(solutions: tuple[Solution, ...], requirement: str) -> tuple[Answer, ...]:
    """Alternatives where one input cannot help: the other inputs' answers for the same requirement (or all)."""
    answers = (
        next((a for a in (*solution.each, solution.together) if a.requirement == requirement), None)
        for solution in solutions
    )
    return tuple(answer for answer in answers if answer is not None and answer.outcome == "limited")


def round_down(value: float) -> float:
    """The largest number of three significant digits that is not above `value`, so that it still meets the limit."""
    if value <= 0:
        return 0.0
    unit = 10.0 ** (math.floor(math.log10(value)) - 2)
    return math.floor(value / unit * (1 + 1e-12)) * unit
