"""Allocation of a requirement: what each sensor and contributor may take of its limit, less a reserve.

The initial tilt belongs to the noises that cause it [T-18], so that every entry has somebody who can answer for it.
Allocated entries combine as the figure does: the root of the sum of squares of what is random plus the sum of what is
systematic is the limit times (1 - reserve). Source: ECSS-E-ST-60-10C, apportionment of an error budget.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError, not_a_choice, quoted
from nav_model.budget.contributors import as_phase
from nav_model.budget.result import Budget
from nav_model.budget.verdict import Check, required
from nav_model.design.figures import RESPONSE
from nav_model.design.user_entries import Allotment
from nav_model.processing.paired_echo import NOTHING


@dataclass(frozen=True)
class AllocationEntry:
    """Allowance of one source and its value today, both in SI at the confidence of the limit.

    ``margin`` is 1 - estimated/allocated, None where nothing is left to allocate.
    """

    source: str
    allocated: float
    estimated: float
    owner: str
    locked: bool
    systematic: bool

    @property
    def margin(self) -> float | None:
        """The part of the allocated value that is left over."""
        return 1 - self.estimated / self.allocated if self.allocated else None


@dataclass(frozen=True)
class Allocation:
    """The entries of one requirement; ``limit`` in SI, ``blocked_by`` the locks that leave nothing for the rest."""

    requirement: str
    limit: float
    reserve: float
    blocked_by: tuple[str, ...]
    entries: tuple[AllocationEntry, ...]

    @property
    def closes(self) -> bool:
        """True if the entries fit the limit with the reserve."""
        return not self.blocked_by


def check_of(budget: Budget, requirement: str | None = None) -> Check:
    """The check of a requirement on the straight leg, by default the tightest that can be allocated, where one can.

    Raises
    ------
    InputError
        If the design has no requirement, or none of this name.
    """
    checks = {check.name: check for check in budget.straight_leg().checks}
    if not checks:
        reason = (
            "Only a flight judges what the design requires"
            if budget.verdict.checks
            else "The design has no requirement"
        )
        raise InputError("requirement", f"{reason}, so there is nothing to allocate.")
    if requirement is None:
        return min(checks.values(), key=lambda check: (check.on in RESPONSE, check.margin))
    if requirement not in checks:
        raise InputError("requirement", not_a_choice(requirement, checks), requirement)
    return checks[requirement]


def allocate(budget: Budget, requirement: str | None = None, plan: Allotment | None = None) -> Allocation:
    """Split a requirement's limit among the sources that are above zero.

    Parameters
    ----------
    budget : Budget
    requirement : str, optional
        Name of a check of the budget's verdict; by default the tightest.
    plan : Allotment, optional
        By default that of the design. Its `reserve` is the part of the limit that is not allocated, its `locks` are
        what sources of this requirement take, and its `split` says how the rest is split. "equal": every entry has
        the same value. "shares": all have the same ratio to their estimates, so that they keep their shares among
        each other. "cheapest": the sum over the free entries of the squared relative change,
        ((allocated - estimated) / estimated)², is as small as it can be; an entry that this takes below zero is zero.

    Raises
    ------
    InputError
        As `check_of`, for a measure of the impulse response, and for a lock of an unknown source.

    Examples
    --------
    >>> from nav_model import allocate, analyse, read_design
    >>> design = read_design("examples/mems_x_band.toml")
    >>> split = allocate(analyse(design), "detrended_phase")
    >>> split.entries[0].source, round(split.entries[0].allocated, 4)  # rad
    ('accelerometer noise', 0.0746)
    """
    check, plan = check_of(budget, requirement), plan or budget.design.allocation or Allotment()
    if check.on in RESPONSE:
        raise InputError(
            "requirement",
            f"{quoted(check.name)} limits a measure of the impulse response, which is not a sum over sources. "
            "Allocate a limit on the quadratic phase instead.",
            check.name,
        )
    locked = {
        lock.name: as_phase(lock.value, lock.dimension, check.dimension, budget.sar.wavelength)
        for lock in plan.locks
        if lock.requirement == check.name
    }
    sizes, systematic = _sizes(budget, check)
    for source in locked.keys() - sizes.keys():
        reason = f"{source!r} is no source here; {check.label} has {', '.join(sizes) or 'none'}. Remove its lock."
        raise InputError("lock", reason, source)
    target = check.limit * (1 - plan.reserve)
    free = [source for source in sizes if source not in locked]
    square = sum(value**2 for source, value in locked.items() if source not in systematic)
    remainder = target - sum(value for source, value in locked.items() if source in systematic)
    blocked: tuple[str, ...] = ()
    # With nothing free, locks may use the whole of the target; rounding of their sum is no excess.
    if locked and math.sqrt(square) >= remainder + (0 if free else 1e-12 * target):
        alone = tuple(source for source, value in locked.items() if value >= target)
        blocked = alone or tuple(locked)
    allocated = dict(locked) | dict.fromkeys(free, 0.0)
    if free and not blocked:
        estimates = np.array([sizes[source] for source in free])
        linear = np.array([source in systematic for source in free])
        start = np.ones(len(free)) if plan.split == "equal" else estimates
        if plan.split == "cheapest":
            start = _cheapest(estimates, linear, square, remainder)
        split_up = start * _factor(start, linear, square, remainder)
        allocated |= dict(zip(free, split_up.tolist(), strict=True))
    owners = {contributor.name: contributor.owner for contributor in budget.design.contributors}
    entries = tuple(
        AllocationEntry(
            source, allocated[source], size, owners.get(source, ""), source in locked, source in systematic
        )
        for source, size in sizes.items()
    )
    return Allocation(check.name, check.limit, plan.reserve, blocked, entries)


def _sizes(budget: Budget, check: Check) -> tuple[dict[str, float], frozenset[str]]:
    """Size of each source of a figure at the confidence of its limit, and the names of the systematic ones."""
    figure = budget.composed(check.on, budget.processing, required(budget.design)[check.name].at)
    sizes = {source: (check.confidence or 1.0) * float(size) for source, size in figure.sizes.items()}
    systematic = frozenset(part.name for part in figure.parts if part.systematic)
    return {source: size for source, size in sizes.items() if size > NOTHING}, systematic


def _combined(values: Array, linear: NDArray[np.bool_], square: float) -> float:
    """The free entries with the `square` of the random locks."""
    return float(np.sqrt(square + np.sum(values[~linear] ** 2)) + np.sum(values[linear]))


def _factor(values: Array, linear: NDArray[np.bool_], square: float, target: float) -> float:
    """By what all values are multiplied to combine to the `target`: the positive root of a quadratic equation."""
    squares, sums, rest = float(np.sum(values[~linear] ** 2)), float(np.sum(values[linear])), target**2 - square
    return rest / (target * sums + math.sqrt(squares * rest + sums**2 * square))


def _cheapest(estimates: Array, linear: NDArray[np.bool_], square: float, target: float) -> Array:
    """The point nearest to today's, each axis in units of its estimate, of all that combine to the `target`.

    Lagrange's condition for a random entry e is a = e / (1 + t e²), and for a systematic one a = e (1 - t r e), not
    below zero, with r the root of the sum of squares of all random ones; one multiplier t holds for all. Where even
    random entries of zero leave systematic ones too large, the random ones are zero.
    """
    from scipy.optimize import brentq  # here, as a budget without an allocation does not need SciPy

    scale = float(np.max(estimates))
    e, square, target = estimates / scale, square / scale**2, target / scale

    def at(multiplier: float) -> Array:
        values = np.where(linear, 0.0, e / (1 + multiplier * e**2))
        root = math.sqrt(square + float(np.sum(values**2)))
        return np.where(linear, e * np.maximum(1 - multiplier * root * e, 0), values)

    def linear_at(multiplier: float) -> Array:
        return np.where(linear, e * np.maximum(1 - multiplier * e, 0), 0.0)

    def solved(along: Callable[[float], Array], low: float, high: float) -> Array:
        best = brentq(lambda t: _combined(along(t), linear, square) - target, low, high, xtol=1e-300, rtol=1e-14)
        return scale * along(float(best))

    if np.all(linear):
        most = 1 / float(np.min(e))  # there, every entry is zero
        least = -(target + float(np.sum(e))) / float(np.sum(e**2))
        return solved(linear_at, least, most)
    if _combined(e, linear, square) >= target:
        high = 1.0
        while _combined(at(high), linear, square) > target:
            high *= 8
            if high > 1e60:
                return solved(linear_at, 0.0, 1 / float(np.min(e)))
        return solved(at, 0.0, high)
    pole = -1 / float(np.max(e[~linear])) ** 2
    short = 0.5
    while _combined(at(pole * (1 - short)), linear, square) < target:
        short /= 8
    return solved(at, pole * (1 - short), 0.0)
