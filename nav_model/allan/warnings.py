"""Warnings about a static log: movement, temperature, coarse counts, wrong units."""

import numpy as np

from nav_model.allan.imu_log import ImuLog
from nav_model.base.arrays import Array
from nav_model.base.constants import STANDARD_GRAVITY

_BLOCKS = 60
_BURST_RATIO = 1.3
_BURST_SCORES = 6.0
_GRAVITY_TOLERANCE = 0.03
_FASTEST_MEAN_RATE = np.radians(5.0)
_STUCK_SHARE = 0.5
_TEMPERATURE_SHARE = 0.5
_FEWEST_LEVELS = 4
_FEWEST_CUT = 8  # samples at a limit
_CUT_RATIO = 1.5  # of those over the ones at the next value
_ROUNDING = 1e-5  # of a step between levels
_END_VALUES = 256


def saturated_share(signal: Array) -> float:
    """Share of samples at a limit of the sensor's range; 0 where no limit is seen.

    Noise becomes rarer towards its largest value. If the largest (or smallest) value occurs far more often than the
    value next to it, larger ones were cut off. Signals with three levels or fewer are coarse and give no answer.
    Differences of a running total have its rounding: values that near to each other are one level.
    """
    largest, smallest = signal.max(), signal.min()
    near = _ROUNDING * (largest - smallest)
    if max(np.sum(signal >= largest - near), np.sum(signal <= smallest + near)) < _FEWEST_CUT:
        return 0.0
    values, counts = np.unique(signal, return_counts=True)
    gaps = np.diff(values)
    if not len(gaps):
        return 0.0
    rounding = _ROUNDING * max(gaps[:_END_VALUES].max(), gaps[-_END_VALUES:].max())
    of_level = np.bincount(np.concatenate([[0], np.cumsum(gaps > rounding)]), counts)
    if len(of_level) < _FEWEST_LEVELS:
        return 0.0
    ends = (of_level[0], of_level[1]), (of_level[-1], of_level[-2])
    cut = sum(float(end) for end, beside in ends if end >= _FEWEST_CUT and end > _CUT_RATIO * beside)
    return cut / len(signal)


def log_warnings(log: ImuLog) -> tuple[str, ...]:
    """Warnings that concern the log as a whole: units and standstill, from the means, and stamps that repeat."""
    warnings = []
    if log.rows_of_time > 1:
        warnings.append(
            f"each time is on {log.rows_of_time} rows: if they are of {log.rows_of_time} sensors, the values are of "
            "none of them; give a column that numbers the sensors, or a log of one; or the stamps are coarse"
        )
    if log.accelerometer is not None and log.accelerometer.shape[1] == 3:
        force = float(np.linalg.norm(log.accelerometer.mean(axis=0)))
        if abs(force / STANDARD_GRAVITY - 1.0) > _GRAVITY_TOLERANCE:
            warnings.append(
                f"mean specific force is {force:.4g} m/s², not gravity: wrong unit or scale, or the unit was moving"
            )
    if log.gyro is not None:
        rate = float(np.linalg.norm(log.gyro.mean(axis=0)))
        if rate > _FASTEST_MEAN_RATE:
            warnings.append(f"mean angular rate is {np.degrees(rate):.4g} °/s: wrong unit, or the unit was turning")
    return tuple(warnings)


def axis_warnings(signal: Array, interval_s: float, temperature_c: Array | None) -> tuple[str, ...]:
    """Warnings of one axis: bursts of vibration, temperature, coarse resolution."""
    warnings = []
    steps = np.diff(signal)
    stuck = float(np.mean(steps == 0.0))
    if stuck > _STUCK_SHARE:
        warnings.append(
            f"{100 * stuck:.0f} % of successive samples are equal: the resolution is coarser than the noise"
        )
    burst = _burst(steps, interval_s)
    if burst is not None:
        warnings.append(burst)
    if temperature_c is not None:
        heat = _temperature(signal, temperature_c)
        if heat is not None:
            warnings.append(heat)
    return tuple(warnings)


def _burst(steps: Array, interval_s: float) -> str | None:
    """Loudest of equal blocks of the first differences against the median one."""
    length = len(steps) // _BLOCKS
    loudness = steps[: length * _BLOCKS].reshape(_BLOCKS, length).std(axis=1)
    usual = float(np.median(loudness))
    if usual == 0.0:
        return None
    worst = int(np.argmax(loudness))
    ratio = float(loudness[worst]) / usual
    if ratio < max(_BURST_RATIO, 1.0 + _BURST_SCORES / np.sqrt(2.0 * length)):
        return None
    start = worst * length * interval_s
    return (
        f"disturbed: between {start:.0f} s and {start + length * interval_s:.0f} s the signal is {ratio:.1f} "
        "times as restless as usual; trim the log or repeat it at rest"
    )


def _temperature(signal: Array, temperature_c: Array) -> str | None:
    length = len(signal) // _BLOCKS
    slow = signal[: length * _BLOCKS].reshape(_BLOCKS, length).mean(axis=1)
    heat = temperature_c[: length * _BLOCKS].reshape(_BLOCKS, length).mean(axis=1)
    slow, heat = slow - slow.mean(), heat - heat.mean()
    if not np.any(heat) or not np.any(slow):
        return None
    slope = float(slow @ heat / (heat @ heat))
    share = slope**2 * float(heat @ heat) / float(slow @ slow)
    if share < _TEMPERATURE_SHARE:
        return None
    return (
        f"temperature ({np.ptp(heat):.1f} °C over the log) goes with {100 * share:.0f} % of the slow variation, "
        f"{slope:.3g} SI units per °C: bias instability, rate random walk and ramp include it"
    )
