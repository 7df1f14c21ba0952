"""Residual errors over the aperture, split by their effect on the image, and statistics over the runs.

A history is expanded in polynomials orthonormal over its samples: order 0 and 1 only shift; order 2 gives the
QPE, order 3 the CPE; orders 4 to 8 are the higher smooth part, and what no such polynomial holds is high
frequency: ripple, the saw of the fix rate. An autofocus "to order n" takes orders 0..n away.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from nav_model.aperture.impulse_response import aperture_of_phase, impulse_response
from nav_model.aperture.window import Window
from nav_model.base.arrays import Array

HIGHEST_SMOOTH_ORDER = 8
ENSEMBLE_PADDING = 8


@dataclass(frozen=True)
class Decomposition:
    """Parts of each history, shape (...), in the unit of the history (metres or radians).

    ``quadratic``, ``cubic``: coefficient of x^2 and x^3 on x in [-1, 1] in the fits of degree 2 and 3.
    ``*_rms``: rms over the aperture of each part; ``detrended_rms`` and ``detrended_max`` after the line;
    ``residual_rms`` after the autofocus order asked for. ``detrended_rms``^2 is the sum of the squares of the
    quadratic, cubic, higher and high-frequency rms.
    """

    quadratic: Array
    cubic: Array
    quadratic_rms: Array
    cubic_rms: Array
    higher_rms: Array
    high_frequency_rms: Array
    detrended_rms: Array
    detrended_max: Array
    residual_rms: Array


@dataclass(frozen=True)
class MedianBand:
    """Median and 5-95 % band over the runs (last axis of what it was made from)."""

    median: Array
    low: Array
    high: Array


def polynomial_basis(samples: int, order: int) -> Array:
    """Polynomials (samples, order + 1) of degree 0..order, orthonormal over equally spaced samples."""
    if samples <= order:
        raise ValueError(f"samples: {samples}; more than the polynomial order {order} are needed")
    x = np.linspace(-1, 1, samples)
    basis, triangle = np.linalg.qr(np.polynomial.legendre.legvander(x, order))
    return np.asarray(basis * np.sign(np.diagonal(triangle)))


def autofocus(history: ArrayLike, order: int = 1) -> Array:
    """Histories (..., n) without their polynomial of degree `order` (1: the line)."""
    history = np.asarray(history, float)
    if order < 1:
        raise ValueError(f"autofocus_order: {order}; 1 (line only) or more is needed")
    basis = polynomial_basis(history.shape[-1], order)
    return np.asarray(history - (history @ basis) @ basis.T)


def decompose(history: ArrayLike, autofocus_order: int = 1) -> Decomposition:
    """Split histories (..., n) sampled from end to end; n of at least 10."""
    history = np.asarray(history, float)
    samples = history.shape[-1]
    highest = max(HIGHEST_SMOOTH_ORDER, autofocus_order)
    basis = polynomial_basis(samples, highest)
    detrended = autofocus(history, 1)
    # Coefficients of the detrended history: those of the raw one may be larger by many orders.
    part = detrended @ basis
    x = np.linspace(-1, 1, samples)
    lead_2 = np.polynomial.polynomial.polyfit(x, basis[:, 2], 2)[2]
    lead_3 = np.polynomial.polynomial.polyfit(x, basis[:, 3], 3)[3]
    energy = (detrended**2).sum(axis=-1)
    smooth = (part[..., 2 : HIGHEST_SMOOTH_ORDER + 1] ** 2).sum(axis=-1)
    removed = (part[..., 2 : autofocus_order + 1] ** 2).sum(axis=-1)
    return Decomposition(
        quadratic=part[..., 2] * lead_2,
        cubic=part[..., 3] * lead_3,
        quadratic_rms=np.abs(part[..., 2]) / np.sqrt(samples),
        cubic_rms=np.abs(part[..., 3]) / np.sqrt(samples),
        higher_rms=np.sqrt((part[..., 4 : HIGHEST_SMOOTH_ORDER + 1] ** 2).sum(axis=-1) / samples),
        high_frequency_rms=np.sqrt(np.maximum(energy - smooth, 0.0) / samples),
        detrended_rms=np.sqrt(energy / samples),
        detrended_max=np.maximum(detrended.max(axis=-1), -detrended.min(axis=-1)),
        residual_rms=np.sqrt(np.maximum(energy - removed, 0.0) / samples),
    )


def fix_rate_harmonics(history: ArrayLike, time: ArrayLike, fix_interval: float, harmonics: int = 5) -> Array:
    """Amplitude (..., harmonics) of the ripple at 1, 2, ... times the fix rate, smooth part removed.

    Amplitude of a sinusoid of the same energy there; an amplitude p [rad] of phase makes paired echoes of
    20 log10(p/2) dB at n = k T / fix_interval cells.

    Parameters
    ----------
    history : array_like (..., n)
        Error or phase over the aperture.
    time : array_like (n,)
        Seconds, evenly spaced.
    fix_interval : float
        Seconds.
    harmonics : int, optional
        Number of them.

    Raises
    ------
    ValueError
        For harmonics above half the sampling rate.
    """
    history, time = np.asarray(history, float), np.asarray(time, float)
    step = float(time[1] - time[0])
    if harmonics / fix_interval > 0.5 / step:
        raise ValueError(f"harmonics: {harmonics} of {1 / fix_interval:.4g} Hz lie above half the sampling rate")
    ripple = autofocus(history, HIGHEST_SMOOTH_ORDER)
    turns = np.exp(-2j * np.pi * np.outer(time, np.arange(1, harmonics + 1)) / fix_interval)
    # One end sample closes the period and would be counted twice.
    return np.asarray(2 * np.abs(ripple[..., :-1] @ turns[:-1]) / (len(time) - 1))


def band(values: ArrayLike) -> MedianBand:
    """Median, 5 % and 95 % over the last axis (the runs)."""
    low, median, high = np.percentile(np.asarray(values, float), [5, 50, 95], axis=-1)
    return MedianBand(np.asarray(median), np.asarray(low), np.asarray(high))


def run_responses(phase: ArrayLike, window: Window = "uniform", autofocus_order: int = 1) -> dict[str, Array]:
    """Every measure of the impulse response of each run (...), from phases (..., n) [rad].

    Apertures of 1024 samples, padded by 8: within 0.03 dB and 0.0005 cell of the x64 response. The line is
    removed first, so the shift is what the higher orders add.
    """
    apertures = aperture_of_phase(autofocus(phase, autofocus_order), 1024, keep=False)
    response = impulse_response(apertures, window, ENSEMBLE_PADDING)
    return {
        name: np.asarray(getattr(response, name))
        for name in response.__dataclass_fields__
        if name != "ideal_null_cells"
    }
