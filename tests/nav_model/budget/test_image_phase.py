"""The phase of the image against the covariance of a free INS projected on exact lines of sight."""

import math
from typing import Any

import numpy as np
import pytest

from nav_model import Design, analyse, read_design
from nav_model.budget.figures import figures
from nav_model.budget.inputs import inputs_of
from nav_model.budget.real_time import RealTime

MEMS = read_design("examples/mems_x_band.toml")
NAMES = ("quadratic_phase", "cubic_phase", "detrended_phase")


def axis_covariance(start: np.ndarray, noises: tuple[float, ...], seconds: np.ndarray) -> np.ndarray:
    """Covariance of the position error of an axis at times since the last fix: from the state, impulse by impulse of
    both noises, and from the residual biases."""
    sigma_a, sigma_w, bias, jerk = noises
    step = seconds[-1] / 1500
    moments = (np.arange(1500) + 0.5) * step
    age = np.maximum(seconds[:, None] - moments, 0.0)
    parts = sigma_a * math.sqrt(step) * age, sigma_w * math.sqrt(step) * age**2 / 2
    constant = np.stack([bias * seconds**2 / 2, jerk * seconds**3 / 6], axis=1)
    states = np.stack([np.ones_like(seconds), seconds, seconds**2 / 2], axis=1)
    return states @ start @ states.T + sum(part @ part.T for part in (*parts, constant))


def exact(design: Design) -> dict[str, float]:
    """Quadratic, cubic and what autofocus leaves [rad], along exact unit vectors to the target."""
    x = inputs_of(design)
    start, g = RealTime(x).at_last_fix, float(x.g)
    h, v = start.horizontal, start.vertical
    level = np.array([[h.p11, h.p12, g * h.p13], [h.p12, h.p22, g * h.p23], [g * h.p13, g * h.p23, g**2 * h.p33]])
    upright = np.array([[v.v11, v.v12, 0.0], [v.v12, v.v22, 0.0], [0.0, 0.0, 0.0]])
    u, weights = np.polynomial.legendre.leggauss(40)
    span, sigma_a, bias = float(x.aperture), float(x.sigma_a), float(x.bias)
    seconds = (u + 1) / 2 * span + float(x.before_aperture)
    sideways = axis_covariance(level, (sigma_a, g * float(x.sigma_w), bias, g * float(x.bias_w)), seconds)
    downwards = axis_covariance(upright, (sigma_a, 0.0, bias, 0.0), seconds)
    s, d = math.sin(x.squint), math.sin(x.grazing_angle)
    target = float(x.slant_range) * np.array([s, math.sqrt(1 - s**2 - d**2), d])
    sight = target - np.outer(u * span / 2 * float(x.speed), [1.0, 0.0, 0.0])
    sight /= np.linalg.norm(sight, axis=1)[:, None]
    along = sum(np.outer(sight[:, k], sight[:, k]) * part for k, part in enumerate((sideways, sideways, downwards)))
    coefficients = (np.polynomial.legendre.legvander(u, 3) * weights[:, None]).T * (np.arange(4)[:, None] + 0.5)
    variances = np.einsum("ki,ij,kj->k", coefficients, along, coefficients)
    removed = sum(variances[n] / (2 * n + 1) for n in range(x.autofocus_order + 1))
    squares = 9 / 4 * variances[2], 25 / 4 * variances[3], weights @ np.diag(along) / 2 - removed
    return dict(zip(NAMES, (float(x.to_phase) * math.sqrt(square) for square in squares), strict=True))


@pytest.mark.parametrize(
    ("changes", "printed"),
    [
        ({"flight.speed": 180.0}, (56.9, 11.1, 17.1)),
        ({"flight.speed": 180.0, "radar.squint_angle": math.radians(40)}, (74.9, None, None)),
        ({"flight.speed": 180.0, "radar.squint_angle": math.radians(-40)}, (None, None, None)),
        ({"flight.speed": 150.0}, (75.7, None, None)),
        ({}, (None, None, 54.6)),
        ({"radar.autofocus_order": 2}, (None, None, None)),
        ({"radar.autofocus_order": 3}, (None, None, None)),
        ({"coast.before_aperture": 4.0, "imu.gyro_bias": 2e-6, "imu.accelerometer_bias": 3e-4}, (None, None, None)),
        ({"radar.squint_angle": 0.5, "radar.grazing_angle": 0.9, "gnss.vertical_position_noise": 4.0}, (None,) * 3),
    ],
)
def test_errors_across_and_along_the_track_make_one_phase(
    changes: dict[str, Any], printed: tuple[float | None, ...]
) -> None:
    budget = analyse(MEMS.replace(changes))
    for name, theirs in exact(budget.design).items():
        assert budget[name, "real time"].sigma == pytest.approx(theirs, rel=0.01), name
    for name, degrees in zip(NAMES, printed, strict=True):
        if degrees is not None:
            assert math.degrees(budget[name, "real time"].sigma) == pytest.approx(degrees, abs=0.11), name


def test_both_parts_within_a_limit_do_not_meet_it_together() -> None:
    budget = analyse(MEMS.replace({"flight.speed": 180.0, "requirements.quadratic_phase": math.radians(45)}))
    parts = [budget[f"{part}_quadratic_phase", "real time"] for part in ("line_of_sight", "along_track")]
    assert [math.degrees(part.sigma) for part in parts] == pytest.approx([41.4, 41.3], abs=0.05)
    check = budget.verdict.checks[0]
    assert check.name == "quadratic_phase"
    assert not check.met
    assert "along_track_quadratic_phase" not in [each.name for each in budget.verdict.checks]


@pytest.mark.parametrize("mode", ["real time", "post-processed"])
@pytest.mark.parametrize("order", [1, 2, 3])
def test_a_phase_is_one_value_for_a_design_and_for_arrays(mode: str, order: int) -> None:
    design = MEMS.replace({"processing.mode": mode, "radar.autofocus_order": order, "radar.squint_angle": 0.3})
    names = [f"{part}{name}" for part in ("", "line_of_sight_", "along_track_") for name in NAMES]
    arrays = figures(inputs_of(design, {"flight.speed": np.array([90.0, 140.0])}), names)
    for place, speed in enumerate((90.0, 140.0)):
        budget = analyse(design.replace({"flight.speed": speed}))
        for name in names:
            assert arrays[name][place] == pytest.approx(budget[name, mode].sigma, rel=1e-9), name
            assert math.fsum(budget[name, mode].shares.values()) == pytest.approx(1, abs=1e-9), name


def test_without_a_turn_the_image_has_the_phase_along_the_line_of_sight() -> None:
    far = analyse(MEMS.replace({"radar.slant_range": 2e6, "radar.aperture_time": 5.0, "radar.squint_angle": 0.2}))
    for name in NAMES:
        for mode in ("real time", "post-processed"):
            assert far[name, mode].sigma == pytest.approx(far[f"line_of_sight_{name}", mode].sigma, rel=1e-3)
