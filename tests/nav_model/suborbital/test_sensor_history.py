"""Drawn sensor errors against what they do to an INS that was integrated with them."""

import numpy as np
import pytest

from nav_model.base.constants import GRAVITATIONAL_PARAMETER
from nav_model.base.errors import InputError
from nav_model.suborbital.errors import CLASSES, ErrorSet, SensorErrors, mask, parameter_vector
from nav_model.suborbital.mechanisation import mechanise
from nav_model.suborbital.navigation_errors import navigation_errors
from nav_model.suborbital.sensor_history import sensor_history


@pytest.fixture(scope="module")
def parameters():
    """A hundredth of GP-1, so that the INS's own second order is out of sight."""
    p = 0.01 * parameter_vector(ErrorSet())
    return np.stack([p * mask(CLASSES[name]) for name in ("accelerometer total", "gyro total")])


def test_gyro_error_integrates_to_the_attitude_error_of_the_ins(flight, parameters):
    """psi' = C domega [B-4], summed by the trapezoidal rule, against the integrated INS."""
    errors = ErrorSet()
    history = sensor_history(flight, parameters, errors, every=1).angular_rate_rad_s[1]
    rates = np.einsum("tij,tj->ti", flight.attitude_bi, history)
    psi = np.concatenate([np.zeros((1, 3)), np.cumsum(0.05 * (rates[1:] + rates[:-1]), axis=0)])
    run = mechanise(flight, parameters[1], errors, every=10)
    result = navigation_errors(flight, run).attitude_inertial_rad[0]
    assert np.abs(psi[::10] - result).max() < 1e-4 * np.abs(result).max()


def test_accelerometer_error_is_the_acceleration_the_ins_gains(flight, parameters):
    """dr'' = C df + w² (3 u u^T - I) dr: the INS's velocity error differentiated, away from burn-out."""
    errors = ErrorSet()
    run = mechanise(flight, parameters[0], errors, every=1)
    dv, dr = run.velocity_i[0] - flight.velocity_i, run.position_i[0] - flight.position_i
    df = sensor_history(flight, parameters, errors, every=1).specific_force_m_s2[0]
    for second in (50, 150, 190, 400, 900, 1490):
        i = 10 * second
        gained = (dv[i + 1] - dv[i - 1]) / 0.2
        r = flight.position_i[i]
        radius = np.linalg.norm(r)
        gravity = GRAVITATIONAL_PARAMETER / radius**3 * (3 * r * (r @ dr[i]) / radius**2 - dr[i])
        result = flight.attitude_bi[i] @ df[i]
        assert gained - gravity == pytest.approx(result, abs=1e-3 * np.linalg.norm(result))


def test_bias_and_instability_add_up_and_follow_their_periods(flight):
    errors = ErrorSet()
    p = parameter_vector(errors)
    cases = np.stack([p * mask(CLASSES[f"gyro {kind}"]) for kind in ("bias", "instability", "total")])
    bias, slow, total = sensor_history(flight, cases, errors).angular_rate_rad_s
    np.testing.assert_allclose(bias + slow, total, rtol=1e-12, atol=1e-20)
    assert np.all(slow[0] == 0)  # sin 0
    # in coast the rate is small: a quarter of the gyros' 600 s later the oscillation is near its amplitude
    still = np.flatnonzero(flight.time_s[::10] == 750.0)
    assert slow[still[0]] == pytest.approx(np.radians(0.3) / 3600, rel=0.06)


def test_a_pure_bias_is_itself_everywhere(flight):
    p = parameter_vector(ErrorSet(accelerometers=SensorErrors(constant_bias=(1.0, -2.0, 3.0)), gyros=SensorErrors()))
    result = sensor_history(flight, p, ErrorSet(), every=100)
    assert np.all(result.specific_force_m_s2 == [1.0, -2.0, 3.0])
    assert np.all(result.angular_rate_rad_s == 0)


def test_refusals(flight):
    with pytest.raises(InputError, match="does not divide"):
        sensor_history(flight, np.zeros(61), ErrorSet(), every=7)
    with pytest.raises(InputError, match="shape"):
        sensor_history(flight, np.zeros(3), ErrorSet())
