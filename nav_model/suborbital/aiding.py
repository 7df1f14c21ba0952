"""Aiding without a filter [B-7]: the star camera's attitude replaces the gyros' at every frame.

The camera sees inertial attitude, so gyro and alignment errors vanish at each frame; between frames the gyros
carry it on. What remains: accelerometer, initial and gravity errors, and the unstable height, whose forcing the
tracker reduces but which it does not stabilise.
"""

from dataclasses import dataclass

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.errors import InputError
from nav_model.earth.rotation import matrix_from_vector, vector_from_matrix
from nav_model.suborbital.errors import Triple
from nav_model.suborbital.flight import TrueFlight
from nav_model.suborbital.mechanisation import AttitudeFrames


@dataclass(frozen=True)
class Aiding:
    """When and how well the star camera gives attitude. The default is the perfect camera of GP-1.

    from_height_m: frames only while the flight is at or above it (80 km is typical; None: from lift-off);
    frame_interval_s: a multiple of the step; latency_s: age of the attitude when it is taken for current;
    misalignment_rad: camera to IMU, rotation vector on body axes; dropouts_s: (start, stop) intervals without
    frames, in which the gyros hold the attitude.
    """

    from_height_m: float | None = None
    frame_interval_s: float = 0.1
    latency_s: float = 0.0
    misalignment_rad: Triple = (0.0, 0.0, 0.0)
    dropouts_s: tuple[tuple[float, float], ...] = ()


def frame_stride(aiding: Aiding, step_s: float) -> int:
    """Steps from frame to frame. InputError if frames fall between steps."""
    ratio = aiding.frame_interval_s / step_s
    stride = round(ratio)
    if stride < 1 or abs(ratio - stride) >= 1e-6:
        reason = f"{aiding.frame_interval_s:g} s is not a whole number of steps of {step_s:g} s"
        raise InputError("frame_interval_s", reason, aiding.frame_interval_s)
    return stride


def frame_steps(flight: TrueFlight, aiding: Aiding) -> np.ndarray:
    """Steps at which a frame reaches the INS, (n+1,) bool. InputError if frames fall between steps."""
    stride = frame_stride(aiding, flight.step_s)
    used = np.zeros(flight.steps + 1, dtype=np.bool_)
    used[::stride] = True
    if aiding.from_height_m is not None:
        used &= flight.height_m >= aiding.from_height_m
    used &= flight.time_s >= aiding.latency_s - 1e-9
    for start, stop in aiding.dropouts_s:
        used &= (flight.time_s < start) | (flight.time_s >= stop)
    return used


def attitude_at(flight: TrueFlight, time_s: Array) -> Array:
    """True body to inertial attitude at any times of the flight, (..., 3, 3): turn at constant rate in a
    step."""
    position = np.clip(np.asarray(time_s, dtype=np.float64) / (0.5 * flight.step_s), 0.0, 2.0 * flight.steps)
    low = np.minimum(position.astype(np.int64), 2 * flight.steps - 1)
    start, stop = flight.half_attitude_bi[low], flight.half_attitude_bi[low + 1]
    turn = vector_from_matrix(np.swapaxes(start, -1, -2) @ stop)
    return np.asarray(start @ matrix_from_vector((position - low)[..., None] * turn))


def perfect_frames(flight: TrueFlight, aiding: Aiding) -> AttitudeFrames:
    """Frames at the aiding's instants, each the true attitude."""
    return AttitudeFrames(frame_steps(flight, aiding), np.ascontiguousarray(flight.attitude_bi))


def camera_frames(
    flight: TrueFlight,
    aiding: Aiding,
    measured: AttitudeFrames | None = None,
) -> AttitudeFrames:
    """Frames with latency and misalignment; `measured` brings attitudes from star images, gated frames
    unused.

    Latency takes the attitude of t - latency for that of t. With measured frames it must be a whole number of
    steps, because an image exists only at a step; otherwise InputError.
    """
    used, covariance = frame_steps(flight, aiding), None
    if measured is None:
        attitude = flight.attitude_bi
        if aiding.latency_s > 0.0:
            attitude = attitude_at(flight, flight.time_s - aiding.latency_s)
    else:
        late = round(aiding.latency_s / flight.step_s)
        if abs(late * flight.step_s - aiding.latency_s) >= 1e-6:
            reason = f"with star images {aiding.latency_s:g} s is not a whole number of steps of {flight.step_s:g} s"
            raise InputError("latency_s", reason, aiding.latency_s)
        source = np.maximum(np.arange(flight.steps + 1) - late, 0)
        attitude, used = measured.attitude_bi[source], used & measured.used[source]
        covariance = None if measured.covariance is None else measured.covariance[source]
    if any(aiding.misalignment_rad):
        attitude = attitude @ matrix_from_vector(np.array(aiding.misalignment_rad))
    return AttitudeFrames(used, np.ascontiguousarray(attitude), covariance)
