"""The small scene: targets in place, errors seen, nothing folded."""

import numpy as np
import pytest

from nav_model.aperture.polynomial_response import quadratic_response
from nav_model.sar.line_of_sight import ApertureGeometry
from nav_model.sar.scene import scene_images

GEOMETRY = ApertureGeometry(6000.0, 100.0, 0.6)
TARGETS = [[0.0, 0.0], [6.0, -5.0], [-4.0, 3.0]]
RADAR = {"aperture_time": 2.0, "wavelength": 0.031, "bandwidth": 300e6}


@pytest.mark.parametrize("squint", [0.0, 0.2])
def test_each_strategy_has_its_image_on_one_scale(squint):
    geometry = ApertureGeometry(6000.0, 100.0, 0.6, squint)
    x = np.linspace(-1, 1, 201)
    errors = np.stack([0 * x, 0.031 / (4 * np.pi) * (np.pi / 2) * x**2]).reshape(2, 1, 201)
    scene = scene_images(geometry, **RADAR, targets=TARGETS, range_error=errors, amplitudes=[1, 0.5, 0.5], pixels=161)
    assert scene.power_db.shape == (2, 1, 161, 161)
    for (tx, ty), level in zip(TARGETS, (0.0, -6.02, -6.02), strict=True):
        row, column = np.argmin(np.abs(scene.y - ty)), np.argmin(np.abs(scene.x - tx))
        clean, smeared = scene.power_db[:, 0, row, column]
        assert clean == pytest.approx(level, abs=0.3)
        assert smeared - clean == pytest.approx(quadratic_response(np.pi / 2, "taylor").peak_loss_db, abs=0.15)


def test_nothing_folds_into_the_scene():
    scene = scene_images(GEOMETRY, **RADAR, targets=[[9.0, 9.0]], half_width=10.0)
    far = scene.power_db[:100, :100]
    assert far.max() < -25
    assert scene.power_db.shape == (128, 128)
