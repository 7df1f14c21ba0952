"""Effective noise in motion."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from nav_model.allan.imu_log import ImuLog
from nav_model.allan.log_content import LogOptions
from nav_model.allan.log_file import read_log
from nav_model.allan.motion import BenchNoise, analyse_motion, motion_to_json, over_bench


def driven(factor: float) -> ImuLog:
    """White noise of 1e-4 rad/√s times `factor` under a slow, strong manoeuvre."""
    time = np.arange(20_000) / 100.0
    noise = np.random.default_rng(4).standard_normal((20_000, 3)) * 1e-3 * factor
    swing = np.stack([np.sin(2 * np.pi * f * time) for f in (0.1, 0.4, 1.0)], axis=1)
    return ImuLog(noise + swing, 10.0 * noise + swing, 100.0)


def test_manoeuvre_is_filtered_out_and_the_factor_recovered():
    """20,000 windowed samples fix the deviation within 0.6 % (1 sigma) per axis."""
    result = analyse_motion(driven(3.0), BenchNoise(1e-4, 1e-3))
    assert result.gyro_factor == pytest.approx(3.0, rel=0.02)
    assert result.accelerometer_factor == pytest.approx(3.0, rel=0.02)
    assert result.vibration_factor == max(result.gyro_factor, result.accelerometer_factor)
    for axis in result.axes:
        assert axis.low < axis.typical < axis.high


def test_without_bench_noise_there_is_no_factor():
    result = analyse_motion(driven(1.0))
    assert result.vibration_factor is None
    assert motion_to_json(result)["axes"][0]["effective"]["unit"] == "°/√h"
    half = analyse_motion(driven(1.0), BenchNoise(velocity_random_walk=1e-3))
    assert half.gyro_factor is None
    assert half.vibration_factor == half.accelerometer_factor
    assert over_bench(half, BenchNoise(1e-4, 1e-3)) == analyse_motion(driven(1.0), BenchNoise(1e-4, 1e-3))


@pytest.mark.parametrize(
    ("bench", "rate", "complaint"),
    [
        (BenchNoise(-1.0), 100.0, "angle_random_walk"),
        (BenchNoise(velocity_random_walk=float("nan")), 100.0, "velocity_random_walk"),
        (None, 39.0, "39 Hz is too slow"),
    ],
)
def test_bad_input_is_refused(bench: BenchNoise | None, rate: float, complaint: str):
    with pytest.raises(ValueError, match=complaint):
        analyse_motion(replace(driven(1.0), rate_hz=rate), bench)


def test_real_increments_are_read(shared_data: Path):
    """The PSINS drive: the first sample's rate of turn and the mean specific force come out in SI."""
    log = read_log(
        shared_data / "moving_psins_fog_mems_100s.npz", LogOptions(gyro_unit="rad", accelerometer_unit="m/s")
    )
    assert np.linalg.norm(log.accelerometer.mean(axis=0)) == pytest.approx(9.8, rel=0.04)
    assert all(axis.effective > 0.0 for axis in analyse_motion(log).axes)
