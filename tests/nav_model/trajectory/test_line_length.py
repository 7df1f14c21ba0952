"""When a line fails, why, and how long it may be: against the closed form of heading, and lines flown again."""

import math
from dataclasses import replace

import numpy as np
import pytest

from nav_model.base.constants import DEGREE, DEGREE_PER_HOUR
from nav_model.design import Design
from nav_model.simulation.design_study import specification
from nav_model.simulation.study_inputs import read_study_inputs
from nav_model.trajectory.covariance import covariance
from nav_model.trajectory.design_study import covariance_specification
from nav_model.trajectory.result import to_json
from nav_model.trajectory.specification import Line

START, WALK, BIAS, TIME = 0.005 * DEGREE, 0.05 * DEGREE / 60, 0.5 * DEGREE_PER_HOUR, 200.0
TACTICAL = Design({"imu.angle_random_walk": WALK, "flight.speed": 60.0, "gnss.position_noise": 0.05})


@pytest.mark.parametrize("states", [9, 15])
def test_heading_grows_along_a_straight_line_as_its_closed_form(states: int) -> None:
    """Variance sigma0² + N² t + 2 B² tau (t - tau (1 - exp(-t/tau))) to 1 %, and a limit is passed when it says."""
    noise = {"gyro.bias_instability": "0.5 °/h", "gyro.correlation_time": "200 s", "filter.initial_yaw": "0.005 °"}
    study = specification(
        TACTICAL, trajectory="straight", duration=900.0, states=states, more=read_study_inputs(noise)
    )
    limit = 0.02 * DEGREE
    spec = covariance_specification(TACTICAL, study, (Line("line 1", 0.0, 900.0),))
    flown = covariance(replace(spec, most=(("heading", limit),)))
    t = np.arange(901.0)
    drift = 2 * BIAS**2 * TIME * (t - TIME * (1 - np.exp(-t / TIME)))
    variance = START**2 + WALK**2 * t + drift
    np.testing.assert_allclose(flown.real_time.attitude[:, 2] ** 2, variance, rtol=0.01)
    (line,) = flown.lines
    passes = float(np.interp(limit**2, variance, t))
    assert line.fails_at_s == pytest.approx(passes, abs=0.01 * passes + 1)  # judged just before the next fix
    minutes, seconds = divmod(round(line.fails_at_s), 60)
    mostly = "gyro noise" if WALK**2 * passes > np.interp(passes, t, drift) else "gyro bias instability"
    assert line.because == f"heading passes 0.02° (1σ) after {minutes} min {seconds} s; mostly {mostly}"
    (told,) = to_json(flown)["lines"]
    assert (told["because"], told["limits"]) == (line.because, {"heading": limit})
    heading = told["figures"]["heading"]
    assert heading["start"] == pytest.approx(math.sqrt(variance[1]), rel=0.01)
    assert heading["worst"] == pytest.approx(math.sqrt(variance[-1]), rel=0.01)
    assert heading["mean"] == pytest.approx(math.sqrt(np.mean(variance)), rel=0.01)
    assert told["figures"].keys() >= {"horizontal_position", "vertical_velocity", "tilt", "detrended_phase"}


def test_a_line_within_its_limits_fails_at_no_time_and_one_beyond_from_the_start_says_so() -> None:
    study = specification(TACTICAL, trajectory="straight", duration=60.0)
    spec = covariance_specification(TACTICAL, study, (Line("line 1", 10.0, 60.0),))
    within, beyond = (
        covariance(replace(spec, most=(("heading", limit * DEGREE),))).lines[0] for limit in (1.0, 0.05)
    )
    assert (within.fails_at_s, within.fails_by, within.because) == (None, "", "")
    assert (beyond.fails_at_s, beyond.fails_by) == (0.0, "heading")
    assert beyond.because == "heading is beyond 0.05° (1σ) from the start; mostly initial heading"
