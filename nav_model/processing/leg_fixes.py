"""What the fixes of the legs say about the states at the ends of an aperture.

Fixes are at whole intervals from a fix at the aperture's start, and a leg of any length is made by doubling
(`nav_model.analytic.doubling`). Everything takes complex steps.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from nav_model.analytic.doubling import Doubles, Segment, before, drift, information, repeated
from nav_model.base.arrays import Array
from nav_model.processing.spectrum import Channel, Leg, rates

_FAR = 12.0  # time constants of the error, and as many fixes: farther ones carry no information about the aperture
_UNKNOWN = 1e-10  # information about unknown states, as a part of one fix's
_KNOWN = 1e30  # 1/m²: information about a state that does not exist
WHOLE = 1e-3
"""Relative difference from a whole number of fixes of one kind to those of the other."""
_NEAR = 24  # fixes of each leg that are taken one by one where there is no such number; farther ones are spread
_FEW = 8  # so many times as often as the other kind, and fixes may always be spread
_SAME = 1e-3  # relative difference below which two fix intervals are equal
_FEW_ROWS = 64  # with fewer, to find those alike takes longer than their legs


@dataclass(frozen=True)
class Row:
    """One row per design, every field an array (rows); None without velocity fixes or slow error.

    Noises are squared: densities of the sensors, variances of the fixes and of their slow error. Times are in s,
    ``fastest`` and ``slowest`` those of `nav_model.processing.spectrum.rates`.
    """

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

    @property
    def slow_error(self) -> tuple[Array, Array] | None:
        """Variance [m²] and correlation time [s] of the slow error of the position fixes."""
        return None if self.slow is None or self.slow_time is None else (self.slow, self.slow_time)

    def of(self, rows: NDArray[np.int64]) -> Row:
        """These rows."""
        taken: dict[str, Any] = {
            key: value[rows] for key, value in vars(self).items() if isinstance(value, np.ndarray)
        }
        return replace(self, **taken)


def rows_of(channel: Channel, aperture: Array, leg: Leg) -> tuple[Row, tuple[int, ...]]:
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
    return Row(**dict.fromkeys(squared) | flat, kind=kind), even.shape  # type: ignore[arg-type]


def _count(span: Array, step: Array) -> NDArray[np.int64]:
    """Whole steps in a span, with a tolerance for rounding."""
    return np.asarray(np.floor(np.maximum(span.real / step.real, -1.0) + 1e-9), np.int64)


def _drift(x: Row, step: Array) -> tuple[Array, Array]:
    return drift(step, x.accelerometer, x.gyro, x.slow_error)


def _seen(x: Row, positions: ArrayLike, velocities: ArrayLike) -> Array:
    """Information of this many fixes of each kind."""
    size = 3 if x.slow is None else 4
    found: Array = np.zeros((size, size, len(x.fix)), x.kind)
    seen = [0] if x.slow is None else [0, 3]
    found[np.ix_(seen, seen)] = np.asarray(positions) / x.fix
    if x.velocity is not None:
        found[1, 1] = np.asarray(velocities) / x.velocity
    return found


class Pace(NamedTuple):
    """Intervals of the two kinds of fixes, (rows): one comes often, the other seldom, unless they are equal."""

    often: Array  # s
    seldom: Array  # s; the same array where both kinds come together, or there is one alone
    dense: Array  # information of one of the fixes that come often, (n, n, rows)
    sparse: Array  # and of one of the others, zero where the two kinds come together


def pace_of(x: Row) -> Pace:
    """How often the fixes of each row come, and what one of them says about the states."""
    if x.velocity_interval is None or np.array_equal(x.velocity_interval, x.interval):
        seen = _seen(x, 1.0, 1.0)
        return Pace(x.interval, x.interval, seen, 0 * seen)
    often, seldom = np.minimum(x.interval, x.velocity_interval), np.maximum(x.interval, x.velocity_interval)
    first, second = (step.real <= often.real * (1 + _SAME) for step in (x.interval, x.velocity_interval))
    return Pace(often, seldom, _seen(x, first, second), _seen(x, ~first, ~second))


def _unit(x: Row, pace: Pace, between: Doubles) -> Segment:
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


class _Near(NamedTuple):
    """The first fixes of legs, of both kinds, where one interval holds no whole number of the other.

    Of each, (rows, n): its ``time`` from the aperture [s], rising, whether it is of the kind that comes ``often``,
    and whether the leg has it. Farther ones begin with one of the other kind at ``beyond`` [s]: how many intervals
    between these, -1 without one, and how many fixes after the last of them, (rows).
    """

    time: Array
    often: NDArray[np.bool_]
    there: NDArray[np.bool_]
    beyond: Array
    whole: NDArray[np.int64]
    rest: NDArray[np.int64]


def uneven(pace: Pace) -> NDArray[np.bool_]:
    """Where the longer interval holds no whole number of the shorter one, nor nearly, nor many: (rows)."""
    ratio = (pace.seldom / pace.often).real
    return np.asarray((abs(ratio - np.rint(ratio)) > WHOLE * ratio) & (ratio < _FEW))


def _near(reach: Array, begin: Array, often: Array, seldom: Array) -> _Near:
    """Of legs that reach this far from `begin`, the time since a fix of both kinds; seconds, (rows)."""
    first, other = (np.ceil((begin / step).real - 1e-9) for step in (often, seldom))
    beyond = np.ceil(((first + _NEAR) * often / seldom).real - 1e-9) * seldom - begin
    k = np.arange(_NEAR + _FEW + 1)
    time = np.hstack([
        (count[:, None] + k) * step[:, None] - begin[:, None] for count, step in ((first, often), (other, seldom))
    ])  # fmt: skip
    edge = 1e-9 * often.real[:, None]
    there = (time.real < beyond.real[:, None] - edge) & (time.real <= reach.real[:, None] + edge)
    order = np.argsort(np.where(there, time.real, np.inf), axis=1)[:, : int(np.max(there.sum(axis=1), initial=0))]
    whole = _count(reach - beyond, seldom)
    rest = np.where(whole < 0, 0, _count(reach - beyond - whole * seldom, often) + 1)
    return _Near(
        np.take_along_axis(time, order, 1), order < len(k), np.take_along_axis(there, order, 1), beyond, whole, rest
    )


def _leg_one_by_one(x: Row, reach: Array, begin: Array) -> tuple[Array, Array]:
    """Information about the states at the first fix of a leg, whose near fixes are not spread, and when that is."""
    pace = pace_of(x)
    near = _near(reach, begin, pace.often, pace.seldom)
    between = Doubles(Segment(pace.dense, *_drift(x, pace.often)))
    known = information(between, near.rest[None])[:, :, 0] + pace.sparse * (near.whole >= 0)
    units = Doubles(_unit(x, pace, between))
    known = information(units, np.maximum(near.whole, 0)[None], known[:, :, None])[:, :, 0]
    time = np.where(near.there, near.time, near.beyond[:, None]).T  # those that a leg has not are at its beyond
    then = np.concatenate([time[1:], near.beyond[None]])
    through, noise = _drift(x, then - time)
    for n in reversed(range(len(time))):
        seen = np.where(near.often[:, n], pace.dense, pace.sparse) * near.there[:, n]
        known = before(known, through[:, :, n], noise[:, :, n]) + seen
    return known, time[0] if len(time) else near.beyond


def _legs_one_by_one(x: Row, reach: Array) -> tuple[Array, Array]:
    """As `_legs`, and the time from the aperture's end to the first fix."""
    rows = len(x.aperture)
    both = x.of(np.tile(np.arange(rows), 2))
    begin, reach = np.concatenate([0 * x.aperture, x.aperture]), reach.ravel()
    if rows > _FEW_ROWS:
        first, alike = different(both, reach, begin)
        known, then = _leg_one_by_one(both.of(first), reach[first], begin[first])
        known, then = known[..., alike], then[alike]
    else:
        known, then = _leg_one_by_one(both, reach, begin)
    return known.reshape(*known.shape[:2], 2, rows), then[rows:]


def _legs(x: Row, fixes: _Fixes) -> Array:
    """Information about the states at the legs' fixes beside the aperture, (n, n, legs, rows)."""
    pace = pace_of(x)
    between = Doubles(Segment(pace.dense, *_drift(x, pace.often)))
    if pace.often is pace.seldom:
        return information(between, fixes.whole + 1)
    known = information(between, fixes.rest) + pace.sparse[:, :, None] * (fixes.whole >= 0)
    known = information(Doubles(_unit(x, pace, between)), np.maximum(fixes.whole, 0), known)
    return information(between, fixes.lead, known)


def different(x: Row, *others: Array) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Rows of which no two are alike in drift, fixes and `others` (rows), and for each row which of these it is
    like."""
    known = (x.accelerometer, x.gyro, x.fix, x.interval, x.velocity, x.velocity_interval, x.slow, x.slow_time)
    table = np.array([*(value for value in known if value is not None), *others])
    rows = np.ascontiguousarray(table.T)
    _, first, alike = np.unique(rows.view(f"V{rows[0].nbytes}"), return_index=True, return_inverse=True)
    return first, alike.ravel()


def _legs_once(x: Row, fixes: _Fixes) -> Array:
    """`_legs` of many rows, those alike once: maps over the aperture have few that differ, over legs few of each."""
    first, alike = different(x, *fixes.counts)
    legs = fixes.leg(0), fixes.leg(1)
    apart = [different(x, *leg.counts) for leg in legs]
    if sum(len(rows) for rows, _ in apart) < len(first):
        each = (_legs(x.of(rows), leg.of(rows))[..., like] for leg, (rows, like) in zip(legs, apart, strict=True))
        return np.concatenate(list(each), axis=2)
    return _legs(x.of(first), fixes.of(first))[..., alike]


def at_ends(x: Row) -> tuple[Array, Array]:
    """Information of the legs about the states at the aperture's start and end, each (n, n, rows).

    States are position, velocity, acceleration by tilt, and the slow error of the fixes where there is one, n 3 or 4.
    A fix at the start or the end belongs to its leg. Farther fixes than 12 time constants and intervals are left out.
    """
    pace = pace_of(x)
    far = _FAR * (1 / x.slowest + pace.seldom.real)
    # before the aperture, counted from its last fix backward; after it, from its end
    reach = np.stack([np.minimum(x.before - x.gap, far), np.minimum(x.after, far)])
    apart = uneven(pace)
    if np.all(apart):
        known, soon = _legs_one_by_one(x, reach)
    else:
        fixes = _fixes(reach, x.aperture, pace.often, pace.seldom)
        known, soon = _legs_once(x, fixes) if len(x.fix) > _FEW_ROWS else _legs(x, fixes), fixes.soon
        if np.any(apart):
            known, soon, rows = known.astype(x.kind), soon.astype(x.kind), np.flatnonzero(apart)
            known[..., rows], soon[rows] = _legs_one_by_one(x.of(rows), reach[:, rows])
    steps = np.stack([x.gap, soon])
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
    start, end = at_ends(rows_of(channel, span, leg)[0])
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
    span = aperture + 0 * reach[0]
    nothing = np.zeros(())
    if uneven(Pace(often, seldom, nothing, nothing)):
        begin = np.concatenate([0 * span, span])
        near = _near(reach.ravel(), begin, often + 0 * begin, seldom + 0 * begin)
        return np.stack([near.whole, near.rest, near.there.sum(axis=1)]).reshape(3, 2, -1)
    fixes = _fixes(reach, span, often, often if often == seldom else seldom)
    return np.stack([fixes.whole, fixes.rest, fixes.lead])
