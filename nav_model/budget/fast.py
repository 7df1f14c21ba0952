"""Vibration, unsensed motion and oscillator of a design, as lines and spectra seen through its aperture."""

import math
from collections.abc import Callable, Iterable, Mapping
from functools import lru_cache

import numpy as np

from nav_model.aperture.impulse_response import aperture_positions
from nav_model.aperture.window import ideal_null_cells, weights_of
from nav_model.base.arrays import Array
from nav_model.base.constants import SPEED_OF_LIGHT
from nav_model.base.frozen import FrozenMapping
from nav_model.design import Design
from nav_model.design.motion import Motion, Oscillator
from nav_model.design.rows import Row
from nav_model.processing import paired_echo
from nav_model.processing.fast_motion import Curve, Fast, Source, density_of, through_aperture

VIBRATION, UNSENSED, OSCILLATOR = "vibration", "unsensed motion", "oscillator"
"""Names of the sources in every budget."""

Value = Callable[[str], Array]


def fast_sources(design: Design, value: Value, wavelength: Array, aperture: Array) -> Mapping[str, Fast]:
    """Every source that the design has, over its aperture.

    Parameters
    ----------
    design : Design
        Its motion, oscillator and window.
    value : callable
        Dotted key -> an input's number or array.
    wavelength, aperture : array
        m and s.
    """
    numbers = {key: value(key) for key in _NUMBERS if design[key] is not None}
    numbers |= {"wavelength": wavelength, "aperture": aperture}
    parts = design.motion, design.oscillator, design.radar.window
    if all(number.ndim == 0 and number.dtype == float for number in numbers.values()):
        return _of_one(*parts, tuple((key, float(number)) for key, number in numbers.items()))
    return _through(*parts, numbers)


_NUMBERS = ("motion.delay", "imu.bandwidth", "oscillator.frequency", "radar.slant_range")
"""Inputs of the sources beside their tables, the wavelength and the aperture."""


@lru_cache(maxsize=64)
def _of_one(
    motion: Motion, oscillator: Oscillator, window: str, numbers: tuple[tuple[str, float], ...]
) -> Mapping[str, Fast]:
    """Fast sources of one design, cached by the parts they depend on."""
    by_source = _through(motion, oscillator, window, {key: np.asarray(number) for key, number in numbers})
    for effect in by_source.values():
        effect.frequency.flags.writeable = effect.amplitude.flags.writeable = False
    return by_source


def _through(motion: Motion, oscillator: Oscillator, window: str, numbers: Mapping[str, Array]) -> Mapping[str, Fast]:
    sources = _sources(motion, oscillator, numbers)
    lobe = ideal_null_cells(window) if sources else 1.0
    return FrozenMapping(
        {name: through_aperture(source, numbers["aperture"], lobe) for name, source in sources.items()}
    )


def scattered_floor(design: Design, cells: Array, wavelength: float, aperture: float, exponent: float) -> Array:
    """Mean power that the spectra scatter to places of the azimuth response, over the error-free peak. [P-11]

    Zero within the main lobe; a spectrum is taken as even over the width of the lobe.

    Parameters
    ----------
    design : Design
    cells : array
        Places in cells from the target.
    wavelength, aperture : float
        m, s.
    exponent : float
        Variance of the phase that is scattered, rad².

    Returns
    -------
    array
        As `cells`.
    """
    away = np.abs(cells)
    beside = away > ideal_null_cells(design.radar.window)
    frequency = np.where(beside, away, 1.0) / aperture
    numbers = {key: np.asarray(design[key], float) for key in _NUMBERS if design[key] is not None}
    sources = _sources(design.motion, design.oscillator, numbers | {"wavelength": np.asarray(wavelength)})
    density = sum((density_of(source, frequency) for source in sources.values()), start=0 * cells)
    weights = weights_of(design.radar.window, aperture_positions(1024))
    wide = np.mean(weights**2) / np.mean(weights) ** 2  # energy of the lobe over its peak, cells
    share = -math.expm1(-exponent) / exponent if exponent else 1.0
    one_side = (4 * math.pi / wavelength) ** 2 * density / 2 / aperture
    return np.where(beside, share * wide * one_side, 0.0)


def _sources(motion: Motion, oscillator: Oscillator, numbers: Mapping[str, Array]) -> dict[str, Source]:
    none = np.zeros(0)
    sources: dict[str, Source] = {}
    bandwidth = numbers.get("imu.bandwidth")
    if (motion.lines or motion.spectrum) and (bandwidth is not None or np.any(numbers["motion.delay"] != 0)):
        sources[VIBRATION] = Source(
            *_lines(motion.lines),
            accelerations=_curve(motion.spectrum),
            delay=numbers["motion.delay"],
            bandwidth=bandwidth,
        )
    if motion.unsensed_lines or motion.unsensed_spectrum:
        curve = _curve(motion.unsensed_spectrum)
        accelerations = motion.unsensed_spectrum and motion.unsensed_spectrum[0][2] == "acceleration density"
        sources[UNSENSED] = Source(
            *_lines(motion.unsensed_lines),
            accelerations=curve if accelerations else None,
            displacements=None if accelerations else curve,
        )
    if (curve := _curve(oscillator.phase_noise)) is not None:
        times = (
            1.0
            if oscillator.frequency is None
            else SPEED_OF_LIGHT / numbers["wavelength"] / numbers["oscillator.frequency"]
        )
        sources[OSCILLATOR] = Source(
            none,
            none,
            displacements=Curve(curve.frequency, 2 * curve.density),  # both sidebands
            delay=None if oscillator.bistatic else 2 * numbers["radar.slant_range"] / SPEED_OF_LIGHT,
            scale=times * numbers["wavelength"] / (4 * math.pi),
        )
    return sources


def rectified(design: Design, value: Value) -> Array | None:
    """Accelerometer bias that vibration makes [m/s²], None without vibration or a figure for it. [P-12]"""
    motion = design.motion
    if not (motion.lines or motion.spectrum):
        return None
    curve = _curve(motion.spectrum)
    square = sum(
        (amount if kind == "acceleration" else amount * (2 * math.pi * frequency) ** 2) ** 2 / 2
        for frequency, amount, kind in motion.lines
    )
    bias = value("motion.rectification") * (square + (0.0 if curve is None else curve.variance))
    return bias if np.any(bias != 0) else None


def not_flown(design: Design) -> tuple[str, ...]:
    """A sentence on what simulated runs and flights omit of a design's budget; empty if nothing."""
    motion = design.motion
    given = {
        VIBRATION: motion.lines or motion.spectrum,
        UNSENSED: motion.unsensed_lines or motion.unsensed_spectrum,
        OSCILLATOR: design.oscillator.phase_noise,
    }
    if not (uncounted := [name for name, rows in given.items() if rows]):
        return ()
    return (f"The runs leave out the design's {', '.join(uncounted)}; the Budget page includes them [P-8].",)


def levels(
    effects: Iterable[Fast], to_phase: Array, aperture: Array, window: str, estimated: Array | float = 0.0
) -> dict[str, Array]:
    """Amplitudes over a target's, by figure: the highest paired echo, and the root of the scattered energy.

    Parameters
    ----------
    effects : iterable of Fast
        Sources.
    to_phase : array
        Two-way phase of a metre, rad.
    aperture : array
        Seconds.
    window : str
        Weighting.
    estimated : array or float
        Variance of the phase [rad²] that an autofocus scatters by its error of estimation.
    """
    sources, lobe = tuple(effects), ideal_null_cells(window)
    exponent = estimated + paired_echo.scatter_exponent(sources, to_phase, aperture, lobe)
    return {
        "paired_echo": paired_echo.highest_echo(sources, to_phase, aperture, lobe),
        "islr": paired_echo.scattered_ratio(exponent),
    }


def power_at_target(effects: Iterable[Fast], to_phase: Array, aperture: Array, window: str) -> tuple[Array, Array]:
    """Power that stays at a target, and the same with only the errors within ten null distances.

    Parameters
    ----------
    effects, to_phase, aperture, window
        As `levels`.
    """
    sources, lobe = tuple(effects), ideal_null_cells(window)
    near = paired_echo.scatter_exponent(sources, to_phase, aperture, lobe, "near")
    return np.exp(-paired_echo.scatter_exponent(sources, to_phase, aperture, lobe)), np.exp(-near)


def _lines(rows: tuple[Row, ...]) -> tuple[Array, Array]:
    """Frequencies [Hz] and displacements [m]."""
    frequency = np.array([row[0] for row in rows])
    amount = [amount if kind == "length" else amount / (2 * math.pi * at) ** 2 for at, amount, kind in rows]
    return frequency, np.array(amount)


def _curve(rows: tuple[Row, ...]) -> Curve | None:
    return Curve(np.array([row[0] for row in rows]), np.array([row[1] for row in rows])) if rows else None
