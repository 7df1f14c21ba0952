"""Position error from the star camera's noise, over a range of it."""

import numpy as np

from app.charts.kinds import Array, Chart, Line, Points
from app.document.blocks import Answer
from app.document.numbers import number, show
from nav_model.base.constants import ARCSECOND
from nav_model.suborbital.camera_noise import CameraNoise

NOISES = np.geomspace(0.3, 300.0, 13) * ARCSECOND


def camera_noise_chart(swept: CameraNoise, now_rad: float) -> Chart:
    """Position error at the end from noise, over the centroid noise of the camera; a mark at the one in force."""
    x = swept.centroid_rad / ARCSECOND
    imu = np.sqrt(np.maximum(swept.total_m**2 - swept.camera_m**2, 0.0))
    return Chart(
        key="camera-noise",
        title="Final position error from noise, 1σ",
        x_label="centroid noise per axis [arcsec]",
        y_label="position error, three axes [m]",
        lines=(
            Line("alone", "INS alone", x, np.full(len(x), swept.alone_m), "INS alone", "covariance of [B-4]"),
            Line("total", "INS with tracker", x, swept.total_m, "INS with tracker", "covariance of [B-4], [B-9]"),
            Line("camera", "from the camera", x, swept.camera_m, "gyros", "covariance of [B-9]"),
            Line("imu", "from the IMU", x, imu, "reference", "covariance of [B-4]"),
        ),
        points=(
            Points("now", "this camera", np.array([now_rad / ARCSECOND]), np.array([_at(swept, now_rad)]),
                   ("this camera",), "mark", source="interpolated"),
        ),
        knowledge="White noise of IMU and camera by the covariance of [B-4]. Attitude noise of an image [B-9] is "
        "proportional to the centroid noise. A frame is lost where its roll about the boresight is too uncertain.",
        x_log=True,
        y_log=True,
    )  # fmt: skip


def camera_noise_answer(swept: CameraNoise, now_rad: float) -> Answer:
    """From which centroid noise on the camera matters, and what the one in force costs."""
    imu = np.sqrt(np.maximum(swept.total_m**2 - swept.camera_m**2, 0.0))
    over = np.flatnonzero(swept.camera_m > imu)
    worse = np.flatnonzero(swept.total_m > swept.alone_m)
    arcsec = swept.centroid_rad / ARCSECOND
    remaining = f"{show(_at(swept, now_rad), 'length')} with tracker and {show(swept.alone_m, 'length')} without"
    sentences = [f"At {number(now_rad / ARCSECOND, given=True)} arcsec, noise leaves {remaining}."]
    if len(worse):
        level = _crossing(arcsec, swept.total_m, np.full_like(swept.total_m, swept.alone_m), int(worse[0]))
        sentences.append(f"Above {number(level, 2)} arcsec the tracker adds more noise than it removes.")
    if not len(over):
        return Answer("Camera noise stays below IMU noise", "open", tuple(sentences))
    level = _crossing(arcsec, swept.camera_m, imu, int(over[0]))
    word = f"Camera noise exceeds IMU noise above about {number(level, 2)} arcsec"
    return Answer(word, "open", tuple(sentences))


def _crossing(x: Array, rising: Array, other: Array, after: int) -> float:
    """Where one curve comes to lie above another, at or before a point of the grid: straight between points on
    logarithmic axes, as they are drawn."""
    if after == 0 or min(rising[after - 1], other[after - 1], other[after]) <= 0:
        return float(x[after])
    apart = np.log(rising[after - 1 : after + 1] / other[after - 1 : after + 1])
    return float(np.exp(np.interp(0.0, apart, np.log(x[after - 1 : after + 1]))))


def _at(swept: CameraNoise, now_rad: float) -> float:
    x, y = np.log(swept.centroid_rad), np.log(swept.total_m)
    return float(np.exp(np.interp(np.log(now_rad), x, y)))
