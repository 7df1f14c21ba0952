"""Slow errors of two antennas and of a barometer, which the filter takes for white: by an own filter, and in runs."""

import math
import re

import numpy as np
import pytest
from entered import entered

from nav_model.base.constants import DEGREE
from nav_model.design.file import read_design
from nav_model.simulation.design_study import specification
from nav_model.simulation.schedule import assumed_noise
from nav_model.simulation.single_run import fly
from nav_model.trajectory.covariance import covariance
from nav_model.trajectory.design_study import covariance_specification
from nav_model.trajectory.result import TrajectoryResult
from nav_model.trajectory.trust import too_much_trust

MEMS = read_design("examples/mems_x_band.toml")


def flown(changes: dict[str, float], outages: list[tuple[float, float]], duration: float) -> TrajectoryResult:
    design = MEMS.replace(changes)
    study = specification(design, trajectory="straight", duration=duration, every=60.0, outages=outages)
    return covariance(covariance_specification(design, study))


def heading(white: float, slow: float, time: float) -> float:
    """Sigma [rad] of a heading after a fix, of a filter of the heading alone, step by step from 0.1°."""
    q, dt = (MEMS.imu.angle_random_walk * MEMS.imu.vibration_factor) ** 2, MEMS.gnss.interval
    kept, assumed = math.exp(-dt / time), white**2 + slow**2
    p, true = (0.1 * DEGREE) ** 2, np.diag([(0.1 * DEGREE) ** 2, slow**2])
    for _ in range(5000):
        p, moved = p + q * dt, np.diag([1.0, kept])
        gain = p / (p + assumed)
        p *= 1.0 - gain
        true = moved @ true @ moved + np.diag([q * dt, slow**2 * (1.0 - kept**2)])
        update = np.array([[1.0 - gain, gain], [0.0, 1.0]])
        true = update @ true @ update.T + np.diag([(gain * white) ** 2, 0.0])
    return math.sqrt(true[0, 0])


@pytest.mark.parametrize(("white", "slow", "time", "published"), [
    (0.3, 0.0, 60.0, 0.0273), (1e-4, 0.3, 60.0, 0.174), (0.0, 0.3, 300.0, 0.254), (0.2, 0.1, 60.0, None),
])  # fmt: skip
def test_two_antennas_hold_a_heading_that_is_slowly_off(
    white: float, slow: float, time: float, published: float | None
) -> None:
    changes = {
        "trajectory.heading_slow_noise": slow * DEGREE,
        "trajectory.heading_correlation_time": time,
        **({"trajectory.heading_noise": white * DEGREE} if white else {}),
    }
    expected = heading(white * DEGREE, slow * DEGREE, time)
    if published is not None:
        assert expected == pytest.approx(published * DEGREE, rel=0.003)
    result = flown(changes, [], 900.0)
    yaw = result.real_time.attitude[:, 2]
    assert yaw[-1] == pytest.approx(expected, rel=2e-3)
    # What the filter knows begins as large as it believes.
    np.testing.assert_allclose(yaw, expected, rtol=0.01)
    assert ("slow heading error" in result.sources) == (slow > 0.0)


def heights(white: float, slow: float, time: float, outage: tuple[float, float], duration: float) -> np.ndarray:
    """Sigma [m] of the height after each fix, of a filter of the vertical channel; no position in the outage."""
    dt, unstable = MEMS.gnss.interval, 2.0 * MEMS.flight.gravity / 6.37e6  # gravity decreases with height
    q = (MEMS.imu.velocity_random_walk * MEMS.imu.vibration_factor) ** 2
    step = np.array([[1.0 + unstable * dt**2 / 2, dt, 0.0], [unstable * dt, 1.0 + unstable * dt**2 / 2, 0.0],
                     [0.0, 0.0, math.exp(-dt / time)]])  # fmt: skip
    noise = np.zeros((3, 3))
    noise[:2, :2] = q * np.array([[dt**3 / 3, dt**2 / 2], [dt**2 / 2, dt]])
    process = np.diag([0.0, 0.0, slow**2 * (1.0 - step[2, 2] ** 2)])
    gnss = MEMS.gnss.position_noise**2
    p, true, sigmas = np.diag([1e4, 100.0, 0.0]), np.diag([1e4, 100.0, slow**2]), []
    settling = 4.0 * time
    for k in range(1, int((settling + duration) / dt) + 1):
        p, true = step @ p @ step.T + noise, step @ true @ step.T + noise + process
        at = k * dt - settling
        fixes = [(np.array([1.0, 0.0, -1.0]), white**2 + slow**2, white**2)]
        if not outage[0] < at <= outage[1]:
            fixes.append((np.array([1.0, 0.0, 0.0]), gnss, gnss))
        for row, assumed, real in fixes:
            known = row * [1.0, 1.0, 0.0]
            gain = p @ known / (known @ p @ known + assumed)
            update = np.eye(3) - np.outer(gain, row)
            p = p - np.outer(gain, known @ p)
            true = update @ true @ update.T + np.outer(gain, gain) * real
        sigmas.append(math.sqrt(true[0, 0]))
    return np.array(sigmas[int(settling / dt) - 1 :: int(60 / dt)])


@pytest.mark.long
@pytest.mark.parametrize(("white", "slow", "time"), [(0.0, 3.0, 3600.0), (1.0, 2.0, 900.0)])
def test_a_barometer_holds_a_height_that_is_slowly_off(white: float, slow: float, time: float) -> None:
    """3 m over 1 h: 3.0 m (3.05 as gravity decreases with height) after 20 min without fixes, 3.7 m at most.

    Good gyros: else the horizontal velocity after minutes without fixes enters the height by the Earth's rotation.
    """
    changes = {
        "imu.angle_random_walk": 0.001 * DEGREE / 60.0,
        "trajectory.barometer_slow_noise": slow,
        "trajectory.barometer_correlation_time": time,
        **({"trajectory.barometer_noise": white} if white else {}),
    }
    outage, duration = (90.0, 1790.0), 1800.0
    down = flown(changes, [outage], duration).real_time.position[:, 2]
    expected = heights(white, slow, time, outage, duration)
    np.testing.assert_allclose(down[1:-1], expected[1:-1], rtol=0.01)
    assert down[0] == pytest.approx(expected[0], rel=0.02)
    if time == 3600.0:
        assert down[22] == pytest.approx(3.0, abs=0.06)
        assert down.max() == pytest.approx(3.7, abs=0.05)


def test_the_filter_takes_the_root_of_both_variances_for_white() -> None:
    both = {"trajectory.heading_noise": 0.3e-3, "trajectory.heading_slow_noise": 0.4e-3,
            "trajectory.barometer_noise": 0.6, "trajectory.barometer_slow_noise": 0.8}  # fmt: skip
    white = {"trajectory.heading_noise": 0.5e-3, "trajectory.barometer_noise": 1.0}
    flights = [
        specification(MEMS.replace(changes), trajectory="straight", duration=120.0, every=10.0)
        for changes in (both, white)
    ]
    sigmas = [fly(study, 0).filter_sigma for study in flights]
    np.testing.assert_allclose(sigmas[0], sigmas[1], rtol=1e-5)
    assert assumed_noise(flights[0], np.full((1, 8), np.inf)).tolist() == [[math.inf] * 8]


def sentences(changes: dict[str, float], more: dict[str, str] | None = None, states: int = 0) -> str:
    design = entered(MEMS.replace({**changes, "filter.states": states}), more or {})
    study = specification(design, trajectory="straight", duration=120.0)
    return " ".join(too_much_trust(covariance_specification(design, study)))


def test_an_aid_that_is_taken_for_white_has_its_slow_figure_beside_it() -> None:
    assert sentences({}) == ""
    text = sentences({"trajectory.heading_noise": 0.3 * DEGREE, "trajectory.barometer_noise": 3.0})
    white, slow = heading(0.3 * DEGREE, 0.0, 60.0), heading(0.03 * DEGREE, 0.3 * DEGREE, 60.0)
    assert f"leaves {math.degrees(white):.3g}° of heading" in text
    figure = float(re.findall(r"heading_slow_noise\) that is ([\d.]+)°", text)[0])
    assert figure == pytest.approx(math.degrees(slow), rel=0.01)
    assert "(trajectory.barometer_slow_noise)" in text
    assert "too much" not in text


def test_a_filter_that_trusts_a_sensor_too_much_would_be_better_with_more_noise() -> None:
    """By the own filter of the heading; a slow error far below the white one changes nothing by it."""
    slow, more = 0.3 * DEGREE, math.sqrt(0.44) * 0.3 * DEGREE
    gain = 1.0 - heading(more, slow, 60.0) / heading(0.0, slow, 60.0)
    text = sentences({"trajectory.heading_slow_noise": slow})
    assert "trusts the two antennas too much" in text
    assert float(re.findall(r"heading by ([\d.]+) %", text)[0]) == pytest.approx(100.0 * gain, rel=0.05)
    assert sentences({"trajectory.heading_noise": slow, "trajectory.heading_slow_noise": slow / 30.0}) == ""
    scaled = {"accelerometer.scale_factor": "400 ppm"}
    assert "trusts the accelerometers too much" in sentences({}, scaled, states=9)
    assert "vertical position by" in sentences({}, scaled, states=9)
