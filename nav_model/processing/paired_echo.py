"""Echoes and scattered energy of phase errors faster than the main lobe. [P-9], [P-11]

A line of p radians leaves J0(p) of a target's amplitude at its place and puts J1(p) on each side; a wide spectrum
of variance s² leaves exp(-s²/2) and spreads the rest.
"""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import Array
from nav_model.processing.fast_motion import NEAR_CELLS, Fast

NOTHING = 1e-15
"""Amplitude that stands for an echo that is not there: a logarithm needs one."""

_MOST = 2.3  # rad: just beyond, nothing is left of the target's own peak
_MOST_EXPONENT = 40.0
_ANGLES = 2 * np.pi * np.arange(32) / 32


def bessel_0_less_1(p: Array) -> Array:
    """J0 - 1 for p up to 10, good to rounding near zero too."""
    return np.asarray(-2 * np.mean(np.sin(p[..., None] / 2 * np.sin(_ANGLES)) ** 2, axis=-1))


def bessel_1(p: Array) -> Array:
    """J1 for p up to 10."""
    return np.asarray(np.mean(np.sin(_ANGLES) * np.sin(p[..., None] * np.sin(_ANGLES)), axis=-1))


def echo(phase: Array) -> Array:
    """Amplitude of a paired echo over its target, J1/J0 of the phase [rad]; beyond 2.3 rad that at 2.3. [P-9]

    Examples
    --------
    >>> import numpy as np
    >>> f"{20 * np.log10(echo(np.array([0.0632]))[0]):.2f} dB"
    '-30.00 dB'
    """
    p = _held(phase)
    return np.asarray(bessel_1(p) / (1 + bessel_0_less_1(p)))


def _held(phase: Array) -> Array:
    return np.where(phase.real > _MOST, _MOST, phase)


def fast_lines(effect: Fast, aperture: Array, lobe: float) -> NDArray[np.bool_]:
    """Mask of the lines that lie beyond the main lobe, and so make echoes."""
    return np.asarray(effect.frequency * aperture[..., None].real > lobe)


def highest_echo(sources: Iterable[Fast], to_phase: Array, aperture: Array, lobe: float) -> Array:
    """The largest echo's amplitude over the target's; `NOTHING` without one. [P-9]

    Parameters
    ----------
    sources : iterable of Fast
    to_phase : array
        Two-way phase of a metre, rad.
    aperture : array
        Seconds.
    lobe : float
        Cells from the peak to the first null.
    """
    largest = NOTHING + 0 * to_phase * aperture
    for effect in sources:
        beside = fast_lines(effect, aperture, lobe)
        lines = np.where(beside, echo(to_phase[..., None] * effect.amplitude), NOTHING)
        for n in range(lines.shape[-1]):
            largest = np.where(lines[..., n].real > largest.real, lines[..., n], largest)
    return np.asarray(largest)


def scatter_exponent(
    sources: Iterable[Fast], to_phase: Array, aperture: Array, lobe: float, density: str = "scattered"
) -> Array:
    """E of the power exp(-E) that stays at the target: variances of the spectra, and -2 ln J0 of each line. [P-11]

    Parameters
    ----------
    sources, to_phase, aperture, lobe
        As `highest_echo`.
    density : str, optional
        "scattered", or "near" for what falls within ten null distances.
    """
    total = 0 * to_phase * aperture
    for effect in sources:
        total = total + to_phase**2 * getattr(effect, density)
        where = fast_lines(effect, aperture, lobe)
        if density == "near":
            where = where & ~fast_lines(effect, aperture, NEAR_CELLS * lobe)
        lines = _log1p(bessel_0_less_1(_held(to_phase[..., None] * effect.amplitude)))
        total = total - 2 * np.sum(np.where(where, lines, 0), axis=-1)
    return np.asarray(np.where(total.real > _MOST_EXPONENT, _MOST_EXPONENT, total))


def _log1p(z: Array) -> Array:
    """log(1 + z), with a complex step: NumPy's own of a complex number has the digits of 1 + z."""
    real = np.log1p(z.real)
    return np.asarray(real + 1j * z.imag / (1 + z.real) if np.iscomplexobj(z) else real)


def scattered_ratio(exponent: Array) -> Array:
    """Amplitude whose square is the scattered energy over the target's, exp(E) - 1. [P-11]"""
    return np.asarray(np.sqrt(np.expm1(exponent) + NOTHING**2))
