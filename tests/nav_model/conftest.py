"""Designs to test on: the theory page's, a fleet from MEMS to navigation grade, two examples, random ones."""

import math
from importlib.resources import files
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import strategies as st

from nav_model.design import Design
from nav_model.design.figures import FIGURES, REQUIRED
from nav_model.design.file import parse_design, read_design

EXAMPLES = Path(__file__).parents[2] / "examples"


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


def _log(low, high):
    return st.floats(0, 1).map(lambda x: low * (high / low) ** x)


_VIBRATION = tuple((at, density, "acceleration density") for at, density in ((5.0, 0.1), (20.0, 4.0), (2e3, 0.1)))
_PHASE_NOISE = ((0.1, 1e-6, "phase noise"), (10.0, 1e-10, "phase noise"), (1e3, 1e-14, "phase noise"))

_FAST = st.fixed_dictionaries(
    {
        "motion.lines": st.sampled_from([(), ((20.0, 1.0, "acceleration"), (7.0, 1e-4, "length"))]),
        "motion.spectrum": st.sampled_from([(), _VIBRATION]),
        "imu.bandwidth": st.one_of(st.none(), _log(20, 500)),
        "motion.delay": st.one_of(st.just(0.0), _log(1e-5, 5e-3)),
        "motion.unsensed_lines": st.sampled_from([(), ((12.0, 1e-4, "length"),)]),
        "motion.rectification": st.one_of(st.just(0.0), _log(1e-6, 1e-4)),
        "oscillator.phase_noise": st.sampled_from([(), _PHASE_NOISE]),
    }
)


def _designs():
    plain = st.fixed_dictionaries(
        {
            "imu.velocity_random_walk": _log(1e-5, 1e-2),
            "imu.angle_random_walk": _log(3e-7, 2e-3),
            "imu.accelerometer_bias": st.one_of(st.just(0.0), _log(1e-5, 1e-2)),
            "imu.gyro_bias": st.one_of(st.just(0.0), _log(1e-8, 1e-4)),
            "imu.vibration_factor": _log(1, 10),
            "gnss.position_noise": _log(0.005, 10),
            "gnss.vertical_position_noise": st.one_of(st.none(), _log(0.005, 10)),
            "gnss.interval": _log(0.05, 20),
            "gnss.velocity_noise": st.one_of(st.none(), st.none(), _log(0.005, 1)),
            "gnss.vertical_velocity_noise": st.one_of(st.none(), _log(0.005, 1)),
            "processing.scene_height_error": st.one_of(st.just(0.0), _log(0.1, 10)),
            "flight.speed": _log(20, 300),
            "flight.altitude": st.floats(0, 15e3),
            "flight.latitude": st.floats(-1.5, 1.5),
            "flight.heading": st.floats(-3, 3),
            "coast.duration": _log(1, 600),
            "coast.before_aperture": st.one_of(st.just(0.0), _log(0.1, 100)),
            "radar.slant_range": _log(1e3, 3e4),
            "radar.grazing_angle": st.floats(0, 1.5),
            "radar.azimuth_resolution": _log(0.2, 5),
            "radar.window": st.sampled_from(["uniform", "hamming", "taylor"]),
            "radar.aperture_time": st.one_of(st.none(), _log(0.1, 50)),
            "radar.autofocus_order": st.sampled_from([1, 2, 3]),
            "requirements.confidence": st.floats(0.5, 3),
            "requirements.steady_state": st.sampled_from(["prior", "closed", "posterior"]),
            **{f"requirements.{name}": _log(*FIGURES[name].requirement.softbounds) for name in REQUIRED},
        }
    )
    # One in four has vibration or an oscillator: they take longer.
    fast = st.sampled_from([False, False, False, True]).flatmap(lambda given: _FAST if given else st.just({}))
    return st.builds(lambda values, more: Design(values | more), plain, fast)


@pytest.fixture(scope="session")
def designs():
    """Strategy: random designs with every requirement."""
    return _designs()


@pytest.fixture(scope="session")
def open_design():
    """The first screen's design: does not close, gyro noise to blame."""
    return parse_design(files("app").joinpath("examples", "mems_x_band.toml").read_text(encoding="utf-8"))


@pytest.fixture(scope="session")
def closed_design():
    """A design that closes."""
    return read_design(EXAMPLES / "tactical_x_band.toml")
