"""The sweep of star-camera noise against studies that image the stars at each noise."""

import numpy as np
import pytest

from nav_model.base.constants import ARCSECOND
from nav_model.suborbital.camera_noise import sweep_camera_noise
from nav_model.suborbital.settings import DEFAULTS
from nav_model.suborbital.survey import run_survey


@pytest.mark.slow
def test_the_sweep_is_what_a_study_with_star_images_finds_at_each_noise() -> None:
    noises = np.array([2.0, 40.0]) * ARCSECOND
    swept = sweep_camera_noise(run_survey(DEFAULTS).study, DEFAULTS, noises)
    for k, noise in enumerate(noises):
        imaged = run_survey(
            DEFAULTS.change({"camera.frames": "star images", "camera.centroid_noise": float(noise)}, "test")
        )
        result = float(np.linalg.norm(imaged.study.aided_noise.position_sigma_m[-1]))
        assert swept.total_m[k] == pytest.approx(result, rel=0.01)  # covariances go by measured, noisy places
        alone = float(np.linalg.norm(imaged.study.pure_noise.position_sigma_m[-1]))
        assert swept.alone_m == pytest.approx(alone, rel=1e-9)
