"""Map drift against one written here, which correlates magnitudes of looks, on histories of points in clutter."""

import math
from itertools import combinations

import numpy as np
import pytest

from nav_model.aperture.autofocus import noise_of_map_drift
from tests.support.phase_gradient import without_line

PULSES, FINE = 144, 4  # pixels a cell of a look
X = (np.arange(PULSES) + 0.5) / PULSES * 2 - 1


def shift_between(first: np.ndarray, second: np.ndarray) -> float:
    """Shift [cells] at which the magnitudes of two looks (range bins, pixels) correlate best."""
    size = 4 * first.shape[1]
    spectra = [np.fft.rfft(look - look.mean(axis=1, keepdims=True), size) for look in (first, second)]
    correlation = np.fft.irfft((spectra[0].conj() * spectra[1]).sum(axis=0), size)
    top = int(correlation.argmax())
    before, at, after = correlation[[top - 1, top, (top + 1) % size]]
    return ((top + size // 2) % size - size // 2 + (before - after) / (2 * (before - 2 * at + after))) / FINE


def map_drift(history: np.ndarray, order: int) -> np.ndarray:
    """Polynomial that is removed from a history (range bins, pulses), its points in the middle, in five rounds."""
    edges, in_look = np.linspace(-1, 1, order + 1), PULSES // order
    powers = range(2, order + 1)
    # Shift of each look in its cells for a coefficient of one.
    moves = np.stack([np.diff(edges**n) / np.diff(edges) for n in powers], axis=1) / (np.pi * order)
    pairs = list(combinations(range(order), 2))
    design = np.array([moves[j] - moves[i] for i, j in pairs])
    removed, coefficients = np.zeros(PULSES), np.zeros(order - 1)
    for half_width in (8, 8, 2, 2, 2):  # of the window about a point, cells
        place = np.arange(-half_width * FINE, half_width * FINE + 1) / FINE
        steering = np.exp(-2j * np.pi * np.outer((np.arange(in_look) - (in_look - 1) / 2) / in_look, place))
        looks = np.split(history * np.exp(-1j * removed), order, axis=1)
        seen = [np.abs(look @ steering) ** 2 for look in looks]
        shifts = [shift_between(seen[i], seen[j]) for i, j in pairs]
        coefficients = coefficients + np.linalg.lstsq(design, np.array(shifts), rcond=None)[0]
        removed = sum(c * X**n for c, n in zip(coefficients, powers, strict=True))
    return removed


def residuals(order: int, points: int, contrast: float, draws: int) -> np.ndarray:
    """Rms phase [rad] of each draw that map drift leaves of a polynomial that it can remove whole."""
    rng, clutter = np.random.default_rng(points), math.sqrt(PULSES / contrast / 2)
    rms = []
    for _ in range(draws):
        phase = sum(rng.normal(scale=3.0) * X**n for n in range(2, order + 1))
        noise = clutter * (rng.normal(size=(points, PULSES)) + 1j * rng.normal(size=(points, PULSES)))
        history = np.exp(1j * (without_line(phase) + rng.uniform(0, 2 * np.pi, (points, 1)))) + noise
        rms.append(np.std(without_line(phase - map_drift(history, order))))
    return np.array(rms)


def predicted(order: int, points: int, contrast: float) -> float:
    noise = noise_of_map_drift(order, np.array(float(points)), np.array(contrast))
    return float(noise.sigma * np.sqrt(noise.weights[2]))


@pytest.mark.long
@pytest.mark.parametrize(
    ("order", "points", "decibels"), [(2, 5, 20.0), (3, 5, 20.0), (2, 50, 15.0), (3, 50, 15.0), (2, 200, 6.0)]
)
def test_map_drift_leaves_what_is_predicted(order: int, points: int, decibels: float, compared, ratio_off) -> None:
    """Within 20 %: the draws leave the rms uncertain by 4 %."""
    contrast = 10 ** (decibels / 10)
    rms = math.sqrt(np.mean(residuals(order, points, contrast, 300) ** 2))
    compared(
        "Phase after map drift",
        "S-10",
        "our own derivation",
        "a map drift written in the test, on simulated points in clutter, 300 draws each",
        ratio_off(rms, predicted(order, points, contrast)),
        0.2,
        "ratio − 1",
    )


@pytest.mark.parametrize(("points", "contrast"), [(5, 4.0), (50, 1.5), (200, 0.6)])
def test_it_fails_where_it_is_said_to(points: int, contrast: float) -> None:
    """At least half of twenty draws are left with more than the largest error."""
    assert predicted(2, points, contrast) > 0.3
    assert np.median(residuals(2, points, contrast, 20)) > 0.3
