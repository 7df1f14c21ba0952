"""A sensor at the end of its range: told by its axis, and never of a log that is only coarse."""

import numpy as np
import pytest

from nav_model.allan.imu_log import ImuLog
from nav_model.allan.motion import BenchNoise, analyse_motion
from nav_model.allan.static_log import analyse_log
from nav_model.allan.warnings import saturated_share
from nav_model.base.errors import InputError


def _noise(seed: int, samples: int = 60_000) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal(samples)


@pytest.mark.parametrize("step", [0.0, 0.02, 0.25])
@pytest.mark.parametrize("limits", [(-np.inf, 1.0), (-1.2, np.inf), (-1.0, 1.5), (-2.5, 2.5)])
def test_the_share_is_what_lies_beyond_the_limits(limits: tuple[float, float], step: float) -> None:
    whole = _noise(1)
    if step:
        whole = np.round(whole / step) * step
    cut = np.clip(whole, *limits)
    at_limits = np.mean((cut == limits[0]) | (cut == limits[1]))
    if step == 0.25 and max(np.abs(limits)[np.isfinite(limits)]) > 2:
        return  # as coarse as that, and so little cut: the level at the limit is no fuller than the next
    assert saturated_share(cut) == pytest.approx(at_limits)


@pytest.mark.parametrize("step", [0.0, 0.001, 0.1, 0.5, 1.0, 2.0, 4.0, 8.0])
@pytest.mark.parametrize("mean", [0.0, 0.3, 0.5, 17.83])
def test_a_coarse_or_a_fine_log_is_not_saturated(step: float, mean: float) -> None:
    for seed in range(20):
        signal = _noise(seed, 20_000) + mean
        assert saturated_share(np.round(signal / step) * step if step else signal) == 0.0


@pytest.mark.parametrize(("count", "start"), [(1.0, 0.0), (1e-6, 10.0), (np.radians(0.1 / 3600.0), 0.0)])
def test_increments_of_a_running_total_in_whole_counts_are_not_saturated(count: float, start: float) -> None:
    """Each total is a rounded product, so that equal increments differ in their last digits."""
    for seed in range(80):
        rng = np.random.default_rng(seed)
        spread, mean = 10.0 ** rng.uniform(-0.3, 1.0), (0.0, 1000.0 * rng.random())[seed % 2]
        total = start + np.floor(np.cumsum(mean + spread * rng.standard_normal(60_000))) * count
        assert saturated_share(np.diff(total)) == 0.0
    clipped = np.clip(np.round(mean + 20.0 * rng.standard_normal(60_000)), mean - 25.0, mean + 25.0)
    result = saturated_share(np.diff(np.cumsum(clipped) * count + start))
    assert result == pytest.approx(np.mean(np.abs(clipped - mean) >= 25.0), rel=1e-3)


def test_the_clipped_axis_is_told_and_the_others_are_analysed() -> None:
    signal = np.stack([_noise(2), np.clip(_noise(3), -0.6, 0.6), _noise(4)], axis=1) * 1e-3
    x, y, z = analyse_log(ImuLog(signal, None, 100.0)).axes
    for axis in (x, z):
        assert axis.coefficients["random_walk"] is not None
        assert not any("saturated" in warning for warning in axis.warnings)
    assert y.coefficients["random_walk"] is None
    assert "a limit of the sensor's range" in y.not_resolved["random_walk"]
    assert "wider range" in y.would_resolve["random_walk"]
    assert y.warnings[0].startswith("saturated: 5")
    with pytest.raises(InputError, match=r"flight.csv: gyro_y is saturated: 5\d\.\d\d% of its samples"):
        analyse_motion(ImuLog(signal, None, 100.0, file_name="flight.csv"), BenchNoise())
