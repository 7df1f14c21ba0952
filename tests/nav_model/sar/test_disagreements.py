"""What is said to disagree does: both figures, from outside where there is one."""

import re

import numpy as np
import pytest

from nav_model.sar.axis_model import AxisModel
from nav_model.sar.decomposition import decompose
from nav_model.sar.disagreements import disagreements
from nav_model.sar.fast_engine import simulate_axis


def figures(text):
    return [float(number.replace("−", "-")) for number in re.findall(r"−?\d+\.?\d*(?:e-?\d+)?", text)]


@pytest.fixture(scope="module")
def said():
    return {d.what: d for d in disagreements()}


def test_each_has_both_sides_and_a_reason(said):
    assert len(said) == 7
    for d in said.values():
        assert d.printed != d.ours
        assert all((d.printed, d.source, d.ours, d.holds))


def test_ten_nulls(said):
    ours = [figures(d.ours)[0] for what, d in said.items() if what.startswith("ISLR")]
    assert ours == pytest.approx([-8.908, -6.449], abs=0.002)  # test_impulse_response has them from quadrature


def test_gyro_noise_by_simulation(said):
    """Random walks of tilt, integrated twice, at the printed density."""
    d = next(d for what, d in said.items() if what.startswith("Position error of gyro"))
    random, step = np.random.default_rng(4), 0.02
    tilt = 1e-4 * np.sqrt(step) * np.cumsum(random.standard_normal((4000, 1000)), axis=1)
    position = np.cumsum(np.cumsum(9.80665 * tilt, axis=1), axis=1)[:, -1] * step**2
    assert figures(d.ours)[0] == pytest.approx(position.std(), rel=0.03)
    assert figures(d.ours)[0] / figures(d.printed)[0] == pytest.approx(np.sqrt(21 / 20), abs=0.004)


def test_a_constant_velocity_by_exact_ranges(said):
    d = next(d for what, d in said.items() if what.startswith("A constant velocity"))
    time = np.linspace(-2.7, 2.7, 4001)
    error = np.hypot(6500.0, 90 * time + 0.0655 * time) - np.hypot(6500.0, 90 * time)
    quadratic = np.polynomial.polynomial.polyfit(time / 2.7, error, 2)[2] * 4 * np.pi / 0.0312
    assert figures(d.ours)[0] == pytest.approx(np.degrees(quadratic), abs=0.6)


def test_on_one_axis_the_shrunk_fit_does_not_lose(said):
    d = next(d for what, d in said.items() if what.startswith("Strategy 5w"))
    _, shrunk, _, free = figures(d.ours)
    assert shrunk > 2 * free
    model = AxisModel(0.06 / 60, np.radians(0.15) / 60, 1.0, 1.0)
    result = simulate_axis(model, 5.38, runs=1000, seed=1, rate=30.0)
    rms = [np.mean(decompose(result.of(key)).detrended_rms ** 2) for key in ("5w", "2")]
    assert rms[0] < 1.01 * rms[1]


def test_fixes_by_least_squares(said):
    d = next(d for what, d in said.items() if what.startswith("Quadratic that"))
    for text, fixes in ((d.printed, np.arange(1, 21)), (d.ours, np.arange(21))):
        x = (fixes - fixes.mean()) / 10
        assert figures(text)[0] == pytest.approx(130 * np.linalg.norm(np.linalg.pinv(np.vander(x, 3))[0]), rel=0.005)
