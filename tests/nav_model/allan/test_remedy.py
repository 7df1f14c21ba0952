"""The scaling law for the log that would resolve a hidden coefficient, compared with simulated logs."""

import re
from collections.abc import Callable

import numpy as np
import pytest

from nav_model.allan.imu_log import ImuLog
from nav_model.allan.remedy import what_would_resolve
from nav_model.allan.static_log import analyse_log

pytestmark = pytest.mark.long

SAMPLES = 2048
LOGS = 8


def bounds(term: str, samples: int, rate_hz: float, seed: int, logs: int = LOGS) -> float:
    """Median upper bound on `term` over logs of white noise of one density (1e-3 rad/s at 10 Hz)."""
    result = []
    for log in range(logs):
        noise = np.random.default_rng([seed, log]).standard_normal((samples, 3)) * 1e-3 * np.sqrt(rate_hz / 10.0)
        for axis in analyse_log(ImuLog(noise, None, rate_hz)).axes:
            match = re.search(r"at most (\S+) ", axis.not_resolved.get(term, ""))
            if match:
                result.append(float(match[1]))
    assert len(result) > 2 * logs
    return float(np.median(result))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("term", "factor"), [("bias_instability", 4.0), ("rate_random_walk", 2.0), ("ramp", 2.0 ** (2.0 / 3.0))]
)
def test_the_longer_log_halves_the_bound(term: str, factor: float):
    """Medians of 24 axes scatter by about 10 %; a law wrong by half a power would give 0.35 or 0.71."""
    duration = SAMPLES / 10.0
    assert f"{duration * factor / 60.0:.0f} min" in what_would_resolve("hidden", term, ["random_walk"], duration, 0.1)
    longer = bounds(term, int(SAMPLES * factor), 10.0, seed=2)
    assert longer / bounds(term, SAMPLES, 10.0, seed=1) == pytest.approx(0.5, rel=0.25)


@pytest.mark.slow
def test_the_faster_log_halves_the_bound_on_quantization():
    factor = 2.0 ** (4.0 / 3.0)
    assert "25.2 Hz" in what_would_resolve("hidden", "quantization", ["random_walk"], 100.0, 0.1)
    faster = bounds("quantization", int(SAMPLES * factor), 10.0 * factor, seed=4, logs=4)
    assert faster / bounds("quantization", SAMPLES, 10.0, seed=3, logs=4) == pytest.approx(0.5, rel=0.25)


def test_a_slower_noise_is_not_beaten_by_length():
    advice = what_would_resolve("hidden", "bias_instability", ["random_walk", "rate_random_walk"], 3600.0, 0.01)
    assert "less rate random walk" in advice
    assert "4 h" in what_would_resolve("hidden", "ramp", ["rate_random_walk"], 3600.0, 0.01)


def test_every_unresolved_coefficient_has_its_remedy(simulate: Callable[..., np.ndarray]):
    signal = np.stack([simulate(seed, 20_000, 0.01, random_walk=1e-4) for seed in range(3)], axis=1)
    signal[:, 1] = 0.25
    axes = analyse_log(ImuLog(signal, None, 100.0)).axes
    for axis in axes:
        assert set(axis.would_resolve) == set(axis.not_resolved)
        assert all(axis.would_resolve.values())
    assert "connected" in axes[1].would_resolve["ramp"]
