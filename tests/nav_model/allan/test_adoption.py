"""A log's figures in a design: what changes, and what the design says of it afterwards."""

import numpy as np
import pytest

from nav_model.allan.adoption import (
    adopt_noise,
    adopt_vibration_factor,
    bench_of,
)
from nav_model.allan.imu_log import ImuLog
from nav_model.allan.motion import analyse_motion
from nav_model.allan.result import READING_INTERVAL, to_json, triad_coefficient
from nav_model.allan.static_log import analyse_log
from nav_model.design import Design

pytestmark = pytest.mark.long

ARW, VRW = "imu.angle_random_walk", "imu.velocity_random_walk"
WALKS = {"gyro": 1e-4, "accelerometer": 1e-3}


def noise(seed: int, walk: float, samples: int = 20_000) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal((samples, 3)) * walk * 10.0


def test_random_walks_go_into_the_design_with_their_origin():
    design = Design({"description": "survey pod"})
    gyro, force = noise(1, WALKS["gyro"]), noise(2, WALKS["accelerometer"]) + np.array([0.0, 0.0, 9.8])
    log = ImuLog(gyro, force, 100.0, file_name="bench 7.csv", sha256="ab" * 32)
    adoption = adopt_noise(analyse_log(log))
    adopted = design.replace(adoption.changes, adoption.written, adoption.origins)
    # 60,000 samples fix each triad within 0.3 % (1 sigma).
    assert adopted.imu.angle_random_walk == pytest.approx(1e-4, rel=0.015)
    assert adopted.imu.velocity_random_walk == pytest.approx(1e-3, rel=0.015)
    assert adopted.description == "survey pod"
    assert set(adopted.origins) == {ARW, VRW}
    for origin in adopted.origins.values():
        for part in ("rms of", "bench 7.csv", "sha256 abababab", "100 Hz", "200 s", "95 % confidence"):
            assert part in origin
    again = adopted.replace(adoption.changes, adoption.written, adoption.origins)
    assert (again, again.origins) == (adopted, adopted.origins)


def test_a_hostile_file_name_stays_one_line():
    log = ImuLog(noise(1, 1e-4), None, 100.0, file_name="a\nimu.gyro_bias = 0 °/h: b" + "x" * 500)
    adoption = adopt_noise(analyse_log(log))
    assert set(Design().replace(adoption.changes, origins=adoption.origins).origins) == {ARW}
    assert len(adoption.origins[ARW]) < 400


def test_an_unresolved_triad_changes_nothing():
    gyro = noise(3, 1e-4)
    gyro[:, 1] = 0.25
    assert adopt_noise(analyse_log(ImuLog(gyro, None, 100.0))).changes == {}


def test_a_reading_at_one_second_is_said_to_be_one():
    """A line at 0.6 Hz, as the ADIS16405's accelerometers have: left out of the fit, within the reading."""
    line = 2e-4 * np.sin(2 * np.pi * 0.6 * np.arange(50_000) / 100.0)
    analysis = analyse_log(ImuLog(noise(4, 1e-4, 50_000) + line[:, None], None, 100.0))
    walks = [axis.coefficients["random_walk"] for axis in analysis.axes]
    assert all(walk is not None and walk.reading and walk.value > 1.05e-4 for walk in walks)
    assert all(axis["random_walk"]["interval"] == READING_INTERVAL for axis in to_json(analysis)["axes"])
    triad = triad_coefficient(analysis, "gyro")
    assert triad.reading
    note = adopt_noise(analysis).origins[ARW]
    assert "read at 1 s, above the white-noise floor, on gyro x, gyro y, gyro z" in note
    assert "not a confidence interval" in note
    assert "95 %" not in note


def test_vibration_factor_is_offered_over_the_random_walks_of_the_design_that_takes_it():
    design = Design({ARW: 1e-4, VRW: 1e-3})
    log = ImuLog(noise(5, 3e-4), noise(6, 2e-3), 100.0, file_name="flight.csv", sha256="cd" * 32)
    result = analyse_motion(log, bench_of(design))
    adoption = adopt_vibration_factor(design, result)
    adopted = design.replace(adoption.changes, adoption.written, adoption.origins)
    # Known factors 3 and 2; the larger is offered, good to 1 %.
    assert adopted.imu.vibration_factor == pytest.approx(3.0, rel=0.03)
    assert "as white noise" in adopted.origins["imu.vibration_factor"]
    quieter = adopt_vibration_factor(design.replace({ARW: 0.5e-4}), result)
    assert quieter.changes["imu.vibration_factor"] == pytest.approx(6.0, rel=0.03)


def test_drifts_of_a_log_go_into_the_design_as_biases_that_vary(simulate):
    """Flicker noise with the sigma of a Gauss-Markov process; their Allan deviations agree about their floor."""
    truth = {"random_walk": 1e-4, "bias_instability": 1e-4}
    axes = np.stack([simulate(axis, 65_536, 0.1, **truth) for axis in range(3)], axis=1)
    adoption = adopt_noise(analyse_log(ImuLog(axes, None, 10.0, file_name="bench.csv")))
    design = Design().replace(adoption.changes, adoption.written, adoption.origins)
    assert design.imu.angle_random_walk == pytest.approx(1e-4, rel=0.02)
    assert design.gyro.bias_instability == pytest.approx(1e-4, rel=0.2)
    assert set(design.origins) == {ARW, "gyro.bias_instability", "gyro.correlation_time"}
    assert "bench.csv" in design.origins["gyro.correlation_time"]
    # Allan variance of a Gauss-Markov process beside that of the white noise, by its closed form.
    sigma, time = design.gyro.bias_instability, design.gyro.correlation_time
    tau = np.geomspace(0.5, 4.0, 9) * 1.89 * time
    x = tau / time
    markov = 2 * sigma**2 / x**2 * (x - (3 - 4 * np.exp(-x) + np.exp(-2 * x)) / 2)
    flicker = 2 * np.log(2) / np.pi * truth["bias_instability"] ** 2
    np.testing.assert_allclose(np.sqrt(markov), np.sqrt(flicker), rtol=0.35)
    assert np.sqrt(markov[3]) == pytest.approx(np.sqrt(flicker), rel=0.25)
