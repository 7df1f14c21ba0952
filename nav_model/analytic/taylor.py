"""A linear system under white noise over a time without fixes, by the Taylor series of its transition.

The series is summed over a time that is short beside the system's fastest change, and that time is then doubled. What
white noise makes of the states is a sum of its repeated integrals, which are polynomials with the noise's Legendre
coefficients: covariances are sums of squares, no difference of exponentials costs digits, and complex steps pass.

Source: scaling and doubling, Van Loan, IEEE Trans. Automatic Control 23(3), 1978; the integrals of white noise in
Legendre polynomials are our own addition.
"""

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre

from nav_model.analytic.doubling import Segment, continued
from nav_model.base.arrays import Array

ORDERS = 6
"""Legendre orders of a position error that figures use: 0 to 5."""
TERMS = 11
"""Terms of the series: the rest is 1e-14 of what changes at the fastest rate, 1e-11 of what that drives."""
_LONGEST = 0.25  # part of the fastest time constant that one series spans
_MODES = TERMS + ORDERS  # of white noise: those above add nothing to the first coefficients of its integrals


class System(NamedTuple):
    """dx/dt = F x + W w with white noises w of density one.

    ``dynamics`` is F, (..., n, n), ``drive`` W, (..., n, m), and ``fastest`` the largest rate of change [1/s] beside
    those of plain integration, (...).
    """

    dynamics: Array
    drive: Array
    fastest: Array


class Series(NamedTuple):
    """Terms of a system over a time: ``transition``, (..., TERMS, n, n), by powers of the time as a part of the
    whole, and ``noise``, (..., TERMS, n, m), by the repeated integrals of each noise."""

    transition: Array
    noise: Array


def halvings(system: System, span: Array) -> int:
    """Number of times that the longest span is halved before the series holds for it."""
    longest = float(np.max(np.abs(span * system.fastest), initial=0.0))
    return max(0, math.ceil(math.log2(longest / _LONGEST))) if longest else 0


def series(system: System, span: Array) -> Series:
    """Terms over a span [s], (...)."""
    span = span[..., None, None]
    step, driven = system.dynamics * span, system.drive * np.sqrt(span)
    power = np.broadcast_to(np.eye(step.shape[-1]), step.shape)
    powers = np.empty((*power.shape[:-2], TERMS, *power.shape[-2:]), step.dtype)
    noises = np.empty((*driven.shape[:-2], TERMS, *driven.shape[-2:]), driven.dtype)
    powers[..., 0, :, :], noises[..., 0, :, :] = power, driven
    for term in range(1, TERMS):
        powers[..., term, :, :] = step @ powers[..., term - 1, :, :] / term
        noises[..., term, :, :] = step @ noises[..., term - 1, :, :]
    return Series(powers, noises)


def segment(terms: Series) -> Segment:
    """The segment of flight that the terms are of."""
    transition, ends = terms.transition.sum(axis=-3), noise_at_end(terms)
    flat = ends.reshape(*ends.shape[:-2], -1)
    noise = flat @ flat.mT
    return Segment(np.zeros_like(noise), transition, noise)


def noise_at_end(terms: Series) -> Array:
    """State at the end by the modes of each noise, (..., n, m, TERMS): its square is the covariance."""
    return np.moveaxis(terms.noise, -3, -1) @ integrals().ends


def drift(system: System, span: Array) -> Segment:
    """A span [s] without fixes, (...).

    Examples
    --------
    >>> markov = System(np.array([[-1.0]]), np.array([[2.0**0.5]]), np.array(1.0))
    >>> bool(np.isclose(drift(markov, np.array(2.0)).noise[0, 0], 1 - np.exp(-4)))
    True
    """
    count = halvings(system, span)
    part = segment(series(system, span / 2**count))
    for _ in range(count):
        part = continued(part, part)
    return part


class Integrals(NamedTuple):
    """White noise of density one over a time of one, and its repeated integrals, the first to the last of `TERMS`.

    ``lines`` are their coefficients in orthonormal polynomials by the noise's modes, (TERMS, ORDERS, modes), ``ends``
    their values at the end, (TERMS, TERMS), which higher modes do not reach, ``rest`` the mean products of what these
    orders leave of two, (TERMS, TERMS); ``powers`` are the coefficients of the powers of time, (TERMS, ORDERS).
    """

    lines: Array
    ends: Array
    rest: Array
    powers: Array


@cache
def integrals() -> Integrals:
    """Tables of the integrals, each Legendre polynomial being one at the end."""
    modes = np.eye(_MODES) * np.sqrt(2 * np.arange(_MODES) + 1)
    norm = np.sqrt(2 * np.arange(ORDERS) + 1)[:, None]
    repeated = [legendre.legint(modes, count, lbnd=-1, scl=0.5) for count in range(1, TERMS + 1)]
    lines = np.stack([part[:ORDERS] / norm for part in repeated])
    # The m-th integral weighs noise u before by u^(m-1)/(m-1)!: the mean product of two is a plain integral.
    order = np.arange(1, TERMS + 1)
    factorial = np.array([math.factorial(m - 1) for m in order], float)
    both = order[:, None] + order
    product = 1 / (factorial[:, None] * factorial * (both - 1) * both)
    constant = np.eye(ORDERS, 1)
    powers = [
        np.pad(legendre.legint(constant, count, lbnd=-1, scl=0.5), ((0, ORDERS), (0, 0)))[:ORDERS, 0]
        * math.factorial(count)
        for count in range(TERMS)
    ]
    ends = np.stack([part.sum(axis=0)[:TERMS] for part in repeated])
    return Integrals(lines, ends, product - np.einsum("kij,lij->kl", lines, lines), np.stack(powers) / norm[:, 0])
