from dataclasses import replace

import numpy as np

from nav_model.earth.sphere import ned_to_inertial
from nav_model.suborbital.errors import ErrorSet
from nav_model.suborbital.layout import COUNT
from nav_model.suborbital.mechanisation import mechanise
from nav_model.suborbital.navigation_errors import navigation_errors


def test_attitude_error_in_navigation_axes_comes_from_position(study):
    """With a perfect camera the inertial attitude is exact and the local one is off by dr / r [B-7]."""
    k = study.case("all")
    assert np.abs(study.aided.attitude_inertial_rad[k]).max() < 1e-12
    north, east, _ = study.aided.position_m[k, -1]
    r = np.linalg.norm(study.flight.position_i[-1])
    tilt = study.aided.attitude_navigation_rad[k, -1]
    # To first order the local axes turn by (-dE, dN, dE tan L)/r, and the attitude in them by the opposite.
    lat = study.flight.latitude_rad[-1]
    np.testing.assert_allclose(tilt, [-east / r, north / r, east * np.tan(lat) / r], atol=3e-6, rtol=0.01)


def test_down_and_cross_range_are_the_horizontal_error_turned(study):
    p = study.pure
    np.testing.assert_allclose(
        np.hypot(p.down_range_m, p.cross_range_m),
        np.hypot(p.position_m[..., 0], p.position_m[..., 1]),
        atol=1e-6,
    )


def test_navigation_error_of_a_pure_shift(flight):
    """A run displaced by a known local vector must report just that."""
    run = mechanise(flight, np.zeros(COUNT), ErrorSet(), every=flight.steps)
    axes = ned_to_inertial(flight.latitude_rad[-1], np.arctan2(flight.position_i[-1, 1], flight.position_i[-1, 0]))
    shifted = run.position_i.copy()
    shifted[0, -1] = flight.position_i[-1] + axes @ np.array([3.0, -4.0, -12.0])
    errors = navigation_errors(flight, replace(run, position_i=shifted))
    np.testing.assert_allclose(errors.position_m[0, -1], [3.0, -4.0, 12.0], atol=1e-6)
