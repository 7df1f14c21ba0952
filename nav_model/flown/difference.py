"""Figures of a flight from the difference of two solutions, line by line, beside those of the budget. [F-1], [F-2]

What a difference shows of a solution's error depends on the relation: a smoothed reference takes away what it has in
common with the solution, an independent one adds its own error. Mean squares are over time, at one sigma and of
navigation alone; to what is compared with a limit comes what the budget has beside navigation.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.stats import chi2

from nav_model.base.units import time_in_words
from nav_model.budget.inputs import Inputs
from nav_model.budget.verdict import confidence_of
from nav_model.design import Design
from nav_model.design.figures import IN_FLIGHT, PARTS_OF_PHASES
from nav_model.design.processing import POST_PROCESSED, REAL_TIME
from nav_model.flown.relation import Compared, Relation
from nav_model.flown.result import ALL, CONSISTENT, FEW, LESS, MORE, FlownLine, FlownVerdict, Jump, Measured
from nav_model.flown.solution import Solution
from nav_model.flown.spread import Error, Sums, covariance_of, freedom, mean_square, of_images, of_states
from nav_model.flown.track import Stretch, Track
from nav_model.trajectory import aperture
from nav_model.trajectory.covariance import Followed
from nav_model.trajectory.lines import along
from nav_model.trajectory.place import PLACES, places_of
from nav_model.trajectory.result import STATE_AXES

FloatArray = NDArray[np.float64]
FIGURES_FLOWN = tuple(name for name in IN_FLIGHT if name not in PARTS_OF_PHASES)
"""Figures that a flown flight may show."""
_ACROSS = 0.25  # of an aperture, from one to the next
_LEAST_SAMPLES = 20  # in an aperture
_LEAST_FREEDOM = 5.0
_WINDOW = 100  # apertures, or results, whose covariance gives the freedom of a longer line
_CONFIDENCE = 0.95
_FILTER = "a filter's output has the steps of its fixes, which an image from the free INS has not; the raw log tells"
_COMMON = "both passes share noise and fixes over an aperture"


@dataclass(frozen=True, eq=False)
class Budgeted:
    """The budget along a flown track: the covariance in parts, the adjoint of later fixes, the relation, and whether
    the solution is post-processed."""

    design: Design
    track: Track
    followed: Followed
    adjoint: FloatArray
    relation: Relation
    post_processed: bool

    @property
    def x(self) -> Inputs:
        """Inputs of the design."""
        return self.track.spec.inputs

    @property
    def processing(self) -> str:
        """The processing whose budget the solution has."""
        return POST_PROCESSED if self.post_processed else REAL_TIME

    @property
    def error(self) -> Error:
        """The error that the difference shows."""
        if self.relation == "smoothed":
            return "difference"
        return "smoothed" if self.post_processed else "output"

    @property
    def outputs_s(self) -> FloatArray:
        """Times of the results in the flight [s]."""
        return self.followed.model.time_s[self.followed.model.outputs]

    def states(self, processing: str) -> FloatArray:
        """Variances of position, velocity and roll, pitch, yaw after each fix (outputs, 9)."""
        part = self.followed.figures[processing]
        return np.hstack([part.position, part.velocity, part.attitude]) ** 2

    @property
    def smoothed_as_believed(self) -> FloatArray:
        """Variances of the smoothed states by the filter's own belief, (outputs, 9)."""
        model, run, m = self.followed.model, self.followed.run, self.followed.model.states.estimated
        P, L = run.covariance[model.outputs], self.adjoint[model.outputs]
        rows = model.output_rows[:, :, :m]
        return np.asarray(np.einsum("oqm,omn,oqn->oq", rows, P - P @ L @ P, rows))


@dataclass(frozen=True)
class _Square:
    """A mean square of a difference: what it shows of the solution comes with `beyond` that it does not show, what
    a figure has beside navigation in `others`; all at one sigma."""

    seen: float
    beyond: float
    others: float
    budget: float
    freedom: float
    apertures: int = 0
    refused: str = ""


@dataclass(frozen=True, eq=False)
class Flown:
    """A line as it was flown, middles of its apertures [s] with one sigma of each figure, and its mean squares."""

    line: FlownLine
    aperture_s: FloatArray
    apertures: Mapping[str, FloatArray]
    squares: Mapping[str, "_Square"]


def line_of(
    stretch: Stretch, budgeted: Budgeted, compared: Compared, jumps: tuple[Jump, ...], reference: Solution
) -> Flown:
    """The figures of a line.

    Parameters
    ----------
    stretch : Stretch
    budgeted : Budgeted
    compared : Compared
    jumps : tuple of Jump
        Which no aperture may touch.
    reference : Solution
        Whose claims are its own error.
    """
    states = _states(stretch, budgeted, compared, reference)
    images, left_out, middles, values = _images(stretch, budgeted, compared, jumps)
    limits = dict(budgeted.track.spec.most)
    limits |= dict(next((line.most for line in budgeted.track.spec.lines if line.name == stretch.name), ()))
    squares = images | states
    figures = _figures(squares, limits, budgeted, stretch.stop - stretch.start)
    return Flown(FlownLine(stretch.name, stretch.start, stretch.stop, figures, left_out), middles, values, squares)


def together(flown: Sequence[Flown], budgeted: Budgeted) -> FlownLine:
    """All lines as one: mean squares over their time, with the degrees of freedom of all."""
    lines = [each.line for each in flown]
    squares = {}
    for name in dict.fromkeys(name for each in flown for name in each.squares):
        known = [
            (each.line.stop_s - each.line.start_s, each.squares[name])
            for each in flown
            if name in each.squares and math.isfinite(each.squares[name].seen)
        ]
        if not known:
            continue
        time = sum(duration for duration, _ in known)
        squares[name] = _Square(
            **{
                part: sum(duration * getattr(one, part) for duration, one in known) / time
                for part in ("seen", "beyond", "others", "budget")
            },
            freedom=sum(one.freedom for _, one in known),
            apertures=sum(one.apertures for _, one in known),
            refused=next((one.refused for _, one in known if one.refused), ""),
        )
    limits, time = dict(budgeted.track.spec.most), sum(line.stop_s - line.start_s for line in lines)
    figures = _figures(squares, limits, budgeted, time)
    left_out = sum(line.apertures_left_out for line in lines)
    return FlownLine(ALL, lines[0].start_s, lines[-1].stop_s, figures, left_out)


def _figures(
    squares: Mapping[str, "_Square"], limits: Mapping[str, float], budgeted: Budgeted, duration: float
) -> dict[str, Measured]:
    return {
        name: _measured(name, squares[name], limits.get(name), budgeted, duration)
        for name in FIGURES_FLOWN
        if name in squares
    }


def _measured(name: str, square: _Square, limit: float | None, budgeted: Budgeted, duration: float) -> Measured:
    """A figure at its confidence, with its verdict."""
    factor = confidence_of(budgeted.design, name)
    level = None if limit is None else factor * limit

    def whole(seen: float) -> float:
        return factor * math.sqrt(max(seen + square.beyond + square.others, 0.0))

    budget = factor * math.sqrt(square.budget + square.others)
    if not math.isfinite(square.seen):
        nothing = math.nan, math.nan, math.nan, 0.0, square.apertures
        verdict: FlownVerdict = "" if level is None else "cannot be told"
        return Measured(level, budget, *nothing, verdict, "", math.nan, square.refused)
    low, high = (square.seen * part for part in _band(square.freedom))
    navigation = math.sqrt(max(square.seen + square.beyond, 0.0) / square.budget) if square.budget else math.nan
    against = ""
    if square.freedom >= _LEAST_FREEDOM:
        sides = (low + square.beyond > square.budget, high + square.beyond < square.budget)
        against = MORE if sides[0] else LESS if sides[1] else CONSISTENT
    verdict, reason = _decided(level, square, (low, high), whole, duration)
    return Measured(
        level, budget, whole(square.seen), whole(low), whole(high), square.freedom, square.apertures,
        verdict, against, navigation, reason,
    )  # fmt: skip


def _band(degrees: float) -> tuple[float, float]:
    """Factors on a mean square that make the ends of its band, by chi-square."""
    if degrees < 0.5:
        return 0.0, math.inf
    half = 0.5 * (1.0 - _CONFIDENCE)
    return degrees / float(chi2.ppf(1.0 - half, degrees)), degrees / float(chi2.ppf(half, degrees))


def _decided(
    level: float | None, square: _Square, band: tuple[float, float], whole: Callable[[float], float], duration: float
) -> tuple[FlownVerdict, str]:
    """The verdict on a figure and its reason, of its limit, its band [of the mean square seen], and how a mean square
    becomes a value; `duration`: of the line [s]."""
    if level is None:
        return "", square.refused
    if square.refused:
        return "cannot be told", square.refused
    if square.freedom < _LEAST_FREEDOM:
        few = f"{square.freedom:.1f} {FEW} {_LEAST_FREEDOM:.0f}"
        return "cannot be told", few
    low, high = (whole(one) for one in band)
    if high <= level:
        return "met", ""
    if low > level:
        return "not met", ""

    # Open: with more degrees of freedom the band is narrower, until an end of it passes the limit.
    end = 1 if whole(square.seen) <= level else 0

    def beyond(logarithm: float) -> float:
        return float(whole(square.seen * _band(math.exp(logarithm))[end]) - level)

    first, last = math.log(square.freedom), math.log(1e7)
    if beyond(first) * beyond(last) > 0.0:
        return "open", "it lies at its limit"
    needed = math.exp(brentq(beyond, first, last))
    more = duration * (needed / square.freedom - 1.0)
    return "open", f"{time_in_words(more)} more of such flight would decide"


def _states(stretch: Stretch, budgeted: Budgeted, compared: Compared, reference: Solution) -> dict[str, _Square]:
    """Mean squares of the states on a line, each of the axis that is farther off."""
    clock, spec = budgeted.track.clock, budgeted.track.spec
    start, stop = clock.in_flight(np.array([stretch.start, stretch.stop])).tolist()
    on = np.flatnonzero(along(start, stop, spec, budgeted.outputs_s, image=False))
    inside = (compared.time_s >= stretch.start) & (compared.time_s <= stretch.stop)
    parts = [compared.position, compared.velocity, compared.attitude]
    count = len(compared.time_s)
    d = np.hstack([np.full((count, 3), np.nan) if part is None else part for part in parts])[inside]
    if not on.size or len(d) < 2:
        return {}
    seen = np.trapezoid(d**2, compared.time_s[inside], axis=0) / np.ptp(compared.time_s[inside])
    output = budgeted.states(budgeted.processing)[on].mean(axis=0)
    beyond, refused = _beyond(seen, output, on, budgeted, reference, compared.time_s[inside])
    # Which values stand for themselves: from some of the results, evenly.
    chosen = on[np.unique(np.linspace(0, len(on) - 1, min(len(on), 2 * _WINDOW)).astype(np.int64))]
    model, run = budgeted.followed.model, budgeted.followed.run
    error: Error = "output" if budgeted.relation == "reverse" else budgeted.error
    C = covariance_of(model, run, budgeted.adjoint, of_states(model, chosen), error)
    squares = {}
    for name, axes in STATE_AXES.items():
        if not np.isfinite(seen[axes]).all():
            continue
        axis = axes.start + int(np.argmax(seen[axes] + beyond[axes]))
        degrees = freedom(C, np.eye(9)[axis])
        squares[name] = _Square(
            float(seen[axis]), float(beyond[axis]), 0.0, float(output[axis]), degrees, refused=refused[axis]
        )
    return squares


def _beyond(
    seen: FloatArray, output: FloatArray, on: NDArray[np.int64], budgeted: Budgeted, reference: Solution,
    time: FloatArray,
) -> tuple[FloatArray, list[str]]:  # fmt: skip
    """The part of the mean square of the solution's error that is not in the difference, by axis (9,), and why an
    axis is refused. [F-1]"""
    refused = [""] * 9
    if budgeted.relation == "smoothed":
        assert budgeted.followed.difference is not None
        of_difference = budgeted.followed.difference[on].mean(axis=0)
        rest = np.maximum(output - of_difference, 0.0)
        # An IMU that is noisier than its budget makes the smoothed error larger too, by the same factor.
        believed = np.minimum(budgeted.smoothed_as_believed[on].mean(axis=0), rest)
        ratio = seen / np.where(of_difference > 0.0, of_difference, np.inf)
        empty = "the smoothed reference has the same error by the budget: is it post-processed?"
        refused = [empty if one <= 1e-6 * whole else "" for one, whole in zip(of_difference, output, strict=True)]
        return rest + (ratio - 1.0) * believed, refused
    if budgeted.relation == "reverse":
        # One time alone: the smoothed information is that of both passes together.
        smoothed = budgeted.states(POST_PROCESSED)[on].mean(axis=0)
        forward = budgeted.states(REAL_TIME)[on].mean(axis=0)
        backward = 1.0 / np.maximum(1.0 / smoothed - 1.0 / forward, 1e-12 / forward)
        return -seen * backward / (forward + backward), refused
    claimed = np.zeros(9)
    if reference.claims is not None and reference.claims.kind != "test ratio":
        near = np.clip(np.searchsorted(reference.time_s, time), 0, len(reference.time_s) - 1)
        for first, part in enumerate(
            (reference.claims.position, reference.claims.velocity, reference.claims.attitude)
        ):
            if part is not None:
                claimed[3 * first : 3 * first + 3] = np.nan_to_num(np.nanmean(part[near] ** 2, axis=0))
    for axis in np.flatnonzero(claimed > 0.5 * seen):
        refused[axis] = "the reference's claim is more than half of the difference"
    return -claimed, refused


def _images(
    stretch: Stretch, budgeted: Budgeted, compared: Compared, jumps: tuple[Jump, ...]
) -> tuple[dict[str, _Square], int, FloatArray, Mapping[str, FloatArray]]:
    """Mean squares of the image figures on a line, how many apertures were left out, and figures by aperture."""
    x, T = budgeted.x, float(budgeted.x.aperture)
    nothing = np.zeros(0)
    begin = np.arange(stretch.start, stretch.stop - T + 1e-9, _ACROSS * T)
    at = np.array([jump.time_s for jump in jumps])
    touched = np.searchsorted(at, begin + T, side="right") > np.searchsorted(at, begin - 1e-9)
    first = np.searchsorted(compared.time_s, begin)
    last = np.searchsorted(compared.time_s, begin + T, side="right")
    few = last - first < _LEAST_SAMPLES
    budget = _of_budget(stretch, budgeted)
    usable = begin[~touched & ~few]
    if not usable.size:
        why = "the plan's line is shorter than an aperture" if not begin.size else ""
        if few.any():
            why = f"fewer than {_LEAST_SAMPLES} samples in an aperture of {T:.3g} s"
        elif touched.any():
            why = "a jump, a gap or a change of fix in every aperture"
        empty = {
            name: _Square(math.nan, 0.0, others, navigation, 0.0, 0, why)
            for name, (navigation, others) in budget.items()
        }
        return empty, int(touched.sum()), nothing, {}
    columns, rest = sums_of_samples(compared.time_s, compared.position, compared.track, usable, x)
    squares = columns**2
    mean, mean_rest = squares.mean(axis=0), np.full((1, 1), rest.mean())
    values = {name: float(one[0, 0]) for name, one in aperture.figures(mean[None, None], x, mean_rest).items()}
    moved = aperture.shifts_of(mean[None])
    values |= {
        name: float(sigma[0] ** 2)
        for name, (sigma, _) in places_of(moved, aperture.shifts_of(mean[None, None]), x).items()
    }
    C, factors, window = _spread(usable, budgeted)
    expected = mean_square(C)
    by_aperture = aperture.figures(squares[None], x, rest[None])
    made: dict[str, _Square] = {}
    refused = _COMMON if budgeted.relation == "reverse" else "" if budgeted.post_processed else _FILTER
    for name, (navigation, others) in budget.items():
        degrees = freedom(C, factors[name]) * len(usable) / window
        if not budgeted.post_processed and name not in PLACES:
            navigation = float(expected @ factors[name])  # of the filter's output, steps and all
        made[name] = _Square(values[name], 0.0, others, navigation, degrees, len(usable), refused)
    series = {name: np.sqrt(np.maximum(by_aperture[name][0], 0.0)) for name in made if name in by_aperture}
    return made, int(touched.sum()), usable + 0.5 * T, series


def sums_of_samples(
    time: FloatArray, position: FloatArray, track: FloatArray, begin: FloatArray, x: Inputs
) -> tuple[FloatArray, FloatArray]:
    """The sums of apertures over a recorded error, and the mean square that their coefficients leave along the line
    of sight [m²], by trapezia in time.

    Parameters
    ----------
    time : array (n,)
        Seconds.
    position, track : array (n, 3)
        The error [m], and the velocity over the ground [m/s], north, east, down.
    begin : array (apertures,)
        Seconds.
    x : Inputs

    Returns
    -------
    array (apertures, COLUMNS), array (apertures,)
    """
    T = float(x.aperture)
    in_middle = np.column_stack([np.interp(begin + 0.5 * T, time, axis) for axis in track.T])
    sums, sight = aperture.sums_of(in_middle, x)
    columns, rest = np.zeros((len(begin), aperture.COLUMNS)), np.zeros(len(begin))
    orders = np.arange(aperture.ORDERS)
    for a, start in enumerate(begin):
        inside = slice(np.searchsorted(time, start, side="right"), np.searchsorted(time, start + T))
        t = np.concatenate([[start], time[inside], [start + T]])
        ends = np.column_stack([np.interp(t[[0, -1]], time, axis) for axis in position.T])
        error = np.vstack([ends[:1], position[inside], ends[1:]])
        u = 2.0 * (t - start) / T - 1.0
        weight = 0.5 * np.diff(u)
        weight = np.concatenate([weight, [0.0]]) + np.concatenate([[0.0], weight])
        coefficients = (aperture.legendre_of(u) * weight[:, None]).T @ error
        columns[a] = np.einsum("cmx,mx->c", sums[a], coefficients)
        whole = 0.5 * float(weight @ (error @ sight[a]) ** 2)
        rest[a] = max(whole - float(np.sum((coefficients @ sight[a]) ** 2 / (2 * orders + 1))), 0.0)
    return columns, rest


def _of_budget(stretch: Stretch, budgeted: Budgeted) -> dict[str, tuple[float, float]]:
    """Mean squares of the image figures on a line by the budget: of navigation, and of all else."""
    clock, spec, model = budgeted.track.clock, budgeted.track.spec, budgeted.followed.model
    start, stop = clock.in_flight(np.array([stretch.start, stretch.stop])).tolist()
    on = along(start, stop, spec, budgeted.outputs_s, image=True)
    part = budgeted.followed.figures[budgeted.processing]
    squares = {}
    for name in FIGURES_FLOWN:
        if name in STATE_AXES or name not in part.figures:
            continue
        there = on & np.isfinite(part.figures[name])
        if not there.any():
            continue
        whole = part.figures[name][there] ** 2
        share = np.nan_to_num(part.shares[name][: len(model.states.sources), there].sum(axis=0))
        navigation = whole if name in PLACES else whole * np.minimum(share, 1.0)
        squares[name] = float(navigation.mean()), float((whole - navigation).mean())
    return squares


def _spread(begin: FloatArray, budgeted: Budgeted) -> tuple[FloatArray, Mapping[str, FloatArray], int]:
    """Covariance of the sums of the first apertures, the factors of each figure on its mean square, and how many
    apertures these are."""
    model, x = budgeted.followed.model, budgeted.x
    at = budgeted.track.clock.in_flight(begin)
    inside = (at >= 0.0) & (at + float(x.aperture) <= model.time_s[-1])
    at = at[inside][:_WINDOW]
    whole = {
        name: values[:, 0]
        for name, values in aperture.figures(
            np.eye(aperture.COLUMNS)[:, None], x, np.zeros((aperture.COLUMNS, 1))
        ).items()
    }
    shift = np.eye(aperture.COLUMNS)
    whole |= {
        "azimuth_shift": shift[aperture.ORDERS],
        "range_shift": shift[0],
        "ce90": shift[0] + shift[aperture.ORDERS],
    }
    whole = {name: values for name, values in whole.items() if name in FIGURES_FLOWN}
    columns = np.flatnonzero(np.any([values != 0.0 for values in whole.values()], axis=0))
    sums = of_images(model, x, aperture.apertures_at(model, x, at, np.arange(len(at))))
    chosen = Sums(sums.first, sums.before[:, :, columns], sums.after[:, :, columns])
    C = covariance_of(model, budgeted.followed.run, budgeted.adjoint, chosen, budgeted.error)
    return C, {name: values[columns] for name, values in whole.items()}, len(at)
