"""States that the filter of a study estimates unless told otherwise: constant and varying biases apart."""

import math

import numpy as np
import pytest
from entered import entered

from app.examples import example
from nav_model.base.constants import DEGREE_PER_HOUR
from nav_model.design import Design
from nav_model.simulation.design_study import specification
from nav_model.trajectory.covariance import covariance
from nav_model.trajectory.design_study import covariance_specification
from nav_model.trajectory.result import TrajectoryResult

DESIGN = example("mems_x_band")
LONG = 720.0  # s


def flown(turn_on: float, instability: float, time: float, states: int = 0) -> TrajectoryResult:
    """A straight flight with gyro biases [°/h], [s]."""
    texts = {
        "turn_on_bias": f"{turn_on} °/h",
        "bias_instability": f"{instability} °/h",
        "correlation_time": f"{time} s",
    }
    design = entered(DESIGN, {f"gyro.{name}": text for name, text in texts.items()} | {"filter.states": str(states)})
    study = specification(design, trajectory="straight", duration=LONG, every=LONG)
    return covariance(covariance_specification(DESIGN, study))


def tilt_of_a_channel(design: Design, turn_on: float, instability: float, time: float) -> float:
    """Tilt after a fix, 1σ [rad], of a filter of one horizontal channel whose gyro has two biases, by small steps."""
    dt, steps, fixes = design.gnss.interval, 50, 3600
    h, dynamics = dt / steps, np.zeros((5, 5))
    dynamics[0, 1] = dynamics[2, 3] = dynamics[2, 4] = 1.0
    dynamics[1, 2], dynamics[4, 4] = design.flight.gravity, -1 / time
    q = np.zeros((5, 5))
    factor = design.imu.vibration_factor
    q[1, 1] = (design.imu.velocity_random_walk * factor) ** 2
    q[2, 2] = (design.imu.angle_random_walk * factor) ** 2
    q[4, 4] = 2 * instability**2 / time
    step = np.eye(5) + dynamics * h + dynamics @ dynamics * h**2 / 2
    transition, noise = np.eye(5), np.zeros((5, 5))
    for _ in range(steps):
        transition, noise = step @ transition, step @ noise @ step.T + q * h
    p = np.diag([1.0, 1.0, 0.01, turn_on**2, instability**2])
    for _ in range(fixes):
        p = transition @ p @ transition.T + noise
        gain = p[:, 0] / (p[0, 0] + design.gnss.position_noise**2)
        p = p - np.outer(gain, p[0])
        p = 0.5 * (p + p.T)
    return math.sqrt(p[2, 2])


@pytest.mark.parametrize(("turn_on", "instability", "time"), [(2.0, 5.0, 10.0), (1.0, 3.0, 30.0), (4.0, 8.0, 5.0)])
def test_a_constant_and_a_varying_bias_have_a_state_each(turn_on: float, instability: float, time: float) -> None:
    """The heading of a straight leg, which no fix shows, by its closed form, and the tilt by a filter of one channel.

    One state for the sum, a random walk of the same drive, made 12 to 600 % more of the heading.
    """
    result = flown(turn_on, instability, time)
    assert result.spec.study.filter.states == 21
    b, d = turn_on * DEGREE_PER_HOUR, instability * DEGREE_PER_HOUR
    walk = (DESIGN.imu.angle_random_walk * DESIGN.imu.vibration_factor) ** 2 * LONG
    varying = 2 * d**2 * time * (LONG - time * (1 - math.exp(-LONG / time)))
    heading = math.sqrt(math.radians(0.1) ** 2 + walk + (b * LONG) ** 2 + varying)
    assert result.real_time.attitude[-1, 2] == pytest.approx(heading, rel=0.02)
    assert result.real_time.attitude[-1, :2] == pytest.approx(tilt_of_a_channel(DESIGN, b, d, time), rel=0.02)


def test_fifteen_states_stay_a_choice() -> None:
    assert (
        flown(2.0, 5.0, 10.0, states=15).real_time.attitude[-1, 2]
        > 5 * flown(2.0, 5.0, 10.0).real_time.attitude[-1, 2]
    )
