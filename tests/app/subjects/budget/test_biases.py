"""Residual biases that the strip of the Budget page names, and one press to change them."""

import math

import pytest

from app.examples import example
from app.session import Session
from app.subjects.budget.page import BudgetPage


def test_the_strip_names_the_biases_and_one_press_changes_them() -> None:
    session = Session(example("mems_x_band"))
    page = BudgetPage(session)
    session.param.watch(lambda event: page.show(event.new), "budget")
    biases = page._biases
    assert list(biases.options) == ["Residual biases 0", "in-run of data sheet"]
    assert biases.value == "Residual biases 0"
    assert not any(session.design[key] for key in ("imu.accelerometer_bias", "imu.gyro_bias"))

    biases._handle_msg("in-run of data sheet")  # of a STIM300: 0.05 mg and 0.5 °/h
    assert session.design["imu.accelerometer_bias"] == pytest.approx(0.05e-3 * 9.80665)
    assert session.design["imu.gyro_bias"] == pytest.approx(math.radians(0.5) / 3600)

    session.change({"imu.accelerometer_bias": 1e-3 * 9.80665})
    assert biases.value == "1 mg and 0.5 °/h"
    biases._handle_msg("Residual biases 0")
    assert session.design["imu.accelerometer_bias"] == session.design["imu.gyro_bias"] == 0
    session.undo()
    assert biases.value == "1 mg and 0.5 °/h"
    session.change({"imu.preset": None, "imu.gyro_bias": 0.0})
    assert list(biases.options) == ["Residual biases 0", "1 mg"]
