"""Settled filters, and the information of many fixes, by doubling a segment of flight.

States are position, velocity, acceleration by tilt, and the slow error of the fixes where there is one, then three of
the sensors where their biases vary (`nav_model.analytic.channel`): n is 3 or 4, or 6 or 7.
With a slow error the first state is position and slow error together, as a position fix measures it: the two apart
are known much less well, and their difference would cost digits.

A segment of flight with fixes in it says how its last state x1 follows from its first state x0,

    x1 = Phi x0 + (what the fixes say) + w,    w of covariance Q,

and how much information Y the fixes have about x0. With information Y1 about x1 besides, and K = (1 + Q Y1)⁻¹, it is

    Phi -> K Phi,    Q -> K Q,    Y -> Y + Phiᵀ Y1 K Phi

Two segments in a row are a segment again, so n equal ones take as many steps as n has binary digits, and a filter
settles in about fifteen steps. Matrices are on the last two axes, the designs on those before; everything takes
complex steps.

Source: the doubling algorithm, Anderson and Moore, *Optimal Filtering*, 1979, section 6.7; Chu, Fan, Lin and Wang,
Int. J. Control 77(8), 2004.
"""

from collections.abc import Callable
from functools import cache
from typing import Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nav_model.analytic.rise import rise
from nav_model.base.arrays import Array, as_numbers

_MOST_DOUBLINGS = 60
_SETTLED = 1e-8  # relative change by the last doubling: each squares what is missing, so 1e-16 is missing then

Counts = NDArray[np.int64]
Rows = TypeVar("Rows", bound=tuple[Array, ...])


class Segment(NamedTuple):
    """Information Y about the first state, transition Phi to the last one, covariance Q of the noise: (..., n, n)."""

    info: Array
    transition: Array
    noise: Array


def drift(
    step: ArrayLike,
    accelerometer: ArrayLike,
    gyro: ArrayLike,
    slow: tuple[ArrayLike, ArrayLike] | None = None,
    gradient: ArrayLike | None = None,
) -> Segment:
    """A step without fixes, exact.

    Parameters
    ----------
    step : array_like
        Seconds.
    accelerometer, gyro : array_like
        Densities of the white noises: of velocity random walk [m²/s³], and g² times that of angle random walk
        [m²/s⁵].
    slow : pair of array_like, optional
        Variance of the slow error [m²], its correlation time [s].
    gradient : array_like, optional
        Decrease of gravity with height in a vertical channel, whose gyro noise is zero, 1/s².
    """
    inputs = [as_numbers(value) for value in (step, accelerometer, gyro, *(slow or ()))]
    step, accelerometer, gyro, *markov = inputs
    size = 3 if slow is None else 4
    cosine = sine = twice = as_numbers(1.0)
    by_noise = as_numbers(1 / 3), as_numbers(1 / 2), as_numbers(1.0)
    if gradient is not None:
        gradient = as_numbers(gradient)
        free = rise(gradient, step)
        cosine, sine, twice, by_noise = free.cosine, free.sine, free.twice, free.noise
    shape = np.broadcast_shapes(*(value.shape for value in (*inputs, cosine)))
    phi, noise = np.zeros((2, *shape, size, size), np.result_type(*inputs, cosine))
    # Acceleration by tilt is constant but for the gyro's noise, and is integrated twice.
    phi[..., range(2, size), range(2, size)] = 1
    phi[..., 0, 0] = phi[..., 1, 1] = cosine
    phi[..., 0, 1] = phi[..., 1, 2] = step * sine
    phi[..., 0, 2] = step * step / 2 * twice
    if gradient is not None:
        phi[..., 1, 0] = gradient * step * sine
    # White noise integrated once, twice and three times: Phi(t) diag(0, S_a, S_g) Phi(t)ᵀ over the step.
    a, w = accelerometer * step, gyro * step
    noise[..., 0, 0] = a * step**2 * by_noise[0] + w * step**4 / 20
    noise[..., 0, 1] = noise[..., 1, 0] = a * step * by_noise[1] + w * step**3 / 8
    noise[..., 0, 2] = noise[..., 2, 0] = w * step**2 / 6
    noise[..., 1, 1] = a * by_noise[2] + w * step**2 / 3
    noise[..., 1, 2] = noise[..., 2, 1] = w * step / 2
    noise[..., 2, 2] = w
    # A slow error of the fixes decays; the first state has it too, hence the decay's difference from one in its row.
    if markov:
        variance, time = markov
        phi[..., 3, 3] = np.exp(-step / time)
        phi[..., 0, 3] = np.expm1(-step / time)
        if gradient is not None:  # height alone drives, and the first state has the slow error too
            phi[..., 0, 3] -= free.risen / 2
            phi[..., 1, 3] = -phi[..., 1, 0]
        fresh = -variance * np.expm1(-2 * step / time)
        for i, j in ((0, 0), (0, 3), (3, 0), (3, 3)):
            noise[..., i, j] += fresh
    return Segment(np.zeros_like(noise), phi, noise)


def symmetric(matrix: Array) -> Array:
    """The symmetric part, to remove rounding from matrices that should be symmetric."""
    return (matrix + matrix.mT) * 0.5


def solve_update(covariance: Array, info: Array, b: Array) -> Array:
    """(1 + Q Y)⁻¹ B for a covariance Q and information Y, (..., n, n); with B = Q the covariance that Y leaves of Q.

    NaN where there is no inverse. States are scaled so that Y has ones on its diagonal. Without that, elimination
    loses up to all digits where times of very different length count: a slow error of 30 m under fixes of 3 mm.
    """
    scale = np.sqrt(np.maximum(np.diagonal(info, axis1=-1, axis2=-2).real, 0))[..., None]
    scale = np.where(scale > 0, scale, 1.0)
    matrix = _identity(info.shape[-1]) + scale * (covariance @ info) / scale.mT
    try:
        return np.asarray(np.linalg.solve(matrix, scale * b) / scale)
    except np.linalg.LinAlgError:  # one row beyond double precision must not fail the others
        solution = np.full(np.broadcast_shapes(matrix.shape[:-2], b.shape[:-2]) + b.shape[-2:], np.nan, matrix.dtype)
        regular = np.linalg.det(matrix) != 0
        solution[regular] = np.linalg.solve(matrix[regular], (scale * b)[regular]) / scale[regular]
        return solution


@cache
def _identity(size: int) -> Array:
    return np.eye(size)


def updated(covariance: Array, info: Array) -> Array:
    """Covariance of a state with this information more."""
    return symmetric(solve_update(covariance, info, covariance))


def update_factor(segment: Segment, info: Array) -> Array:
    """K = (1 + Q Y1)⁻¹, with Y1 information about the segment's last state, (..., n, n)."""
    return solve_update(segment.noise, info, _identity(info.shape[-1]))


def measured(segment: Segment, info: Array, k: Array | None = None) -> Segment:
    """The segment with information about its last state; `k` is that of `update_factor`, where it is known."""
    k = update_factor(segment, info) if k is None else k
    phi = k @ segment.transition
    return Segment(segment.info + symmetric(segment.transition.mT @ info @ phi), phi, symmetric(k @ segment.noise))


def joined(first: Segment, second: Segment) -> Segment:
    """One segment after the other: what the second's fixes say of its first state, they say of the first's last."""
    return continued(measured(first, second.info), second)


def continued(first: Segment, second: Segment) -> Segment:
    """The second after a first that has the information of the second's fixes."""
    phi = second.transition
    return Segment(first.info, phi @ first.transition, second.noise + symmetric(phi @ first.noise @ phi.mT))


def without_slow_error(covariance: Array) -> Array:
    """From states with position and slow error together to states with position alone, (..., n, n)."""
    size = covariance.shape[-1]
    if size % 3 == 0:  # position, velocity and acceleration, and further three where a sensor's bias varies
        return covariance
    change = np.eye(size)
    change[0, 3] = -1
    return np.asarray(change @ covariance @ change.T)


def carried(covariance: Array, segment: Segment) -> Array:
    """Covariance of the last state, from that of the first."""
    phi = segment.transition
    return segment.noise + symmetric(phi @ updated(covariance, segment.info) @ phi.mT)


def take(rows: Rows, which: Counts) -> Rows:
    """Some of the designs, which come first in every array."""
    return type(rows)(*(part[which] for part in rows))


def put(rows: Rows, which: Counts, new: Rows) -> Rows:
    """The rows with these replaced by new ones."""
    if len(which) == len(rows[0]):
        return new
    merged = type(rows)(*(part.astype(np.result_type(part, more)) for part, more in zip(rows, new, strict=True)))
    for part, more in zip(merged, new, strict=True):
        part[which] = more
    return merged


class Powers(Generic[Rows]):
    """A unit, two of them in a row, four and so on, each worked out once: `units[3]` is eight of them.

    Designs may share a unit: `which` is the row of each design's, by default its own.
    """

    def __init__(self, unit: Rows, joined: Callable[[Rows, Rows], Rows], which: Counts | None = None) -> None:
        self._powers, self._joined = [unit], joined
        self._which = np.arange(len(unit[0])) if which is None else which

    def __getitem__(self, power: int) -> Rows:
        while len(self._powers) <= power:
            self._powers.append(self._joined(self._powers[-1], self._powers[-1]))
        return self._powers[power]

    def prepend(self, counts: Counts, rows: Rows) -> Rows:
        """So many units in a row, and `rows` after them; (rows, ...), `counts` of (rows).

        As in binary: of 5 units, the single one is put before `rows` first, then the four before both.
        """
        for power in range(int(counts.max(initial=0)).bit_length()):
            odd = np.flatnonzero((counts >> power) % 2)
            if len(odd):
                rows = put(rows, odd, self._joined(take(self[power], self._which[odd]), take(rows, odd)))
        return rows


def settled(units: Powers[Segment]) -> Array:
    """Covariance of the last state after endlessly many such units: of the filter in steady state.

    A design that has settled stays as it is while others go on; one beyond double precision gives no number.

    Examples
    --------
    >>> fix = np.diag([1.0, 0.0, 0.0])  # 1 m
    >>> unit = measured(drift(1.0, (0.05 / 60) ** 2, (9.80665 * np.radians(0.5) / 60) ** 2), fix)
    >>> f"{settled(Powers(unit, joined))[0, 0] ** 0.5:.4f} m just after a fix"
    '0.4489 m just after a fix'
    """
    variances = _variances(units[0].noise)
    for power in range(1, _MOST_DOUBLINGS):
        before, variances = variances, _variances(units[power].noise)
        if np.all(np.abs(variances - before) <= _SETTLED * np.abs(variances)):
            break
    return units[power].noise


def _variances(covariance: Array) -> Array:
    return np.asarray(np.diagonal(without_slow_error(covariance), axis1=-1, axis2=-2))
