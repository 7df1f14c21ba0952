"""The smoothed error over an aperture, expanded in modes of the noise, for many designs at once.

Inside the aperture the position error is a parabola from the state at its start and what the white noises of
accelerometer and gyro add. Each noise is a series of Legendre polynomials of time with independent coefficients;
integrated they are polynomials again. The state at the start, the lowest of these coefficients and, where there is
one, the slow error at each fix are the unknowns of a least squares: fixes inside measure them, and the legs know the
states at both ends. Higher coefficients are too fast for the fixes to see and keep the variance they have.
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import legendre

from nav_model.base.arrays import Array

ORDERS = 6
"""Legendre orders of the position error that figures use: 0 to 5."""

_ALL = 9  # modes that reach them
_LEFT = 4  # the lowest order of what is left after order 3
# Quadratics, by the coefficients of orders 0 to 5, of the error, of its turn, and of the square of its turn; cubics.
_QUADRATICS = np.array([[0, 0, 3 / 2, 0, 0, 0], [0, 1, 0, 9 / 14, 0, 0], [1, 0, 11 / 14, 0, 2 / 7, 0]])
_CUBICS = np.array([[0, 0, 0, 5 / 2, 0, 0], [0, 0, 3 / 2, 0, 10 / 9, 0], [0, 1, 0, 23 / 18, 0, 50 / 99]])


class Fixes(NamedTuple):
    """Fixes of one kind inside the aperture: places as parts of it, rising, and one over their variance.

    Both (rows, points); a place with zero has no fix.
    """

    places: Array
    known: Array


class Inside(NamedTuple):
    """One row per design: the drift inside the aperture, and the information about it.

    ``accelerometer`` and ``gyro`` are densities [m²/s³, m²/s⁵], ``aperture`` seconds, ``start`` and ``end`` the
    information of the legs about the states at both ends, (n, n, rows), ``slow`` variance [m²] and correlation time
    [s] of the slow error of the position fixes. States are position, velocity, acceleration by tilt, slow error.
    """

    accelerometer: Array
    gyro: Array
    aperture: Array
    start: Array
    end: Array
    position: Fixes
    velocity: Fixes | None
    slow: tuple[Array, Array] | None


class _Basis(NamedTuple):
    """Legendre coefficients of position and velocity, (modes + 3, 3 + 2 modes), for an aperture of one.

    Columns are the state at the start, then the modes of the accelerometer's noise, then of the gyro's. ``middle``
    and ``end`` are position, velocity and acceleration there, (3, 3 + 2 modes).
    """

    position: Array
    velocity: Array
    middle: Array
    end: Array


@cache
def _basis(modes: int) -> _Basis:
    size = modes + 3
    noise = np.eye(size)[:, :modes] * np.sqrt(2 * np.arange(modes) + 1)
    once, twice, thrice = (legendre.legint(noise, m, lbnd=-1, scl=0.5)[:size] for m in (1, 2, 3))
    once, twice = (np.pad(part, ((0, size - len(part)), (0, 0))) for part in (once, twice))
    state = np.zeros((3, size, 3))
    state[0, :3] = [[1, 1 / 2, 1 / 6], [0, 1 / 2, 1 / 4], [0, 0, 1 / 12]]
    state[1, :2, 1:] = [[1, 1 / 2], [0, 1 / 2]]
    state[2, 0, 2] = 1
    parts = (
        np.hstack([state[0], twice, thrice]),
        np.hstack([state[1], once, twice]),
        np.hstack([state[2], 0 * once, once]),
    )
    middle = legendre.legvander(np.zeros(1), modes + 2)[0]
    # every Legendre polynomial is one at the end
    return _Basis(
        *parts[:2], np.stack([middle @ part for part in parts]), np.stack([part.sum(axis=0) for part in parts])
    )


@cache
def _whole() -> tuple[Array, Array]:
    """Covariance of the Legendre coefficients 0 to 5 by all modes of the accelerometer's noise, and of the gyro's."""
    rows = _basis(_ALL).position[:ORDERS, 3:]
    one, other = rows[:, :_ALL], rows[:, _ALL:]
    return one @ one.T, other @ other.T


class Drift(NamedTuple):
    """Position error along a time of one without fixes, in orthonormal polynomials of orders 0 to 5.

    ``state`` is that by the state at the start, (6, 3). For the noise of the accelerometer and then of the gyro,
    ``spread`` is the covariance, (2, 6, 6), ``with_end`` that with the state at the end, (2, 6, 3), and ``rest`` the
    mean square of what these orders leave, (2).
    """

    state: Array
    spread: Array
    with_end: Array
    rest: Array


@cache
def drifts() -> Drift:
    """The drift that `nav_model.processing.long_aperture` is built of."""
    basis = _basis(_ALL)
    lines = basis.position[:ORDERS] / np.sqrt(2 * np.arange(ORDERS)[:, None] + 1)
    parts = [slice(3, 3 + _ALL), slice(3 + _ALL, None)]
    spread = np.stack([lines[:, part] @ lines[:, part].T for part in parts])
    with_end = np.stack([lines[:, part] @ basis.end[:, part].T for part in parts])
    return Drift(lines[:, :3], spread, with_end, np.array([1 / 12, 1 / 120]) - spread.trace(axis1=1, axis2=2))


def _turned(matrix: Array) -> Array:
    """Transposes of matrices that come last."""
    return matrix.swapaxes(-1, -2)


def _diagonal(matrix: Array) -> Array:
    """Of matrices that come last: a view, to write through."""
    view: Array = np.einsum("nii->ni", matrix)
    return view


def _information(x: Inside, basis: _Basis, modes: int, scale: Array) -> Array:
    """Of everything about the unknowns: state at the start, modes, and the slow error at fixes and the end."""
    rows, plain = scale.shape
    points = x.position.places.shape[-1] if x.slow is not None else 0
    size = plain if x.slow is None else plain + points + 2
    whole: Array = np.zeros((rows, size, size), np.result_type(scale, x.start, x.end, x.position.known))
    _diagonal(whole)[:, 3:plain] = 1
    unit = np.stack([np.ones_like(x.aperture), 1 / x.aperture, 1 / x.aperture**2], axis=-1)
    ends = basis.end * scale[:, None, :] * unit[..., None]
    whole[:, :3, :3] += np.moveaxis(x.start[:3, :3], -1, 0) * unit[:, :, None] * unit[:, None, :]
    whole[:, :plain, :plain] += _turned(ends) @ np.moveaxis(x.end[:3, :3], -1, 0) @ ends
    for kind, fixes, factor in ((basis.position, x.position, 0), (basis.velocity, x.velocity, 1)):
        if fixes is None:
            continue
        seen = legendre.legvander(2 * fixes.places - 1, modes + 2) @ kind * scale[:, None, :]
        weight = fixes.known * (unit[:, factor] ** 2)[:, None]
        weighed = _turned(seen * weight[..., None])
        whole[:, :plain, :plain] += weighed @ seen
        if factor == 0 and x.slow is not None:
            whole[:, :plain, plain + 1 : -1] += weighed
            whole[:, plain + 1 : -1, :plain] += _turned(weighed)
            _diagonal(whole)[:, plain + 1 : -1] += weight
    if x.slow is not None:
        _add_slow(x, whole, plain, unit, ends)
    return whole


def _add_slow(x: Inside, whole: Array, plain: int, unit: Array, ends: Array) -> None:
    """The slow error at the start, at each fix, and at the end: what the legs know of it, and how it drifts."""
    assert x.slow is not None
    variance, time = x.slow
    first, last = plain, whole.shape[-1] - 1
    for place, edge in ((first, x.start), (last, x.end)):
        whole[:, place, place] += edge[3, 3]
    with_start = x.start[3, :3].T * unit
    whole[:, first, :3] += with_start
    whole[:, :3, first] += with_start
    with_end = np.einsum("in,nij->nj", x.end[3, :3], ends)
    whole[:, last, :plain] += with_end
    whole[:, :plain, last] += with_end
    edges = np.ones((len(plain_places := x.position.places), 1))
    steps = np.diff(np.hstack([0 * edges, plain_places, edges]), axis=-1) * (x.aperture / time)[:, None]
    kept = np.exp(-steps)
    tie = 1 / (-np.expm1(-2 * steps) * variance[:, None])
    _diagonal(whole)[:, first:last] += kept**2 * tie
    _diagonal(whole)[:, first + 1 :] += tie
    for beside in (whole[:, first:last, first + 1 :], whole[:, first + 1 :, first:last]):
        _diagonal(beside)[:] -= kept * tie


def smoothed_modes(x: Inside, modes: int) -> dict[str, Array]:
    """Variances over the aperture, as `nav_model.processing.spectrum.smoothed`, from `modes` of each noise.

    Returns
    -------
    dict
        Those of `nav_model.processing.leg.COLUMNS`.
    """
    basis = _basis(modes)
    t = x.aperture
    a, w = np.sqrt(x.accelerometer * t**3), np.sqrt(x.gyro * t**5)
    one = np.ones((len(t), modes))
    scale = np.hstack([np.ones((len(t), 3)), a[:, None] * one, w[:, None] * one])
    wanted = np.vstack([basis.position, basis.middle]) * scale[:, None, :]
    whole = _information(x, basis, modes, scale)
    plain = scale.shape[1]
    sides: Array = np.zeros((*wanted.shape[:2], whole.shape[-1]), wanted.dtype)
    sides[..., :plain] = wanted
    solved = np.linalg.solve(whole, _turned(sides))[:, :plain]
    variance = np.einsum("nij,nji->ni", wanted, solved)
    unseen = np.sum(wanted[..., 3:] ** 2, axis=-1)  # what the modes have when nothing measures them
    orders = np.arange(_LEFT, modes + 3)
    rest = (unseen - variance)[:, orders] / (2 * orders + 1)
    left_3 = a**2 / 6930 + w**2 / 540540 - rest.sum(axis=-1)  # [S-6] but for what the fixes see of it
    # the moment in the middle has a little of modes above those taken
    above = np.stack([a**2 / 24 + w**2 / 640, a**2 / 2 + w**2 / 24, w**2 / 2], axis=-1) - unseen[:, -3:]
    now = variance[:, -3:] + above
    named = wanted[:, :ORDERS] @ solved[..., :ORDERS]
    if modes < _ALL:  # and so have the orders that figures name
        from_a, from_w = _whole()
        noise = wanted[:, :ORDERS, 3:]
        beyond = a[:, None, None] ** 2 * from_a + w[:, None, None] ** 2 * from_w - noise @ _turned(noise)
        named = named + beyond
    return variances(named, left_3, np.stack([now[:, 0], now[:, 1] / t**2, now[:, 2] / t**4], axis=-1), t)


def variances(named: Array, left_3: Array, now: Array, t: Array) -> dict[str, Array]:
    """Those of `nav_model.processing.leg.COLUMNS`.

    Parameters
    ----------
    named : array (rows, 6, 6)
        Covariance of the Legendre coefficients of the position error, orders 0 to 5 [m²].
    left_3 : array (rows)
        Mean square of what the first four of these leave [m²].
    now : array (rows, 3)
        Variances of position, velocity and acceleration by tilt in the middle.
    t : array (rows)
        Aperture [s].
    """
    of_turn, of_cubic = (rows @ named @ rows.T for rows in (_QUADRATICS, _CUBICS))
    quadratic, cubic = named[:, 2, 2] * 9 / 4, named[:, 3, 3] * 25 / 4
    left_2 = left_3 + cubic * (4 / 25 / 7)
    found: dict[str, Any] = {
        "quadratic": quadratic,
        "cubic": cubic,
        "left_1": left_2 + quadratic * (4 / 9 / 5),
        "left_2": left_2,
        "left_3": left_3,
        "slope": named[:, 1, 1] * 4 / t**2,
        "turned": of_turn[:, 1, 1],
        "curved": of_turn[:, 2, 2],
        "with_curved": of_turn[:, 0, 2],
        "mean": named[:, 0, 0],
        "mean_slope": named[:, 0, 1] * 2 / t,
        "with_turned": of_turn[:, 0, 1],
        "turned_curved": of_turn[:, 1, 2],
        "cubic_turned": of_cubic[:, 1, 1],
        "cubic_curved": of_cubic[:, 2, 2],
        "cubic_with_turned": of_cubic[:, 0, 1],
        "cubic_with_curved": of_cubic[:, 0, 2],
        "cubic_turned_curved": of_cubic[:, 1, 2],
        "position": now[:, 0],
        "velocity": now[:, 1],
        "tilt": now[:, 2],
    }
    return found
