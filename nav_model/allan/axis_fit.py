"""Fit of one axis of a real log: sensor filters, vibration lines and departures from the model are found first.

A clean log is fitted over its whole band with nothing removed. Where the five terms do not describe the log,
the top of the band (anti-alias filter) and narrow lines (vibration) are set aside, and what departure remains
enters every interval as a relative model error. A log that departs by more than `WORST_MODEL_ERROR` yields no
coefficient at all. Where the bandwidth of the sensor's low pass is known, only what it leaves as it was is fitted.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nav_model.allan.likelihood import SpectrumFit, fit_spectrum, fitted_spectrum
from nav_model.allan.spectrum import CosineSpectrum
from nav_model.base.arrays import Array

# Set between the available logs: 0.06 at most for the ADIS16405 at rest, above 0.7 for the disturbed laser.
# Relative standard deviation of the measured power about the fitted one past which nothing is reported.
WORST_MODEL_ERROR = 0.4
# Departures below this need no narrower band: they move a coefficient by half as much.
TOLERATED_MODEL_ERROR = 0.05
# Standard scores of the goodness of fit; 4 refuses a true model about once in 10,000 logs.
ADEQUATE_SCORE = 4.0

# Of a low pass; below it one of the first order takes 0.3 % of the power on average, others less.
PASSED_SHARE = 0.1

_LEAST_COEFFICIENTS = 256
_LEAST_OF_OCTAVE = 100
_LEVEL = 0.15  # logarithm of power from octave to octave; less is level
_STEEP = 0.2
_BAND_HALVINGS = 3
_ROUNDS = 4
_PRECISE_COUNT = 50.0
_LINE_LOG_EXCESS = 0.35
_LINE_SCORES = 5.0
_LINE_TAIL = 20.0
_MOST_LINES = 0.25
_MAD_TO_SIGMA = 1.4826


@dataclass(frozen=True)
class AxisFit:
    """The fit with what was set aside: `band_hz` is its top frequency, `lines_hz` the lines left out.

    `clean` says that the whole band was used, nothing was left out and the goodness of fit is within
    ADEQUATE_SCORE; `model_error` is the relative standard deviation of power left over (0 when clean).
    `falls_hz` is where a spectrum that is not clean falls to half as behind a low pass; None where it does not.
    """

    fit: SpectrumFit
    clean: bool
    band_hz: float
    band_cut: bool
    lines_hz: tuple[float, ...]
    model_error: float
    falls_hz: float | None = None


def fit_axis(spectrum: CosineSpectrum, bandwidth_hz: float | None = None) -> AxisFit:
    """Fit the five terms to one axis, narrowing the band only when the log demands it.

    With the `bandwidth_hz` of a low pass inside the sensor (3 dB), the band ends at PASSED_SHARE of it.

    Raises ValueError where the log is too short for that band.
    """
    nyquist = 0.5 / spectrum.interval_s
    top = min(nyquist, PASSED_SHARE * (bandwidth_hz or np.inf))
    everything = spectrum.frequency_hz <= top
    if top < nyquist and (held := float(spectrum.count[everything].sum())) < _LEAST_COEFFICIENTS:
        needed = f"at least {_LEAST_COEFFICIENTS / (2.0 * top):.0f} s are needed for a fit"
        raise ValueError(f"log has {held / (2.0 * top):.0f} s; with a bandwidth of {bandwidth_hz:g} Hz {needed}")
    model, residual = fitted_spectrum(spectrum, everything, 0.0)
    clean = fit_score(spectrum.count[everything], (residual / model)[everything]) < ADEQUATE_SCORE
    chosen = _Selection(everything, 0.0, top, model)
    if not clean or np.any(_narrow_lines(spectrum, model) & everything):
        clean = False
        chosen = _select(spectrum, top)
        for halving in range(1, _BAND_HALVINGS + 1 if top == nyquist else 1):
            if chosen.model_error <= TOLERATED_MODEL_ERROR:
                break
            candidate = _select(spectrum, top / 2**halving)
            if candidate.model_error < chosen.model_error:
                chosen = candidate
    set_aside = (spectrum.frequency_hz <= chosen.band_hz) & ~chosen.used
    return AxisFit(
        fit=fit_spectrum(spectrum, chosen.used, chosen.model_error),
        clean=clean,
        band_hz=chosen.band_hz,
        band_cut=chosen.band_hz < nyquist,
        lines_hz=_merge_lines(spectrum, set_aside, chosen.model),
        model_error=chosen.model_error,
        falls_hz=None if clean or top < nyquist else _low_pass(spectrum),
    )


def _low_pass(spectrum: CosineSpectrum) -> float | None:
    """Frequency at which the power has fallen to half of the level below, where it falls to the top of the band as
    behind a low pass; None where it does not.

    Noise that falls with frequency ends in a level one; behind a low pass the level comes first and the fall lasts.
    """
    levels = []
    high = 0.5 / spectrum.interval_s
    while True:
        octave = (spectrum.frequency_hz <= high) & (spectrum.frequency_hz > high / 2.0)
        if (count := spectrum.count[octave].sum()) < _LEAST_OF_OCTAVE:
            break
        levels.append(float(spectrum.count[octave] @ np.log(spectrum.power[octave]) / count))
        high /= 2.0
    steps = -np.diff(levels)  # from an octave to the one above, from the top on
    level = np.flatnonzero(np.abs(steps) < _LEVEL)
    if not len(level) or not level[0] or steps[0] > -_STEEP or np.any(steps[: level[0]] > 0.0):
        return None
    half = levels[level[0]] - np.log(2.0)
    above = np.flatnonzero(np.log(spectrum.power) > half)
    return float(spectrum.frequency_hz[above[-1]]) if levels[0] < half else None


def fit_score(count: Array, ratio: Array) -> float:
    """Standard score of the deviance of bins of `count` coefficients; about normal(0, 1) when the model
    holds.

    `ratio` is measured over fitted power, same shape as `count`.
    """
    from scipy.special import polygamma, psi

    ratio = np.maximum(ratio, np.finfo(np.float64).tiny)
    deviance = count * (ratio - 1.0 - np.log(ratio))
    expected = count * (np.log(count / 2.0) - psi(count / 2.0))
    variance = count**2 * (polygamma(1, count / 2.0) - 2.0 / count)
    return float((deviance - expected).sum() / np.sqrt(variance.sum()))


@dataclass(frozen=True)
class _Selection:
    used: NDArray[np.bool_]
    model_error: float
    band_hz: float
    model: Array


def _select(spectrum: CosineSpectrum, band_hz: float) -> _Selection:
    """Set lines aside below `band_hz` and measure the departure that remains, in rounds of refitting."""
    in_band = spectrum.frequency_hz <= band_hz
    upper = in_band & (spectrum.count > 1)
    used, model_error = in_band, 0.0
    model, residual = fitted_spectrum(spectrum, used, model_error)
    for _ in range(_ROUNDS):
        log_ratio = np.log(spectrum.power / model)
        usual = _usual_departure(log_ratio[upper], spectrum.count[upper])
        limit = np.maximum(_LINE_LOG_EXCESS, _LINE_SCORES * np.sqrt(2.0 / spectrum.count + usual**2))
        lines = upper & (log_ratio > limit)
        if usual < WORST_MODEL_ERROR:
            lines |= upper & _narrow_lines(spectrum, model)
        if np.count_nonzero(lines) > _MOST_LINES * np.count_nonzero(upper):
            lines = np.zeros_like(lines)
        used = in_band & ~lines
        fitted = used & upper
        model_error = _model_error(log_ratio[fitted], spectrum.count[fitted])
        model, residual = fitted_spectrum(spectrum, used, model_error)
    if fit_score(spectrum.count[used], (residual / model)[used]) < ADEQUATE_SCORE:
        model_error = 0.0
    return _Selection(used, model_error, band_hz, model)


def _narrow_lines(spectrum: CosineSpectrum, model: Array) -> NDArray[np.bool_]:
    """Bins where one coefficient is larger than Gaussian noise allows (about once in 60,000 bins)."""
    largest = spectrum.peak * spectrum.power / model
    return np.asarray((spectrum.count > 8) & (largest > 2.0 * np.log(spectrum.count) + _LINE_TAIL))


def _usual_departure(log_ratio: Array, count: Array) -> float:
    """Robust relative scatter of power about the model beyond the counts' own, blind to a few lines."""
    spread = _MAD_TO_SIGMA * float(np.median(np.abs(log_ratio)))
    return float(np.sqrt(max(0.0, spread**2 - float(np.median(2.0 / count)))))


def _model_error(log_ratio: Array, count: Array) -> float:
    """Rms relative departure of power from the model beyond what the counts explain, lines already gone.

    Not robust on purpose: a spectrum that collapses above a body's sway is a minority of bins and the whole
    story. Bins of few coefficients, whose own scatter would hide a departure, are left to the goodness of
    fit.
    """
    precise = count >= min(_PRECISE_COUNT, float(np.median(count)))
    return float(np.sqrt(max(0.0, float(np.mean(log_ratio[precise] ** 2 - 2.0 / count[precise])))))


def _merge_lines(spectrum: CosineSpectrum, lines: NDArray[np.bool_], model: Array) -> tuple[float, ...]:
    """One frequency per run of neighbouring line bins: that of its strongest bin."""
    index = np.flatnonzero(lines)
    if not len(index):
        return ()
    runs = np.split(index, np.flatnonzero(np.diff(index) > 1) + 1)
    strength = spectrum.power * spectrum.peak / model
    return tuple(float(spectrum.peak_frequency_hz[run[np.argmax(strength[run])]]) for run in runs)
