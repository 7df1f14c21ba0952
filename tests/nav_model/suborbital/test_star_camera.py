from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from nav_model.base.constants import ARCSECOND
from nav_model.base.errors import InputError
from nav_model.suborbital.attitude import METHODS, estimate
from nav_model.suborbital.sky import hipparcos_sky, synthetic_sky
from nav_model.suborbital.star_camera import (
    CAMERA_TO_BODY,
    StarCamera,
    focal_length,
    gate,
    project,
    select_stars,
    star_frames,
    track_stars,
)


def test_catalogue_has_7982_stars_to_magnitude_6_5(sky):
    assert len(sky) == 7982
    assert np.all(np.diff(sky.magnitude) >= 0.0)
    assert sky.magnitude[-1] <= 6.5
    np.testing.assert_allclose(np.linalg.norm(sky.direction, axis=-1), 1.0, atol=1e-12)


def test_sirius_and_barnards_star_stand_where_almanacs_put_them(compared):
    """ICRS places at epoch 2000 (SIMBAD): Sirius 101.28716 -16.71612, Barnard's star 269.45208 +4.69339 deg.
    The latter moves by 10.4 arcsec a year: without proper motion it would be 90 arcsec off."""
    sky = hipparcos_sky(10.0, 2000.0)
    for number, ra, dec in ((32349, 101.28716, -16.71612), (87937, 269.45208, 4.69339)):
        direction = sky.direction[np.flatnonzero(sky.identifier == number)[0]]
        a, d = np.radians(ra), np.radians(dec)
        truth = np.array([np.cos(d) * np.cos(a), np.cos(d) * np.sin(a), np.sin(d)])
        compared(
            "Directions of Sirius and Barnard's star in 2000", "B-8", "published figure", "SIMBAD",
            np.linalg.norm(np.cross(direction, truth)) / ARCSECOND, 1.0, "largest angle, ″",
        )  # fmt: skip
    assert sky.identifier[0] == 32349


def test_focal_length_of_the_eight_degree_camera():
    camera = StarCamera()
    assert camera.focal_length_m == pytest.approx(117.15e-3, abs=5e-6)
    assert np.degrees(camera.field_of_view_rad) == pytest.approx(8.0)
    assert focal_length(np.radians(8.0)) == pytest.approx(camera.focal_length_m)


def test_average_number_of_stars_in_the_field(sky):
    """12.3 (star_tracker.md); 7982 times the solid angle 4 asin(sin² 4°) over the sphere is 12.36."""
    attitude = Rotation.random(40000, rng=np.random.default_rng(2)).as_matrix()
    _, count = select_stars(StarCamera(), sky, attitude)
    assert count.mean() == pytest.approx(12.3, abs=0.15)
    share = 4.0 * np.arcsin(np.sin(np.radians(4.0)) ** 2) / (4.0 * np.pi)
    assert count.mean() == pytest.approx(len(sky) * share, abs=0.12)


def test_selection_agrees_with_projecting_every_star(sky):
    camera = StarCamera()
    for attitude in Rotation.random(20, rng=np.random.default_rng(4)).as_matrix():
        x, y = project(camera, sky.direction @ attitude @ CAMERA_TO_BODY)
        inside = (x >= -0.5) & (x <= 1023.5) & (y >= -0.5) & (y <= 1023.5)
        chosen, count = select_stars(camera, sky, attitude[None])
        assert count[0] == inside.sum()
        wanted = np.flatnonzero(inside)[:10]
        np.testing.assert_array_equal(chosen[0][: len(wanted)], wanted)
        assert np.all(chosen[0][len(wanted) :] == -1)


def test_boresight_falls_on_the_centre_and_the_corner_on_the_edge():
    camera = StarCamera()
    x, y = project(camera, np.array([[0.0, 0.0, 1.0], [np.tan(np.radians(4.0)), 0.0, 1.0], [0.0, 0.0, -1.0]]))
    assert x[0] == y[0] == pytest.approx(511.5)
    assert x[1] == pytest.approx(1023.5)
    assert np.isnan(x[2])


@pytest.mark.parametrize("time", [100.0, 500.0, 1000.0, 333.333])
def test_star_frame(flight, sky, time):
    (frame,) = star_frames(flight, StarCamera(), sky, np.array([time]))
    assert frame.used
    assert 3 <= len(frame.identifier) <= 10 <= max(10, frame.stars_in_field)
    assert np.all((frame.pixel_x > -0.5) & (frame.pixel_x < 1023.5))
    # 10 arcsec on 28.2 arcsec pixels: measured stars lie within five sigma of the truth.
    assert np.abs(frame.measured_x - frame.pixel_x).max() < 5.0 * 10.0 / 28.0
    assert np.all(np.abs(frame.error_rad) < 5.0 * frame.sigma_rad)
    assert frame.sigma_rad[2] > 5.0 * frame.sigma_rad[0]


def test_poor_geometry_is_gated_with_its_reason(flight, sky):
    starless = hipparcos_sky(2.0)
    (frame,) = star_frames(flight, StarCamera(), starless, np.array([500.0]))
    assert not frame.used
    assert "fewer than 3 stars" in frame.reason
    assert frame.error_rad is None
    strict = replace(StarCamera(), roll_limit_rad=5.0 * ARCSECOND)
    (frame,) = star_frames(flight, strict, sky, np.array([500.0]))
    assert not frame.used
    assert "rotation about the boresight" in frame.reason
    line = np.zeros((1, 3, 3))
    line[..., 2] = -1.0
    used, reason = gate(StarCamera(), line, np.ones((1, 3)))
    assert not used[0]
    assert "line" in reason[0]


def test_what_a_method_would_refuse_is_gated_for_it_alone():
    """Three stars on a great circle, two of them a close pair in the first places; then the same turned about."""
    x = np.array([0.0, 1e-6, 0.05])
    line = np.stack([x, np.zeros(3), np.ones(3)], axis=-1)
    body = (line / np.linalg.norm(line, axis=-1, keepdims=True) @ np.diag([1.0, -1.0, -1.0]))[None]
    weight, camera = np.ones((1, 3)), StarCamera(roll_limit_rad=1.0)
    assert {m: bool(gate(camera, body, weight, m)[0][0]) for m in METHODS} == {
        "TRIAD": False, "N-vector": False, "SVD": True,
    }  # fmt: skip
    assert gate(camera, body, weight, "N-vector")[1][0] == "the stars that N-vector takes are in one line or plane"
    apart = body[:, ::-1]
    assert bool(gate(camera, apart, weight, "TRIAD")[0][0])
    for name in METHODS:  # the gate's answer is the method's own
        good = gate(camera, apart, weight, name)[0][0]
        if good:
            estimate(name, apart, apart, 1e-5, weight)
        else:
            with pytest.raises(InputError, match="plane"):
                estimate(name, apart, apart, 1e-5, weight)


def test_whole_flight_is_consistent_and_reports_progress(flight, sky):
    """15001 frames: NEES of mean 3, standard error sqrt(6/15001) = 0.02; five of those."""
    steps: list[float] = []
    track = track_stars(flight, StarCamera(), sky, progress=steps.append)
    assert steps[-1] == 1.0
    assert np.all(np.diff(steps) > 0.0)
    assert track.frames.used.all()
    assert track.mean_nees == pytest.approx(3.0, abs=0.1)
    assert np.isfinite(track.roll_sigma_rad).all()


def test_gated_frames_leave_the_gyros_in_force(flight):
    thin = synthetic_sky(2000, seed=3)
    track = track_stars(flight, StarCamera(), thin)
    assert 0 < track.frames.used.sum() < len(track.frames.used)
    gated = ~track.frames.used
    np.testing.assert_array_equal(track.frames.attitude_bi[gated], flight.attitude_bi[gated])
    assert not track.covariance[gated].any()
    assert (np.linalg.det(track.covariance[~gated]) > 0).all()


def test_synthetic_sky_is_seeded_and_even():
    first, second, other = synthetic_sky(20000, 5), synthetic_sky(20000, 5), synthetic_sky(20000, 6)
    np.testing.assert_array_equal(first.direction, second.direction)
    assert not np.array_equal(first.direction, other.direction)
    # The mean of n directions has components of variance 1/(3 n): five sigma.
    assert np.abs(first.direction.mean(axis=0)).max() < 5.0 / np.sqrt(3.0 * 20000)
    brighter = np.sum(first.magnitude <= 5.5)
    assert brighter / 20000 == pytest.approx(10**-0.51, rel=0.05)


def test_refusals(flight, sky):
    with pytest.raises(InputError, match="magnitude_limit"):
        hipparcos_sky(-5.0)
    with pytest.raises(InputError, match="count"):
        synthetic_sky(0)
    with pytest.raises(InputError, match="least_stars"):
        track_stars(flight, replace(StarCamera(), least_stars=2), sky, method="N-vector")
    with pytest.raises(InputError, match="brightest"):
        StarCamera(brightest=2)
