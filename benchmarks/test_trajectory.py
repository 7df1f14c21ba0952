"""The covariance along a flight: processor seconds on one core after compilation, and memory; no limit fails."""

import time
import tracemalloc
from pathlib import Path

import pytest

from nav_model.design.file import parse_design
from nav_model.simulation.design_study import specification
from nav_model.trajectory.covariance import covariance
from nav_model.trajectory.design_study import covariance_specification, planned
from nav_model.trajectory.specification import CovarianceSpec

RICH = {
    "gyro.bias_instability": "20 °/h",
    "gyro.correlation_time": "100 s",
    "gyro.rate_random_walk": "1 °/h/√h",
    "gyro.scale_factor": "1000 ppm",
    "gyro.misalignment": "0.5 mrad",
    "accelerometer.bias_instability": "0.3 mg",
    "accelerometer.correlation_time": "100 s",
    "accelerometer.scale_factor": "1000 ppm",
    "accelerometer.misalignment": "0.5 mrad",
    "gnss.velocity_noise": "3 cm/s",
    "gnss.lever_forward": "2 m",
}
AIDED = [
    "gnss.interval=1 s",
    "imu.gyro_bias=5 °/h",
    "imu.accelerometer_bias=0.1 mg",
    "trajectory.barometer_noise=2 m",
]
AIDED += ["trajectory.heading_noise=0.1°", "trajectory.lever_arm_error=10 cm", "trajectory.time_offset=2 ms"]


def an_hour(name: str) -> CovarianceSpec:
    """21 states and 20 sources, fixes at 1 Hz."""
    rich = [f"{key}={text}" for key, text in RICH.items()]
    design = parse_design(Path(f"examples/{name}.toml").read_bytes(), changes=[*AIDED, *rich, "filter.states=21"])
    study = specification(design, trajectory="turns", duration=3600.0)
    return covariance_specification(design, study)


@pytest.mark.parametrize("name", ["mems_x_band", "tactical_x_band"])
def test_an_hour_with_twenty_sources(benchmark, name):
    """Limits 3 s and 300 MB beside the loaded program."""
    spec = an_hour(name)
    assert len(covariance(spec).sources) == 20
    began = time.process_time()
    benchmark.pedantic(lambda: covariance(spec), rounds=2)
    benchmark.extra_info["processor_s"] = (time.process_time() - began) / 2
    tracemalloc.start()
    covariance(spec)
    benchmark.extra_info["most_mb"] = tracemalloc.get_traced_memory()[1] / 1e6
    tracemalloc.stop()


def test_ten_minutes_of_a_plan_follow_a_slider(benchmark):
    """Limit 0.3 s."""
    changes = ["trajectory.flight=lines", "trajectory.length=6 km", "trajectory.lines=3", "gnss.interval=1 s"]
    design = parse_design(Path("examples/mems_x_band.toml").read_bytes(), changes=changes)
    flight = planned(design)
    study = specification(design, trajectory=flight.trajectory, duration=flight.duration)
    spec = covariance_specification(design, study, flight.lines)
    covariance(spec)
    began = time.process_time()
    benchmark.pedantic(lambda: covariance(spec), rounds=5)
    benchmark.extra_info["processor_s"] = (time.process_time() - began) / 5
    benchmark.extra_info["flight_s"] = flight.duration
