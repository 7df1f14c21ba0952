"""WGS 84 against its published numbers and the closed form of the normal field."""

from __future__ import annotations

import numpy as np
import pytest

from nav_model.earth.wgs84 import (
    FLATTENING,
    GRAVITATIONAL_CONSTANT,
    ROTATION_RATE,
    SEMI_MAJOR_AXIS,
    curvature_radii,
    normal_gravity,
)


def test_gravity_on_the_ellipsoid_matches_the_published_values(compared):
    # TR8350.2 table 3.4: theoretical gravity at equator and poles; 45 deg from Somigliana's formula there.
    compared(
        "Gravity of the simulator at equator and poles", "", "published figure", "NIMA TR8350.2, table 3.4",
        [normal_gravity(0.0, 0.0) - 9.7803253359, normal_gravity(1.0, 0.0) - 9.8321849378], 1e-9,
        "largest difference, m/s²",
    )  # fmt: skip


def normal_field(latitude: float, height: float) -> float:
    """Magnitude of normal gravity in ellipsoidal coordinates, exact at any height (Heiskanen and Moritz,
    2-66)."""
    a, b = SEMI_MAJOR_AXIS, SEMI_MAJOR_AXIS * (1 - FLATTENING)
    focal = np.sqrt(a * a - b * b)
    n = a / np.sqrt(1 - (focal / a) ** 2 * np.sin(latitude) ** 2)
    rho, z = (n + height) * np.cos(latitude), (n * (b / a) ** 2 + height) * np.sin(latitude)
    difference = rho**2 + z**2 - focal**2
    u = np.sqrt(0.5 * difference * (1 + np.sqrt(1 + 4 * focal**2 * z**2 / difference**2)))
    beta = np.arctan2(z * np.sqrt(u**2 + focal**2), u * rho)
    w = np.sqrt((u**2 + focal**2 * np.sin(beta) ** 2) / (u**2 + focal**2))

    def q(x):
        return 0.5 * ((1 + 3 * x**2 / focal**2) * np.arctan(focal / x) - 3 * x / focal)

    q_slope = 3 * (1 + u**2 / focal**2) * (1 - u / focal * np.arctan(focal / u)) - 1
    total = u**2 + focal**2
    rate2 = ROTATION_RATE**2
    along_u = GRAVITATIONAL_CONSTANT / total - rate2 * u * np.cos(beta) ** 2
    along_u += rate2 * a**2 * focal / total * q_slope / q(b) * (0.5 * np.sin(beta) ** 2 - 1 / 6)
    along_beta = rate2 * a**2 / np.sqrt(total) * q(u) / q(b) - rate2 * np.sqrt(total)
    return float(np.hypot(along_u, along_beta * np.sin(beta) * np.cos(beta)) / w)


@pytest.mark.parametrize("latitude", [0.1, 0.7, 1.2])
@pytest.mark.parametrize("height", [0.0, 3000.0, 12_000.0])
def test_gravity_aloft_matches_the_exact_normal_field(latitude, height, compared):
    compared(
        "Gravity of the simulator to 12 km",
        "",
        "our own derivation",
        "exact normal field of Heiskanen and Moritz, written out in the test",
        normal_gravity(np.sin(latitude), height) - normal_field(latitude, height),
        2e-6,
        "largest difference, m/s²",
    )


def test_curvature_radii_match_distances_along_the_ellipse():
    latitude = np.linspace(0.2, 1.2, 5)
    step = 1e-4

    def meridian_point(angle):
        n = SEMI_MAJOR_AXIS / np.sqrt(1 - FLATTENING * (2 - FLATTENING) * np.sin(angle) ** 2)
        return np.stack([n * np.cos(angle), n * (1 - FLATTENING) ** 2 * np.sin(angle)])

    meridian, prime = curvature_radii(np.sin(latitude))
    chord = np.linalg.norm(meridian_point(latitude + step) - meridian_point(latitude - step), axis=0)
    assert chord / (2 * step) == pytest.approx(meridian, rel=1e-8)
    assert meridian_point(latitude)[0] == pytest.approx(prime * np.cos(latitude), rel=1e-12)
