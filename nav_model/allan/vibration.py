"""Vibration spectrum of a log in motion, in third octaves, as an input of a design."""

from itertools import pairwise

import numpy as np

from nav_model.allan.imu_log import AxisSignal, ImuLog
from nav_model.base.arrays import Array
from nav_model.base.units import format_quantity, parse_quantity
from nav_model.design.parts import declaration_of
from nav_model.design.rows import Row, Rows
from nav_model.design.table import MOST_ROWS

SPECTRUM_KEY = "motion.spectrum"
LOWEST_HZ = 2.0
"""Below it the vehicle's own motion rules."""

BLOCK_S = 5.0
_RATIO = 2 ** (1 / 3)
_DIGITS = 3


def vibration_spectrum(log: ImuLog) -> tuple[Row, ...]:
    """One-sided density of the accelerometers [(m/s²)²/Hz], a row for each third of an octave from 2 Hz up.

    Each row is the mean over its band of the axis that vibrates most there, rounded to three digits: a log does not
    know where the radar looks. Hann-windowed blocks of 5 s without their mean and trend (Welch's method). Empty
    without accelerometers, for less than two blocks, or where fewer than two bands fit below half the rate.
    """
    axes = [axis for axis in log.axes() if axis.quantity == "accelerometer"]
    if not axes or block_count(axes[0]) < 2:
        return ()
    rate_hz = axes[0].rate_hz
    density = np.max([2 * np.mean(block_densities(axis), axis=0) for axis in axes], axis=0)
    frequency = np.arange(len(density)) * rate_hz / block_length(rate_hz)
    count = int(np.log(rate_hz / 2 / LOWEST_HZ) / np.log(_RATIO))
    edges = LOWEST_HZ * _RATIO ** np.arange(count + 1)
    rows = []
    for low, high in pairwise(edges):
        inside = (frequency >= low) & (frequency < high)
        mean = float(density[inside].mean()) if inside.any() else 0.0
        if mean > 0:
            middle = float(f"{np.sqrt(low * high):.{_DIGITS}g}")
            density_text = format_quantity(mean, "g²/Hz", "acceleration density", _DIGITS)
            rows.append((middle, parse_quantity(density_text, "acceleration density").value, "acceleration density"))
    return tuple(rows[:MOST_ROWS]) if len(rows) > 1 else ()


def declared_spectrum() -> Rows:
    """The input of a design that takes such a spectrum."""
    declaration = declaration_of(SPECTRUM_KEY)
    assert isinstance(declaration, Rows)
    return declaration


def block_length(rate_hz: float) -> int:
    """Samples of a block of BLOCK_S seconds."""
    return round(BLOCK_S * rate_hz)


def block_count(axis: AxisSignal) -> int:
    """Whole blocks of BLOCK_S seconds between the gaps of an axis."""
    return int(np.sum(axis.lengths // block_length(axis.rate_hz)))


def block_densities(axis: AxisSignal) -> Array:
    """Two-sided density [unit²/Hz] of each block of BLOCK_S seconds, shape (blocks, samples of a block // 2 + 1).

    Blocks lie between gaps. Each is Hann-windowed without its mean and trend, which keeps strong slow motion from
    leaking into the rest.
    """
    from scipy.signal import detrend

    length = block_length(axis.rate_hz)
    window = np.hanning(length)
    blocks = [stretch[: len(stretch) // length * length].reshape(-1, length) for stretch in axis.stretches]
    stacked = detrend(blocks[0] if len(blocks) == 1 else np.concatenate(blocks), axis=1)
    return np.asarray(np.abs(np.fft.rfft(stacked * window, axis=1)) ** 2 / (window @ window) / axis.rate_hz)
