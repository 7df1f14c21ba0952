"""Whatever moves a figure of the budget moves it along a straight flight as much, or is refused by name."""

from functools import cache

import numpy as np
import pytest

from app.examples import example
from nav_model.budget import analyse
from nav_model.design import Design
from nav_model.design.declaration import BaseQuantity
from nav_model.design.figures import IN_FLIGHT, OF_BUDGET
from nav_model.design.parts import INPUTS, quantity
from nav_model.design.processing import POST_PROCESSED, REAL_TIME
from nav_model.simulation.design_study import specification
from nav_model.trajectory.covariance import covariance
from nav_model.trajectory.design_study import covariance_specification
from nav_model.trajectory.result import TrajectoryResult

MEMS = example("mems_x_band").replace(
    {
        "gnss.correlated": True,
        "gnss.correlated_noise": 0.3,
        "gnss.correlation_time": 60.0,
        "gnss.vertical_position_noise": 0.8,
        "gnss.velocity_noise": 0.1,
        "gnss.vertical_velocity_noise": 0.1,
        "imu.accelerometer_bias": 1e-3,
        "imu.gyro_bias": 1e-5,
        "processing.scene_height_error": 1.0,
        "motion.lines": ((20.0, 3.0, "acceleration"),),
        "motion.rectification": 1e-5,
        "requirements.steady_state": "posterior",
        "accelerometer.bias_instability": 1e-3,
        "accelerometer.correlation_time": 3000.0,
        "accelerometer.turn_on_bias": 3e-3,
        "accelerometer.misalignment": 2e-4,
        "accelerometer.rate_random_walk": 1e-6,
        "gyro.bias_instability": 5e-6,
        "gyro.correlation_time": 3000.0,
        "gyro.turn_on_bias": 1e-5,
        "gyro.scale_factor": 3e-3,
        "gyro.misalignment": 3e-3,
        "gyro.rate_random_walk": 1e-8,
        "gyro.g_sensitivity": 1e-7,
    }
)
SOURCES = [
    declaration.key
    for names in INPUTS.values()
    for declaration in names.values()
    if isinstance(declaration, BaseQuantity) and declaration.source
]
"""Inputs that are the size of an error source."""


@cache
def flown(design: Design) -> TrajectoryResult:
    study = specification(design, trajectory="straight", duration=60.0, every=30.0)
    return covariance(covariance_specification(design, study))


def stepped(key: str) -> Design:
    value = MEMS[key]
    assert isinstance(value, float | None)
    low, high = quantity(key).bounds
    new = 1.3 * value if value else min(max(0.5, low), high)
    return MEMS.replace({key: new})


def test_a_figure_that_is_declared_along_a_flight_is_there() -> None:
    for processed in (flown(MEMS).real_time, flown(MEMS).post_processed):
        assert set(IN_FLIGHT) <= processed.figures.keys(), "a figure has `in_flight` and no formula along a flight"
        assert all(np.isfinite(processed.figures[name][1]) for name in IN_FLIGHT)


@pytest.mark.parametrize("key", SOURCES)
def test_what_moves_the_budget_moves_a_straight_flight(key: str) -> None:
    before, after = MEMS, stepped(key)
    budgets, results = [analyse(design) for design in (before, after)], [flown(design) for design in (before, after)]
    moved = False
    for processing in (REAL_TIME, POST_PROCESSED):
        for name in (name for name in IN_FLIGHT if name in OF_BUDGET):
            one, other = (float(budget[name, processing].sigma) for budget in budgets)
            on, to = (
                (result.real_time if processing == REAL_TIME else result.post_processed).figures[name][1]
                for result in results
            )
            expected, along = other**2 - one**2, to**2 - on**2
            # As much of the variance, within what a straight flight may differ by.
            assert along / on**2 == pytest.approx(expected / one**2, rel=0.15, abs=0.004), (name, processing)
        for name in OF_BUDGET:  # those that a flight has, and those of an outage
            one, other = (float(budget[name, processing].sigma) for budget in budgets)
            moved |= abs(other**2 - one**2) > 1e-6 * one**2
    assert moved, "the source is declared and enters no figure"
