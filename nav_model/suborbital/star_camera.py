"""Star camera [B-8]: star positions on the detector, and the attitude from them along a flight.

Camera axes: Z along the boresight, which is -z of the body, X along x of the body, Y along -y of the body.
The camera measures directions with `centroid_sigma_rad` per axis in the tangent plane.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.compiled import kernel
from nav_model.base.constants import ARCSECOND
from nav_model.base.errors import InputError
from nav_model.suborbital.aiding import attitude_at
from nav_model.suborbital.attitude import COLLINEAR, attitude_error, estimate, information, nees, solvable
from nav_model.suborbital.flight import TrueFlight
from nav_model.suborbital.mechanisation import AttitudeFrames
from nav_model.suborbital.sky import Sky

_CHUNK = 500
"""Frames solved together, between two reports of progress."""

CAMERA_TO_BODY = np.diag([1.0, -1.0, -1.0])
"""Rotation from camera to body axes: the boresight is -z of the body."""


@dataclass(frozen=True)
class StarCamera:
    """Pin-hole camera [B-8]: square detector, SI. Frames are gated on the number of stars and on the
    predicted standard deviation of the rotation about the boresight."""

    pixels: int = 1024
    pixel_pitch_m: float = 16e-6
    focal_length_m: float = 1024 * 16e-6 / (2.0 * np.tan(np.radians(4.0)))
    centroid_sigma_rad: float = 10.0 * ARCSECOND
    brightest: int = 10
    least_stars: int = 3
    roll_limit_rad: float = 600.0 * ARCSECOND

    def __post_init__(self) -> None:
        if self.brightest < self.least_stars:
            reason = f"{self.brightest} stars are fewer than the gate's {self.least_stars} (least_stars)"
            raise InputError("brightest", reason, self.brightest)

    @property
    def field_of_view_rad(self) -> float:
        """Full angle across the square, 2 atan(N p / 2 f) [B-8]."""
        return float(2.0 * np.arctan(self.pixels * self.pixel_pitch_m / (2.0 * self.focal_length_m)))


def focal_length(field_of_view_rad: float, pixels: int = 1024, pixel_pitch_m: float = 16e-6) -> float:
    """Focal length, m, that gives a field of view (full angle across the square) [B-8]."""
    return float(pixels * pixel_pitch_m / (2.0 * np.tan(0.5 * field_of_view_rad)))


def project(camera: StarCamera, direction_c: Array) -> tuple[Array, Array]:
    """Pixel coordinates x/p + (N-1)/2 of directions on camera axes (..., 3) [B-8]; NaN behind the camera."""
    z = direction_c[..., 2]
    depth = np.where(z > 0.0, z, np.nan)
    scale, middle = camera.focal_length_m / camera.pixel_pitch_m, 0.5 * (camera.pixels - 1)
    return scale * direction_c[..., 0] / depth + middle, scale * direction_c[..., 1] / depth + middle


@kernel
def _select(
    attitude_ci: Array, stars: Array, half_tangent: float, most: int, chosen: np.ndarray, count: np.ndarray
) -> None:
    """Brightest stars in each square field: cone first, then the square. stars run from bright to faint."""
    cone = 1.0 / np.sqrt(1.0 + 2.0 * half_tangent * half_tangent)
    for i in range(attitude_ci.shape[0]):
        a = attitude_ci[i]
        number = 0
        for k in range(stars.shape[0]):
            x, y, z = stars[k, 0], stars[k, 1], stars[k, 2]
            depth = a[2, 0] * x + a[2, 1] * y + a[2, 2] * z
            if depth < cone:
                continue
            limit = half_tangent * depth
            if abs(a[0, 0] * x + a[0, 1] * y + a[0, 2] * z) > limit:
                continue
            if abs(a[1, 0] * x + a[1, 1] * y + a[1, 2] * z) > limit:
                continue
            if number < most:
                chosen[i, number] = k
            number += 1
        count[i] = number


def select_stars(camera: StarCamera, sky: Sky, attitude_bi: Array) -> tuple[np.ndarray, np.ndarray]:
    """Brightest stars in the field for attitudes (n, 3, 3) body to inertial.

    Returns indices into the sky (n, `brightest` of the camera), -1 where there are fewer, and the number of all
    stars in the field (n,).
    """
    ci = np.ascontiguousarray(np.swapaxes(attitude_bi @ CAMERA_TO_BODY, -1, -2))
    chosen = np.full((len(ci), camera.brightest), -1, dtype=np.int64)
    count = np.zeros(len(ci), dtype=np.int64)
    _select(ci, sky.direction, np.tan(0.5 * camera.field_of_view_rad), camera.brightest, chosen, count)
    return chosen, count


def measure(
    camera: StarCamera, sky: Sky, attitude_bi: Array, chosen: np.ndarray, generator: np.random.Generator
) -> tuple[Array, Array, Array]:
    """Noisy body directions, catalogue directions (n, k, 3) and weights (n, k), zero where there is no star.

    Parameters
    ----------
    camera : StarCamera
        Its noise.
    sky : Sky
        The catalogue.
    attitude_bi : array (n, 3, 3)
        Body to inertial axes.
    chosen : array (n, k) of int
        Stars in the field, -1 for none.
    generator : numpy.random.Generator
        Of the noise.
    """
    weight = (chosen >= 0).astype(np.float64)
    reference = sky.direction[np.maximum(chosen, 0)]
    body = reference @ attitude_bi
    noise = camera.centroid_sigma_rad * generator.standard_normal(body.shape)
    body = body + noise - np.sum(noise * body, axis=-1, keepdims=True) * body
    return body / np.linalg.norm(body, axis=-1, keepdims=True), reference, weight


def roll_sigma(camera: StarCamera, body: Array, weight: Array) -> Array:
    """Predicted standard deviation about the boresight, rad (...,); infinite where it is not observable
    [B-9]."""
    full = information(body, weight)
    sound = (np.linalg.eigvalsh(full)[..., 0] > COLLINEAR) & (np.sum(weight > 0.0, axis=-1) >= 2)
    covariance = np.linalg.inv(np.where(sound[..., None, None], full, np.eye(3)))
    return np.where(sound, camera.centroid_sigma_rad * np.sqrt(covariance[..., 2, 2]), np.inf)


def gate(camera: StarCamera, body: Array, weight: Array, method: str = "SVD") -> tuple[np.ndarray, np.ndarray]:
    """Frames that may be used, (n,) bool, and why the others may not, (n,) text (empty where used).

    Parameters
    ----------
    camera : StarCamera
        Least number of stars and limit on the roll's sigma.
    body : array (n, k, 3)
        Measured directions, body axes.
    weight : array (n, k)
        Zero where there is no star.
    method : str, optional
        Key of `attitude.METHODS`, which has to be able to solve the frame.
    """
    stars, roll = np.sum(weight > 0.0, axis=-1), roll_sigma(camera, body, weight)
    few, flat = stars < camera.least_stars, roll > camera.roll_limit_rad
    refused = ~solvable(method, body, weight)
    reason = np.select(
        [few, flat, refused],
        [
            f"fewer than {camera.least_stars} stars",
            "stars too close together or near a line: rotation about the boresight too uncertain",
            f"the stars that {method} takes are in one line or plane",
        ],
        "",
    )
    return ~(few | flat | refused), reason


class _Solved(NamedTuple):
    """Attitudes of frames: which are used and why not, body to inertial (the truth where unused), the error on body
    axes (NaN there) and its covariance (zero there)."""

    used: np.ndarray
    reason: np.ndarray
    attitude: Array
    error: Array
    covariance: Array


def _solved(camera: StarCamera, truth: Array, body: Array, reference: Array, weight: Array, method: str) -> _Solved:
    used, reason = gate(camera, body, weight, method)
    frames = _Solved(used, reason, truth.copy(), np.full((len(truth), 3), np.nan), np.zeros((len(truth), 3, 3)))
    rotation, frames.covariance[used] = estimate(
        method, body[used], reference[used], camera.centroid_sigma_rad, weight[used]
    )
    frames.attitude[used] = np.swapaxes(rotation, -1, -2)
    frames.error[used] = attitude_error(rotation, np.swapaxes(truth[used], -1, -2))
    return frames


@dataclass(frozen=True)
class StarFrame:
    """One image: catalogue numbers, magnitudes, pixel positions (true and measured), the error of their attitude.

    error_rad and sigma_rad (body axes) are None when the frame is gated; reason then says why.
    """

    time_s: float
    identifier: np.ndarray
    magnitude: Array
    pixel_x: Array
    pixel_y: Array
    measured_x: Array
    measured_y: Array
    stars_in_field: int
    boresight_ra_rad: float
    boresight_dec_rad: float
    used: bool
    reason: str
    error_rad: Array | None
    sigma_rad: Array | None
    source: str


def star_frames(
    flight: TrueFlight, camera: StarCamera, sky: Sky, time_s: Array, seed: int = 1, method: str = "SVD"
) -> tuple[StarFrame, ...]:
    """Star images at given times of the flight.

    Parameters
    ----------
    flight : TrueFlight
        The flight.
    camera : StarCamera
        The camera.
    sky : Sky
        The catalogue.
    time_s : array (n,)
        Times of the images.
    seed : int, optional
        Noise is from the seeds `seed`, `seed` + 1 and so on.
    method : str, optional
        Key of `attitude.METHODS`.
    """
    attitude = attitude_at(flight, time_s)
    chosen, count = select_stars(camera, sky, attitude)
    measured = [
        measure(camera, sky, attitude[[k]], chosen[[k]], np.random.default_rng(seed + k)) for k in range(len(time_s))
    ]
    body, reference, weight = (np.concatenate(parts) for parts in zip(*measured, strict=True))
    done = _solved(camera, attitude, body, reference, weight, method)
    sigma = np.sqrt(np.diagonal(done.covariance, axis1=-2, axis2=-1))
    x, y = project(camera, sky.direction[np.maximum(chosen, 0)] @ attitude @ CAMERA_TO_BODY)
    mx, my = project(camera, body @ CAMERA_TO_BODY)

    def frame(k: int) -> StarFrame:
        seen = chosen[k][chosen[k] >= 0]
        stars, boresight = len(seen), -attitude[k, :, 2]
        return StarFrame(
            time_s=float(time_s[k]),
            identifier=sky.identifier[seen],
            magnitude=sky.magnitude[seen],
            pixel_x=x[k, :stars],
            pixel_y=y[k, :stars],
            measured_x=mx[k, :stars],
            measured_y=my[k, :stars],
            stars_in_field=int(count[k]),
            boresight_ra_rad=float(np.arctan2(boresight[1], boresight[0]) % (2.0 * np.pi)),
            boresight_dec_rad=float(np.arcsin(np.clip(boresight[2], -1.0, 1.0))),
            used=bool(done.used[k]),
            reason=str(done.reason[k]),
            error_rad=done.error[k] if done.used[k] else None,
            sigma_rad=sigma[k] if done.used[k] else None,
            source=f"{sky.source}; camera [B-8], {method} [B-9], seed {seed + k}",
        )

    return tuple(frame(k) for k in range(len(time_s)))


@dataclass(frozen=True)
class StarTrack:
    """Star frames of a whole flight, one per step (n+1): use them as `measured` of `study.run_study`.

    frames.used is false where the geometry was gated; roll_sigma_rad (n+1,); covariance (n+1, 3, 3), zero where
    gated; mean_nees over used frames.
    """

    frames: AttitudeFrames
    roll_sigma_rad: Array = field(repr=False)
    covariance: Array = field(repr=False)
    mean_nees: float


def track_stars(
    flight: TrueFlight,
    camera: StarCamera,
    sky: Sky,
    method: str = "SVD",
    seed: int = 1,
    *,
    progress: Callable[[float], None] | None = None,
) -> StarTrack:
    """Image, identify and solve every step of a flight (15000 frames on the reference flight), in chunks.

    A frame refused by the gate leaves the gyro attitude in force.

    Parameters
    ----------
    flight, camera, sky, method, seed
        As `star_frames`.
    progress : callable, optional
        Takes the share done, after each chunk.
    """
    if method == "N-vector" and camera.least_stars < 3:
        reason = f"{camera.least_stars} is too few: the N-vector method needs at least 3 stars"
        raise InputError("least_stars", reason, camera.least_stars)
    generator = np.random.default_rng(seed)
    total = flight.steps + 1
    truth = flight.attitude_bi
    roll, chunks = np.empty(total), []
    for start in range(0, total, _CHUNK):
        part = slice(start, min(start + _CHUNK, total))
        attitude = truth[part]
        chosen, _ = select_stars(camera, sky, attitude)
        body, reference, weight = measure(camera, sky, attitude, chosen, generator)
        roll[part] = roll_sigma(camera, body, weight)
        chunks.append(_solved(camera, attitude, body, reference, weight, method))
        if progress is not None:
            progress(part.stop / total)
    done = _Solved(*map(np.concatenate, zip(*chunks, strict=True)))
    used, covariance = done.used, done.covariance
    return StarTrack(
        frames=AttitudeFrames(used, done.attitude, covariance),
        roll_sigma_rad=roll,
        covariance=covariance,
        mean_nees=float(np.mean(nees(done.error[used], covariance[used]))) if used.any() else float("nan"),
    )
