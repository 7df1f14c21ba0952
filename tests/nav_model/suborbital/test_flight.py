import math

import numpy as np
import pytest
from flight_files import format_flight

from nav_model.base.errors import InputError
from nav_model.suborbital.flight import FlightParameters, in_gravity, reference_flight
from nav_model.suborbital.flight_file import parse_flight


def test_reference_flight_has_the_printed_milestones(flight):
    """star_tracker.md, "Reference flight (X)"."""
    time, height = flight.apogee
    assert time == pytest.approx(815.6, abs=0.05)
    assert height == pytest.approx(991.44e3, abs=5.0)
    assert flight.height_m[1950] == pytest.approx(232.33e3, abs=5.0)
    assert np.linalg.norm(flight.velocity_i[1950]) == pytest.approx(6172.88, abs=5e-3)
    assert flight.time_s[flight.height_m > 80e3][0] == pytest.approx(111.3, abs=0.05)
    assert flight.height_m[-1] == pytest.approx(64.70e3, abs=5.0)


def test_starts_at_rest_on_the_pad_along_the_azimuth(flight):
    assert np.degrees(flight.latitude_rad[0]) == pytest.approx(37.94, abs=1e-9)
    assert np.degrees(flight.longitude_rad[0]) == pytest.approx(-75.46, abs=1e-9)
    assert np.abs(flight.velocity_ned[0]).max() < 1e-9
    assert flight.ground_range_m[0] == 0.0
    # During boost the flight heads down the launch azimuth to within a few degrees.
    assert math.degrees(flight.track_rad[1000]) == pytest.approx(110.0, abs=5.0)


def test_energy_and_angular_momentum_are_kept_in_coast(flight):
    """After burn-out the motion is Keplerian: both constants of the two-body problem must stand still."""
    r, v = flight.position_i[1950:], flight.velocity_i[1950:]
    energy = 0.5 * np.sum(v * v, axis=1) - 3.986004418e14 / np.linalg.norm(r, axis=1)
    momentum = np.cross(r, v)
    assert np.ptp(energy) / abs(energy[0]) < 1e-12
    assert np.abs(momentum - momentum[0]).max() / np.linalg.norm(momentum[0]) < 1e-12


def test_angular_rate_is_the_derivative_of_the_attitude(flight):
    c, h = flight.half_attitude_bi, 0.5 * flight.step_s
    cross = np.swapaxes(c[1:-1], -1, -2) @ (c[2:] - c[:-2]) / (2.0 * h)
    rate = np.stack([cross[:, 2, 1], cross[:, 0, 2], cross[:, 1, 0]], axis=-1)[::2]
    # The central difference itself is off by h^2/6 of the rate's second derivative, about 1e-8 rad/s here.
    assert np.abs(rate - flight.angular_rate_b[:, 1]).max() < 3e-8


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"burn_time_s": 195.05}, "burn_time_s"),
        ({"duration_s": 1500.03}, "duration_s"),
        ({"gravity": "flat"}, "gravity"),
        ({"burn_time_s": 120.0}, "pitch_end_s"),
    ],
)
def test_bad_parameters_are_refused_by_name(change, words):
    with pytest.raises(InputError, match=words):
        FlightParameters(**change)


def test_a_flight_into_the_ground_is_refused():
    with pytest.raises(InputError, match="reaches the ground"):
        reference_flight(FlightParameters(duration_s=1700.0))
    with pytest.raises(InputError, match="reaches the ground"):
        reference_flight(FlightParameters(initial_thrust_m_s2=5.0))


def test_trajectory_file_round_trip(flight):
    loaded = parse_flight(format_flight(flight), "flight.csv")
    assert np.abs(loaded.position_i - flight.position_i).max() < 1e-4
    assert np.abs(loaded.angular_rate_b - flight.angular_rate_b).max() < 1e-6
    # Away from burn-out, which a spline smears over a few rows.
    assert np.abs(loaded.specific_force_b[:1900] - flight.specific_force_b[:1900]).max() < 2e-3
    assert np.abs(loaded.specific_force_b[2000:]).max() < 2e-3


def test_the_same_flight_in_another_field_is_that_flown_there(flight):
    there, flown = in_gravity(flight, "j2"), reference_flight(FlightParameters(gravity="j2"))
    np.testing.assert_array_equal(there.position_i, flown.position_i)
    np.testing.assert_array_equal(there.specific_force_b, flown.specific_force_b)
    assert there.gravity == "j2"
    assert np.abs(there.position_i - flight.position_i).max() > 1e3
    assert in_gravity(flight, flight.gravity) is flight
