"""A constant residual bias in the settled filter and in the outage, against a filter that estimates it."""

import math

import numpy as np
import pytest

from app.examples import example
from nav_model import Design, analyse
from nav_model.base.constants import STANDARD_GRAVITY

MILLI_G = 1e-3 * STANDARD_GRAVITY
DESIGN = example("mems_x_band").replace(
    {
        "imu.accelerometer_bias": 0.5 * MILLI_G,
        "requirements.steady_state": "posterior",
        "requirements.tilt": 1e-3,
        "requirements.vertical_position": 1.0,
        "requirements.horizontal_velocity": 1.0,
        "requirements.vertical_velocity": 1.0,
    }
)


def settled_with_bias(design: Design) -> float:
    """Tilt after a fix, 1σ [rad], of a filter of one channel with its bias as a fourth state, after an hour."""
    g, dt = design.flight.gravity, design.gnss.interval
    noises = np.diag([0.0, design.imu.velocity_random_walk**2, design.imu.angle_random_walk**2, 0.0])
    noises *= design.imu.vibration_factor**2
    dynamics = np.zeros((4, 4))
    dynamics[0, 1], dynamics[1, 2], dynamics[1, 3] = 1.0, g, 1.0
    # Van Loan 1978: the noise of a step from an exponential, here its series, which ends.
    whole = np.block([[-dynamics, noises], [np.zeros((4, 4)), dynamics.T]]) * dt
    exponential = sum(np.linalg.matrix_power(whole, n) / math.factorial(n) for n in range(12))
    transition = exponential[4:, 4:].T
    noise = transition @ exponential[:4, 4:]
    p = np.diag([1.0, 1.0, 0.01, design.imu.accelerometer_bias**2]) + 0.0
    for _ in range(round(3600 / dt)):
        p = transition @ p @ transition.T + noise
        gain = p[:, 0] / (p[0, 0] + design.gnss.position_noise**2)
        p = p - np.outer(gain, p[0])
        p = 0.5 * (p + p.T)
    return math.sqrt(p[2, 2])


def test_the_tilt_is_that_of_a_filter_that_has_estimated_what_it_can():
    tilt = check_of(DESIGN, "tilt")
    assert tilt.sigma == pytest.approx(settled_with_bias(DESIGN), rel=1e-3)
    assert tilt.sigma == pytest.approx(0.000548, rel=1e-3)
    assert check_of(DESIGN.replace({"imu.accelerometer_bias": 0.0}), "tilt").sigma == pytest.approx(
        0.000223, rel=2e-3
    )
    assert tilt.shares["accelerometer bias"] == pytest.approx(
        (0.5e-3 * STANDARD_GRAVITY / 9.80665 / 0.000548) ** 2, rel=0.01
    )


def test_a_smoother_sees_no_more_of_it():
    design = DESIGN.replace({"processing.mode": "post-processed"})
    without = check_of(design.replace({"imu.accelerometer_bias": 0.0}), "tilt").sigma
    tilt = 0.5 * MILLI_G / design.flight.gravity
    assert check_of(design, "tilt").sigma == pytest.approx(math.hypot(without, tilt), rel=1e-9)


def test_what_the_filter_has_estimated_costs_nothing_in_steady_state():
    biased = DESIGN.replace({"imu.gyro_bias": 1e-5})
    for name in ("horizontal_position", "vertical_position", "horizontal_velocity", "vertical_velocity"):
        without = check_of(DESIGN.replace({"imu.accelerometer_bias": 0.0}), name).sigma
        assert check_of(biased, name).sigma == pytest.approx(without, rel=1e-12)


def check_of(design: Design, name: str):
    return next(check for check in analyse(design).verdict.checks if check.name == name)
