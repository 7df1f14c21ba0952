"""An autofocus at work on simulated histories of points in clutter, and what it would leave without noise. [S-9]"""

import math
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import Array
from nav_model.design.autofocus import PHASE_GRADIENT, Autofocus
from nav_model.sar.decomposition import autofocus

_IN_BLOCK = 4  # pulses
_LOOK_PULSES, _FINE = 96, 4  # pulses of a look; pixels a cell
_MOST_POINTS = 500  # range bins that are simulated; more change the residual little and take long
_WINDOWS = 8, 8, 4, 2, 2, 2  # cells of a look each side of a point that map drift correlates, round by round
_SMEARED = 2, 1, 0, 0, 0, 0  # cells over which a point is found, round by round

_Complex = NDArray[np.complex128]


class Focusing(NamedTuple):
    """A design's autofocus, ``used``, in its scene.

    ``points``: range bins that have a point, of this ``contrast``: its power over the mean of its clutter in a cell.
    ``estimation`` [m]: 1σ that it adds to what it leaves. ``largest`` [m]: quadratic at one sigma beyond which its
    limits are not met, and nothing is removed.
    """

    used: Autofocus
    points: float
    contrast: float
    estimation: float
    largest: float


def after_autofocus(history: Array, used: Autofocus) -> Array:
    """Histories (..., n) less what a noiseless autofocus removes, and less their line."""
    if used.method != PHASE_GRADIENT:
        return autofocus(history, used.order)
    samples = history.shape[-1]
    edges = np.arange(used.blocks) * samples // used.blocks
    counts = np.diff(np.append(edges, samples))
    means = np.add.reduceat(history, edges, axis=-1) / counts
    return autofocus(history - _lines_between(means, edges + (counts - 1) / 2, samples))


def focused(phase: Array, focusing: Focusing, seed: int) -> Array:
    """Phase [rad] (n,) that the autofocus itself leaves of an error, its line out.

    Every range bin has a point somewhere in the image, in clutter of its own; ``seed`` is that of both.
    """
    used, points, contrast = focusing[:3]
    gradient = used.method == PHASE_GRADIENT
    pulses = used.blocks * _IN_BLOCK if gradient else used.order * _LOOK_PULSES
    bins = max(1, min(round(points), _MOST_POINTS))
    rng = np.random.default_rng(seed)
    x = (np.arange(pulses) + 0.5) / pulses * 2 - 1
    samples = np.linspace(-1, 1, len(phase))
    error = np.interp(x, samples, autofocus(phase))
    place = rng.uniform(-0.5, 0.5, (bins, 1)) * np.pi * pulses / 2
    clutter = rng.normal(size=(2, bins, pulses)) * math.sqrt(pulses / contrast / 2)
    history = np.exp(1j * (error + place * x)) + clutter[0] + 1j * clutter[1]
    removed = phase_gradient(history, used.blocks) if gradient else map_drift(history, used.order)
    return autofocus(phase - np.interp(samples, x, removed))


def phase_gradient(history: _Complex, blocks: int) -> Array:
    """Phase [rad] of the pulses of a history (range bins, pulses) by the main eigenvector of its blocks.

    The brightest place of each range bin is moved to the middle first; the window about it is as wide as a block is
    short.
    """
    pulses = history.shape[1]
    centres = (np.arange(blocks) + 0.5) * pulses / blocks - 0.5
    removed = np.zeros(pulses)
    for smeared in _SMEARED:
        means = _centred(history * np.exp(-1j * removed), smeared).reshape(len(history), blocks, -1).mean(axis=2)
        _, vectors = np.linalg.eigh(means.T @ means.conj())
        # The whole phase of a block, not what the lines before have left: adding lines to lines sharpens noise.
        whole = removed.reshape(blocks, -1).mean(axis=1) + np.unwrap(np.angle(vectors[:, -1]))
        removed = _lines_between(whole, centres, pulses)
    return removed


def map_drift(history: _Complex, order: int) -> Array:
    """Polynomial [rad] of a history (range bins, pulses) from the shifts between the magnitudes of as many looks."""
    pulses = history.shape[1]
    x, powers = (np.arange(pulses) + 0.5) / pulses * 2 - 1, range(2, order + 1)
    edges = np.linspace(-1, 1, order + 1)
    # Mean slopes of x² and x³ over a look, in its cells.
    slopes = np.stack([np.diff(edges**n) / np.diff(edges) for n in powers], axis=1) / (np.pi * order)
    pairs = list(combinations(range(order), 2))
    between = np.array([slopes[j] - slopes[i] for i, j in pairs])
    steps = (np.arange(pulses // order) - (pulses // order - 1) / 2) * order / pulses
    removed, coefficients = np.zeros(pulses), np.zeros(order - 1)
    for window, smeared in zip(_WINDOWS, _SMEARED, strict=True):
        pixels = np.arange(-window * _FINE, window * _FINE + 1) / _FINE
        looks = np.split(_centred(history * np.exp(-1j * removed), smeared), order, axis=1)
        seen = [np.abs(look @ np.exp(-2j * np.pi * np.outer(steps, pixels))) ** 2 for look in looks]
        shifts = np.array([_shift(seen[i], seen[j]) for i, j in pairs])
        coefficients = coefficients + np.linalg.lstsq(between, shifts, rcond=None)[0]
        removed = np.asarray(np.stack([x**n for n in powers], axis=1) @ coefficients)
    return removed


def _centred(history: _Complex, smeared: int) -> _Complex:
    """A history with the brightest place of each range bin in the middle of its image, the brightness of which is a
    mean over so many cells."""
    pulses = history.shape[1]
    power = np.abs(np.fft.fft(history, _FINE * pulses, axis=1)) ** 2
    if width := smeared * _FINE // 2:
        whole = np.cumsum(np.concatenate([power[:, -width - 1 :], power, power[:, :width]], axis=1), axis=1)
        power = whole[:, 2 * width + 1 :] - whole[:, : -2 * width - 1]
    cycles = power.argmax(axis=1)[:, None] / (_FINE * pulses)
    return np.asarray(history * np.exp(-2j * np.pi * cycles * (np.arange(pulses) - (pulses - 1) / 2)))


def _shift(first: Array, second: Array) -> float:
    """Shift in cells at which the pixels of two looks (range bins, pixels) correlate best, between pixels by a
    parabola."""
    size = 4 * first.shape[1]
    one, other = (np.fft.rfft(look - look.mean(axis=1, keepdims=True), size) for look in (first, second))
    correlation = np.fft.irfft((one.conj() * other).sum(axis=0), size)
    top = int(correlation.argmax())
    before, at, after = correlation[[top - 1, top, (top + 1) % size]]
    whole = (top + size // 2) % size - size // 2
    return float(whole + (before - after) / (2 * (before - 2 * at + after))) / _FINE


def _lines_between(phases: Array, centres: Array, samples: int) -> Array:
    """Straight lines between the phases (..., blocks) of blocks with these centres, carried on to the ends."""
    at = np.arange(samples)
    first = np.clip(np.searchsorted(centres, at) - 1, 0, len(centres) - 2)
    share = (at - centres[first]) / (centres[first + 1] - centres[first])
    return np.asarray(phases[..., first] * (1 - share) + phases[..., first + 1] * share)
