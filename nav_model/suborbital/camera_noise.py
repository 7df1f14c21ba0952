"""Position error at the end of the flight over a range of the star camera's centroid noise.

Attitude covariances [B-9] go with the square of the centroid noise, so the star images of a flight are made once. A
larger noise also loses frames: those whose roll about the boresight is known worse than the camera's gate allows.
"""

from dataclasses import dataclass, replace

import numpy as np

from nav_model.base.arrays import Array
from nav_model.suborbital.aiding import frame_steps
from nav_model.suborbital.sensitivity import white_noise_spread
from nav_model.suborbital.settings import Settings
from nav_model.suborbital.star_camera import track_stars
from nav_model.suborbital.study import Study


@dataclass(frozen=True)
class CameraNoise:
    """Position error at the end of the flight from noise, root sum square of the three axes, 1 sigma, m.

    Attributes
    ----------
    centroid_rad : ndarray (k,)
        Noise of a star's place in the image, per axis.
    total_m, camera_m : ndarray (k,)
        With the tracker: of camera and inertial unit together, and of the camera alone.
    alone_m : float
        The INS without a tracker.
    """

    centroid_rad: Array
    total_m: Array
    camera_m: Array
    alone_m: float


def sweep_camera_noise(study: Study, settings: Settings, centroid_rad: Array) -> CameraNoise:
    """Sweep the centroid noise of the camera of some settings, for a study flown at them.

    Parameters
    ----------
    study : Study
    settings : Settings
        Camera, sky, attitude method and frame instants; their own centroid noise plays no part.
    centroid_rad : ndarray (k,)
        Noise per axis, above zero.

    Examples
    --------
    >>> swept = sweep_camera_noise(survey.study, survey.settings, np.geomspace(1, 100, 9) * ARCSECOND)
    >>> swept.total_m
    """
    inputs, flight = settings.study_inputs(), study.flight
    least = float(np.min(centroid_rad))
    camera = replace(settings.camera(), centroid_sigma_rad=least)
    track = track_stars(flight, camera, settings.sky(), method=settings["camera.method"], seed=int(settings["seed"]))
    frames = frame_steps(flight, inputs.aiding) & track.frames.used
    accelerometer, gyro = inputs.errors.accelerometers.white_noise, inputs.errors.gyros.white_noise
    total, by_camera = [], []
    for noise in centroid_rad:
        scale = float(noise) / least
        used = frames & (track.roll_sigma_rad * scale <= camera.roll_limit_rad)
        covariance = scale**2 * track.covariance
        total.append(_final(white_noise_spread(flight, accelerometer, gyro, used, covariance).position_sigma_m))
        by_camera.append(_final(white_noise_spread(flight, 0.0, 0.0, used, covariance).position_sigma_m))
    alone = _final(white_noise_spread(flight, accelerometer, gyro).position_sigma_m)
    return CameraNoise(np.asarray(centroid_rad, float), np.array(total), np.array(by_camera), alone)


def _final(sigma_m: Array) -> float:
    return float(np.linalg.norm(sigma_m[-1]))
