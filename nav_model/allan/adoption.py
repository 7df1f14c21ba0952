"""Puts the results of a log into a design, with their origin: method and log file."""

import math
from dataclasses import dataclass
from typing import Final

import numpy as np

from nav_model.allan.motion import MOTION_CAVEAT, BenchNoise, MotionAnalysis, over_bench
from nav_model.allan.result import UNITS, Coefficient, LogAnalysis, LogSource, fitted_lines, triad_coefficient
from nav_model.allan.vibration import SPECTRUM_KEY
from nav_model.base.errors import InputError
from nav_model.base.units import format_quantity, from_si
from nav_model.design import Design, Value
from nav_model.design.parts import quantity

WALK_KEYS: Final = {"gyro": "imu.angle_random_walk", "accelerometer": "imu.velocity_random_walk"}
VIBRATION_KEY: Final = "imu.vibration_factor"
DRIFTS: Final = "bias_instability", "rate_random_walk"
"""Terms of a log that are inputs of the sections [gyro] and [accelerometer], by their names."""

_PEAK = 1.89  # correlation times
_DIGITS = 3  # what a page shows, so that the design has what was offered
_LONGEST_NAME = 80


@dataclass(frozen=True)
class Adoption:
    """Arguments of `Design.replace`, by dotted key: values in SI, units to write them in, origins."""

    changes: dict[str, Value]
    written: dict[str, str]
    origins: dict[str, str]


def adopt_noise(result: LogAnalysis) -> Adoption:
    """The noise of a static log's triads, rounded to the digits shown, as changes to a design.

    Random walk, bias instability and rate random walk; what a triad did not resolve on all axes changes nothing.
    """
    quoted: dict[str, str] = {}
    origins: dict[str, str] = {}
    of_log = f"from static log {_log(result.provenance)}"
    for sensor, walk_key in WALK_KEYS.items():
        keys = {"random_walk": walk_key} | {term: f"{sensor}.{term}" for term in DRIFTS}
        for term, key in keys.items():
            if (size := triad_coefficient(result, sensor, term)) is None:
                continue
            unit, _ = UNITS[sensor][term]
            dimension = quantity(key).dimension
            quoted[key] = format_quantity(size.value, unit, dimension, _DIGITS)
            origins[key] = f"{_in_words(size, unit, dimension)}, {of_log}"
        if f"{sensor}.bias_instability" in quoted:
            time, key = _correlation_time(result, sensor), f"{sensor}.correlation_time"
            quoted[key] = format_quantity(time, "s", "time", _DIGITS)
            origins[key] = f"lowest Allan deviation at {_PEAK * time:.3g} s, over {_PEAK:g}, {of_log}"
    return _adoption(quoted, origins)


def _correlation_time(result: LogAnalysis, sensor: str) -> float:
    """Correlation time of a Gauss-Markov bias in place of a triad's flicker noise, s.

    The Allan deviation of such a process of sigma B is highest, 0.617 B, at 1.89 correlation times, and the floor of
    flicker noise B is at 0.664 B: the same place and, to 7 %, the same size (IEEE Std 952, annex C). The place is
    that of the lowest deviation of all terms that the log resolved, on the geometric mean of the axes.
    """
    axes = [axis for axis in result.axes if axis.quantity == sensor]
    times = np.geomspace(1.0 / axes[0].rate_hz, result.provenance.duration_s, 400)
    lowest = [math.log(times[np.argmin(fitted_lines(axis, times)["total"])]) for axis in axes]
    return math.exp(math.fsum(lowest) / len(lowest)) / _PEAK


def adopt_vibration_factor(design: Design, result: MotionAnalysis) -> Adoption:
    """The vibration factor of a log in motion as a change to `design`, whose own random walks it multiplies."""
    bench = bench_of(design)
    factor = over_bench(result, bench).vibration_factor
    assert factor is not None  # every log has a sensor, and a design both random walks
    low, high = result.band_hz
    walks = " and ".join(
        format_quantity(walk, design.unit(key), quantity(key).dimension, _DIGITS)
        for key, walk in zip(WALK_KEYS.values(), (bench.angle_random_walk, bench.velocity_random_walk), strict=True)
        if walk is not None
    )
    origin = (
        f"noise from {low:g} to {high:g} Hz over the design's {walks}, from log in motion "
        f"{_log(result.provenance)}; {MOTION_CAVEAT}"
    )
    return _adoption({VIBRATION_KEY: f"{factor:.{_DIGITS}g}"}, {VIBRATION_KEY: origin})


def adopt_vibration_spectrum(result: MotionAnalysis) -> Adoption:
    """The vibration of a log in motion, as a spectrum, as a change to a design.

    Raises InputError when the log has none: no accelerometers, or too short.
    """
    if not result.spectrum:
        raise InputError(SPECTRUM_KEY, "The log has too few accelerometer data for a spectrum.")
    origin = (
        f"third octaves from {result.spectrum[0][0]:g} to {result.spectrum[-1][0]:g} Hz, in each the axis that "
        f"vibrates most, from log in motion {_log(result.provenance)}"
    )
    return Adoption({SPECTRUM_KEY: result.spectrum}, {}, {SPECTRUM_KEY: origin})


def bench_of(design: Design) -> BenchNoise:
    """The design's random walks, which its vibration factor multiplies."""
    return BenchNoise(design.imu.angle_random_walk, design.imu.velocity_random_walk)


def _adoption(quoted: dict[str, str], origins: dict[str, str]) -> Adoption:
    read = {key: quantity(key).read(text) for key, text in quoted.items()}
    return Adoption(
        changes={key: parsed.value for key, parsed in read.items()},
        written={key: parsed.unit for key, parsed in read.items()},
        origins=origins,
    )


def _in_words(walk: Coefficient, unit: str, dimension: str) -> str:
    low, high = (f"{from_si(limit, unit, dimension):.{_DIGITS}g}" for limit in (walk.low, walk.high))
    return f"{walk.method} ({low} to {high}, {walk.interval})"


def _log(provenance: LogSource) -> str:
    name = " ".join(provenance.file_name.split())[:_LONGEST_NAME]
    return f"{name} (sha256 {provenance.sha256[:16]}, {provenance.rate_hz:g} Hz, {provenance.duration_s:.0f} s)"
