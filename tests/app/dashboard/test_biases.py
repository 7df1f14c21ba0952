"""Both residual biases by one choice of the sidebar."""

import math

import pytest

from app.dashboard.controls.biases import BiasInput
from app.examples import example
from app.session import Session


def test_one_choice_sets_both_biases_and_names_those_in_force() -> None:
    session = Session(example("mems_x_band"))
    biases = BiasInput(session, "imu.residual_bias", None)
    assert biases.current()["text"] == "none"
    assert biases.take("in-run") is None  # of a STIM300: 0.05 mg and 0.5 °/h
    assert session.design["imu.accelerometer_bias"] == pytest.approx(0.05e-3 * 9.80665)
    assert session.design["imu.gyro_bias"] == pytest.approx(math.radians(0.5) / 3600)
    assert biases.current()["text"] == "in-run"
    session.change({"imu.accelerometer_bias": 1e-3 * 9.80665})
    assert biases.current()["text"] == ""
    biases.take("none")
    assert session.design["imu.accelerometer_bias"] == session.design["imu.gyro_bias"] == 0
    session.undo()
    assert biases.current()["text"] == ""
    session.change({"imu.preset": None})
    refused = biases.take("in-run")
    assert refused is not None
    assert "choose an IMU" in str(refused)
    assert session.design["imu.accelerometer_bias"] == pytest.approx(1e-3 * 9.80665)
