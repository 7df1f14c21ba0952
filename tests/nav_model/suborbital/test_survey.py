"""Moved curves against integrating again at the same inputs, which shares nothing with the linear matrix."""

import json

import numpy as np
import pytest
from flight_files import format_flight

from nav_model.base.errors import InputError
from nav_model.suborbital.flight_file import parse_flight
from nav_model.suborbital.moving import moved, needs_other_matrices, renewed
from nav_model.suborbital.settings import DEFAULTS, read_changes
from nav_model.suborbital.study import position_gap
from nav_model.suborbital.survey import needs_run, run_survey
from nav_model.suborbital.survey_json import command, survey_json

pytestmark = pytest.mark.long

HISTORIES = ("position_m", "velocity_m_s", "attitude_inertial_rad", "attitude_navigation_rad", "cross_range_m")


@pytest.fixture(scope="module")
def survey():
    return run_survey(DEFAULTS)


def compare(linear, exact, share):
    for which in ("pure", "aided"):
        for name in HISTORIES:
            a, b = getattr(getattr(linear, which), name), getattr(getattr(exact, which), name)
            assert np.abs(a - b).max() <= share * np.abs(b).max() + 1e-9, (which, name)
    # White noise and the decoupled channels are linear: no gap at all.
    for which in ("pure_noise", "aided_noise"):
        for name in ("position_sigma_m", "covariance"):
            np.testing.assert_allclose(
                getattr(getattr(linear, which), name), getattr(getattr(exact, which), name), rtol=1e-9, atol=1e-12
            )
    np.testing.assert_allclose(linear.channels_m, exact.channels_m, atol=1e-5)


def test_sliders_of_sensor_and_initial_errors(survey):
    settings = read_changes(
        DEFAULTS,
        {"gyros.bias": "4, 5, 1 °/h", "accelerometers.bias": "1.2, 1, -1.4 mg", "initial.attitude": "90 arcsec",
         "gyros.white_noise": "0.05 °/√h", "tracker.misalignment": "5, -5, 2 arcsec"},
        "test",
    )  # fmt: skip
    assert not needs_run(survey, settings)
    assert not needs_other_matrices(survey.study, settings.study_inputs())
    linear, exact = moved(survey.study, settings.study_inputs()), run_survey(settings).study
    compare(linear, exact, 0.02)
    gap = position_gap(linear.pure.position_m, linear.aided.position_m, exact)
    assert gap.pure_share[gap.names.index("all")] < 0.02
    # and the move was not a small one
    assert np.linalg.norm((linear.pure.position_m - survey.study.pure.position_m)[:, -1], axis=1).max() > 3000


def test_frames_at_other_instants_and_other_periods_need_other_matrices(survey):
    settings = read_changes(
        DEFAULTS,
        {"tracker.from_height": "80 km", "tracker.dropouts": "150-160 s", "gyros.bias_period": "500 s"},
        "test",
    )
    assert needs_other_matrices(survey.study, settings.study_inputs())
    assert not needs_run(survey, settings)
    inputs = settings.study_inputs()
    linear = moved(survey.study, inputs, renewed(survey.study, inputs))
    compare(linear, run_survey(settings).study, 0.02)


def test_flight_camera_and_gravity_need_a_run(survey):
    for key, text in (("flight.burnout_pitch", "25°"), ("camera.centroid_noise", "20 arcsec"), ("ins.gravity", "j2")):
        assert needs_run(survey, read_changes(DEFAULTS, {key: text}, "test"))


def test_a_saved_flight_flown_again_gives_the_same_errors(survey):
    again = run_survey(DEFAULTS, ("flown.csv", format_flight(survey.study.flight, every=5)))
    size = np.abs(survey.study.pure.position_m[:, -1]).max()
    known = [survey.study.case(name) for name in ("accelerometer total", "gyro total", "all")]
    difference = (again.study.pure.position_m - survey.study.pure.position_m)[known, -1]
    assert np.abs(difference).max() < 0.02 * size
    assert again.trajectory == "flown.csv"
    assert again.gravity == ()


_HEAD = b"time_s,latitude_deg,longitude_deg,height_m,roll_deg,pitch_deg,yaw_deg\n"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (_HEAD + b"".join(b"%d,0,0,1e5,0,0,0\n" % (k * 10**9) for k in range(5)), "at most 10000 s"),
        (_HEAD + b"".join(b"%d,91,0,1e5,0,0,0\n" % k for k in range(5)), "line 2: latitude_deg = 91"),
        (_HEAD + b"".join(b"%d,0,0,1e300,0,0,0\n" % k for k in range(5)), "line 2: height_m = 1e.300"),
        (_HEAD + b"".join(b"%d,%d,0,1e5,0,0,0\n" % (k, k % 2 * 90) for k in range(5)), "asks for .* m/s²"),
        (_HEAD + b"".join(b"%de-300,0,0,1e5,0,0,0\n" % k for k in range(5)) + b"1,0,0,1e5,0,0,0\n", "1e-06 s at"),
        (b"x" * 16_000_001, "larger than 16 MB"),
    ],
)  # fmt: skip
def test_a_file_is_refused_by_its_name(content, message):
    with pytest.raises(InputError, match=f"mine.csv.*({message})"):
        parse_flight(content, "mine.csv")


def test_json_says_where_every_input_came_from(survey):
    settings = read_changes(DEFAULTS, {"tracker.latency": "10 ms", "gyros.bias": "1 °/h"}, "command line")
    answer = json.loads(
        json.dumps(survey_json(survey, moved(survey.study, settings.study_inputs()), settings), allow_nan=False)
    )
    assert answer["exact"] is False
    assert answer["inputs"]["tracker.latency"] == {"value": "10 ms", "si": 0.01, "from": "command line"}
    assert answer["inputs"]["initial.position"]["from"] == "GP-1"
    assert command(settings) == "navbudget suborbital --set 'gyros.bias=1, 1, 1 °/h' 'tracker.latency=10 ms'"
