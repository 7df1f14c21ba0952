"""A log in motion as a vibration spectrum, and that spectrum in a design."""

import numpy as np
import pytest

from nav_model.allan.adoption import adopt_vibration_spectrum
from nav_model.allan.imu_log import ImuLog
from nav_model.allan.motion import analyse_motion, motion_to_json
from nav_model.allan.vibration import vibration_spectrum
from nav_model.base.errors import InputError
from nav_model.design import Design
from nav_model.design.file import parse_design

RATE = 400.0


@pytest.fixture(scope="module")
def log():
    """200 s of white noise of 1e-3 (m/s²)²/Hz on x, ten times less on y and z, on gravity and a slow turn."""
    rng = np.random.default_rng(11)
    time = np.arange(int(200 * RATE)) / RATE
    size = np.sqrt(RATE / 2 * np.array([1e-3, 1e-4, 1e-4]))
    accelerometer = size * rng.standard_normal((len(time), 3)) + [0, 0, -9.8] + 3 * np.sin(0.2 * time)[:, None]
    return ImuLog(1e-3 * rng.standard_normal((len(time), 3)), accelerometer, RATE, sha256="0" * 64)


def test_white_noise_comes_back_as_its_density(log):
    """Bands of n coefficients in 40 blocks are good to 1/√(40 n); the axis that vibrates most counts."""
    rows = vibration_spectrum(log)
    assert rows[0][0] == pytest.approx(2 * 2 ** (1 / 6), rel=5e-3)
    assert rows[-1][0] > 120
    for frequency, density, _ in rows:
        assert density == pytest.approx(1e-3, rel=5 / np.sqrt(40 * max(frequency * 0.23 * 5, 1))), frequency


def test_variance_is_kept(log):
    """Density times the width of each band adds up to the noise's variance between the ends."""
    rows, half = vibration_spectrum(log), 2 ** (1 / 6)
    variance = sum(density * frequency * (half - 1 / half) for frequency, density, _ in rows)
    assert variance == pytest.approx(1e-3 * (rows[-1][0] * half - 2), rel=0.03)


def test_it_goes_into_a_design_with_its_origin(log):
    result = analyse_motion(log)
    adoption = adopt_vibration_spectrum(result)
    design = Design().replace(adoption.changes, adoption.written, adoption.origins)
    assert design.motion.spectrum == vibration_spectrum(log)
    assert "log in motion" in design.origins["motion.spectrum"]
    text = ", ".join(f'["{at}", "{density}"]' for at, density in motion_to_json(result)["spectrum"])
    assert parse_design(f"[motion]\nspectrum = [{text}]").motion.spectrum == design.motion.spectrum


def test_without_accelerometers_there_is_none(log):
    result = analyse_motion(ImuLog(log.gyro, None, RATE))
    assert result.spectrum == ()
    with pytest.raises(InputError) as caught:
        adopt_vibration_spectrum(result)
    assert caught.value.key == "motion.spectrum"
