"""WGS 84 and the gravity models against published numbers and the closed form of the normal field."""

import numpy as np
import pytest

from nav_model.base.constants import EARTH_RATE, FLATTENING, GRAVITATIONAL_PARAMETER, SEMI_MAJOR_AXIS
from nav_model.earth.gravity import ZONALS, compare_gravity, gravitation
from nav_model.earth.wgs84 import curvature_radii, normal_gravity


def test_gravity_on_the_ellipsoid_matches_the_published_values(compared):
    # TR8350.2 table 3.4: theoretical gravity at equator and poles; 45 deg from Somigliana's formula there.
    compared(
        "Gravity of the simulator at equator and poles", "", "published figure", "NIMA TR8350.2, table 3.4",
        [normal_gravity(0.0, 0.0) - 9.7803253359, normal_gravity(1.0, 0.0) - 9.8321849378], 1e-9,
        "largest difference, m/s²",
    )  # fmt: skip


def meridian_point(latitude, height):
    """Distance from the axis and from the equator [m] of a point at geodetic latitude [rad]."""
    squared = (1 - FLATTENING) ** 2
    n = SEMI_MAJOR_AXIS / np.sqrt(np.cos(latitude) ** 2 + squared * np.sin(latitude) ** 2)
    return (n + height) * np.cos(latitude), (n * squared + height) * np.sin(latitude)


def normal_field(latitude, height):
    """Components of normal gravity along the axis and away from it, in ellipsoidal coordinates, exact at any height
    (Heiskanen and Moritz, Physical Geodesy, 2-66 and 2-120 to 2-126)."""
    a, b = SEMI_MAJOR_AXIS, SEMI_MAJOR_AXIS * (1 - FLATTENING)
    focal = np.sqrt(a * a - b * b)
    rho, z = meridian_point(latitude, height)
    difference = rho**2 + z**2 - focal**2
    u = np.sqrt(0.5 * difference * (1 + np.sqrt(1 + 4 * focal**2 * z**2 / difference**2)))
    total = u**2 + focal**2
    beta = np.arctan2(z * np.sqrt(total), u * rho)
    w = np.sqrt((u**2 + focal**2 * np.sin(beta) ** 2) / total)

    def q(x):
        return 0.5 * ((1 + 3 * x**2 / focal**2) * np.arctan(focal / x) - 3 * x / focal)

    q_slope = 3 * (1 + u**2 / focal**2) * (1 - u / focal * np.arctan(focal / u)) - 1
    rate2 = EARTH_RATE**2
    along_u = GRAVITATIONAL_PARAMETER / total - rate2 * u * np.cos(beta) ** 2
    along_u += rate2 * a**2 * focal / total * q_slope / q(b) * (0.5 * np.sin(beta) ** 2 - 1 / 6)
    along_beta = rate2 * a**2 / np.sqrt(total) * q(u) / q(b) - rate2 * np.sqrt(total)
    along_u, along_beta = -along_u / w, along_beta * np.sin(beta) * np.cos(beta) / w
    tilt = u / np.sqrt(total) / w
    return (
        along_u * np.sin(beta) / w + along_beta * tilt * np.cos(beta),
        along_u * tilt * np.cos(beta) - along_beta * np.sin(beta) / w,
    )


@pytest.mark.parametrize("latitude", [0.1, 0.7, 1.2])
@pytest.mark.parametrize("height", [0.0, 3000.0, 12_000.0])
def test_gravity_aloft_matches_the_exact_normal_field(latitude, height, compared):
    compared(
        "Gravity of the simulator to 12 km",
        "",
        "our own derivation",
        "exact normal field of Heiskanen and Moritz, written out in the test",
        normal_gravity(np.sin(latitude), height) - np.hypot(*normal_field(latitude, height)),
        2e-6,
        "largest difference, m/s²",
    )


def test_curvature_radii_match_distances_along_the_ellipse():
    latitude = np.linspace(0.2, 1.2, 5)
    step = 1e-4

    meridian, prime = curvature_radii(np.sin(latitude))
    chord = np.hypot(*np.subtract(meridian_point(latitude + step, 0), meridian_point(latitude - step, 0)))
    assert chord / (2 * step) == pytest.approx(meridian, rel=1e-8)
    assert meridian_point(latitude, 0)[0] == pytest.approx(prime * np.cos(latitude), rel=1e-12)


def felt(latitude, height):
    """Gravity of the ellipsoidal model with its centrifugal part, along the axis and away from it."""
    x, z = meridian_point(latitude, height)
    field = gravitation(np.stack([x, 0 * x, z], axis=-1), "ellipsoidal")
    return field[..., 2], field[..., 0] + EARTH_RATE**2 * x


def test_ellipsoidal_gravity_has_the_published_values(compared):
    """NIMA TR8350.2, table 3.6: 9.7803253359 at the equator, 9.8321849378 at the poles."""
    magnitude = np.hypot(*felt(np.array([0.0, np.pi / 2]), 0.0))
    compared(
        "Ellipsoidal gravity at equator and poles", "", "published figure", "NIMA TR8350.2, table 3.6",
        magnitude - [9.7803253359, 9.8321849378], 5e-9, "largest difference, m/s²",
    )  # fmt: skip


@pytest.mark.parametrize("height", [0.0, 1e5, 5e5, 1e6])
def test_zonals_agree_with_the_closed_normal_field(height):
    latitude = np.radians(np.linspace(-85.0, 85.0, 35))
    np.testing.assert_allclose(felt(latitude, height), normal_field(latitude, height), atol=5e-9)


@pytest.mark.parametrize("model", ZONALS)
def test_gravitation_is_the_gradient_of_a_harmonic_potential(model):
    """Its divergence and curl vanish outside the Earth (central differences)."""
    point, step = np.array([3.1e6, -2.4e6, 5.6e6]), 200.0
    shift = step * np.eye(3)
    jacobian = (gravitation(point + shift, model) - gravitation(point - shift, model)) / (2.0 * step)
    assert abs(np.trace(jacobian)) < 1e-13
    assert np.abs(jacobian - jacobian.T).max() < 1e-13


def test_gravity_comparison_falls_with_height_and_knows_its_models():
    table = compare_gravity(np.radians(38.0), np.linspace(0.0, 1e6, 11))
    assert np.all(np.diff(table.spherical_m_s2) < 0.0)
    # J2 makes all but a few 1e-5 m/s² of what separates the ellipsoid from the sphere.
    assert np.abs(table.j2_m_s2 - table.ellipsoidal_m_s2).max() < 2e-4
    assert np.abs(table.spherical_m_s2 - table.ellipsoidal_m_s2).min() > 1e-3
    assert np.all(table.horizontal_j2_m_s2 < 0.0)
