"""Two solutions of one flight: how they belong together, and what has to be taken off before they are compared.

A solution `x` is held against a reference `y`. Their clocks are brought together first; then a lag of x, a lever arm
between the two points and an offset are fitted together to their difference, by least squares with the residual's own
correlation (Newey and West 1987). What the track cannot part stays in the difference. [P-17]
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import interpolated
from nav_model.base.errors import InputError
from nav_model.earth.rotation import matrix_from_euler
from nav_model.earth.wgs84 import metres_per_radian
from nav_model.flown.solution import Solution, wrapped

FloatArray = NDArray[np.float64]
Relation = Literal["smoothed", "reverse", "independent", "claims"]
RELATIONS: tuple[Relation, ...] = ("smoothed", "reverse", "independent")
"""Relations of two solutions that a user may give; without a reference there are claims alone."""
MEANINGS = {
    "smoothed": "the reference is the smoothed answer on the same data",
    "reverse": "both are passes of one processing, forward and backward",
    "independent": "the reference is another system, with its own errors",
    "claims": "no second solution: only what the file claims",
}
_WEEK, _DAY = 604_800.0, 86_400.0
_LEAP = 18.0  # s, since 2017
_IN_GPS_TIME = {"gps": 0.0, "gps week seconds": 0.0, "utc": _LEAP - 315_964_800.0}
"""Seconds to add to the times of a clock for GPS time."""
_LONGEST_LAG = 60.0  # s
_STEP = 0.2  # s between velocities that are compared for a lag
_CLEARLY = 0.5  # a lag found by velocities leaves at most this of the mean square without it
_PARTED = 10.0  # times the sigma of a parameter alone: beyond, the track does not part it
_SIGMAS = 3.0
_OUTLIER = 6.0
LEAST = 20.0
"""Seconds that a flight, or what two solutions have in common, lasts at least."""
_MOST_FITTED = 4000  # differences


@dataclass(frozen=True)
class Fitted:
    """A fitted number with its sigma, and whether it was taken off."""

    value: float
    sigma: float
    removed: bool = False


@dataclass(frozen=True, eq=False)
class Compared:
    """The difference of two solutions, x less y, at common times of x's clock (n).

    position, velocity [m, m/s] north, east, down and attitude [rad] roll, pitch, heading: (n, 3), None where one of
    the two has none. track: velocity over the ground (n, 3) [m/s]. lag: of x behind y [s]. lever_arm: of x's point
    from y's, forward, right, and down where bank parts it from an offset [m], None without an attitude or a turn.
    offset: north, east, down [m], never taken off, as it is an error. clock_shift: what brings the reference's clock
    to the solution's [s], without the lag. remark: what the track does not part. notes: on clocks.
    """

    time_s: FloatArray
    position: FloatArray
    velocity: FloatArray | None
    attitude: FloatArray | None
    track: FloatArray
    lag: Fitted
    lever_arm: tuple[Fitted, ...] | None
    offset: tuple[Fitted, ...]
    clock_shift: float
    remark: str
    notes: tuple[str, ...]


def guessed(x: Solution, y: Solution | None) -> Relation:
    """The relation that the files tell; where they tell none, that of another system."""
    if y is None:
        return "claims"
    if {x.smoothing, y.smoothing} == {"forward", "backward"}:
        return "reverse"
    if x.kind != "post-processed" and y.kind == "post-processed":
        return "smoothed"
    return "independent"


def compare(x: Solution, y: Solution, rate: float = 100.0, *, remove_lag: bool = True) -> Compared:
    """The difference of two solutions of one flight.

    Parameters
    ----------
    x, y : Solution
        The solution, and its reference.
    rate : float, optional
        At which they are compared at most [Hz].
    remove_lag : bool, optional
        False to leave a lag in the difference.

    Raises
    ------
    InputError
        Under "reference": no common time, no common place, or the solution itself.
    """
    first = y.time_s[0]
    y, notes = _on_clock(y, x)
    start = _lag_of_velocities(x, y)
    lag, fit = start, None
    for _ in range(3):  # the interpolated reference moves with the lag
        fit = _fit(_difference(x, y, lag, rate))
        if not fit.parted or abs(fit.change) < 1e-4:
            break
        lag += fit.change
    assert fit is not None
    beyond = (abs(lag) > _SIGMAS * fit.lag_sigma and fit.parted) or (start != 0.0 and abs(start) > _STEP)
    removed = remove_lag and beyond
    common = _difference(x, y, lag if removed else 0.0, rate)
    if math.isclose(abs(lag), _LEAP, abs_tol=0.1):
        notes = (*notes, f"a lag of {lag:.1f} s is UTC beside GPS time: one of the two has the other clock")
    refit = _fit(common)
    position, lever_arm = common.position, refit.lever_arm
    if common.matrix is not None and lever_arm is not None and any(arm.removed for arm in lever_arm):
        arm = np.array([each.value for each in lever_arm])
        position = position - common.matrix[:, :, : len(arm)] @ arm
    return Compared(
        common.time, position, common.velocity, common.attitude, common.track, Fitted(lag, fit.lag_sigma, removed),
        lever_arm, refit.offset, float(y.time_s[0] - first), refit.remark, notes,
    )  # fmt: skip


def _on_clock(y: Solution, x: Solution) -> tuple[Solution, tuple[str, ...]]:
    """The reference with times of the solution's clock, and how they were brought there."""
    time, notes = y.time_s.copy(), list[str]()
    clocks = {x.clock, y.clock}
    if clocks <= _IN_GPS_TIME.keys():
        time += _IN_GPS_TIME[y.clock] - _IN_GPS_TIME[x.clock]
        if "utc" in clocks and len(clocks) == 2:
            notes.append(f"UTC and GPS time are {_LEAP:.0f} s apart, as since 2017")
    # A week or a day has no number: the whole ones between the two that bring them nearest.
    name, period = ("day", _DAY) if "day seconds" in clocks else ("week", _WEEK)
    if clocks & {"day seconds", "gps week seconds"} and "" not in clocks:
        middle = 0.5 * (x.time_s[0] + x.time_s[-1] - time[0] - time[-1])
        if whole := period * round(middle / period):
            time += whole
            notes.append(f"times match but for whole {name}s: the date is that of the solution")
    return replace(y, time_s=time), tuple(notes)


def _velocity(solution: Solution) -> FloatArray:
    """Velocity north, east, down [m/s] at the times of a solution, of its places where it has none."""
    if solution.velocity is not None:
        return solution.velocity
    north, east = metres_per_radian(solution.place[:, 0], solution.place[:, 2])
    rates = np.gradient(solution.place, solution.time_s, axis=0)
    return np.column_stack([rates[:, 0] * north, rates[:, 1] * east, -rates[:, 2]])


def _lag_of_velocities(x: Solution, y: Solution) -> float:
    """The lag of x behind y [s] at which velocities agree best, 0 unless they agree clearly better than without.

    Where a clock begins somewhere, any lag is looked for, else up to a minute.
    """
    any_lag = "" in (x.clock, y.clock)
    begin, end = (x.time_s[0], x.time_s[-1])
    first, last = min(begin, y.time_s[0]), max(end, y.time_s[-1])
    if not any_lag and (min(end, y.time_s[-1]) - max(begin, y.time_s[0])) < LEAST:
        return 0.0
    step = max(_STEP, (x.duration_s + y.duration_s) / 200_000)
    sampled = []
    for solution in (x, y):
        grid = np.arange(solution.time_s[0], solution.time_s[-1], step)
        sampled.append(interpolated(grid, solution.time_s, _velocity(solution)[:, :2]))
    a, b = sampled
    if not any_lag and last - first > 10 * max(x.duration_s, y.duration_s):
        return 0.0
    # Mean square of the difference at each lag by correlations: of the squares on what is common, and of the product.
    from scipy.signal import correlate

    product = sum(correlate(a[:, n], b[:, n], method="fft") for n in (0, 1))
    ones = (np.ones(len(a)), np.ones(len(b)))
    squares = correlate((a**2).sum(axis=1), ones[1], method="fft") + correlate(
        ones[0], (b**2).sum(axis=1), method="fft"
    )
    common = np.round(correlate(*ones, method="fft"))
    shift = (np.arange(len(product)) - (len(b) - 1)) * step + x.time_s[0] - y.time_s[0]
    enough = common * step >= max(LEAST, 0.3 * min(x.duration_s, y.duration_s))
    if not any_lag:
        enough &= np.abs(shift) <= _LONGEST_LAG
    if not enough.any():
        return 0.0
    mean = np.where(enough, np.maximum(squares - 2.0 * product, 0.0) / np.maximum(common, 1.0), np.inf)
    best, none = int(np.argmin(mean)), int(np.argmin(np.abs(shift)))
    if enough[none] and abs(shift[none]) <= step and not mean[best] < _CLEARLY * mean[none]:
        return 0.0  # of a track that repeats itself, any period is as good
    return float(shift[best])


@dataclass(frozen=True, eq=False)
class _Common:
    """Difference x less y at common times, as in `Compared`; matrix: rotations (n, 3, 3) from the body to north,
    east, down, of y's attitude, else of x's; None where neither has one."""

    time: FloatArray
    position: FloatArray
    velocity: FloatArray | None
    attitude: FloatArray | None
    track: FloatArray
    matrix: FloatArray | None


def _difference(x: Solution, y: Solution, lag: float, rate: float) -> _Common:
    """x less y at common times, the reference taken `lag` [s] before."""
    from scipy.interpolate import CubicHermiteSpline, CubicSpline

    begin, end = max(x.time_s[0], y.time_s[0] + lag), min(x.time_s[-1], y.time_s[-1] + lag)
    # At the times of the slower one: the faster is interpolated, which takes nothing away.
    slower = x.time_s if x.rate_hz <= y.rate_hz else y.time_s + lag
    thin = max(1, round(min(x.rate_hz, y.rate_hz) / rate))
    time = slower[(slower >= begin) & (slower <= end)][::thin]
    for solution, shift in ((x, 0.0), (y, lag)):  # not in what is not recorded
        for start, stop in solution.gaps:
            time = time[(time <= start + shift) | (time >= stop + shift)]
    if (shared := float(np.ptp(time)) if time.size else 0.0) < LEAST:
        reason = f"has {shared:.0f} s in common with the solution; a comparison needs {LEAST:.0f}"
        raise InputError("reference", f"{reason}. Give the reference of the same flight, on the same clock.")
    of_place = {}
    for name, solution, at in (("x", x, time), ("y", y, time - lag)):
        north, east = metres_per_radian(solution.place[:, 0], solution.place[:, 2])
        if np.array_equal(at, solution.time_s):
            of_place[name] = solution.place
        elif solution.velocity is not None:
            rates = solution.velocity / np.column_stack([north, east, -np.ones_like(north)])
            of_place[name] = CubicHermiteSpline(solution.time_s, solution.place, rates)(at)
        else:
            of_place[name] = CubicSpline(solution.time_s, solution.place)(at)
    north, east = metres_per_radian(of_place["y"][:, 0], of_place["y"][:, 2])
    steps = of_place["x"] - of_place["y"]
    position = np.column_stack([steps[:, 0] * north, wrapped(steps[:, 1]) * east, -steps[:, 2]])
    if not position.any():
        raise InputError("reference", "has the places of the solution itself. Give a second one.")
    if float(np.median(np.linalg.norm(position[:, :2], axis=1))) > 50_000.0:
        raise InputError("reference", "is of another place, more than 50 km away. Give that of the same flight.")

    velocity = _less(_at(time, x, x.velocity), _at(time - lag, y, y.velocity))
    euler = _at(time, x, x.attitude), _at(time - lag, y, y.attitude)
    attitude = _less(*euler)
    body = euler[0] if euler[1] is None else euler[1]
    track = interpolated(time - lag, y.time_s, _velocity(y))
    return _Common(
        time,
        position,
        velocity,
        None if attitude is None else wrapped(attitude),
        track,
        None if body is None else matrix_from_euler(*body.T),
    )


def _at(time: FloatArray, solution: Solution, values: FloatArray | None) -> FloatArray | None:
    return None if values is None else interpolated(time, solution.time_s, values)


def _less(a: FloatArray | None, b: FloatArray | None) -> FloatArray | None:
    return None if a is None or b is None else a - b


@dataclass(frozen=True)
class _Fit:
    """A fit: change of the lag, its sigma, whether the track parts it, lever arm and offset, and the remark."""

    change: float
    lag_sigma: float
    parted: bool
    lever_arm: tuple[Fitted, ...] | None
    offset: tuple[Fitted, ...]
    remark: str


def _fit(common: _Common) -> _Fit:
    """Lag, lever arm and offset fitted to a difference together, outliers aside."""
    thin = max(1, len(common.time) // _MOST_FITTED)
    d, track = common.position[::thin], common.track[::thin]
    count = len(d)
    groups = {"lag": -track[:, :, None]}
    if common.matrix is not None:
        groups |= {"lever arm": common.matrix[::thin, :, :2], "lever arm down": common.matrix[::thin, :, 2:]}
    groups["offset"] = np.broadcast_to(np.eye(3), (count, 3, 3))
    there = np.ones(count, dtype=np.bool_)
    for _ in range(2):
        values, sigma, parted = _parted(groups, d, there)
        residual = d - sum(groups[name] @ values[name] for name in values)
        size = np.linalg.norm(residual - np.median(residual, axis=0), axis=1)
        there = size <= _OUTLIER * max(float(np.median(size)), 1e-9)
    lever_arm = None
    if "lever arm" in values:
        pairs = [
            pair
            for name in ("lever arm", "lever arm down")
            if name in values
            for pair in zip(values[name].tolist(), sigma[name].tolist(), strict=True)
        ]
        removed = any(abs(value) > _SIGMAS * each and abs(value) > 0.01 for value, each in pairs)
        lever_arm = tuple(Fitted(value, each, removed) for value, each in pairs)
    offset = tuple(Fitted(v, s) for v, s in zip(values["offset"].tolist(), sigma["offset"].tolist(), strict=True))
    remark = ""
    if not parted:
        speed = np.maximum(np.linalg.norm(track, axis=1), 1e-9)
        along = float(np.mean(np.einsum("ni,ni->n", d, track) / speed))
        remark = f"the track does not part a lag from an offset: {along:+.2f} m along the velocity in all"
    change = float(values["lag"][0]) if parted else 0.0
    return _Fit(change, float(sigma["lag"][0]), parted, lever_arm, offset, remark)


def _parted(
    groups: Mapping[str, FloatArray], d: FloatArray, there: NDArray[np.bool_]
) -> tuple[dict[str, FloatArray], dict[str, FloatArray], bool]:
    """Values and sigmas by group, without those that the track does not part: the lever arm first, then the lag,
    whose sigma then is that of it alone."""
    names = list(groups)
    while True:
        values, sigma, inflation = _least_squares({name: groups[name] for name in names}, d, there)
        mixed = [
            name for name in ("lever arm down", "lever arm", "lag") if name in names and inflation[name] > _PARTED
        ]
        if not mixed:
            break
        names.remove(mixed[0])
    if "lag" in values:
        return values, sigma, True
    return values, sigma | {"lag": _least_squares({"lag": groups["lag"]}, d, there)[1]["lag"]}, False


def _least_squares(
    groups: Mapping[str, FloatArray], d: FloatArray, there: NDArray[np.bool_]
) -> tuple[dict[str, FloatArray], dict[str, FloatArray], dict[str, float]]:
    """Least squares of a difference (n, 3): values, sigmas by the residual's own correlation over time, and by how
    much the others make the sigma of a group larger than it is alone."""
    design = np.concatenate([*groups.values()], axis=2)[there]
    values = d[there]
    scale = np.maximum(np.sqrt(np.sum(design**2, axis=(0, 1))), 1e-12)
    a = design / scale
    squares = np.einsum("nij,nik->jk", a, a)
    normal = np.linalg.inv(squares + 1e-12 * np.eye(len(squares)))
    solution = normal @ np.einsum("nij,ni->j", a, values)
    residual = values - a @ solution
    scores = np.einsum("nij,ni->nj", a, residual)
    whole, longest = scores.T @ scores, _correlated(residual)
    for k in range(1, longest + 1):
        part = scores[k:].T @ scores[:-k]
        whole += (1.0 - k / (longest + 1)) * (part + part.T)
    spread = np.sqrt(np.maximum(np.diag(normal @ whole @ normal), 0.0)) / scale
    inflated = np.sqrt(np.diag(normal) * np.diag(squares))
    places, first = dict[str, slice](), 0
    for name, part in groups.items():
        places[name] = slice(first, first + part.shape[2])
        first = places[name].stop
    return (
        {name: (solution / scale)[at] for name, at in places.items()},
        {name: spread[at] for name, at in places.items()},
        {name: float(inflated[at].max()) for name, at in places.items()},
    )


def _correlated(residual: FloatArray) -> int:
    """Lag in samples up to which a residual (n, 3) is correlated with itself, twice its first crossing of zero."""
    n = len(residual)
    centred = residual - residual.mean(axis=0)
    power = np.abs(np.fft.rfft(centred, 2 * n, axis=0)) ** 2
    correlation = np.fft.irfft(power.sum(axis=1))[:n]
    below = np.flatnonzero(correlation <= 0.0)
    first = int(below[0]) if below.size else n
    return max(min(2 * first, n // 4), 1)
