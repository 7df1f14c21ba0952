"""A flight begins settled: with what a long straight leg has made of the errors that its filter does not know."""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest
from entered import entered

from nav_model.budget import analyse
from nav_model.design import Design
from nav_model.design.file import parse_design, read_design
from nav_model.simulation.design_study import specification
from nav_model.trajectory.covariance import covariance
from nav_model.trajectory.design_study import covariance_specification
from nav_model.trajectory.result import TrajectoryResult

INSTALLED = parse_design(
    b"""
[imu]
angle_random_walk = "0.18 \xc2\xb0/\xe2\x88\x9ah"
velocity_random_walk = "0.06 m/s/\xe2\x88\x9ah"
[gnss]
position_noise = "1 cm"
vertical_position_noise = "2 cm"
interval = "0.2 s"
[flight]
speed = "7 m/s"
altitude = "100 m"
latitude = "47\xc2\xb0"
[radar]
frequency = "9.6 GHz"
slant_range = "200 m"
grazing_angle = "35\xc2\xb0"
azimuth_resolution = "0.3 m"
"""
)
"""A small aircraft with fixes of 1 cm."""
MEMS = read_design("examples/mems_x_band.toml")
SLOW = MEMS.replace({"gnss.correlated": True, "gnss.correlated_noise": 0.5, "gnss.correlation_time": 100.0})
ANTENNAS = MEMS.replace({"trajectory.heading_noise": math.radians(0.3)})


def flown(
    design: Design, more: Mapping[str, str] = MappingProxyType({}), states: int = 0, **options: Any
) -> TrajectoryResult:
    design = entered(design, {**more, "filter.states": str(states)})
    flight = {"trajectory": "straight", "duration": 60.0, "every": 1.0, **options}
    return covariance(covariance_specification(design, specification(design, **flight)))


def states(result: TrajectoryResult, index: int) -> np.ndarray:
    """Sigma of position, velocity, roll and pitch in real time."""
    part = result.real_time
    return np.concatenate([part.position[index], part.velocity[index], part.attitude[index, :2]])


def channel(design: Design, *, force: float = 0.0, shift: float = 0.0, time: float = math.inf) -> np.ndarray:
    """Sigma of position, velocity and tilt after the last of many fixes, of a filter of one horizontal channel.

    Its accelerometer has an error `force` [m/s²], or its fixes one of `shift` [m], that the filter ignores: constant,
    or a Gauss-Markov process of a correlation time [s]. Step by step, from no knowledge.
    """
    steps, fixes = 20, 3000
    h = design.gnss.interval / steps
    dynamics, q, driven = np.zeros((4, 4)), np.zeros((4, 4)), np.diag([0.0, 0.0, 0.0, 2 / time])
    dynamics[0, 1], dynamics[1, 2], dynamics[1, 3], dynamics[3, 3] = 1.0, design.flight.gravity, force, -1 / time
    q[1, 1] = (design.imu.velocity_random_walk * design.imu.vibration_factor) ** 2
    q[2, 2] = (design.imu.angle_random_walk * design.imu.vibration_factor) ** 2
    step = np.eye(4) + dynamics * h + dynamics @ dynamics * h**2 / 2 + dynamics @ dynamics @ dynamics * h**3 / 6
    transition, noise, unknown = np.eye(4), np.zeros((4, 4)), np.zeros((4, 4))
    for _ in range(steps):
        transition = step @ transition
        noise = step @ (noise + q * h / 2) @ step.T + q * h / 2
        unknown = step @ (unknown + driven * h / 2) @ step.T + driven * h / 2
    measured, r = np.array([1.0, 0.0, 0.0, -shift]), design.gnss.position_noise**2
    p, true = np.diag([1e6, 100.0, 0.01]), np.diag([1e6, 100.0, 0.01, 1.0])
    for _ in range(fixes):
        p = transition[:3, :3] @ p @ transition[:3, :3].T + noise[:3, :3]
        gain = np.append(p[:, 0] / (p[0, 0] + r), 0.0)
        p = p - np.outer(gain[:3], p[0])
        p = 0.5 * (p + p.T)
        update = np.eye(4) - np.outer(gain, measured)
        true = update @ (transition @ true @ transition.T + noise + unknown) @ update.T + np.outer(gain, gain) * r
    return np.asarray(np.sqrt(np.diag(true)[:3]))


G = MEMS.flight.gravity
UNKNOWN: dict[str, tuple[Design, dict[str, str], int, dict[str, float]]] = {
    "lever arm error": (INSTALLED.replace({"trajectory.lever_arm_error": 0.05}), {}, 9, {"shift": 0.05}),
    "time offset": (INSTALLED.replace({"trajectory.time_offset": 0.01}), {}, 9, {"shift": 0.07}),
    "misalignment": (INSTALLED, {"accelerometer.misalignment": "1 mrad"}, 9, {"force": 1e-3 * G}),
    "misalignment, slow filter": (MEMS, {"accelerometer.misalignment": "0.2 mrad"}, 9, {"force": 0.2e-3 * G}),
    "constant bias": (MEMS, {"accelerometer.turn_on_bias": "1 mg"}, 9, {"force": 1e-3 * 9.80665}),
    "varying bias": (
        MEMS,
        {"accelerometer.bias_instability": "1 mg", "accelerometer.correlation_time": "100 s"},
        9,
        {"force": 1e-3 * 9.80665, "time": 100.0},
    ),
    "varying bias, shorter than a fix interval": (
        MEMS,
        {"accelerometer.bias_instability": "10 mg", "accelerometer.correlation_time": "0.2 s"},
        9,
        {"force": 1e-2 * 9.80665, "time": 0.2},
    ),
    "slow error of the fixes": (SLOW, {}, 9, {"shift": 0.5, "time": 100.0}),
}


@pytest.mark.long
@pytest.mark.parametrize("name", UNKNOWN)
def test_a_flight_begins_as_a_long_leg_ends(name: str) -> None:
    """The first and the last second against another filter, of one channel, step by step from no knowledge."""
    design, more, count, error = UNKNOWN[name]
    result = flown(design, more, states=count)
    along = 0  # north, of a flight to the north
    for index in (0, 1, -1):
        sigma = states(result, index)
        of_channel = np.array([sigma[along], sigma[3 + along], sigma[7]])
        np.testing.assert_allclose(of_channel, channel(design, **error), rtol=0.01)


@pytest.mark.long
@pytest.mark.parametrize(
    ("design", "more", "count"),
    [
        (MEMS, {"accelerometer.scale_factor": "400 ppm", "gyro.scale_factor": "1000 ppm"}, 9),
        (MEMS, {"accelerometer.turn_on_bias": "1 mg", "gyro.turn_on_bias": "5 °/h"}, 9),
        (MEMS, {"gyro.bias_instability": "10 °/h", "gyro.correlation_time": "100 s"}, 9),
        (
            MEMS,
            {
                "accelerometer.turn_on_bias": "1 mg",
                "accelerometer.misalignment": "0.5 mrad",
                "accelerometer.scale_factor": "400 ppm",
            },
            15,
        ),
        (SLOW, {"accelerometer.scale_factor": "400 ppm"}, 12),
        (INSTALLED.replace({"trajectory.lever_arm_error": 0.05, "trajectory.barometer_noise": 1.0}), {}, 9),
    ],
)
def test_twenty_minutes_of_straight_flight_change_nothing(design: Design, more: dict[str, str], count: int) -> None:
    result = flown(design, more, states=count, duration=1200.0, every=300.0)
    for index in range(1, 5):
        np.testing.assert_allclose(states(result, index), states(result, 0), rtol=0.005)


def test_published_figures_of_an_installation() -> None:
    """Own filters: 5 cm of lever arm and 10 ms make 0.0502 and 0.0702 m at once, and no phase."""
    plain = flown(INSTALLED)
    arm = flown(INSTALLED.replace({"trajectory.lever_arm_error": 0.05}))
    late = flown(INSTALLED.replace({"trajectory.time_offset": 0.01}))
    skewed = flown(INSTALLED, {"accelerometer.misalignment": "1 mrad"})
    for index in (0, 1, -1):
        assert states(arm, index)[0] == pytest.approx(0.0502, abs=1e-4)
        assert states(arm, index)[3] == pytest.approx(states(plain, index)[3], rel=1e-3)
        assert states(late, index)[0] == pytest.approx(0.0702, abs=2e-4)
        assert np.degrees(states(skewed, index)[6:]) == pytest.approx(math.hypot(0.0573, 0.0064), rel=5e-3)
    for result in (arm, late, skewed):
        for name in ("quadratic_phase", "detrended_phase"):
            np.testing.assert_allclose(
                result.real_time.figures[name], plain.real_time.figures[name], rtol=2e-3, equal_nan=True
            )


def test_height_begins_with_what_a_scale_factor_makes() -> None:
    """A filter of 9 states holds a height off; one of the design's takes it for a bias, as the budget's."""
    scaled = {"accelerometer.scale_factor": "400 ppm"}
    assert states(flown(MEMS, scaled, states=9), 0)[2] == pytest.approx(3.84, abs=0.01)
    known = analyse(MEMS).steady_state.posterior["vertical_position"]
    assert states(flown(MEMS, scaled), 0)[2] == pytest.approx(known, rel=0.005)


def test_two_antennas_have_settled_too() -> None:
    """White noise r of fixes each dt, and N of the gyro: p² = q (p + r²) before a fix, q = N² dt; 0.1° without."""
    density, dt = MEMS.imu.angle_random_walk * MEMS.imu.vibration_factor, MEMS.gnss.interval
    q, r = density**2 * dt, math.radians(0.3) ** 2
    before = 0.5 * (q + math.sqrt(q**2 + 4 * q * r))
    result = flown(ANTENNAS)
    for index in (0, 1, -1):
        assert result.real_time.attitude[index, 2] == pytest.approx(math.sqrt(before * r / (before + r)), rel=2e-3)
    assert flown(MEMS).real_time.attitude[0, 2] == pytest.approx(math.radians(0.1))


def test_two_antennas_hold_a_rate_of_the_vertical_gyro_from_the_start() -> None:
    """A constant rate d is off by d dt (1 - k)/k after each fix of gain k, of the filter of the test above."""
    rate, density, dt = math.radians(20.0) / 3600, MEMS.imu.angle_random_walk * MEMS.imu.vibration_factor, 1.0
    q, r = density**2 * dt, math.radians(0.3) ** 2
    before = 0.5 * (q + math.sqrt(q**2 + 4 * q * r))
    gain = before / (before + r)
    yaw = flown(ANTENNAS.replace({"imu.gyro_bias": rate})).real_time.attitude[:, 2]
    expected = math.hypot(rate * dt * (1.0 - gain) / gain, math.sqrt(gain * r))
    assert MEMS.gnss.interval == dt
    np.testing.assert_allclose(yaw[[0, 1, -1]], expected, rtol=2e-3)


@pytest.mark.long
def test_tilt_has_settled_too() -> None:
    """Noisy accelerometers' biases: position settles in seconds, the tilt that their noise leaves takes minutes."""
    design = MEMS.replace(
        {
            "gnss.position_noise": 0.066,
            "gnss.interval": 0.1,
            "imu.angle_random_walk": math.radians(0.02855) / 60,
            "imu.velocity_random_walk": 0.00855 / 60,
        }
    )
    more = {"accelerometer.bias_instability": "0.464 mg", "accelerometer.correlation_time": "13.4 s"}
    result = flown(design, more, duration=300.0, every=300.0)
    assert result.spec.study.filter.states == 15
    np.testing.assert_allclose(states(result, 0)[6:], states(result, -1)[6:], rtol=0.01)
