"""The smoothed error over an aperture in a leg of limited length or with sparse fixes.

Fixes are at whole intervals from a fix at the aperture's start. Those before it and those after it become
information about the states at its two ends (`nav_model.analytic.doubling`), and between these the aperture is solved
in modes of its noise (`nav_model.processing.modes`) or, where it is long or its fixes are far apart, by doubling
(`nav_model.processing.long_aperture`). Everything takes complex steps.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nav_model.analytic.doubling import Doubles, Segment, before, drift, information, repeated
from nav_model.analytic.steady_state import Array
from nav_model.processing.long_aperture import Fixing, Noise, smoothed_by_doubling
from nav_model.processing.modes import Fixes, Inside, smoothed_modes
from nav_model.processing.spectrum import Channel, Leg, rates

COLUMNS = (
    "quadratic", "cubic", "left_1", "left_2", "left_3", "slope", "turned", "curved", "with_curved", "mean",
    "position", "velocity", "tilt", "mean_slope", "with_turned", "turned_curved", "cubic_turned", "cubic_curved",
    "cubic_with_turned", "cubic_with_curved", "cubic_turned_curved",
)  # fmt: skip
"""What `smoothed_in_leg` finds; as `nav_model.processing.spectrum.smoothed`."""

_FAR = 12.0  # time constants of the error, and as many fixes: farther ones carry no information about the aperture
_UNKNOWN = 1e-10  # information about unknown states, as a part of one fix's
_KNOWN = 1e30  # 1/m²: information about a state that does not exist
_POINTS = 32  # fixes inside an aperture, treated one by one; more are treated as evenly spread
_MODES = ((0.8, 4), (2.5, 8), (7.0, 16))
"""Times in which the error changes that an aperture may hold, and the modes of noise that it then takes."""
_HELD = [most for most, _ in _MODES]
_DOUBLED = len(_MODES)  # the level of apertures of more, which are solved by doubling
_SHARP = 0.3  # so many of these times between velocity fixes, and modes converge too slowly
_SAME = 1e-3  # relative difference below which two fix intervals are equal
_AT_ONCE = 2**18  # numbers in the largest array of one batch of modes, which stays in the cache
_ROWS = 4096  # whose legs are taken together
_FEW_ROWS = 64  # with fewer, to find those alike takes longer than their legs


@dataclass(frozen=True)
class _Row:
    """One row per design, every field an array; None without velocity fixes or slow error."""

    accelerometer: Array  # m²/s³
    gyro: Array  # m²/s⁵
    fix: Array  # m²
    interval: Array
    aperture: Array
    before: Array
    after: Array
    gap: Array
    fastest: Array
    slowest: Array
    velocity: Array | None
    velocity_interval: Array | None
    slow: Array | None
    slow_time: Array | None

    kind: np.dtype[Any]  # of the numbers: complex where one is

    def of(self, rows: NDArray[np.int64]) -> _Row:
        taken: dict[str, Any] = {
            key: value[rows] for key, value in vars(self).items() if isinstance(value, np.ndarray)
        }
        return replace(self, **taken)


def _count(span: Array, step: Array) -> NDArray[np.int64]:
    """Whole steps in a span, with a tolerance for rounding."""
    return np.asarray(np.floor(np.maximum(span.real / step.real, -1.0) + 1e-9), np.int64)


def _drift(x: _Row, step: Array) -> tuple[Array, Array]:
    slow = None if x.slow is None or x.slow_time is None else (x.slow, x.slow_time)
    return drift(step, x.accelerometer, x.gyro, slow)


def _seen(x: _Row, positions: ArrayLike, velocities: ArrayLike) -> Array:
    """Information of this many fixes of each kind."""
    size = 3 if x.slow is None else 4
    found: Array = np.zeros((size, size, len(x.fix)), x.kind)
    seen = [0] if x.slow is None else [0, 3]
    found[np.ix_(seen, seen)] = np.asarray(positions) / x.fix
    if x.velocity is not None:
        found[1, 1] = np.asarray(velocities) / x.velocity
    return found


class _Pace(NamedTuple):
    """Intervals of the two kinds of fixes: one comes often, the other seldom, unless they are equal."""

    often: Array  # s
    seldom: Array  # s; the same array where both kinds come together, or there is one alone
    dense: Array  # information of the fixes that come often, together
    sparse: Array  # and of the others, zero where the two kinds come together


def _pace(x: _Row) -> _Pace:
    if x.velocity_interval is None or np.array_equal(x.velocity_interval, x.interval):
        seen = _seen(x, 1.0, 1.0)
        return _Pace(x.interval, x.interval, seen, 0 * seen)
    often, seldom = np.minimum(x.interval, x.velocity_interval), np.maximum(x.interval, x.velocity_interval)
    first, second = (step.real <= often.real * (1 + _SAME) for step in (x.interval, x.velocity_interval))
    return _Pace(often, seldom, _seen(x, first, second), _seen(x, ~first, ~second))


def _unit(x: _Row, pace: _Pace, between: Doubles) -> Segment:
    """From one of the fixes that come seldom, at its start, to the next, with a whole number of the others."""
    ratio = pace.seldom / pace.often
    parts = np.asarray(np.rint(ratio.real), np.int64)
    if not np.array_equal(ratio, parts):
        between = Doubles(Segment(pace.dense * ratio / parts, *_drift(x, pace.seldom / parts)))
    unit = repeated(between, parts)
    return unit._replace(info=unit.info + pace.sparse)


class _Fixes(NamedTuple):
    """Of the legs before the aperture and after it: how many intervals between fixes that come seldom, -1 without
    one; how many of the others follow the last of these, and lead to the first; from the aperture's end to a fix [s].
    """

    whole: NDArray[np.int64]  # (2, rows)
    rest: NDArray[np.int64]
    lead: NDArray[np.int64]
    soon: Array  # (rows)

    def of(self, rows: NDArray[np.int64]) -> _Fixes:
        return _Fixes(self.whole[:, rows], self.rest[:, rows], self.lead[:, rows], self.soon[rows])

    @property
    def counts(self) -> tuple[Array, ...]:
        return (*self.whole, *self.rest, *self.lead)

    def leg(self, n: int) -> _Fixes:
        """One leg alone."""
        one = slice(n, n + 1)
        return _Fixes(self.whole[one], self.rest[one], self.lead[one], self.soon)


def _fixes(reach: Array, aperture: Array, often: Array, seldom: Array) -> _Fixes:
    away = np.ceil((aperture / seldom).real - 1e-9) * seldom - aperture
    first = np.stack([0 * away, away])
    whole = _count(reach - first, seldom)
    if often is seldom:
        return _Fixes(whole, 0 * whole, 0 * whole, away)
    soon = np.ceil((aperture / often).real - 1e-9) * often - aperture
    sooner = np.stack([0 * soon, soon])
    rest = np.where(whole < 0, 0, _count(reach - first - whole * seldom, often) + 1)
    most = np.asarray(np.rint(np.maximum(((first - sooner) / often).real, 0.0)), np.int64)
    return _Fixes(whole, rest, np.clip(_count(reach - sooner, often) + 1, 0, most), soon)


def _legs(x: _Row, fixes: _Fixes) -> Array:
    """Information about the states at the legs' fixes beside the aperture, (n, n, legs, rows)."""
    pace = _pace(x)
    between = Doubles(Segment(pace.dense, *_drift(x, pace.often)))
    if pace.often is pace.seldom:
        return information(between, fixes.whole + 1)
    known = information(between, fixes.rest) + pace.sparse[:, :, None] * (fixes.whole >= 0)
    known = information(Doubles(_unit(x, pace, between)), np.maximum(fixes.whole, 0), known)
    return information(between, fixes.lead, known)


def _different(x: _Row, *others: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Rows of which no two are alike in drift, fixes and `others`, and for each row which of these it is like."""
    known = (x.accelerometer, x.gyro, x.fix, x.interval, x.velocity, x.velocity_interval, x.slow, x.slow_time)
    table = np.array([*(value for value in known if value is not None), *others])
    rows = np.ascontiguousarray(table.T)
    _, first, alike = np.unique(rows.view(f"V{rows[0].nbytes}"), return_index=True, return_inverse=True)
    return first, alike.ravel()


def _legs_once(x: _Row, fixes: _Fixes) -> Array:
    """`_legs` of many rows, those alike once: maps over the aperture have few that differ, over legs few of each."""
    first, alike = _different(x, *fixes.counts)
    legs = fixes.leg(0), fixes.leg(1)
    apart = [_different(x, *leg.counts) for leg in legs]
    if sum(len(rows) for rows, _ in apart) < len(first):
        each = (_legs(x.of(rows), leg.of(rows))[..., like] for leg, (rows, like) in zip(legs, apart, strict=True))
        return np.concatenate(list(each), axis=2)
    return _legs(x.of(first), fixes.of(first))[..., alike]


def _ends(x: _Row) -> tuple[Array, Array]:
    """Information of the legs about the states at the aperture's start and end."""
    pace = _pace(x)
    far = _FAR * (1 / x.slowest + pace.seldom.real)
    # before the aperture, counted from its last fix backward; after it, from its end
    reach = np.stack([np.minimum(x.before - x.gap, far), np.minimum(x.after, far)])
    fixes = _fixes(reach, x.aperture, pace.often, pace.seldom)
    known = _legs_once(x, fixes) if len(x.fix) > _FEW_ROWS else _legs(x, fixes)
    steps = np.stack([x.gap, fixes.soon])
    if np.any(steps):
        known = before(known, *_drift(x, steps))
    start, end = known[:, :, 0].copy(), known[:, :, 1]
    # Backward in time the drift is the same but for the sign of velocity; the slow error comes from a steady state.
    start[1] *= -1
    start[:, 1] *= -1
    waited = np.where(x.gap.real > 0, 1.0, 0.0)  # then fixes come back at the aperture's start
    start += _seen(x, waited, waited)
    unknown = _UNKNOWN / x.fix
    start[0, 0] += unknown
    start[1, 1] += unknown * pace.seldom**2
    start[2, 2] += np.where(x.gyro == 0, _KNOWN, unknown * pace.seldom**4)
    if x.slow is not None:
        start[3, 3] += 1 / x.slow
    return start, end


def _fixes_inside(aperture: Array, interval: Array) -> NDArray[np.int64]:
    """How many fixes are between an aperture's start and its end, without these two."""
    return np.asarray(np.ceil((aperture / interval).real - 1e-9), np.int64) - 1


def _inside(x: _Row, variance: Array, interval: Array, nodes: int) -> Fixes:
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


def _solved(x: _Row, start: Array, end: Array, modes: int) -> dict[str, Array]:
    velocity = None
    if x.velocity is not None and x.velocity_interval is not None:
        velocity = _inside(x, x.velocity, x.velocity_interval, modes + 3)
    slow = None if x.slow is None or x.slow_time is None else (x.slow, x.slow_time)
    position = _inside(x, x.fix, x.interval, modes + 3)
    return smoothed_modes(Inside(x.accelerometer, x.gyro, x.aperture, start, end, position, velocity, slow), modes)


def _rows(channel: Channel, aperture: Array, leg: Leg) -> tuple[_Row, tuple[int, ...]]:
    """A row a design, and the shape that the inputs have together."""
    fastest, slowest = rates(channel)
    velocity, slow = channel.velocity, channel.slow
    squared = {
        "accelerometer": channel.accelerometer**2,
        "gyro": 0 * channel.accelerometer if channel.gyro is None else channel.gyro**2,
        "fix": channel.fix**2, "interval": channel.interval, "aperture": aperture,
        "before": leg.before, "after": leg.after, "gap": leg.gap, "fastest": fastest, "slowest": slowest,
        "velocity": None if velocity is None else velocity**2, "velocity_interval": channel.velocity_interval,
        "slow": None if slow is None else slow**2, "slow_time": channel.slow_time,
    }  # fmt: skip
    given = {name: np.asarray(value) for name, value in squared.items() if value is not None}
    even = np.zeros(np.broadcast_shapes(*(value.shape for value in given.values())))
    flat = {name: (value + even).ravel() for name, value in given.items()}
    kind = np.result_type(*flat.values())
    return _Row(**dict.fromkeys(squared) | flat, kind=kind), even.shape  # type: ignore[arg-type]


def known_at_ends(channel: Channel, span: Array, leg: Leg) -> tuple[Array, Array]:
    """Information of the fixes of the legs about the states at two moments, for one design.

    Parameters
    ----------
    channel : Channel
        Numbers as arrays without axes.
    span : array
        Seconds between the two moments; a fix at either belongs to its leg.
    leg : Leg
        Before the first moment and after the second.

    Returns
    -------
    pair of array, (n, n)
        Information about position, velocity, acceleration by tilt, and the slow error where there is one.
    """
    start, end = _ends(_rows(channel, span, leg)[0])
    return start[..., 0], end[..., 0]


def fixes_in_legs(channel: Channel, aperture: Array, leg: Leg) -> NDArray[np.int64]:
    """How many fixes each leg has, by which alone its length counts, (3, 2, rows); but for what is too far to tell.

    Two rows with equal columns have equal figures. The first is one less than the number of fixes of a leg where both
    kinds come together, or there is one alone; the rest is then zero.

    Parameters
    ----------
    channel : Channel
        Whose intervals between fixes are numbers.
    aperture : array
        Seconds, a number.
    leg : Leg
        Of (rows), or numbers.
    """
    kinds = [channel.interval] if channel.velocity_interval is None else [channel.interval, channel.velocity_interval]
    often, seldom = min(kinds), max(kinds)
    reach = np.stack(np.broadcast_arrays(leg.before - leg.gap, leg.after))
    fixes = _fixes(reach, aperture + 0 * reach[0], often, often if often == seldom else seldom)
    return np.stack([fixes.whole, fixes.rest, fixes.lead])


def levels(channel: Channel, aperture: Array) -> NDArray[np.int64]:
    """How an aperture is solved: index into `_MODES`, or `_DOUBLED`."""
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
    x, shape = _rows(channel, aperture, leg)
    if level is None:
        taken = _level(x.fastest, x.aperture.real, x.velocity_interval)
    else:
        taken = np.ravel(np.broadcast_to(level, shape))
    found = {name: np.empty(taken.shape, x.kind) for name in COLUMNS}
    for rows in np.array_split(np.arange(len(taken)), max(1, len(taken) // _ROWS)):
        _put(x.of(rows), rows, taken[rows], found)
    return {name: values.reshape(shape) for name, values in found.items()}


def _put(x: _Row, places: NDArray[np.int64], level: NDArray[np.int64], found: dict[str, Array]) -> None:
    """Put the figures of these rows into `found`, at their places: each by as many modes as its aperture needs."""
    start, end = _ends(x)
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


def _doubled(x: _Row, start: Array, end: Array) -> dict[str, Array]:
    slow = None if x.slow is None or x.slow_time is None else (x.slow, x.slow_time)
    return smoothed_by_doubling(
        Noise(x.accelerometer, x.gyro, slow), Fixing(*_pace(x)), x.aperture, start, end, *_different(x)
    )
