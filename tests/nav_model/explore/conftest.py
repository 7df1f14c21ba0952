"""Designs to explore, and a strategy of random ones."""

import signal
import subprocess
import sys
from importlib.resources import files
from pathlib import Path

import pytest
from hypothesis import strategies as st

from nav_model.design import Design
from nav_model.design.file import parse_design, read_design

EXAMPLES = Path(__file__).parents[3] / "examples"


def _log(low, high):
    return st.floats(0, 1).map(lambda x: low * (high / low) ** x)


def _designs():
    return st.fixed_dictionaries(
        {
            "imu.velocity_random_walk": _log(1e-5, 1e-2),
            "imu.angle_random_walk": _log(3e-7, 2e-3),
            "imu.accelerometer_bias": st.one_of(st.just(0.0), _log(1e-5, 1e-2)),
            "imu.gyro_bias": st.one_of(st.just(0.0), _log(1e-8, 1e-4)),
            "imu.vibration_factor": _log(1, 10),
            "gnss.position_noise": _log(0.005, 10),
            "gnss.vertical_position_noise": st.one_of(st.none(), _log(0.005, 10)),
            "gnss.interval": _log(0.05, 20),
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
            "requirements.quadratic_phase": _log(0.1, 10),
            "requirements.detrended_phase": _log(0.02, 3),
            "requirements.horizontal_position": _log(0.02, 20),
            "requirements.vertical_position": _log(0.02, 20),
            "requirements.horizontal_velocity": _log(0.001, 1),
            "requirements.vertical_velocity": _log(0.001, 1),
            "requirements.tilt": _log(1e-5, 1e-2),
            "requirements.coast_horizontal_position": _log(0.1, 1e3),
            "requirements.coast_vertical_position": _log(0.1, 1e2),
        }
    ).map(Design)


_KILLED = """
import os, signal, sys, threading, time
from nav_model.explore.sweep import run_sweep
from nav_model.explore.sweep_plan import read_plan

plan, parts = read_plan(sys.argv[1]), int(sys.argv[3])
told = iter(range(plan.parts + 1))

def progress(done, total):
    written = next(told)
    if written == parts:
        threading.Timer(0.005, os.kill, (os.getpid(), signal.SIGKILL)).start()
    if written == plan.parts - 1:
        time.sleep(3600)

run_sweep(plan, sys.argv[2], progress=progress)
"""


@pytest.fixture(scope="session")
def kill_during_sweep():
    """A function that begins a sweep in a process killed (kill -9) among its writing: some milliseconds after so
    many parts are there, and always before the last."""

    def kill(plan_file, out, parts):
        done = subprocess.run([sys.executable, "-c", _KILLED, plan_file, out, str(parts)], check=False)
        assert done.returncode == -signal.SIGKILL

    return kill


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
