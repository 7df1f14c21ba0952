"""Allocation against the sum written out here and against a numerical optimiser."""

import math
import random
from functools import cache
from typing import Any

import numpy as np
import pytest
from scipy.optimize import minimize

from nav_model import Budget, Design, InputError, analyse
from nav_model.budget.allocation import Allocation, allocate
from nav_model.design.contributors import Contributor
from nav_model.design.user_entries import SPLITS, Allotment, Lock, UserEntries

_REQUIREMENTS = {
    "detrended_phase": 0.3, "quadratic_phase": 1.0, "ce90": 5.0, "horizontal_position": 1.0, "tilt": 1e-3,
    "coast_horizontal_position": 30.0, "islr": 0.1,
}  # fmt: skip


_SYSTEMATIC = ("time tag", "datum")


@cache
def _budget(seed: int) -> Budget:
    draw = random.Random(seed)
    changes: dict[str, Any] = {
        f"requirements.{name}": limit * 10 ** draw.uniform(-0.7, 0.7) for name, limit in _REQUIREMENTS.items()
    }
    changes |= {
        "requirements.confidence": draw.choice([1.0, 2.0]),
        "processing.mode": draw.choice(["real time", "post-processed"]),
        "imu.angle_random_walk": 10 ** draw.uniform(-6, -4), "gnss.position_noise": 10 ** draw.uniform(-1.5, 0.5),
    }  # fmt: skip
    contributors = (
        Contributor("lever arm", 10 ** draw.uniform(-4, -3), "detrended_phase", "length", owner="mechanics"),
        Contributor("time tag", 10 ** draw.uniform(-2.5, -1), "detrended_phase", "angle", kind="systematic"),
        Contributor("datum", 10 ** draw.uniform(-2, 0), "ce90", "length", kind="systematic", allowance=0.2),
    )
    return analyse(Design(changes, entries=UserEntries(contributors)))


def _combined(values: dict[str, float]) -> float:
    """As a figure is: the root of the random ones' squares, and the systematic ones."""
    square = sum(value**2 for source, value in values.items() if source not in _SYSTEMATIC)
    return math.sqrt(square) + sum(value for source, value in values.items() if source in _SYSTEMATIC)


def _whole(allocation: Allocation) -> float:
    return _combined({entry.source: entry.allocated for entry in allocation.entries})


def test_today_combines_to_the_value_that_is_checked() -> None:
    for seed in range(10):
        for check in _budget(seed).verdict.checks:
            entries = allocate(_budget(seed), check.name).entries
            if check.name != "islr":
                today = _combined({entry.source: entry.estimated for entry in entries})
                assert today == pytest.approx(check.value, rel=1e-9), check.name


def test_a_noise_is_allocated_what_it_alone_adds_to_the_limit() -> None:
    # With the filter as it is the variance is a sum over the noises: the derivative by a noise's square is its part.
    design = Design({"requirements.detrended_phase": 0.3, "coast.before_aperture": 5.0})
    budget, step = analyse(design), 1e-4
    entries = {entry.source: entry for entry in allocate(budget, "detrended_phase", Allotment()).entries}
    assert entries.keys() == {"gyro noise", "accelerometer noise", "GNSS noise"}
    for key, source in (("imu.angle_random_walk", "gyro noise"), ("gnss.position_noise", "GNSS noise")):
        near = [
            analyse(design.replace({key: design[key] * (1 + sign * step)})).verdict.checks[0].value
            for sign in (1, -1)
        ]
        part = (near[0] ** 2 - near[1] ** 2) / (4 * step)
        assert entries[source].estimated ** 2 == pytest.approx(part, rel=1e-4)


def test_random_allocations_close_with_the_reserve_or_name_the_lock() -> None:
    draw, blocked = random.Random(29), 0
    for number in range(500):
        budget = _budget(number % 20)
        name = draw.choice([check.name for check in budget.verdict.checks if check.name != "islr"])
        reserve, split = draw.uniform(0, 0.99), draw.choice(SPLITS)
        plain = allocate(budget, name, Allotment(split, reserve))
        target = plain.limit * (1 - reserve)
        assert plain.closes
        assert _whole(plain) == pytest.approx(target, rel=1e-9)
        sources = [entry.source for entry in plain.entries]
        locks = {
            source: target * draw.uniform(0.05, 1.2) for source in draw.sample(sources, min(2, len(sources) - 1))
        }
        check = next(check for check in budget.verdict.checks if check.name == name)
        locked = tuple(Lock(name, source, value, check.dimension) for source, value in locks.items())
        result = allocate(budget, name, Allotment(split, reserve, locked))
        values = {entry.source: entry.allocated for entry in result.entries}
        assert locks.items() <= values.items()
        assert {entry.source for entry in result.entries if entry.locked} == locks.keys()
        if _combined(locks) < target:
            assert result.closes
            assert _whole(result) == pytest.approx(target, rel=1e-9)
            assert all(entry.allocated >= 0 for entry in result.entries)
        else:
            blocked += 1
            assert not result.closes
            assert set(result.blocked_by) <= locks.keys()
            assert result.blocked_by
    assert 20 < blocked < 480


def test_equal_ones_are_equal_and_shares_keep_their_ratio() -> None:
    budget = _budget(1)
    equal = [e.allocated for e in allocate(budget, "detrended_phase", Allotment("equal")).entries]
    assert equal == pytest.approx([equal[0]] * len(equal), rel=1e-12)
    ratios = [e.allocated / e.estimated for e in allocate(budget, "detrended_phase", Allotment("shares")).entries]
    assert ratios == pytest.approx([ratios[0]] * len(ratios), rel=1e-12)
    margins = [e.margin for e in allocate(budget, "detrended_phase", Allotment("shares")).entries]
    assert margins == pytest.approx([1 - 1 / ratios[0]] * len(ratios), rel=1e-9)


@pytest.mark.parametrize("seed", range(20))
def test_the_cheapest_is_that_of_a_numerical_optimiser(seed: int) -> None:
    budget = _budget(seed)
    for name, reserve in (("detrended_phase", 0.2), ("ce90", 0.2), ("detrended_phase", 0.95)):
        allocation = allocate(budget, name, Allotment("cheapest", reserve))
        target = (1 - reserve) * allocation.limit
        e = np.array([entry.estimated for entry in allocation.entries])
        linear = np.array([entry.source in _SYSTEMATIC for entry in allocation.entries])
        ours = np.array([entry.allocated for entry in allocation.entries]) / e

        def remaining(x: Any, e: Any = e, linear: Any = linear, target: float = target) -> float:
            root = np.sqrt(np.sum((e * x)[~linear] ** 2))
            return float((root + np.sum((e * x)[linear])) / target - 1)

        def cost(x: Any) -> float:
            return float(np.sum((x - 1) ** 2))

        starts = [target / (remaining(np.ones(len(e))) * target + target) * np.ones(len(e)), ours * 1.3 + 0.01]
        best = min(
            (
                minimize(cost, start, constraints={"type": "eq", "fun": remaining}, bounds=[(0, None)] * len(e),
                         method="SLSQP", options={"ftol": 1e-15, "maxiter": 2000})
                for start in starts
            ),
            key=lambda result: result.fun if abs(remaining(result.x)) < 1e-7 else math.inf,
        )  # fmt: skip
        assert abs(remaining(best.x)) < 1e-7
        assert cost(ours) <= best.fun * (1 + 1e-5) + 1e-9
        assert ours == pytest.approx(best.x, rel=1e-3, abs=2e-3 * float(np.max(best.x)))


@pytest.mark.parametrize(
    ("named", "options"),
    [
        ("allocation.split", {"split": "fair"}),
        ("allocation.reserve", {"reserve": 1.0}),
        ("allocation.reserve", {"reserve": -0.1}),
        ("allocation.reserve", {"reserve": math.nan}),
    ],
)
def test_a_plan_that_is_wrong_is_refused_by_name(named: str, options: dict[str, Any]) -> None:
    with pytest.raises(InputError) as refused:
        Allotment(**options)
    assert refused.value.key == named


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_a_lock_is_more_than_zero(value: float) -> None:
    with pytest.raises(InputError) as refused:
        Lock("tilt", "gyro noise", value, "angle")
    assert refused.value.key == "allocation.locks.tilt.gyro noise"


def test_what_is_not_there_is_refused_by_name() -> None:
    for requirement in ("yaw", "le90"):
        with pytest.raises(InputError, match="requirement"):
            allocate(_budget(1), requirement)
    with pytest.raises(InputError, match=r"lock: 'lever arm' is no source here; Tilt has .*Remove its lock"):
        allocate(_budget(1), "tilt", Allotment(locks=(Lock("tilt", "lever arm", 1.0, "angle"),)))


def test_a_design_without_requirements_has_nothing_to_allocate() -> None:
    with pytest.raises(InputError, match="no requirement"):
        allocate(analyse(Design()))


def test_the_tightest_is_taken_and_the_owner_named() -> None:
    budget = _budget(3)
    assert allocate(budget).requirement == budget.verdict.tightest.name
    owners = {e.source: e.owner for e in allocate(budget, "detrended_phase").entries}
    assert owners.pop("lever arm") == "mechanics"
    assert not any(owners.values())
