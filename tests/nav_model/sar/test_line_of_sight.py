"""Line of sight against ranges computed in extended precision, [S-1] and [S-2]."""

import numpy as np
import pytest
from exact_sight import directions
from hypothesis import given, settings
from hypothesis import strategies as st

from nav_model.sar.decomposition import autofocus, decompose
from nav_model.sar.line_of_sight import ApertureGeometry, range_error, ranges_to_target

WAVELENGTH = 0.03
TIME = np.linspace(0, 5, 501)
angles = st.floats(0, 1.2)


def exact(geometry, time, error):
    """|target - (platform + error)| - |target - platform| in long double."""
    vectors = ranges_to_target(geometry, time).astype(np.longdouble)
    moved = vectors - error.astype(np.longdouble)
    return np.sqrt((moved**2).sum(axis=1)) - np.sqrt((vectors**2).sum(axis=1))


@settings(max_examples=40)
@given(
    grazing=angles,
    squint=st.floats(-0.35, 0.35),
    offset=st.tuples(*[st.floats(-50, 50)] * 3),
    velocity=st.tuples(*[st.floats(-0.5, 0.5)] * 3),
)
def test_x_band_10_km_5_s_against_exact_ranges(grazing, squint, offset, velocity):
    geometry = ApertureGeometry(10e3, 100.0, grazing, squint)
    error = np.array(offset) + np.outer(TIME, velocity) + 0.02 * np.outer(TIME**2, [1, -1, 0.5])
    result = range_error(geometry, TIME, *error.T)
    phase = 4 * np.pi / WAVELENGTH * np.abs(result - exact(geometry, TIME, error))
    assert phase.max() < 1e-3


def test_target_has_the_range_and_angles_asked_for():
    geometry = ApertureGeometry(8e3, 100.0, 0.5, 0.2)
    target = geometry.target
    assert np.linalg.norm(target) == pytest.approx(8e3)
    assert np.arcsin(target[2] / 8e3) == pytest.approx(0.5)
    assert np.arcsin(target[0] / 8e3) == pytest.approx(0.2)
    u = directions(geometry, TIME)
    np.testing.assert_allclose(np.linalg.norm(u, axis=1), 1.0)
    np.testing.assert_allclose(u[250], target / 8e3, atol=1e-12)
    assert u[0, 0] > u[-1, 0]  # the target falls back


@pytest.mark.parametrize("k", [0.8859, 1.1875])
def test_along_track_velocity_error_makes_the_qpe_of_s2(k):
    slant, speed, resolution, error = 10e3, 100.0, 0.5, 0.05
    aperture = k * WAVELENGTH * slant / (2 * resolution * speed)
    time = np.linspace(0, aperture, 1001)
    geometry = ApertureGeometry(slant, speed, 0.7)
    phase = 4 * np.pi / WAVELENGTH * range_error(geometry, time, along=error * time)
    expected = np.pi * WAVELENGTH * slant * error * k**2 / (4 * resolution**2 * speed)
    assert abs(decompose(phase).quadratic) == pytest.approx(expected, rel=2e-3)
    # Detrending before the projection would have lost it.
    assert np.abs(range_error(geometry, time, along=autofocus(error * time))).max() < 1e-12


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ((0.0, 100.0), "slant_range"),
        ((1e4, np.nan), "speed"),
        ((1e4, 100.0, 1.6), "grazing_angle"),
        ((1e4, 100.0, 1.0, 0.8), "squint"),
    ],
)
def test_bad_geometry_is_refused_by_name(arguments, message):
    with pytest.raises(ValueError, match=message):
        ApertureGeometry(*arguments)
