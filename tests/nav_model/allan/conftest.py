"""Shared by the Allan tests: the folder of real logs beside the checkout, and a simulator of known noise."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter

Simulator = Callable[..., np.ndarray]


@pytest.fixture(scope="session")
def shared_data() -> Path:
    folder = Path(__file__).resolve().parents[3].parent / "shared" / "data"
    if not folder.is_dir():
        pytest.skip(f"real data not present at {folder}")
    return folder


def flicker(rng: np.random.Generator, samples: int, interval_s: float) -> np.ndarray:
    """1/f noise of unit B as a sum of Gauss-Markov processes, spaced evenly in log correlation time.

    Each of unit variance contributes 2T/(1 + (wT)²); their integral over d ln T is pi/w, against B²/w wanted.
    """
    times = np.geomspace(interval_s / 5.0, samples * interval_s * 100.0, 3 * int(np.log10(500.0 * samples)))
    total = np.zeros(samples)
    for time in times:
        keep = np.exp(-interval_s / time)
        shocks = rng.standard_normal(samples) * np.sqrt(1.0 - keep**2)
        shocks[0] = rng.standard_normal()
        total += lfilter([1.0], [1.0, -keep], shocks)
    return total * np.sqrt(np.log(times[1] / times[0]) / np.pi)


@pytest.fixture(scope="session")
def simulate() -> Simulator:
    """Rate samples with the given IEEE 952 coefficients, built in time, without any spectrum."""

    def simulated(
        seed: int,
        samples: int,
        interval_s: float,
        quantization: float = 0.0,
        random_walk: float = 0.0,
        bias_instability: float = 0.0,
        rate_random_walk: float = 0.0,
        ramp: float = 0.0,
    ) -> np.ndarray:
        rng = np.random.default_rng(seed)
        signal = rng.standard_normal(samples) * random_walk / np.sqrt(interval_s)
        signal += np.diff(rng.standard_normal(samples + 1)) * quantization / interval_s
        signal += np.cumsum(rng.standard_normal(samples)) * rate_random_walk * np.sqrt(interval_s)
        signal += ramp * np.arange(samples) * interval_s
        if bias_instability:
            signal += bias_instability * flicker(rng, samples, interval_s)
        return signal

    return simulated
