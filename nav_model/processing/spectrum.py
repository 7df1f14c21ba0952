"""The smoothed error of a long leg as a spectrum, filtered by the aperture. [P-1] to [P-5]

Two-sided densities over angular frequency w; a variance is (1/pi) times the integral of one from zero to
infinity. Everything broadcasts over arrays and takes complex steps.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from nav_model.base.arrays import Array
from nav_model.processing.aperture_filter import table

FOCUS = (
    "quadratic", "cubic", "left_1", "left_2", "left_3", "slope", "turned", "curved", "with_curved", "mean",
    "position", "velocity", "cubic_turned", "cubic_curved", "cubic_with_curved",
)  # fmt: skip
"""What `smoothed` finds of a channel; "tilt" too for one that has a gyro."""

UNEVEN = ("mean_slope", "with_turned", "turned_curved", "cubic_with_turned", "cubic_turned_curved")
"""Covariances of what is even in time with what is odd: none in an error that has no beginning."""


class Leg(NamedTuple):
    """Seconds with fixes before the aperture and after it, and without fixes right before it (part of ``before``)."""

    before: Array
    after: Array
    gap: Array


@dataclass(frozen=True)
class Channel:
    """One axis: noise of the inertial sensors and of the receiver; arrays that broadcast together.

    ``accelerometer`` is the velocity random walk [m/s/√s], ``gyro`` gravity times the angle random walk
    [m/s²/√s], None for the vertical. ``fix`` and ``interval`` are one position fix, 1σ [m], and the time between two
    [s]; ``velocity`` and ``velocity_interval`` the same for velocity [m/s], [s], None without it. ``slow`` and
    ``slow_time`` are the slow error of the position fixes, 1σ [m], and its correlation time [s], None without it.
    """

    accelerometer: Array
    gyro: Array | None
    fix: Array
    interval: Array
    velocity: Array | None = None
    velocity_interval: Array | None = None
    slow: Array | None = None
    slow_time: Array | None = None


def rates(channel: Channel) -> tuple[Array, Array]:
    """Angular frequencies [rad/s], real, at which fixes start to correct the drift: the fastest, the slowest.

    Where [P-1] meets [P-2]: w0 = (g sigma_w/s)^(1/3) with a gyro, (sigma_a/s)^(1/2) without. The slowest counts the
    slow GNSS error as noise, and is no faster than tilt comes out of accelerometer noise, nor than twice the rate at
    which position is forgotten where velocity fixes alone hold it, as errors at w0 decay at half of that. The fastest
    has velocity.
    """
    a, s = channel.accelerometer.real, (channel.fix * np.sqrt(channel.interval)).real
    gyro = 0 * a if channel.gyro is None else channel.gyro.real
    fastest = slowest = np.maximum(np.cbrt(gyro / s), np.sqrt(a / s))
    more, time = np.zeros(()), np.zeros(())
    if channel.slow is not None and channel.slow_time is not None:
        time = channel.slow_time.real
        more = 2 * channel.slow.real**2 * time
        for _ in range(4):
            noise = np.sqrt(s**2 + more / (1 + (slowest * time) ** 2))
            slowest = np.maximum(np.cbrt(gyro / noise), np.sqrt(a / noise))
    if channel.velocity is not None and channel.velocity_interval is not None:
        v = (channel.velocity * np.sqrt(channel.velocity_interval)).real
        fastest = np.maximum(fastest, np.maximum(np.sqrt(gyro / v), a / v))
        # the slower root -w² of 1/S_n = 0, which is s_v/s without a slow error
        both = s**2 + more + (v * time) ** 2
        slowest = np.minimum(slowest, 2 * v / np.sqrt((both + np.sqrt(both**2 - (2 * s * v * time) ** 2)) / 2))
    return fastest, np.where(gyro > 0, np.minimum(slowest, gyro / a), slowest)


def inverse_drift(channel: Channel, w: Array) -> Array:
    """One over the density of the IMU's position drift. [P-1]"""
    power = w**2
    if channel.gyro is None:
        return power * power / (channel.accelerometer**2)[..., None]
    return power * power * power / ((channel.accelerometer**2)[..., None] * power + (channel.gyro**2)[..., None])


def inverse_receiver(channel: Channel, w: Array) -> Array:
    """One over the density of the receiver's position error. [P-2]"""
    power = w**2
    noise = (channel.fix**2 * channel.interval)[..., None]
    if channel.slow is not None and channel.slow_time is not None:
        time = channel.slow_time[..., None]
        noise = noise + 2 * channel.slow[..., None] ** 2 * time / (1 + power * time**2)
    known = 1 / noise
    if channel.velocity is not None and channel.velocity_interval is not None:
        known = known + power / (channel.velocity**2 * channel.velocity_interval)[..., None]
    return known


def smoothed(channel: Channel, aperture: Array, names: Collection[str] = FOCUS) -> dict[str, Array]:
    """Variances of the smoothed error of one channel, over an aperture deep inside a long leg. [P-3], [P-5]

    Parameters
    ----------
    channel : Channel
    aperture : array
        Seconds.
    names : collection of str
        Those of `nav_model.processing.aperture_filter.filters` in m² (``slope`` in m²/s², ``turned`` in m² for a
        turn of one), ``position`` [m²], ``velocity`` [m²/s²], and ``tilt`` times gravity [m²/s⁴].

    Returns
    -------
    dict
        Name -> array of the broadcast shape.

    Examples
    --------
    >>> import numpy as np
    >>> navigation = Channel(*(np.array(x) for x in (1e-4, 1e-5, 0.03, 0.1)))
    >>> f"{float(smoothed(navigation, np.array(3.0))['position']) ** 0.5 * 1e3:.3f} mm"
    '2.170 mm'
    """
    rows = _rows(channel, aperture)
    if rows > 1:
        # The aperture alone along its axis: each line of the map then has one set of frequencies.
        axis = 1 if aperture.ndim == 2 and len(aperture) == 1 and aperture.size == rows else 0
        parts = [smoothed(*_line(channel, aperture, axis, k), names) for k in range(rows)]
        return {
            name: parts[0][name] if name in UNEVEN else np.stack([part[name] for part in parts], axis)
            for name in names
        }
    made = table()
    half = aperture / 2
    w = made.nodes / half[..., None]
    drift, known = inverse_drift(channel, w), inverse_receiver(channel, w)
    found: dict[str, Array] = {}
    focus = [name for name in names if name not in ("tilt", *UNEVEN)]
    if focus:
        columns = np.stack([made.weights * made.filters[_FILTER.get(name, name)] for name in focus], axis=-1)
        for column, name in enumerate(focus):
            if name == "velocity":
                columns[:, column] *= made.nodes**2
        whole = _integrals(drift, known, columns)
        for column, name in enumerate(focus):
            scale = np.pi * half * (half**2 if name in ("slope", "velocity") else 1)
            found[name] = whole[..., column] / scale
    found |= {name: np.zeros(()) for name in UNEVEN if name in names}
    if "tilt" in names:
        if channel.gyro is None:
            raise ValueError("tilt: the vertical channel has none")
        # 1/(w²/(g sigma_w)² + 1/(sigma_a² + w⁴ S_n)): the tilt's own drift, and all that hides it.
        own = w**2 / (channel.gyro**2)[..., None]
        rest = 1 / ((channel.accelerometer**2)[..., None] + (w * w) ** 2 / known)
        found["tilt"] = _integrals(own, rest, made.weights[:, None])[..., 0] / (np.pi * half)
    return found


def _rows(channel: Channel, aperture: Array) -> int:
    """Of a map that is taken one row or column at a time, to stay in the cache; else 1.

    The rows differ in their frequencies, or both axes change what drifts, or what the receiver knows; of errors that
    are not white, at the frequencies that each column's aperture takes.
    """
    if aperture.ndim > 1 and len(aperture) > 1:
        return len(aperture)
    given = {name: value.shape for name, value in vars(channel).items() if value is not None}
    drift = np.broadcast_shapes(*(given.pop(name) for name in ("accelerometer", "gyro") if name in given))
    white = given.keys() == {"fix", "interval"}
    known = np.broadcast_shapes(*given.values())
    if aperture.ndim == 2 and aperture.size > 1:
        shapes = (drift, () if white else known)
        return aperture.size if any(len(shape) > 1 and shape[0] > 1 for shape in shapes) else 1
    return max((shape[0] for shape in (drift, known) if len(shape) > 1 and shape[1] > 1), default=1)


def _line(channel: Channel, aperture: Array, axis: int, k: int) -> tuple[Channel, Array]:
    """Of a map, one row or column."""

    def line(value: Array) -> Array:
        return value if value.ndim < 2 else np.asarray(value.take(k if value.shape[axis] > 1 else 0, axis))

    values = {name: line(value) for name, value in vars(channel).items() if value is not None}
    return replace(channel, **values), line(aperture)


_FILTER = {"position": "whole", "velocity": "whole"}


def _integrals(drift: Array, known: Array, columns: Array) -> Array:
    """Of 1/(drift + known) over the last axis against each column; row by row, so that a map stays in the cache."""
    shape = np.broadcast_shapes(drift.shape, known.shape)
    if len(shape) < 3:
        return np.asarray((1 / (drift + known)) @ columns)

    def rows(values: Array) -> Iterable[Array]:
        if values.ndim < len(shape):
            return [values] * shape[0]
        return np.broadcast_to(values, (shape[0], *values.shape[1:]))

    return np.stack([(1 / (a + b)) @ columns for a, b in zip(rows(drift), rows(known), strict=True)])
