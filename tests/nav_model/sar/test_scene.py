"""The small scene: targets in place, errors seen, nothing folded."""

import numpy as np
import pytest

from nav_model.aperture.polynomial_response import quadratic_response
from nav_model.sar.line_of_sight import ApertureGeometry
from nav_model.sar.scene import scene_images

GEOMETRY = ApertureGeometry(6000.0, 100.0, 0.6)
TARGETS = np.array([[0.0, 0.0], [6.0, -5.0], [-4.0, 3.0]])
RADAR = {"aperture_time": 2.0, "wavelength": 0.031, "bandwidth": 300e6, "half_width": 10.0, "window": "taylor"}


@pytest.mark.parametrize("squint", [0.0, 0.2])
def test_each_strategy_has_its_image_on_one_scale(squint):
    geometry = ApertureGeometry(6000.0, 100.0, 0.6, squint)
    x = np.linspace(-1, 1, 201)
    errors = np.stack([0 * x, 0.031 / (4 * np.pi) * (np.pi / 2) * x**2])
    axis, power = scene_images(
        geometry, **RADAR, targets=TARGETS, range_error=errors, amplitudes=[1, 0.5, 0.5], pixels=161
    )
    assert power.shape == (2, 161, 161)
    for (tx, ty), level in zip(TARGETS, (0.0, -6.02, -6.02), strict=True):
        row, column = np.argmin(np.abs(axis - ty)), np.argmin(np.abs(axis - tx))
        clean, smeared = power[:, row, column]
        assert clean == pytest.approx(level, abs=0.3)
        assert smeared - clean == pytest.approx(quadratic_response(np.pi / 2, "taylor").peak_loss_db, abs=0.15)


def test_nothing_folds_into_the_scene():
    target, error = np.array([[9.0, 9.0]]), np.zeros((1, 2))
    _, power = scene_images(GEOMETRY, **RADAR, targets=target, range_error=error, amplitudes=1.0, pixels=128)
    assert power[0, :100, :100].max() < -25
    assert power.shape == (1, 128, 128)
