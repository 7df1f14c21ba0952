"""Sources of line-of-sight error given as lines and spectra, filtered by the aperture. [P-5], [P-8]

Frequencies in Hz, one-sided densities: a variance is the integral of a density over the frequencies above zero.
Everything broadcasts over arrays of apertures, delays and bandwidths, and takes complex steps.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import Array
from nav_model.processing import compensation
from nav_model.processing.aperture_filter import AVERAGES, OSCILLATING, filters
from nav_model.processing.compensation import power_left

NEAR_CELLS = 11.0
"""Null distances from the peak to the end of the ten beyond the main lobe."""

_FILTERS = ("quadratic", "cubic", "left_1", "left_2", "left_3", "mean", "slope")
_STEPS_X = (1.0, 2.0, 3.5, 5.0, *np.linspace(7.5, OSCILLATING, 14))  # as many as the filters' oscillation needs
_STEPS_DELAY = np.linspace(0, compensation.OSCILLATING, 21)[1:]
_FEW_PERIODS = 16
_INNER = np.linspace(0, 1, 2 * _FEW_PERIODS + 1)[1:-1]
_RISE = 4.0  # between the ends of a panel, where nothing oscillates
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
_ROWS = 256  # designs computed together: bounds the memory
_NEVER = 1e-300


@dataclass(frozen=True)
class Curve:
    """Density at rising frequencies [Hz], linear between them in logarithms, zero outside. Real."""

    frequency: Array
    density: Array

    @property
    def variance(self) -> float:
        """The integral of the density, exact."""
        span, slope = np.diff(np.log(self.frequency)), self._slopes
        area = self.frequency[:-1] * self.density[:-1] * span
        z = (slope + 1) * span
        return float(np.sum(area * np.where(np.abs(z) < 1e-9, 1.0, np.expm1(z) / np.where(z == 0, 1.0, z))))

    @property
    def _slopes(self) -> Array:
        return np.diff(np.log(self.density)) / np.diff(np.log(self.frequency))

    def split(self, frequency: float) -> tuple[Curve, Curve]:
        """Below a frequency between the first and the last, and above it."""
        here = self.at(np.searchsorted(self.frequency, [frequency]) - 1, np.log([frequency]))
        low, high = self.frequency < frequency, self.frequency > frequency
        return (
            Curve(np.append(self.frequency[low], frequency), np.append(self.density[low], here)),
            Curve(np.insert(self.frequency[high], 0, frequency), np.insert(self.density[high], 0, here)),
        )

    def at(self, place: NDArray[np.intp], logarithm: Array) -> Array:
        """Density at frequencies given by their logarithm, each in the interval that begins at `place`."""
        away = logarithm - np.log(self.frequency)[place]
        return np.asarray(np.exp(np.log(self.density)[place] + self._slopes[place] * away))


@dataclass(frozen=True)
class Source:
    """Displacement along the line of sight: lines, spectra, and their compensation.

    ``frequency`` [Hz] and ``amplitude`` [m, peak] are those of the lines, ``accelerations`` and ``displacements``
    curves in (m/s²)²/Hz and m²/Hz, ``scale`` what amplitudes are multiplied by. ``delay`` [s] and ``bandwidth``
    [Hz] are those of `power_left`; without a delay nothing is taken off.
    """

    frequency: Array
    amplitude: Array
    accelerations: Curve | None = None
    displacements: Curve | None = None
    delay: Array | None = None
    bandwidth: Array | None = None
    scale: Array | None = None


@dataclass(frozen=True)
class Fast:
    """Variances of the line of sight over an aperture from a source, m²: as `nav_model.processing.aperture_filter`.

    ``scattered`` is the variance of the spectrum beyond the main lobe, ``near`` the part of it within ten null
    distances. ``frequency`` and ``amplitude`` [Hz, m, on the last axis] are of the lines, with what is taken off.
    """

    quadratic: Array
    cubic: Array
    left_1: Array
    left_2: Array
    left_3: Array
    mean: Array
    slope: Array
    scattered: Array
    near: Array
    frequency: Array
    amplitude: Array

    def scaled(self, factor: Array) -> Fast:
        """Copy of the source with its amplitudes multiplied."""
        changed = {name: getattr(self, name) * factor**2 for name in (*_FILTERS, "scattered", "near")}
        return replace(self, amplitude=self.amplitude * np.asarray(factor)[..., None], **changed)


def through_aperture(source: Source, aperture: Array, lobe: float) -> Fast:
    """Filter a source by an aperture.

    Parameters
    ----------
    source : Source
    aperture : array
        Seconds.
    lobe : float
        Cells from the peak of the response to its first null: slower errors blur, faster ones scatter.
    """
    variances = dict.fromkeys((*_FILTERS, "scattered", "near"), 0 * aperture)
    w = 2 * np.pi * source.frequency
    power = 1.0 if source.delay is None else power_left(
        w, source.delay[..., None], None if source.bandwidth is None else source.bandwidth[..., None]
    )  # fmt: skip
    amplitude = source.amplitude * np.sqrt(power + _NEVER) + 0 * aperture[..., None]
    if len(w):
        responses = filters(w / 2 * aperture[..., None])
        for name in _FILTERS:
            variances[name] = variances[name] + np.sum(amplitude**2 / 2 * responses[name], axis=-1)
    for curve, order in ((source.accelerations, 4), (source.displacements, 0)):
        if curve is not None:
            for name, part in zip(variances, _integrals(curve, order, source, aperture, lobe), strict=True):
                variances[name] = variances[name] + part
    result = Fast(**variances, frequency=source.frequency, amplitude=amplitude)
    return result if source.scale is None else result.scaled(source.scale)


def density_of(source: Source, frequency: Array) -> Array:
    """One-sided density of the spectra of a source, with what is taken off, of one design; zero outside them. [P-8]

    Parameters
    ----------
    source : Source
    frequency : array
        Hz, above zero.

    Returns
    -------
    array
        m²/Hz.
    """
    w: Array = 2 * np.pi * frequency
    total: Array = 0 * frequency
    for curve, power in ((source.accelerations, 4), (source.displacements, 0)):
        if curve is not None:
            inside = (frequency >= curve.frequency[0]) & (frequency <= curve.frequency[-1])
            density = curve.at(_interval(curve, frequency), np.log(frequency))
            total = total + np.where(inside, density, 0.0) / w**power
    remaining = 1.0 if source.delay is None else power_left(w, source.delay, source.bandwidth)
    return np.asarray(total * remaining * (1.0 if source.scale is None else source.scale**2))


def _interval(curve: Curve, frequency: Array) -> NDArray[np.intp]:
    """In which interval of the table frequencies lie, from 0."""
    return np.clip(np.searchsorted(curve.frequency, frequency) - 1, 0, len(curve.frequency) - 2)


def _integrals(curve: Curve, power: int, source: Source, aperture: Array, lobe: float) -> Sequence[Array]:
    """Integrals of a curve over w to this power, less what is taken off, against each filter of `Fast`."""
    columns = np.broadcast_arrays(aperture, *(x for x in (source.delay, source.bandwidth) if x is not None))
    table = np.stack(columns, axis=-1).reshape(-1, len(columns))
    # Most arrays of designs differ in other inputs: each kind of aperture is integrated once.
    kinds, place = np.unique(table, axis=0, return_inverse=True)
    parts = np.array_split(kinds, -(-len(kinds) // _ROWS))
    whole = np.concatenate([_rows(curve, power, rows, lobe) for rows in parts])
    return [column.reshape(columns[0].shape) for column in whole[place.reshape(-1)].T]


def _rows(curve: Curve, power: int, rows: Array, lobe: float) -> Array:
    """Integrals of one curve, a row per different aperture: aperture [s] and, where there are any, delay [s] and
    bandwidth [Hz]. Columns are those of `_FILTERS`, and the variance beyond the lobe and near it."""
    aperture, *others = rows.T
    delay, bandwidth = (*others, None, None)[:2]
    # Panels end where the curve bends, where the filters or the delay oscillate, and at the lobe.
    low, high = float(curve.frequency[0]), float(curve.frequency[-1])
    fill = np.geomspace(low, high, 2 + int(math.log(high / low) / math.log(_RISE)))
    moving = np.concatenate([_STEPS_X, [math.pi * lobe, math.pi * lobe * NEAR_CELLS]]) / (np.pi * aperture[:, None])
    if delay is not None:
        late = np.where(delay.real > 0, delay, 1 / _NEVER)[:, None]  # infinity has no product with a complex step
        moving = np.concatenate([moving, _STEPS_DELAY / (2 * np.pi * late)], axis=1)
    few_x, inner = _narrow(curve, aperture.real, OSCILLATING / math.pi)
    moving = np.concatenate([moving, inner], axis=1)
    if delay is not None:
        few_delay, inner = _narrow(curve, delay.real, compensation.OSCILLATING / (2 * math.pi))
        moving = np.concatenate([moving, inner], axis=1)
    moving = np.where(moving.real < low, low, np.where(moving.real > high, high, moving))
    fixed = np.broadcast_to(np.concatenate([curve.frequency, fill]), (len(rows), len(curve.frequency) + len(fill)))
    # Every row has its own panels in log f; those of no width are left out, so that the rest are one long list.
    edges = np.log(np.sort(np.concatenate([fixed, moving], axis=1), axis=1))
    row, panel = np.nonzero(np.diff(edges.real, axis=1) > 0)
    first, last = edges[row, panel], edges[row, panel + 1]
    # Gauss and Legendre's rule on every panel: df = f d(log f).
    logarithm = ((first + last) / 2)[:, None] + ((last - first) / 2)[:, None] * _NODES
    f = np.exp(logarithm)
    weight = ((last - first) / 2)[:, None] * _WEIGHTS * f
    middle = np.exp(((first + last) / 2).real)
    place = _interval(curve, middle)
    w = 2 * np.pi * f
    # Density of displacement at the nodes, times their weights: that of acceleration over w⁴, less what is
    # compensated. Far beyond the first oscillations with the delay their mean serves.
    density = weight * curve.at(place[:, None], logarithm)
    if power:
        density /= (w**2) ** (power // 2)
    if delay is not None:
        wide = None if bandwidth is None else bandwidth[row, None]
        averaged = (2 * np.pi * middle * delay[row].real > compensation.OSCILLATING) & ~few_delay[row, place]
        for where, mean in ((averaged, True), (~averaged, False)):
            density[where] *= power_left(
                w[where], delay[row[where], None], None if wide is None else wide[where], mean=mean
            )
    # Over many oscillations a filter is a constant and a part that falls with x²: two sums serve them all.
    x = w / 2 * aperture[row, None]
    far = (np.pi * middle * aperture[row].real > OSCILLATING) & ~few_x[row, place]
    whole, falling = density.sum(axis=1), np.sum(density[far] / x[far] ** 2, axis=1)
    resolved, near = density[~far], filters(x[~far])
    cells = middle * aperture[row].real
    integrals = np.zeros((len(rows), len(_FILTERS) + 2), density.dtype)
    part = np.empty_like(whole)
    for column, name in enumerate(_FILTERS):
        constant, falling_factor = AVERAGES[name]
        part[far] = constant * whole[far] + falling_factor * falling
        part[~far] = np.einsum("ij,ij->i", resolved, near[name])
        np.add.at(integrals[:, column], row, part)
    # What lies beyond the main lobe scatters; near is within ten null distances.
    for column, counted in enumerate((cells > lobe, (cells > lobe) & (cells < NEAR_CELLS * lobe)), len(_FILTERS)):
        np.add.at(integrals[:, column], row, whole * counted)
    return integrals


def _narrow(curve: Curve, time: Array, settled: float) -> tuple[NDArray[np.bool_], Array]:
    """Where a factor that oscillates with f times `time` has few periods, so that its mean says little.

    Intervals of the table, (rows, intervals), of those above `settled` periods; and frequencies that resolve the
    factor there, (rows, n).
    """
    width = np.diff(curve.frequency)
    narrow = (width * time[:, None] < _FEW_PERIODS) & (curve.frequency[1:] * time[:, None] > settled)
    some = np.any(narrow, axis=0)
    inner = curve.frequency[:-1][some, None] + width[some, None] * _INNER
    there = np.where(narrow[:, some, None], inner, curve.frequency[0])
    return narrow, there.reshape(len(time), -1)
