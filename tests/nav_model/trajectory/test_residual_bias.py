"""Residual biases along a flight: the terms of the budget, against a double integral and the budget itself."""

import math
from functools import cache

import numpy as np
import pytest

from app.examples import example
from nav_model.base.constants import DEGREE_PER_HOUR, MILLI_G
from nav_model.budget import analyse
from nav_model.budget.inputs import inputs_of
from nav_model.design import Design
from nav_model.design.processing import POST_PROCESSED
from nav_model.simulation.design_study import specification
from nav_model.trajectory.covariance import covariance
from nav_model.trajectory.design_study import covariance_specification
from nav_model.trajectory.result import TrajectoryResult, beside_budget

MEMS = example("mems_x_band").replace({"processing.leg_after": 60.0})
BIASES = {"imu.accelerometer_bias": MILLI_G, "imu.gyro_bias": 20 * DEGREE_PER_HOUR}


@cache
def flown(design: Design, *outage: float, every: float = 60.0, duration: float = 180.0) -> TrajectoryResult:
    outages = [(outage[0], outage[1])] if outage else ()
    study = specification(design, trajectory="straight", duration=duration, every=every, outages=outages)
    return covariance(covariance_specification(design, study))


def of_bias(name: str, at: int, *outage: float, every: float = 60.0) -> float:
    """Part of the biases in a figure [rad or m], in squares."""
    whole, without = (
        flown(design, *outage, every=every).real_time.figures[name][at] for design in (MEMS.replace(BIASES), MEMS)
    )
    return math.sqrt(whole**2 - without**2)


def test_a_milli_g_is_as_much_phase_on_a_flight_as_in_the_budget() -> None:
    biased = MEMS.replace({"imu.accelerometer_bias": MILLI_G, "radar.autofocus_order": 1})
    along, budget = flown(biased), analyse(biased)
    for name in ("quadratic_phase", "detrended_phase", "tilt"):
        assert along.real_time.figures[name][1] == pytest.approx(budget[name, "real time"].sigma, rel=0.005), name
    assert beside_budget(along.spec) == ()


@pytest.mark.parametrize("outage", [(), (80.0, 180.0)])
def test_it_acts_in_full_from_the_last_fix_on(outage: tuple[float, ...]) -> None:
    """Both biases, integrated twice and thrice, seen from a target that stands still; polynomials fitted."""
    x, at = inputs_of(MEMS), 2
    since = 120.0 - float(x.aperture) / 2 - 80.0 if outage else 0.0
    t, u = since + np.linspace(0.0, float(x.aperture), 20001), np.linspace(-1.0, 1.0, 20001)
    psi, distance = float(x.grazing_angle), float(x.slant_range)
    flown = float(x.speed) * float(x.aperture) / 2 * u
    sight = np.stack([-flown, np.full_like(u, distance * math.cos(psi)), np.full_like(u, distance * math.sin(psi))])
    sight /= np.linalg.norm(sight, axis=0)
    level, jerk = MILLI_G * t**2 / 2, float(x.g) * BIASES["imu.gyro_bias"] * t**3 / 6
    errors = [sight * level, sight[:2] * jerk]  # along, across and down, each by itself
    fits = [np.polynomial.legendre.legfit(u, path, 5) for axes in errors for path in axes]
    quadratic, cubic = (
        float(x.to_phase) * math.hypot(*(np.polynomial.legendre.leg2poly(fit[:4])[order] for fit in fits))
        for order in (2, 3)
    )
    assert of_bias("quadratic_phase", at, *outage) == pytest.approx(quadratic, rel=0.01)
    # After an outage the place is so far off that the third order of the turn, which is left out, shows in the cubic.
    assert of_bias("cubic_phase", at, *outage) == pytest.approx(cubic, rel=0.06 if outage else 0.02)
    mean = math.hypot(*(np.mean(path) for path in (level, math.cos(psi) * jerk)))
    assert of_bias("range_shift", at, *outage) == pytest.approx(mean, rel=0.01)


def test_states_have_it_where_no_fix_comes_and_a_tilt_always() -> None:
    biased, plain = (flown(design, 80.0, 150.0, every=20.0) for design in (MEMS.replace(BIASES), MEMS))
    b, d, g = MILLI_G, BIASES["imu.gyro_bias"], MEMS.flight.gravity
    for at, t in ((3, 0.0), (7, 60.0), (9, 0.0)):  # 60, 140 and 180 s
        parts = [
            np.sqrt(np.maximum(getattr(biased.real_time, name)[at] ** 2 - getattr(plain.real_time, name)[at] ** 2, 0))
            for name in ("position", "velocity", "attitude")
        ]
        place, speed = math.hypot(b * t**2 / 2, g * d * t**3 / 6), math.hypot(b * t, g * d * t**2 / 2)
        assert parts[0] == pytest.approx([place, place, b * t**2 / 2], rel=1e-3, abs=1e-5)
        assert parts[1] == pytest.approx([speed, speed, b * t], rel=1e-3, abs=1e-6)
        assert parts[2][:2] == pytest.approx(math.hypot(b / g, d * t), rel=1e-3)
        # Nothing shows the vertical gyro's part on a straight leg: it turns the heading from the start on.
        assert parts[2][2] == pytest.approx(d * biased.time_s[at], rel=0.01)


def test_a_smoother_takes_it_up_but_for_the_tilt() -> None:
    biased, plain = (flown(MEMS.replace(changes), 80.0, 150.0).post_processed for changes in (BIASES, {}))
    for name, values in plain.figures.items():
        if name not in ("tilt", "heading"):
            assert biased.figures[name] == pytest.approx(values, rel=1e-9, nan_ok=True), name
    post = analyse(MEMS.replace(BIASES | {"processing.mode": POST_PROCESSED}))
    assert flown(MEMS.replace(BIASES)).post_processed.figures["tilt"][1] == pytest.approx(
        post["tilt", POST_PROCESSED].sigma, rel=0.02
    )


def test_shares_name_it_as_the_budget_does() -> None:
    """Vibration's bias beside the sensors' own, each with the square of its size."""
    shaken = {"motion.lines": ((20.0, 9.8, "acceleration"),), "motion.rectification": 1e-4}
    design = MEMS.replace(BIASES | shaken)
    result, budget = flown(design), analyse(design)
    shares = dict(zip(result.sources, result.real_time.shares["quadratic_phase"][:, 1], strict=True))
    expected = budget["quadratic_phase", "real time"].shares
    for source in ("accelerometer bias", "gyro bias", "vibration rectification"):
        assert shares[source] == pytest.approx(expected[source], rel=0.02)
        assert shares[source] > 0.0
