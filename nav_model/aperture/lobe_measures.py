"""Measures of a sampled power response: width, side-lobe ratios, peak and shift (see impulse_response).

A response is sampled `padding` times to a cell; places are fractional indices, energies are in cells.
"""

import numpy as np

from nav_model.base.arrays import Array

ISLR_NULL_DISTANCES = 10
# Two halves of a split lobe are equally high to rounding; samples this close to the top are ties.
TIE = 1 - 1e-9


def measure_periodic(power: Array, padding: int, null: float, samples: int) -> tuple[float, ...]:
    """Measures of a power response that is known over a whole period; as `measure_line`.

    Parameters
    ----------
    power : array (samples × padding,)
        Of one period.
    padding : int
        Points a cell.
    null : float
        Cells from the peak to the first null of the error-free response.
    samples : int
        Of the aperture.

    Raises
    ------
    ValueError
        For an aperture of zeros.
    """
    length = len(power)
    highest = float(power.max())
    if highest == 0.0:
        raise ValueError("aperture: all samples are zero; there is no response to measure")
    peak = int((power >= highest * TIE).argmax())
    middle = length // 2
    cut = (peak - middle) % length
    centred = np.concatenate([power[cut:], power[:cut]])
    signed = peak if peak < length - middle else peak - length
    return measure_line(centred, middle, padding, null, float(power.sum()) / padding, middle - signed)


def measure_line(
    power: Array, peak: int, padding: int, null: float, total_energy: float, origin: int
) -> tuple[float, ...]:
    """Measures of a sampled power response about its peak.

    Parameters
    ----------
    power : array
        Samples.
    peak, origin : int
        Index of the peak, and of zero shift.
    padding : int
        Points a cell.
    null : float
        Cells from the peak to the first null of the error-free response.
    total_energy : float
        Of the whole period, in cells.
    """
    offset, top = _vertex(power, peak)
    centre = peak + offset
    half = top / 2

    left, right = _crossings(power, peak, half)
    outer_left, outer_right = _outermost(power, half)

    rising = np.flatnonzero(power[peak + 1 :] > power[peak:-1])
    right_minimum = peak + (int(rising[0]) if len(rising) else len(power) - 1 - peak)
    falling = np.flatnonzero(power[:peak] > power[1 : peak + 1])
    left_minimum = int(falling[-1]) + 1 if len(falling) else 0
    minima = (left_minimum + _lowest(power, left_minimum), right_minimum + _lowest(power, right_minimum))
    fixed = (centre - null * padding, centre + null * padding)

    results = []
    for low, high in (minima, fixed):
        lobe = _energy(power, low, high) / padding
        reach = ISLR_NULL_DISTANCES * max(centre - low, high - centre)
        near = _energy(power, low - reach, high + reach) / padding
        side = _highest_outside(power, low, high)
        energies = (total_energy / lobe - 1, near / lobe - 1)
        results.append((_decibels(side / top), _decibels(energies[0]), _decibels(energies[1])))
    (pslr_null, islr_null, ten_null), (pslr_fixed, islr_fixed, ten_fixed) = results
    return (
        (right - left) / padding,
        (outer_right - outer_left) / padding,
        pslr_null,
        pslr_fixed,
        islr_null,
        islr_fixed,
        ten_null,
        ten_fixed,
        _decibels(top),
        (centre - origin) / padding,
    )


def _decibels(ratio: float) -> float:
    return float(10 * np.log10(ratio)) if ratio > 0 else -np.inf


def _vertex(power: Array, index: int) -> tuple[float, float]:
    """Offset and height of the parabola through a sampled maximum and its neighbours."""
    if not 0 < index < len(power) - 1:
        return 0.0, float(power[index])
    before, here, after = float(power[index - 1]), float(power[index]), float(power[index + 1])
    bend = before - 2 * here + after
    if bend >= 0:
        return 0.0, here
    offset = (before - after) / (2 * bend)
    return offset, here - (before - after) * offset / 4


def _lowest(power: Array, index: int) -> float:
    """Offset of the true minimum from a sampled one: where the fourth-order slope vanishes."""
    if not 3 <= index < len(power) - 3:
        return 0.0
    p: list[float] = power[index - 3 : index + 4].tolist()
    slope = [(8 * (p[i + 1] - p[i - 1]) - (p[i + 2] - p[i - 2])) / 12 for i in (2, 3, 4)]
    if not slope[0] < slope[1] < slope[2]:
        return 0.0
    first = slope[1] * slope[2] / ((slope[0] - slope[1]) * (slope[0] - slope[2]))
    last = slope[0] * slope[1] / ((slope[2] - slope[0]) * (slope[2] - slope[1]))
    return max(-1.0, min(1.0, last - first))


def _crossings(power: Array, peak: int, half: float) -> tuple[float, float]:
    below_right = np.flatnonzero(power[peak:] < half)
    below_left = np.flatnonzero(power[: peak + 1] < half)
    right = _cross(power, peak + int(below_right[0]), -1, half) if len(below_right) else float(len(power))
    left = _cross(power, int(below_left[-1]), 1, half) if len(below_left) else 0.0
    return left, right


def half_power_places(power: Array, peak: int) -> tuple[float, float]:
    """Indices of the outermost crossings of half the peak."""
    return _outermost(power, _vertex(power, peak)[1] / 2)


def _outermost(power: Array, half: float) -> tuple[float, float]:
    above = np.flatnonzero(power > half)
    first, last = int(above[0]), int(above[-1])
    left = _cross(power, first - 1, 1, half) if first > 0 else 0.0
    right = _cross(power, last + 1, -1, half) if last < len(power) - 1 else float(len(power))
    return left, right


def _cross(power: Array, below: int, step: int, half: float) -> float:
    """Index where the response crosses `half` between sample `below` and the next one in direction `step`.

    Cubic inverse interpolation through four samples where they are monotone, linear where they are not.
    """
    indices = [below - step, below, below + step, below + 2 * step]
    if min(indices) >= 0 and max(indices) < len(power):
        values = [float(power[i]) for i in indices]
        if values[0] < values[1] < values[2] < values[3]:
            place = 0.0
            for i in range(4):
                term = float(indices[i])
                for j in range(4):
                    if j != i:
                        term *= (half - values[j]) / (values[i] - values[j])
                place += term
            if min(indices[1:3]) <= place <= max(indices[1:3]):
                return place
    low, high = float(power[below]), float(power[below + step])
    return below + step * (half - low) / (high - low)


def _energy(power: Array, low: float, high: float) -> float:
    """Integral between two fractional indices, clipped to the line.

    Trapezoids with the Euler-Maclaurin end correction between whole samples, local parabolas for the rest.
    """
    low, high = max(low, 0.0), min(high, len(power) - 1.0)
    first, last = round(low), round(high)
    start, start_slope, start_bend = _parabola(power, first)
    end, end_slope, end_bend = _parabola(power, last)
    total = float(power[first : last + 1].sum()) - (float(power[first]) + float(power[last])) / 2
    total -= (end_slope - start_slope) / 12
    before, after = first - low, high - last
    total += start * before - start_slope * before**2 / 2 + start_bend * before**3 / 6
    return total + end * after + end_slope * after**2 / 2 + end_bend * after**3 / 6


def _parabola(power: Array, index: int) -> tuple[float, float, float]:
    """Value, slope and second difference at a sample, per sample."""
    inner = min(max(index, 1), len(power) - 2)
    before, here, after = float(power[inner - 1]), float(power[inner]), float(power[inner + 1])
    return float(power[index]), (after - before) / 2, before - 2 * here + after


def _between(power: Array, place: float) -> float:
    index = round(min(max(place, 0.0), len(power) - 1.0))
    value, slope, bend = _parabola(power, index)
    return value + slope * (place - index) + bend * (place - index) ** 2 / 2


def _highest_outside(power: Array, low: float, high: float) -> float:
    """The largest power at or outside the interval: a shoulder cut by the interval counts at the cut."""
    best = 0.0
    if low > 0:
        outside = power[: int(low) + 1]
        index = int(outside.argmax())
        best = max(best, _between(power, low), _vertex(outside, index)[1])
    if high < len(power) - 1:
        outside = power[int(np.ceil(high)) :]
        index = int(outside.argmax())
        best = max(best, _between(power, high), _vertex(outside, index)[1])
    return best
