"""Logs from behind a low pass inside the sensor: named where it is not declared, without harm where it is."""

import math

import numpy as np
import pytest
from scipy.signal import butter, lfilter

from nav_model.allan.imu_log import ImuLog
from nav_model.allan.result import AxisNoise
from nav_model.allan.static_log import analyse_log

pytestmark = pytest.mark.long

WALK = math.radians(0.3) / 60.0


def axes(seed: int, rate: float, corner: float, order: int, bandwidth: float | None) -> tuple[AxisNoise, ...]:
    """Ten minutes of white noise behind a Butterworth low pass that runs at five times the rate of the log."""
    noise = np.random.default_rng(seed).standard_normal((round(600.0 * rate * 5), 3)) * WALK * math.sqrt(5.0 * rate)
    filtered = lfilter(*butter(order, corner, fs=5.0 * rate), noise, axis=0)[::5]
    return analyse_log(ImuLog(filtered, None, rate), bandwidth_hz=bandwidth).axes


@pytest.mark.parametrize(("rate", "corner"), [(100.0, 10.0), (200.0, 20.0)])
@pytest.mark.parametrize("order", [1, 2])
def test_a_declared_low_pass_leaves_the_random_walk(rate: float, corner: float, order: int):
    """A walk from n coefficients scatters by 1/√(2n); of intervals of 95 %, all three miss once in 8,000 tests."""
    inside = 0
    for axis in axes(order, rate, corner, order, corner):
        walk = axis.coefficients["random_walk"]
        assert walk is not None
        assert not walk.reading
        coefficients = 600.0 * 2.0 * corner / 10.0
        assert walk.value == pytest.approx(WALK, rel=4.0 / math.sqrt(2.0 * coefficients))
        assert walk.high / walk.low < 1.0 + 8.0 / math.sqrt(2.0 * coefficients)
        assert axis.band_hz == corner / 10.0
        assert axis.coefficients["quantization"] is None
        inside += walk.low <= WALK <= walk.high
    assert inside >= 1


@pytest.mark.parametrize(("rate", "corner", "order"), [(100.0, 10.0, 1), (200.0, 20.0, 2)])
def test_a_low_pass_that_is_not_declared_is_named(rate: float, corner: float, order: int):
    for axis in axes(order, rate, corner, order, None):
        (caution,) = [line for line in axis.warnings if "as behind a low pass; give the bandwidth" in line]
        assert corner == pytest.approx(float(caution.split("beyond ")[1].split(" Hz")[0]), rel=0.4)
        assert not any("departs from the fit" in line for line in axis.warnings)


def test_slow_noise_and_quantization_are_no_low_pass(simulate):
    for terms in ({"bias_instability": 3e-3}, {"rate_random_walk": 5e-3}, {"quantization": 1e-3}):
        signal = simulate(3, 30_000, 0.02, random_walk=1e-3, **terms)[:, None]
        signal = signal + 1e-2 * np.sin(2.0 * np.pi * 7.0 * 0.02 * np.arange(len(signal)))[:, None]
        (axis,) = analyse_log(ImuLog(signal, None, 50.0)).axes
        assert axis.lines_hz  # so that the log is not clean
        assert not any("low pass" in line for line in axis.warnings)
