"""Vibration factor over the bench noise from a log in motion: effective noise of the high-passed residuals.

Above the vehicle's own motion (a few hertz) what a strapdown sensor measures is noise plus vibration. The
residual there is expressed as the white noise of equal power: the Hann-windowed spectrum of short blocks
restricted to the band is the high-passed residual (the window keeps strong slow motion from leaking into it),
and its mean density is the effective random walk squared. The design's `vibration_factor` is this over the
bench value.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, Final

import numpy as np

from nav_model.allan.imu_log import AxisSignal, ImuLog
from nav_model.allan.result import UNITS, LogSource
from nav_model.allan.vibration import (
    BLOCK_S,
    block_count,
    block_densities,
    block_length,
    declared_spectrum,
    vibration_spectrum,
)
from nav_model.allan.warnings import saturated_share
from nav_model.base.errors import InputError
from nav_model.design.rows import Row

BAND_FROM_HZ = 10.0
"""Below it the vehicle's motion dominates."""
MOTION_CAVEAT: Final = (
    "the factor treats vibration within the band as white noise of equal power; a line or a narrow band "
    "integrates to less or more than that, and what lies outside the band is not counted"
)

_FEWEST_COEFFICIENTS = 50


@dataclass(frozen=True)
class BenchNoise:
    """Random walks at rest, [rad/√s] and [m/s/√s]; None where not known."""

    angle_random_walk: float | None = None
    velocity_random_walk: float | None = None


@dataclass(frozen=True)
class AxisMotionNoise:
    """Effective random walk of one axis over `band_hz` [rad/√s or m/s/√s].

    `effective` is the rms over the log, `typical` the median block, `low` and `high` the 5th and 95th
    percentile of the blocks of BLOCK_S seconds; `factor` is effective over bench, None without a bench value.
    """

    name: str
    quantity: str
    effective: float
    typical: float
    low: float
    high: float
    factor: float | None


@dataclass(frozen=True)
class MotionAnalysis:
    """Effective noise of all axes; factors are rms over a triad, `vibration_factor` the larger of the two.

    `spectrum` is the vibration itself, see `nav_model.allan.vibration`.
    """

    axes: tuple[AxisMotionNoise, ...]
    band_hz: tuple[float, float]
    gyro_factor: float | None
    accelerometer_factor: float | None
    vibration_factor: float | None
    spectrum: tuple[Row, ...]
    provenance: LogSource


def analyse_motion(
    log: ImuLog,
    bench: BenchNoise | None = None,
    progress: Callable[[float, str], None] | None = None,
) -> MotionAnalysis:
    """Effective noise of a moving log from `BAND_FROM_HZ` to half the rate.

    Raises InputError when the rate leaves too narrow a band, the log is shorter than two blocks, or a bench value is
    not positive.
    """
    bench = bench or BenchNoise()
    _check(bench)
    axes = log.axes()
    rate_hz = min(axis.rate_hz for axis in axes)
    if BLOCK_S * (rate_hz / 2.0 - BAND_FROM_HZ) < _FEWEST_COEFFICIENTS:
        least = 2 * (BAND_FROM_HZ + _FEWEST_COEFFICIENTS / BLOCK_S)
        needed = f"noise is measured from {BAND_FROM_HZ:g} Hz to half the rate, which needs {least:g} Hz"
        raise InputError(log.file_name, f"{rate_hz:g} Hz is too slow: {needed}.")
    if min(map(block_count, axes)) < 2:
        longest = max(float(axis.lengths.max()) / axis.rate_hz for axis in axes)
        without = " without a gap" if log.breaks else ""
        raise InputError(log.file_name, f"{longest:.3g} s{without} are too short; {2 * BLOCK_S:g} s are needed.")
    results = []
    for index, axis in enumerate(axes):
        if progress is not None:
            progress(index / len(axes), axis.name)
        if cut := saturated_share(axis.signal):
            raise InputError(
                log.file_name,
                f"{axis.name} is saturated: {cut:.2%} of its samples are at the largest or smallest value, so its "
                "noise is clipped. Record the log with a wider range, or cut out that part.",
            )
        results.append(_axis(axis, rate_hz / 2.0))
    noise = MotionAnalysis(
        axes=tuple(results),
        band_hz=(BAND_FROM_HZ, rate_hz / 2.0),
        gyro_factor=None,
        accelerometer_factor=None,
        vibration_factor=None,
        spectrum=vibration_spectrum(log),
        provenance=LogSource.of(log),
    )
    return over_bench(noise, bench)


def over_bench(result: MotionAnalysis, bench: BenchNoise) -> MotionAnalysis:
    """The analysis with its factors over `bench`, whatever it was compared with before.

    Raises InputError when a bench value is not positive.
    """
    _check(bench)
    walks = {"gyro": bench.angle_random_walk, "accelerometer": bench.velocity_random_walk}
    axes = []
    for axis in result.axes:
        walk = walks[axis.quantity]
        axes.append(replace(axis, factor=None if walk is None else axis.effective / walk))
    factors = {quantity: _triad([a.factor for a in axes if a.quantity == quantity]) for quantity in UNITS}
    known = [factor for factor in factors.values() if factor is not None]
    return replace(
        result,
        axes=tuple(axes),
        gyro_factor=factors["gyro"],
        accelerometer_factor=factors["accelerometer"],
        vibration_factor=max(known) if known else None,
    )


def _check(bench: BenchNoise) -> None:
    for field, value in (
        ("angle_random_walk", bench.angle_random_walk),
        ("velocity_random_walk", bench.velocity_random_walk),
    ):
        if value is not None and not 0.0 < value < np.inf:
            raise InputError(f"bench.{field}", f"{value} is not allowed. Give a positive number.", value)


def _axis(axis: AxisSignal, highest_hz: float) -> AxisMotionNoise:
    length = block_length(axis.rate_hz)
    first, last = (math.ceil(edge * length / axis.rate_hz - 1e-9) for edge in (BAND_FROM_HZ, highest_hz))
    density = np.mean(block_densities(axis)[:, first : min(last, length // 2)], axis=1)
    effective = float(np.sqrt(density.mean()))
    low, typical, high = (float(value) for value in np.sqrt(np.percentile(density, [5.0, 50.0, 95.0])))
    return AxisMotionNoise(axis.name, axis.quantity, effective, typical, low, high, factor=None)


def _triad(factors: list[float | None]) -> float | None:
    known = [factor for factor in factors if factor is not None]
    return float(np.sqrt(np.mean(np.square(known)))) if known else None


def motion_to_json(result: MotionAnalysis) -> dict[str, Any]:
    """The analysis as JSON-ready data, effective noise in the units of the random walks (result.UNITS)."""
    axes = []
    for axis in result.axes:
        unit, si = UNITS[axis.quantity]["random_walk"]
        axes.append(
            {
                "name": axis.name,
                "effective": {
                    "value": axis.effective / si,
                    "typical": axis.typical / si,
                    "low": axis.low / si,
                    "high": axis.high / si,
                    "unit": unit,
                },
                "factor": axis.factor,
            }
        )
    return {
        "axes": axes,
        "band_hz": list(result.band_hz),
        "gyro_factor": result.gyro_factor,
        "accelerometer_factor": result.accelerometer_factor,
        "vibration_factor": result.vibration_factor,
        "spectrum": declared_spectrum().write(result.spectrum),
        "qualification": MOTION_CAVEAT,
        "file": result.provenance.file_name,
        "sha256": result.provenance.sha256,
        "rate_hz": result.provenance.rate_hz,
        "duration_s": result.provenance.duration_s,
        "reading": list(result.provenance.reading),
    }
