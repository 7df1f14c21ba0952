from dataclasses import replace

import numpy as np
import pytest

from nav_model.base.errors import InputError
from nav_model.earth.rotation import matrix_from_euler, vector_from_matrix
from nav_model.earth.sphere import ned_to_inertial
from nav_model.suborbital.aiding import (
    Aiding,
    attitude_at,
    camera_frames,
    frame_steps,
    perfect_frames,
)
from nav_model.suborbital.errors import CLASSES, ErrorSet, mask, parameter_vector
from nav_model.suborbital.flight import FlightParameters, attitude_program
from nav_model.suborbital.layout import COUNT
from nav_model.suborbital.mechanisation import AttitudeFrames, mechanise
from nav_model.suborbital.navigation_errors import navigation_errors


def final(flight, aiding, parameters=None, frames=None):
    p = np.zeros(COUNT) if parameters is None else parameters
    aid = camera_frames(flight, aiding) if frames is None else frames
    return navigation_errors(flight, mechanise(flight, p, ErrorSet(), frames=(aid,), every=flight.steps)).position_m[
        0, -1
    ]


def test_latency_of_ten_milliseconds_costs_about_390_m(flight):
    assert np.linalg.norm(final(flight, Aiding(latency_s=0.01))) == pytest.approx(390.0, abs=10.0)


def test_one_arc_minute_of_misalignment_costs_up_to_2_6_km(flight):
    minute = np.radians(1.0 / 60.0)
    cost = [np.linalg.norm(final(flight, Aiding(misalignment_rad=tuple(minute * row)))) for row in np.eye(3)]
    assert max(cost) == pytest.approx(2.6e3, abs=50.0)
    # About body x, the thrust axis, a misalignment does next to nothing.
    assert cost[0] < 10.0


@pytest.mark.long
def test_a_perfect_camera_leaves_what_does_not_come_through_attitude(study):
    for name in ("accelerometer total", "initial position and velocity"):
        k = study.case(name)
        np.testing.assert_allclose(study.aided.position_m[k, -1], study.pure.position_m[k, -1], atol=1e-3)
    for name in ("gyro total", "initial attitude"):
        k = study.case(name)
        pure = np.linalg.norm(study.pure.position_m[k, -1])
        assert np.linalg.norm(study.aided.position_m[k, -1]) < 1e-3 * pure


def test_tracker_in_coast_does_not_matter(flight):
    """Without thrust attitude drives nothing: frames from after burn-out change no position."""
    p = parameter_vector(ErrorSet()) * mask(CLASSES["gyro total"])
    only_bias = p.copy()
    alone = mechanise(flight, only_bias, ErrorSet(), every=flight.steps)
    pure = navigation_errors(flight, alone).position_m[0, -1]
    late = final(flight, Aiding(dropouts_s=((0.0, 195.0),)), only_bias)
    assert np.linalg.norm(late - pure) < 1e-3


def test_from_height_and_frame_interval_choose_the_steps(flight):
    used = frame_steps(flight, Aiding(from_height_m=80e3, frame_interval_s=0.5))
    assert flight.time_s[used][0] == pytest.approx(111.5)
    assert np.allclose(np.diff(flight.time_s[used])[:100], 0.5)
    assert np.all(flight.height_m[used] >= 80e3)


def test_gyros_hold_the_attitude_through_a_dropout(flight):
    """Attitude error starts at zero at the last frame, grows as rate error times time, then vanishes."""
    p = parameter_vector(ErrorSet()) * mask(CLASSES["gyro bias"])
    aid = camera_frames(flight, Aiding(dropouts_s=((400.0, 500.0),)))
    run = navigation_errors(flight, mechanise(flight, p, ErrorSet(), frames=(aid,)))
    size = np.linalg.norm(run.attitude_inertial_rad[0], axis=-1)
    assert size[399] < 1e-9
    bias = np.linalg.norm(ErrorSet().gyros.constant_bias)
    assert size[499] == pytest.approx(bias * 99.1, rel=0.02)
    assert size[500] < 1e-9


def test_slower_frames_leave_more_gyro_error(flight):
    p = parameter_vector(ErrorSet()) * mask(CLASSES["gyro total"])
    cost = [np.linalg.norm(final(flight, Aiding(frame_interval_s=dt), p)) for dt in (0.1, 1.0, 10.0)]
    # Between frames the mean attitude error is half the growth over the interval.
    assert cost[1] / cost[0] == pytest.approx(10.0, rel=0.05)
    assert cost[2] / cost[1] == pytest.approx(10.0, rel=0.1)


def test_attitude_between_steps_is_the_programme(flight):
    parameters = FlightParameters()
    times = np.array([0.0, 33.337, 100.02, 799.99, 1500.0])
    angles, _ = attitude_program(parameters, times)
    launch = ned_to_inertial(parameters.latitude_rad, parameters.longitude_rad)
    truth = launch @ matrix_from_euler(*np.moveaxis(angles, -1, 0))
    gap = vector_from_matrix(attitude_at(flight, times) @ np.swapaxes(truth, -1, -2))
    # A turn at constant rate inside half a step misses h^2/32 of the angular acceleration: 0.02 arcsec.
    assert np.abs(gap).max() < 1e-7


def test_measured_frames_keep_their_gate_and_are_late_by_whole_steps(flight):
    used = np.ones(flight.steps + 1, dtype=bool)
    used[1000:1100] = False
    measured = AttitudeFrames(used, np.ascontiguousarray(flight.attitude_bi))
    late = camera_frames(flight, Aiding(latency_s=0.3), measured)
    assert not late.used[1003:1103].any()
    assert late.used[1002]
    assert late.used[1103]
    np.testing.assert_array_equal(late.attitude_bi[500], flight.attitude_bi[497])
    with pytest.raises(InputError, match="latency_s"):
        camera_frames(flight, Aiding(latency_s=0.25), measured)


def test_frames_between_steps_are_refused(flight):
    with pytest.raises(InputError, match="frame_interval_s"):
        frame_steps(flight, replace(Aiding(), frame_interval_s=0.25))
    assert perfect_frames(flight, Aiding()).used.all()
