"""Pictures of a study against the response they must show, and uploaded files: real data and refusals."""

from pathlib import Path

import numpy as np
import pytest

from nav_model.budget import analyse
from nav_model.design import Design
from nav_model.sar.image import read_phase_history
from nav_model.sar.pictures import point_pictures, uploaded_pictures

GOTCHA = Path(__file__).parents[4] / "shared/data/sar_gotcha_pass1_az001_HH.npz"
BUDGET = analyse(Design({"radar.aperture_time": 5.0, "radar.azimuth_resolution": 0.5}))
X = np.linspace(-1, 1, 501)


def quadratic(size):
    """Range error [m] of a quadratic phase of `size` rad at the aperture's ends."""
    return BUDGET.sar.wavelength / (4 * np.pi) * size * X**2


def test_point_pictures_lose_what_the_fresnel_integral_says():
    pictures = point_pictures(BUDGET, np.stack([0 * X, quadratic(np.pi / 2)]))
    assert pictures.power_db.shape == (2, len(pictures.y), len(pictures.x))
    peaks = pictures.power_db.max(axis=(1, 2))
    # sar.md, impulse response; end samples count in full here, which costs a hundredth of a decibel.
    np.testing.assert_allclose(peaks, [0.0, -0.967], atol=0.012)
    assert pictures.range_cell == BUDGET.design.radar.azimuth_resolution
    assert not pictures.bandwidth_cut


def test_a_band_wider_than_the_carrier_allows_is_cut_and_said():
    budget = analyse(Design({"radar.frequency": 3e8, "radar.azimuth_resolution": 0.5, "radar.aperture_time": 5.0}))
    pictures = point_pictures(budget, X * 0)
    assert pictures.bandwidth_cut
    assert pictures.range_cell == pytest.approx(299792458 / (2 * 0.3 * 3e8))


def gotcha():
    if not GOTCHA.exists():
        pytest.skip(f"no real phase history at {GOTCHA}")
    return GOTCHA.read_bytes()


def test_real_data_without_error_is_itself_and_an_error_costs_what_it_must():
    data = gotcha()
    history = read_phase_history("az001", data)
    time = np.linspace(0, 5, 501)
    error = history.wavelength / (4 * np.pi) * (np.pi / 2) * X**2
    clean, unmoved, blurred = uploaded_pictures("az001", data, time, np.stack([0 * X, error]), 30.0, 240).power_db
    np.testing.assert_array_equal(clean, unmoved)
    assert clean.max() == 0.0
    # A Taylor window takes weight off the ends, so less than the 0.967 dB of the unweighted aperture is lost.
    assert -0.967 < blurred.max() < -0.2


def test_a_half_width_that_is_none_is_refused():
    with pytest.raises(ValueError, match="half_width"):
        uploaded_pictures("mine.npz", b"", X, X, 0.0)
