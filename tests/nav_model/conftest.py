"""Designs to test on: the one the theory page works through, and a fleet from MEMS to navigation grade."""

import math
from types import SimpleNamespace

import numpy as np
import pytest


@pytest.fixture(scope="session")
def worked():
    """Section 2 of the theory page: 0.05 m/s/√h, 0.5 °/√h, 1 m at 1 Hz, standard gravity; SI."""
    return SimpleNamespace(
        sigma_a=0.05 / 60, sigma_w=math.radians(0.5) / 60, sigma=1.0, interval=1.0, s=1.0, g=9.80665
    )


@pytest.fixture(scope="session")
def fleet():
    """240 random designs: VRW 0.002 to 0.3 m/s/√h, ARW 0.001 to 1 °/√h, 1 cm to 5 m every 0.1 to 10 s."""
    rng = np.random.default_rng(20191)
    n = 240

    def log_uniform(low, high):
        return np.exp(rng.uniform(math.log(low), math.log(high), n))

    sigma, interval = log_uniform(0.01, 5.0), log_uniform(0.1, 10.0)
    return SimpleNamespace(
        size=n,
        sigma_a=log_uniform(0.002, 0.3) / 60,
        sigma_w=np.radians(log_uniform(0.001, 1.0)) / 60,
        sigma=sigma,
        sigma_vertical=sigma * log_uniform(0.7, 3.0),
        interval=interval,
        s=sigma * np.sqrt(interval),
        g=rng.uniform(9.78, 9.84, n),
    )
