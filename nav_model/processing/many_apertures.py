"""Integrals of a spectrum over thousands of apertures, for maps where both axes change the aperture.

Between apertures at which the end of a filter's oscillation, or a limit of the main lobe, passes a point of the
table, an integral is an analytic function of the aperture, whose oscillation is that of the points below: a few
Chebyshev polynomials have it to rounding. Where the delay changes too, as the echo's way does with range, its effect
at the low frequencies that an aperture resolves is a power series in the delay.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.polynomial import chebyshev

from nav_model.base.arrays import Array
from nav_model.processing.aperture_filter import OSCILLATING

_RATIO = 2.0  # between the ends of a piece, at most
_SMOOTH = 26  # polynomials beside those that the oscillation over a piece takes
_ROUNDING = 1e-15


def by_pieces(direct: Callable[[Array], Array], apertures: Array, points: Array, limits: tuple[float, ...]) -> Array:
    """Integrals over many apertures, computed at as few as needed and interpolated, or at all where that saves
    nothing.

    Parameters
    ----------
    direct : callable
        Apertures (n,) [s] to integrals (n, m).
    apertures : array (n,)
        Rising, real.
    points : array
        Frequencies [Hz] at which the spectrum begins, bends and ends.
    limits : tuple of float
        Products of frequency and aperture at which an integral or its filter ends.

    Returns
    -------
    array (n, m)
    """
    least, most = float(apertures[0]), float(apertures[-1])
    far = OSCILLATING / math.pi
    bends = np.outer((far, *limits), 1 / points).ravel()
    ends = np.unique([least, *bends[(bends > least) & (bends < most)], most])
    ends = np.unique([
        end
        for low, high in pairwise(ends)
        for end in np.geomspace(low, high, 2 + int(math.log(high / low) / math.log(_RATIO)))
    ])  # fmt: skip
    # Half the phase that the fastest oscillation turns through over a piece is how many polynomials it takes.
    fastest = np.array([np.max(points[points <= far / high * (1 + 1e-9)], initial=0.0) for high in ends[1:]])
    sizes = np.asarray(np.ceil(math.pi * fastest * np.diff(ends)), int) + _SMOOTH
    if 2 * np.sum(sizes) > len(apertures):
        return direct(apertures)
    middle, half = (np.log(ends[1:]) + np.log(ends[:-1])) / 2, np.diff(np.log(ends)) / 2
    nodes = [chebyshev.chebpts1(size) for size in sizes]
    values = direct(np.exp(np.concatenate([m + h * x for m, h, x in zip(middle, half, nodes, strict=True)])))
    found = np.empty((len(apertures), values.shape[1]))
    places = np.searchsorted(apertures, ends)
    places[-1] = len(apertures)
    for k, here in enumerate(np.split(values, np.cumsum(sizes)[:-1])):
        rows = slice(places[k], places[k + 1])
        series = 2 / sizes[k] * chebyshev.chebvander(nodes[k], sizes[k] - 1).T @ here
        series[0] /= 2
        found[rows] = chebyshev.chebvander((np.log(apertures[rows]) - middle[k]) / half[k], sizes[k] - 1) @ series
    return found


def echo_terms(phase: float) -> Array:
    """Coefficients of 4 sin²(w τ/2) in powers of (w τ)², from the first, for a phase w τ up to this one [rad].

    Examples
    --------
    >>> phase, terms = 0.2, echo_terms(0.2)
    >>> off = sum(term * phase ** (2 * k + 2) for k, term in enumerate(terms)) / (4 * np.sin(phase / 2) ** 2) - 1
    >>> bool(abs(off) < 1e-14)
    True
    """
    terms = [1.0]
    while abs(terms[-1]) * phase ** (2 * len(terms) - 2) > _ROUNDING:
        terms.append(-terms[-1] / ((2 * len(terms) + 1) * (2 * len(terms) + 2)))
    return np.array(terms)
