"""The smoothed error over an aperture in a leg of limited length or with sparse fixes.

Fixes are at whole intervals from a fix at the aperture's start. Those before it and those after it become
information about the states at its two ends (`nav_model.analytic.doubling`), and between these the aperture is solved
in modes of its noise (`nav_model.processing.modes`) or, where it is long or its fixes are far apart, by doubling
(`nav_model.processing.long_aperture`). Everything takes complex steps.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import Array
from nav_model.processing.leg_fixes import Row, at_ends, different, pace_of, rows_of
from nav_model.processing.long_aperture import smoothed_by_doubling
from nav_model.processing.modes import Fixes, Inside, smoothed_modes
from nav_model.processing.spectrum import Channel, Leg, rates
from nav_model.processing.stretch import Noise

COLUMNS = (
    "quadratic", "cubic", "left_1", "left_2", "left_3", "slope", "turned", "curved", "with_curved", "mean",
    "position", "velocity", "tilt", "mean_slope", "with_turned", "turned_curved", "cubic_turned", "cubic_curved",
    "cubic_with_turned", "cubic_with_curved", "cubic_turned_curved",
)  # fmt: skip
"""What `smoothed_in_leg` finds; as `nav_model.processing.spectrum.smoothed`."""

_POINTS = 32  # fixes inside an aperture, treated one by one; more are treated as evenly spread
_MODES = ((0.8, 4), (2.5, 8), (7.0, 16))
"""Times in which the error changes that an aperture may hold, and the modes of noise that it then takes."""
_HELD = [most for most, _ in _MODES]
_DOUBLED = len(_MODES)  # the level of apertures of more, which are solved by doubling
_SHARP = 0.3  # so many of these times between velocity fixes, and modes converge too slowly
_AT_ONCE = 2**18  # numbers in the largest array of one batch of modes, which stays in the cache
_ROWS = 4096  # whose legs are taken together


def _fixes_inside(aperture: Array, interval: Array) -> NDArray[np.int64]:
    """How many fixes are between an aperture's start and its end, without these two."""
    return np.asarray(np.ceil((aperture / interval).real - 1e-9), np.int64) - 1


def _inside(x: Row, variance: Array, interval: Array, nodes: int) -> Fixes:
    """Fixes inside the aperture, one by one where they are few; more of them as evenly spread over Gauss's nodes.

    Each is spread over an interval around it, as those at the aperture's ends belong to the legs.
    """
    count = _fixes_inside(x.aperture, interval)
    points = min(int(np.max(count)), _POINTS)
    few = count <= _POINTS
    if not np.all(few):
        points = max(points, nodes)
    k = np.arange(1, points + 1)
    step = (interval / x.aperture)[:, None]
    there = np.minimum(count, points)[:, None]
    rest = 1 - there * step  # unused places are between the last fix and the end
    places = np.where(k <= there, k * step, there * step + rest * (k - there) / (points + 1 - there))
    known = np.where(k <= there, 1.0, 0.0) / variance[:, None]
    if not np.all(few):
        x_k, weight = _gauss(points)
        last = np.minimum((count + 0.5) * interval / x.aperture, 1.0)[:, None]
        places = np.where(few[:, None], places, step / 2 + (last - step / 2) * (1 + x_k) / 2)
        known = np.where(few[:, None], known, weight / 2 * count[:, None] / variance[:, None])
    return Fixes(places, known)


@cache
def _gauss(points: int) -> tuple[Array, Array]:
    return np.polynomial.legendre.leggauss(points)


def _solved(x: Row, start: Array, end: Array, modes: int) -> dict[str, Array]:
    velocity = None
    if x.velocity is not None and x.velocity_interval is not None:
        velocity = _inside(x, x.velocity, x.velocity_interval, modes + 3)
    position = _inside(x, x.fix, x.interval, modes + 3)
    return smoothed_modes(
        Inside(x.accelerometer, x.gyro, x.aperture, start, end, position, velocity, x.slow_error), modes
    )


def levels(channel: Channel, aperture: Array) -> NDArray[np.int64]:
    """How an aperture [s] is solved: index into `_MODES`, or `_DOUBLED`; an array of the shape of all together."""
    fastest = rates(channel)[0]
    return _level(fastest, aperture.real, None if channel.velocity is None else channel.velocity_interval)


def _level(fastest: Array, aperture: Array, velocity_interval: Array | None) -> NDArray[np.int64]:
    found = np.searchsorted(_HELD, aperture * fastest, "right")
    if velocity_interval is None:
        return np.asarray(found, np.int64)
    apart = velocity_interval.real
    return np.where((apart * fastest > _SHARP) & (apart < aperture), _DOUBLED, found)


def smoothed_in_leg(
    channel: Channel, aperture: Array, leg: Leg, level: NDArray[np.int64] | None = None
) -> dict[str, Array]:
    """Variances of the smoothed error of one channel over an aperture inside a leg of this length.

    Parameters
    ----------
    channel : Channel
    aperture : array
        Seconds.
    leg : Leg
    level : array of int, optional
        Instead of that of `levels`, of the shape that the inputs have together.

    Returns
    -------
    dict
        One entry for each of `COLUMNS`; ``tilt`` is that times gravity [m²/s⁴], zero for the vertical;
        ``mean_slope`` the covariance of the mean with the slope [m²/s], ``with_turned``, ``with_curved`` and
        ``turned_curved`` those of the quadratics of the error, of its turn and of the turn's square [m²], and with
        ``cubic_`` those of the cubics.
    """
    x, shape = rows_of(channel, aperture, leg)
    if level is None:
        taken = _level(x.fastest, x.aperture.real, x.velocity_interval)
    else:
        taken = np.ravel(np.broadcast_to(level, shape))
    found = {name: np.empty(taken.shape, x.kind) for name in COLUMNS}
    for rows in np.array_split(np.arange(len(taken)), max(1, len(taken) // _ROWS)):
        _put(x.of(rows), rows, taken[rows], found)
    return {name: values.reshape(shape) for name, values in found.items()}


def _put(x: Row, places: NDArray[np.int64], level: NDArray[np.int64], found: dict[str, Array]) -> None:
    """Put the figures of these rows into `found`, at their places: each by as many modes as its aperture needs."""
    start, end = at_ends(x)
    kinds = [x.interval] if x.velocity_interval is None else [x.velocity_interval, x.interval]
    # batches of apertures with about as many fixes: all rows of one have as many unknowns
    order = np.lexsort([_fixes_inside(x.aperture, interval) for interval in kinds])
    for n, (_, modes) in enumerate(_MODES):
        rows = order[level[order] == n]
        size = (2 * modes + _POINTS) * (2 * modes + 8)
        for batch in np.array_split(rows, max(1, len(rows) * size // _AT_ONCE)) if len(rows) else ():
            taken = _solved(x.of(batch), start[..., batch], end[..., batch], modes)
            for name, values in taken.items():
                found[name][places[batch]] = values
    if len(rows := order[level[order] == _DOUBLED]):
        for name, values in _doubled(x.of(rows), start[..., rows], end[..., rows]).items():
            found[name][places[rows]] = values


def _doubled(x: Row, start: Array, end: Array) -> dict[str, Array]:
    return smoothed_by_doubling(
        Noise(x.accelerometer, x.gyro, x.slow_error), pace_of(x), x.aperture, start, end, *different(x)
    )
