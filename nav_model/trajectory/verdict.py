"""The checks that a flight makes, in the class of those of a budget: each requirement on the line that is worst."""

import math
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace

import numpy as np

from nav_model.base.errors import InputError
from nav_model.base.frozen import FrozenMapping
from nav_model.budget import Budget
from nav_model.budget.contributors import Shares
from nav_model.budget.verdict import Check, Required, all_required, check_of, flies, flight_required
from nav_model.design.processing import POST_PROCESSED, REAL_TIME
from nav_model.trajectory.covariance import figures_on_lines
from nav_model.trajectory.design_study import along_flight, planned
from nav_model.trajectory.errors import MOST_STEPS
from nav_model.trajectory.lines import judge
from nav_model.trajectory.result import STATE_AXES, LineResult, OnLines, TrajectoryResult

_BASIS = {REAL_TIME: "covariance along the flight", POST_PROCESSED: "smoothed along the flight"}
_OF_STATES = {REAL_TIME: "[P-13]", POST_PROCESSED: "[P-14]"}
_OF_IMAGES = "[P-15]"


def with_flight(budget: Budget, most_steps: int = MOST_STEPS) -> Budget:
    """The budget with the checks of its design's flight, in both processings; as it is where no flight judges.

    Raises
    ------
    InputError
        Naming the key of the design that cannot be flown in `most_steps` steps, or whose covariance is not finite.

    Examples
    --------
    >>> from nav_model import analyse, with_flight, read_design
    >>> design = read_design("examples/mems_x_band.toml")
    >>> design = design.replace({"requirements.heading": 0.001, "trajectory.duration": 60.0})
    >>> check = with_flight(analyse(design)).verdict.checks[-1]
    >>> check.name, check.state, check.judged
    ('heading', 'not met', 'flight')
    """
    design = budget.design
    if not flies(design):
        return budget
    spec = along_flight(design, planned(design))
    try:
        along = figures_on_lines(spec, most_steps=most_steps)
    except ArithmeticError as error:
        raise InputError("trajectory.flight", f"{error}. Bring the design's values closer together.") from error
    return replace(budget, flight=_checks(along, budget))


def checks_of(result: TrajectoryResult, budget: Budget) -> Mapping[str, tuple[Check, ...]]:
    """The checks of a flight, by processing, as `Budget.flight` has them, beside the budget of its design."""
    return _checks(result.on_lines, budget)


def _checks(along: OnLines, budget: Budget) -> Mapping[str, tuple[Check, ...]]:
    required = flight_required(budget.design, every=along.spec.every)
    everywhere = all_required(budget.design)
    checks = {}
    for processing in along.figures:
        lines = judge(along.spec, along.time_s, along.figures[processing], along.sources)
        legs: dict[str, float] = {}
        with suppress(InputError):  # whoever reads that verdict is told
            legs = {check.name: check.value for check in budget.straight_leg(processing).checks}
        checks[processing] = tuple(
            _check(name, requirement, name in everywhere, lines, along, processing, legs.get(name))
            for name, requirement in required.items()
        )
    return FrozenMapping(checks)


def _check(
    name: str, required: Required, everywhere: bool, lines: tuple[LineResult, ...], along: OnLines, processing: str,
    straight: float | None,
) -> Check:  # fmt: skip
    """A requirement on the line that is farthest beyond its limit, or nearest to it.

    Parameters
    ----------
    name : str
    required : Required
    everywhere : bool
        Whether it holds on lines without a limit of their own.
    lines : tuple of LineResult
    along : OnLines
        What they were judged from.
    processing : str
    straight : float or None
        The straight leg's value beside it.
    """
    figure, factor = required.on, required.confidence or 1.0
    of_lines = [dict(line.most).get(figure) for line in along.spec.lines] or [None]
    limited = [
        (line, required if most is None else replace(required, limit=factor * most))
        for line, most in zip(lines, of_lines, strict=True)
        if everywhere or most is not None
    ]
    usual = {
        "straight": straight,
        "basis": _BASIS[processing],
        "equation": _OF_STATES[processing] if figure in STATE_AXES else _OF_IMAGES,
    }
    known = [(line, limit) for line, limit in limited if figure not in line.refused]
    worst = max(known, key=lambda each: each[0].worst[figure] / each[1].limit, default=None)
    checked = worst and check_of(
        name,
        worst[1],
        worst[0].worst[figure],
        judged=worst[0].name,
        shares=_shares(along, processing, figure, worst[0].worst_s[figure]),
        **usual,
    )
    refused = next((each for each in limited if figure in each[0].refused), None)
    if refused is None or (checked and checked.state == "not met"):
        assert checked is not None
        return checked
    line, limit = refused
    reason = f"{line.name} {line.reason}"
    return check_of(name, limit, math.nan, state="refused", judged=line.name, reason=reason, **usual)


def _shares(along: OnLines, processing: str, figure: str, time_s: float) -> Shares:
    """Shares of the sources in a figure at a time of the flight."""
    output = int(np.argmin(np.abs(along.time_s - time_s)))
    shares = np.nan_to_num(along.figures[processing].shares[figure][:, output])  # a figure of zero has none
    return FrozenMapping(dict(zip(along.sources, shares.tolist(), strict=True)))
