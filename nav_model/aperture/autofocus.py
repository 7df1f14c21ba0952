"""Autofocus as a linear measure of the phase over an aperture, and the error that it adds. [S-9], [S-10]

The measure has weights on the variances of the line-of-sight error's quadratic, of its cubic and of the rest beyond a
polynomial of order 3. An autofocus never removes the line.
"""

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from nav_model.base.arrays import Array

KINDS = "quadratic", "cubic", "detrended"
"""Measures: the coefficients of x² and x³, and the mean square over the aperture with the line out."""
_POINTS, _WEIGHTS = legendre.leggauss(5)
_ORDER_3 = 1 / 6930  # mean square beyond order 3 of white noise integrated twice, over its density times T³ [S-6]
_QUADRATIC, _CUBIC = 1 / 64 * 10 / 7, 25 / 4 * 7 / 3960  # of that noise [S-5], [S-6]
_CLUTTER, _LEAST_PEAK = 9.0, 16.0  # of map drift, as simulated
_BETWEEN = 2 / 3  # variance of lines between independent phases, over that of each


class Residual(NamedTuple):
    """Residual after an autofocus, an element for each of `KINDS`.

    ``quadratic``, ``cubic`` and ``beyond`` are weights on the variances of the quadratic, of the cubic and of what a
    polynomial of order 3 leaves; ``white`` and ``walk`` what is left of white noise integrated twice (times T³) and
    thrice (times T⁵). A polynomial of ``order`` is removed whole, or nearly so.
    """

    quadratic: Array
    cubic: Array
    beyond: Array
    white: Array
    walk: Array
    order: int


class Noise(NamedTuple):
    """Error that an autofocus adds: 1σ of one estimate [rad], and what its variance is multiplied by to have that of
    each of `KINDS`."""

    sigma: Array
    weights: Array


def after_map_drift(order: int) -> Residual:
    """Residual after a polynomial of order 2 or 3 is removed. [S-6]"""
    cubic = np.array([0, 1, 4 / 175]) if order == 2 else np.zeros(3)
    beyond = np.array([0.0, 0.0, 1.0])
    return Residual(
        np.zeros(3),
        cubic,
        beyond,
        _CUBIC * cubic + _ORDER_3 * beyond,
        25 / 4 * 7 / 61776 * cubic + beyond / 540540,
        order,
    )


@cache
def after_phase_gradient(blocks: int) -> Residual:
    """Residual after straight lines between the means of so many blocks of the aperture are removed. [S-9]"""
    x = ((np.arange(blocks)[:, None] + (1 + _POINTS) / 2) * (2 / blocks) - 1).ravel()
    weight = np.tile(_WEIGHTS / 2 / blocks, blocks)
    centre = (np.arange(blocks) + 0.5) * (2 / blocks) - 1
    # Lines between the centres, carried on to the ends: a line is removed whole.
    before = np.clip(np.searchsorted(centre, x) - 1, 0, blocks - 2)
    share = (x - centre[before]) * blocks / 2
    lines, row = np.zeros((len(x), blocks)), np.arange(len(x))
    lines[row, before], lines[row, before + 1] = 1 - share, share
    polynomials = legendre.legvander(x, 3)
    coefficients = (2 * np.arange(4) + 1)[:, None] * polynomials.T * weight
    rest = np.eye(len(x)) - lines @ np.kron(np.eye(blocks), _WEIGHTS / 2)
    rest -= polynomials[:, :2] @ (coefficients[:2] @ rest)
    early, late = np.minimum.outer(x, x) / 2 + 0.5, np.maximum.outer(x, x) / 2 + 0.5
    noises = early**2 * (3 * late - early) / 6, early**3 * (10 * late**2 - 5 * late * early + early**2) / 120
    # Rows whose squares add up to each measure.
    measures = (
        3 / 2 * coefficients[2:3] @ rest,
        5 / 2 * coefficients[3:4] @ rest,
        np.sqrt(weight)[:, None] * rest,
    )
    quadratic, cubic = (np.array([np.sum((rows @ x**n) ** 2) for rows in measures]) for n in (2, 3))
    white, walk = (np.array([np.sum((rows @ noise) * rows) for rows in measures]) for noise in noises)
    beyond = (white - quadratic * _QUADRATIC - cubic * _CUBIC) / _ORDER_3
    return Residual(quadratic, cubic, np.maximum(beyond, 0.0), white, walk, 3)


def noise_of_phase_gradient(blocks: int, points: Array, contrast: Array) -> Noise:
    """Error of the phase of a block from its range bins, with the line out. [S-10]

    Parameters
    ----------
    blocks : int
    points : array
        Range bins that have a point.
    contrast : array
        Power of a focused point over the mean of its clutter in a cell.
    """
    in_block = contrast / blocks
    whole = (1 + contrast) / (2 * points * blocks * in_block**2)
    without_line = 1 - 2 / blocks
    weights = np.array([45 / 4 / blocks, 175 / 4 / blocks, _BETWEEN * without_line]) / without_line
    return Noise(np.sqrt(whole * without_line), weights)


def noise_of_map_drift(order: int, points: Array, contrast: Array) -> Noise:
    """Error of a polynomial from the shifts between as many looks as its order. [S-10]

    Parameters
    ----------
    order : int
        2 or 3.
    points, contrast : array
        As `noise_of_phase_gradient`; clutter differs from look to look, so that points make the coherence.
    """
    in_look = contrast / order
    coherence = in_look / (1 + in_look)
    shift = np.sqrt(3 / (2 * points)) * np.sqrt(1 - coherence**2) / (math.pi * coherence)  # between two looks, cells
    # Magnitudes are correlated: clutter of one look against that of the other adds, and hides the peak at last.
    shift = shift * np.sqrt(1 + _CLUTTER / in_look**2)
    hidden = np.real(in_look * np.sqrt(points)) < _LEAST_PEAK
    shift = np.where(hidden, 2 * order**2 / math.sqrt(3), shift)  # anywhere within the capture
    edges = np.linspace(-1, 1, order + 1)
    # Mean slopes of x² and x³ over a look, in its cells; the mean of all is a shift of the image.
    slopes = np.stack([np.diff(edges**n) / np.diff(edges) for n in range(2, order + 1)], axis=1) / (math.pi * order)
    slopes -= slopes.mean(axis=0)
    covariance = np.linalg.inv(slopes.T @ slopes) / 2
    quadratic, cubic = covariance[0, 0], covariance[1, 1] if order == 3 else 0.0
    detrended = 4 / 45 * quadratic + 4 / 175 * cubic
    return Noise(shift * math.sqrt(detrended), np.array([quadratic, cubic, detrended]) / detrended)
