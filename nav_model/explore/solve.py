"""The largest value of one input that still meets each requirement, with the other inputs fixed.

A figure grows with every input solved for, so each answer is an edge between values that meet the limit and values
that do not. All edges are bracketed and found together, in the logarithm of the input, through the broadcasting
closed forms, and each is taken on the side that meets the limit: some figures step, a smoother's where one more fix
enters the leg, an echo where its line leaves the main lobe. Each answer is then put back through `analyse`.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from decimal import ROUND_FLOOR, Context, Decimal
from fractions import Fraction
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.aperture.geometry import WINDOW_WIDTH, cell_length
from nav_model.base.arrays import Array
from nav_model.base.dimensions import DIMENSIONS
from nav_model.base.units import to_si
from nav_model.budget import analyse
from nav_model.budget.inputs import inputs_of
from nav_model.budget.refusals import imaged_inputs
from nav_model.design import Design
from nav_model.design.parts import quantity
from nav_model.explore.margins import ALL, least, needed_limits, ratios

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
_NONE = 1e-300  # of a limit: a figure that is zero, as an estimation without an autofocus
_SAMPLES = 25
_TOLERANCES = {"xatol": 1e-300, "xrtol": 8.9e-16, "fatol": 1e-13, "frtol": 0.0}  # of log(value/limit)
_DOWN = 1e-12  # of the logarithm, from just beyond a limit to within it

_ROUNDING = 1e-15  # first step from an edge that the budget puts elsewhere by a rounding, and the last
_FAR = 1e-3
_DIGITS = (3, 2, 1)  # with which a person types a value

Outcome = Literal["limited", "any value", "no value"]


@dataclass(frozen=True)
class InputAnswer:
    """Largest value of one input for one requirement, or for all.

    ``outcome`` is "limited" when ``value`` [SI] is the largest that meets it; "any value" when every allowed
    value does; "no value" when none does that can be bought or flown. ``margin`` is what `analyse` finds
    with ``value`` put back, None where it was not. ``binding`` names the requirement that limits (for "no value": one
    that stays unmet).
    """

    key: str
    requirement: str
    outcome: Outcome
    value: float | None
    margin: float | None
    binding: str


@dataclass(frozen=True)
class Solution:
    """Answers of one input: one for each requirement, and for all together."""

    key: str
    current: float
    each: tuple[InputAnswer, ...]
    together: InputAnswer


class Offer(NamedTuple):
    """An input as a person types it: the SI that the text reads as, and the unit of the text."""

    key: str
    value: float
    unit: str

    @property
    def changes(self) -> Mapping[str, float]:
        """As `Design.replace` takes it."""
        return {self.key: self.value}

    @property
    def written(self) -> Mapping[str, str]:
        """The units for `Design.replace`."""
        return {self.key: self.unit} if self.unit else {}


def solve(design: Design, *, verify: bool = True) -> tuple[Solution, ...]:
    """The largest value of every input of `SOLVED` that meets each requirement and all of them.

    Parameters
    ----------
    design : Design
    verify : bool
        Whether every answer is put back through `analyse`, some milliseconds each.

    Raises
    ------
    InputError
        If the design gives no requirement, or is one that `analyse` refuses.
    ArithmeticError
        If an answer put back does not meet its limit, and no value just below does: a defect.

    Examples
    --------
    >>> from nav_model import read_design, solve
    >>> design = read_design("examples/mems_x_band.toml")
    >>> gyro = solve(design)[0]
    >>> gyro.key, gyro.together.outcome, f"{gyro.together.value:.2e}"  # rad/√s
    ('imu.angle_random_walk', 'limited', '7.01e-06')
    """
    imaged_inputs(design)
    names = list(needed_limits(design, "solve for"))
    keys = [key for key in SOLVED if key != "gnss.vertical_position_noise" or design[key] is not None]
    roots, outcomes = _roots(design, keys, names)
    solutions = []
    for i, key in enumerate(keys):
        each = tuple(
            InputAnswer(
                key, name, outcomes[i][j], float(roots[i, j]) if outcomes[i][j] == "limited" else None, None, name
            )
            for j, name in enumerate(names)
        )
        if verify:
            each = tuple(_verified(design, answer) for answer in each)
        solutions.append(Solution(key, _current(design, key), each, _together(key, each)))
    return tuple(solutions)


def _current(design: Design, key: str) -> float:
    if key == "radar.aperture_time":
        return float(inputs_of(design).aperture)
    return float(design[key])  # type: ignore[arg-type]


def _together(key: str, each: tuple[InputAnswer, ...]) -> InputAnswer:
    """The least of the answers; a requirement that cannot be met decides for all."""
    stuck = [answer for answer in each if answer.outcome == "no value"]
    if stuck:
        return InputAnswer(key, ALL, "no value", None, None, stuck[0].binding)
    limited = [answer for answer in each if answer.value is not None]
    if not limited:
        return InputAnswer(key, ALL, "any value", None, None, each[0].binding)
    least = min(limited, key=lambda answer: answer.value or 0.0)
    return InputAnswer(key, ALL, "limited", least.value, least.margin, least.binding)


def _verified(design: Design, answer: InputAnswer) -> InputAnswer:
    """The answer with the margin that the budget gives it, moved down where rounding puts the edge elsewhere."""
    if answer.value is None:
        return answer
    value, step = answer.value, _ROUNDING
    while (margin := _margin(design, answer, value)) < 0:
        if step > _FAR:
            raise ArithmeticError(f"{answer.key} = {value!r} gives {answer.binding} a margin of {margin:.3g}")
        value, step = answer.value * (1 - step), 8 * step
    return replace(answer, value=value, margin=margin)


def _margin(design: Design, answer: InputAnswer, value: float) -> float:
    checks = analyse(design.replace({answer.key: value})).straight_leg().checks
    return next(check.margin for check in checks if check.name == answer.binding)


def _bounds(design: Design, key: str) -> tuple[float, float]:
    """Range of an input on a log scale: zero is replaced by a value far below any sensor."""
    high = quantity(key).limits[1]
    return max(least(key, _current(design, key)), _SMALLEST * high), high


def _roots(design: Design, keys: list[str], names: list[str]) -> tuple[Array, list[list[Outcome]]]:
    """Root and outcome for every input (rows) and requirement (columns)."""
    # A figure may meet its limit, break it and meet it again, where it steps: the edge sought is the first one from
    # below. So every input is sampled over its range; the first sample that breaks a limit has the edge behind it.
    low, high = (np.log(np.array(ends)) for ends in zip(*(_bounds(design, key) for key in keys), strict=True))
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
    # All edges are then refined together, each between its two samples, and taken on the side that meets the limit.
    i, j = np.nonzero(~none & ~every)
    k = first[i, j]
    roots = np.full(none.shape, np.nan)
    if i.size:
        from scipy.optimize.elementwise import find_root  # late: the command line starts without it

        def over_limit(x: Array, i: NDArray[np.intp], j: NDArray[np.intp]) -> Array:
            log_ratio: Array = _excess(design, keys, names, i, x)[j, np.arange(len(i))]
            return log_ratio

        # By Chandrupatla's method, Advances in Engineering Software 28(3), 1997.
        root = find_root(over_limit, (grid[i, k - 1], grid[i, k]), args=(i, j), tolerances=_TOLERANCES)
        met = np.maximum(root.bracket[0], root.x - _DOWN)
        roots[i, j] = np.exp(np.where(root.f_x <= 0, root.x, met))
    return roots, outcomes


def _excess(design: Design, keys: list[str], names: list[str], rows: NDArray[np.intp], log_values: Array) -> Array:
    """log(value/limit), shape (requirements, points); point n has input keys[rows[n]] at exp(log_values[n])."""
    changes = {key: np.where(rows == i, np.exp(log_values), _current(design, key)) for i, key in enumerate(keys)}
    by_limit = ratios(design, changes)
    stacked = np.stack(np.broadcast_arrays(*(by_limit[name] for name in names), log_values)[:-1])
    excess: Array = np.log(np.maximum(stacked, _NONE))
    return excess


def resolution_for(design: Design, aperture: float) -> float:
    """Azimuth resolution [m], across the line of sight, that an aperture of so many seconds gives. [S-3]"""
    x = inputs_of(design)
    cell = cell_length(x.wavelength, x.slant_range, x.speed, aperture, x.squint)
    return float(WINDOW_WIDTH[design.radar.window] * cell)


def remedies(solutions: tuple[Solution, ...], requirement: str) -> tuple[InputAnswer, ...]:
    """Alternatives where one input cannot help: the other inputs' answers for the same requirement (or all)."""
    answers = (
        next((a for a in (*solution.each, solution.together) if a.requirement == requirement), None)
        for solution in solutions
    )
    return tuple(answer for answer in answers if answer is not None and answer.outcome == "limited")


def offer(design: Design, solution: Solution) -> Offer | None:
    """The largest value of an input, as a person types it, with which the budget closes; None if none was solved."""
    if solution.together.value is None:
        return None
    offers = (rounded_offer(design, solution.key, solution.together.value, digits) for digits in _DIGITS)
    return next((candidate for candidate in offers if _closes(design, candidate)), None)


def _closes(design: Design, candidate: Offer) -> bool:
    return analyse(design.replace(candidate.changes)).straight_leg().closes


def rounded_offer(design: Design, key: str, value: float, digits: int = 3) -> Offer:
    """A value rounded down to so many digits in the unit that the design has the input in.

    Parameters
    ----------
    design : Design
        Its units.
    key : str
        Dotted key of the input.
    value : float
        SI.
    digits : int, optional
        Significant ones.
    """
    dimension = quantity(key).dimension
    unit = design.unit(key) if dimension else ""
    exact = DIMENSIONS[dimension].number(Fraction(value), unit) if dimension else Fraction(value)
    down = Context(prec=digits, rounding=ROUND_FLOOR).divide(Decimal(exact.numerator), Decimal(exact.denominator))
    return Offer(key, to_si(Fraction(down), unit, dimension) if dimension else float(down), unit)
