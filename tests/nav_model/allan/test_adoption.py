"""A log's figures in a design: what changes, what the design says of it afterwards, and for how long."""

import numpy as np
import pytest

from nav_model.allan.adoption import (
    adopt_random_walks,
    adopt_vibration_factor,
    bench_of,
    noted_origin,
)
from nav_model.allan.imu_log import ImuLog
from nav_model.allan.motion import BenchNoise, analyse_motion
from nav_model.allan.result import READING_INTERVAL, LogAnalysis, to_json, triad_random_walk
from nav_model.allan.static_log import analyse_log
from nav_model.design import Design
from nav_model.design.file import format_design, parse_design

ARW, VRW = "imu.angle_random_walk", "imu.velocity_random_walk"
WALKS = {"gyro": 1e-4, "accelerometer": 1e-3}


def noise(seed: int, walk: float, samples: int = 20_000) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal((samples, 3)) * walk * 10.0


@pytest.fixture(scope="module")
def analysis() -> LogAnalysis:
    gyro, force = noise(1, WALKS["gyro"]), noise(2, WALKS["accelerometer"]) + np.array([0.0, 0.0, 9.8])
    return analyse_log(ImuLog(gyro, force, 100.0, file_name="bench 7.csv", sha256="ab" * 32))


def test_random_walks_go_into_the_design_with_their_origin(analysis: LogAnalysis):
    design = Design({"description": "survey pod"})
    adoption = adopt_random_walks(design, analysis)
    adopted = design.replace(adoption.changes, adoption.written)
    # 60,000 samples fix each triad within 0.3 % (1 sigma).
    assert adopted.imu.angle_random_walk == pytest.approx(1e-4, rel=0.015)
    assert adopted.imu.velocity_random_walk == pytest.approx(1e-3, rel=0.015)
    assert adopted.description.startswith("survey pod\n")
    for key in (ARW, VRW):
        origin = noted_origin(adopted, key)
        assert origin is not None
        for part in ("rms of", "bench 7.csv", "sha256 abababab", "100 Hz", "200 s", "95 % confidence"):
            assert part in origin
    # The note travels with the file and still vouches for the value read back.
    assert noted_origin(parse_design(format_design(adopted)), ARW) == noted_origin(adopted, ARW)


def test_a_note_vouches_only_for_the_value_it_quotes(analysis: LogAnalysis):
    design = Design()
    adoption = adopt_random_walks(design, analysis)
    adopted = design.replace(adoption.changes, adoption.written)
    assert noted_origin(adopted.replace({ARW: 2e-4}), ARW) is None
    assert noted_origin(adopted.replace({ARW: 2e-4}), VRW) is not None
    again = adopt_random_walks(adopted, analysis)
    assert adopted.replace(again.changes, again.written) == adopted


def test_a_hostile_file_name_stays_one_line(analysis: LogAnalysis):
    log = ImuLog(noise(1, 1e-4), None, 100.0, file_name="a\nimu.gyro_bias = 0 °/h: b" + "x" * 500)
    description = str(adopt_random_walks(Design(), analyse_log(log)).changes["description"])
    assert len(description.splitlines()) == 1
    assert len(description) < 400


def test_an_unresolved_triad_changes_nothing():
    gyro = noise(3, 1e-4)
    gyro[:, 1] = 0.25
    assert adopt_random_walks(Design(), analyse_log(ImuLog(gyro, None, 100.0))).changes == {}


def test_a_reading_at_one_second_is_said_to_be_one():
    """A line at 0.6 Hz, as the ADIS16405's accelerometers have: left out of the fit, within the reading."""
    line = 2e-4 * np.sin(2 * np.pi * 0.6 * np.arange(50_000) / 100.0)
    analysis = analyse_log(ImuLog(noise(4, 1e-4, 50_000) + line[:, None], None, 100.0))
    walks = [axis.coefficients["random_walk"] for axis in analysis.axes]
    assert all(walk is not None and walk.reading and walk.value > 1.05e-4 for walk in walks)
    assert all(axis["random_walk"]["interval"] == READING_INTERVAL for axis in to_json(analysis)["axes"])
    triad = triad_random_walk(analysis, "gyro")
    assert triad is not None
    assert triad.reading
    note = str(adopt_random_walks(Design(), analysis).changes["description"])
    assert "effective reading at 1 s, not the white floor, on gyro_x, gyro_y, gyro_z" in note
    assert "not a confidence interval" in note
    assert "95 %" not in note


def test_vibration_factor_is_offered_over_the_bench_it_was_measured_against():
    design = Design({ARW: 1e-4, VRW: 1e-3})
    log = ImuLog(noise(5, 3e-4), noise(6, 2e-3), 100.0, file_name="flight.csv", sha256="cd" * 32)
    result = analyse_motion(log, bench_of(design))
    adoption = adopt_vibration_factor(design, result, bench_of(design))
    adopted = design.replace(adoption.changes, adoption.written)
    # Known factors 3 and 2; the larger is offered, good to 1 %.
    assert adopted.imu.vibration_factor == pytest.approx(3.0, rel=0.03)
    origin = noted_origin(adopted, "imu.vibration_factor")
    assert origin is not None
    assert "as white noise" in origin
    with pytest.raises(ValueError, match="random walks have changed"):
        adopt_vibration_factor(design.replace({ARW: 2e-4}), result, bench_of(design))
    with pytest.raises(ValueError, match="without bench noise"):
        adopt_vibration_factor(design, analyse_motion(log), BenchNoise())
