"""Image figures of a flown line from the difference of two solutions, by apertures that slide along it. [P-18]"""

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from nav_model.base.arrays import interpolated
from nav_model.budget.inputs import Inputs
from nav_model.design.figures import IN_FLIGHT, PARTS_OF_PHASES
from nav_model.flown.budgeted import Budgeted, Square
from nav_model.flown.relation import Compared
from nav_model.flown.result import Jump
from nav_model.flown.solution import gaps_of
from nav_model.flown.spread import Sums, covariance_of, freedom, mean_square, of_images
from nav_model.flown.track import Stretch
from nav_model.trajectory import aperture
from nav_model.trajectory.place import PLACES, beside, places_of
from nav_model.trajectory.result import STATE_AXES

FloatArray = NDArray[np.float64]
FIGURES_FLOWN = tuple(name for name in IN_FLIGHT if name not in PARTS_OF_PHASES)
"""Figures that a flown flight may show."""
_ACROSS = 0.25  # of an aperture, from one to the next
_LEAST_SAMPLES = 20  # in an aperture
_WINDOW = 100  # apertures whose covariance gives the freedom of a longer line
_FILTER = "a filter's output has the steps of its fixes, which an image from the free INS has not; the raw log tells"
_NOISY = "white noise of the reference is more than half of it"
_COMMON = "both passes share noise and fixes over an aperture"


@dataclass(frozen=True, eq=False)
class Images:
    """Mean squares of the image figures on a line, how many apertures were left out, and the middles of the others
    [s] with one sigma of each figure."""

    squares: Mapping[str, Square]
    left_out: int
    aperture_s: FloatArray
    apertures: Mapping[str, FloatArray]


def images_of(stretch: Stretch, budgeted: Budgeted, compared: Compared, jumps: tuple[Jump, ...]) -> Images:
    """The image figures of a line.

    Parameters
    ----------
    stretch : Stretch
    budgeted : Budgeted
    compared : Compared
    jumps : tuple of Jump
        Which no aperture may touch.
    """
    x, T = budgeted.x, float(budgeted.x.aperture)
    usable, left_out, why = _usable(stretch, T, compared, jumps)
    budget = _of_budget(stretch, budgeted)
    if not usable.size:
        empty = {
            name: Square(math.nan, 0.0, others, navigation, 0.0, 0, why)
            for name, (navigation, others) in budget.items()
        }
        return Images(empty, left_out, usable, {})
    columns, rest = sums_of_samples(compared.time_s, compared.position, compared.track, usable, x)
    squares = columns**2
    values = _of_sums(squares.mean(axis=0), float(rest.mean()), x)
    white = _of_white(stretch, compared, usable, x)
    C, columns_of_C, factors, window = _spread(usable, budgeted)
    expected = np.zeros(aperture.COLUMNS)
    expected[columns_of_C] = mean_square(C)
    of_output = _of_sums(expected, 0.0, x)  # of a filter's output, steps and all
    made: dict[str, Square] = {}
    refused = _COMMON if budgeted.relation == "reverse" else "" if budgeted.post_processed else _FILTER
    for name, (navigation, others) in budget.items():
        degrees = freedom(C, factors[name]) * len(usable) / window
        if not budgeted.post_processed:
            navigation = of_output[name]
        noise = white.get(name, 0.0)
        reason = refused or (_NOISY if noise > 0.5 * values[name] else "")
        made[name] = Square(values[name], -noise, others, navigation, degrees, len(usable), reason)
    by_aperture = aperture.figures(squares[None], x, rest[None])
    series = {name: np.sqrt(np.maximum(by_aperture[name][0], 0.0)) for name in made if name in by_aperture}
    return Images(made, left_out, usable + 0.5 * T, series)


def _usable(stretch: Stretch, T: float, compared: Compared, jumps: tuple[Jump, ...]) -> tuple[FloatArray, int, str]:
    """Beginnings [s] of the apertures of T on a line that have samples and touch no jump and no gap; how many touch
    one; and why there are none."""
    begin = np.arange(stretch.start, stretch.stop - T + 1e-9, _ACROSS * T)
    at = np.array([jump.time_s for jump in jumps])
    touched = np.searchsorted(at, begin + T, side="right") > np.searchsorted(at, begin - 1e-9)
    starts, ends = gaps_of(compared.time_s).T  # of either solution
    touched |= np.searchsorted(starts, begin + T, side="right") > np.searchsorted(ends, begin - 1e-9)
    first, last = np.searchsorted(compared.time_s, begin), np.searchsorted(compared.time_s, begin + T, side="right")
    few = last - first < _LEAST_SAMPLES
    why = "a jump, a gap or a change of fix in every aperture"
    if not begin.size:
        why = "the plan's line is shorter than an aperture"
    elif few.any():
        why = f"fewer than {_LEAST_SAMPLES} samples in an aperture of {T:.3g} s"
    return begin[~touched & ~few], int(touched.sum()), why


def _of_sums(squares: FloatArray, rest: float, x: Inputs) -> dict[str, float]:
    """Mean squares of the figures, of those of the sums (COLUMNS,) and of what is left along the sight [m²]."""
    phases = aperture.figures(squares[None, None], x, np.full((1, 1), rest))
    places = places_of(aperture.shifts_of(squares[None]), aperture.shifts_of(squares[None, None]), x)
    return {name: float(one[0, 0]) for name, one in phases.items()} | {
        name: float(sigma[0] ** 2) for name, (sigma, _) in places.items()
    }


def _of_white(stretch: Stretch, compared: Compared, begin: FloatArray, x: Inputs) -> Mapping[str, float]:
    """Mean squares of the phases that white noise of the difference makes: an INS has none from sample to sample, a
    reference from fixes or from sights has. Third differences show it, as no motion of an error does."""
    inside = (compared.time_s >= stretch.start) & (compared.time_s <= stretch.stop)
    variance = np.mean(np.diff(compared.position[inside], n=3, axis=0) ** 2, axis=0) / 20.0
    step, T = float(np.median(np.diff(compared.time_s))), float(x.aperture)
    count = T / step
    middle = interpolated(begin[:1] + 0.5 * T, compared.time_s, compared.track)
    sums, sight = aperture.sums_of(middle, x)
    of_orders = (2 * np.arange(aperture.ORDERS) + 1) / count
    columns = np.einsum("acmx,m,x->ac", sums**2, of_orders, variance)
    rest = (sight**2) @ variance * max(1.0 - aperture.ORDERS / count, 0.0)
    return {name: float(one[0, 0]) for name, one in aperture.figures(columns[None], x, rest[None]).items()}


def sums_of_samples(
    time: FloatArray, position: FloatArray, track: FloatArray, begin: FloatArray, x: Inputs
) -> tuple[FloatArray, FloatArray]:
    """The sums of apertures over a recorded error, and the mean square that their coefficients leave along the line
    of sight [m²], by fits with trapezia in time as weights.

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
    in_middle = interpolated(begin + 0.5 * T, time, track)
    sums, sight = aperture.sums_of(in_middle, x)
    columns, rest = np.zeros((len(begin), aperture.COLUMNS)), np.zeros(len(begin))
    for a, start in enumerate(begin):
        inside = slice(np.searchsorted(time, start, side="right"), np.searchsorted(time, start + T))
        t = np.concatenate([[start], time[inside], [start + T]])
        ends = interpolated(t[[0, -1]], time, position)
        error = np.vstack([ends[:1], position[inside], ends[1:]])
        u = 2.0 * (t - start) / T - 1.0
        weight = 0.5 * np.diff(u)
        weight = np.concatenate([weight, [0.0]]) + np.concatenate([[0.0], weight])
        # A fit, not integrals: what is constant or grows over the aperture is far larger than what it leaves.
        of_orders = legendre.legvander(u, aperture.ORDERS - 1)
        weighed = of_orders * weight[:, None]
        coefficients = np.linalg.solve(weighed.T @ of_orders, weighed.T @ error)
        columns[a] = np.einsum("cmx,mx->c", sums[a], coefficients)
        rest[a] = 0.5 * float(weight @ ((error - of_orders @ coefficients) @ sight[a]) ** 2)
    return columns, rest


def _of_budget(stretch: Stretch, budgeted: Budgeted) -> dict[str, tuple[float, float]]:
    """Mean squares of the image figures on a line by the budget: of navigation, and of all else."""
    model, on = budgeted.followed.model, budgeted.on(stretch, image=True)
    part = budgeted.followed.figures[budgeted.processing]
    squares = {}
    for name in FIGURES_FLOWN:
        if name in STATE_AXES or name not in part.figures:
            continue
        there = on & np.isfinite(part.figures[name])
        if not there.any():
            continue
        whole = part.figures[name][there] ** 2
        # A place that a flight shows has the errors beside it too, such as that of the scene's height.
        sources = len(model.states.sources) + (len(beside(budgeted.x)) if name in PLACES else 0)
        share = np.nan_to_num(part.shares[name][:sources, there].sum(axis=0))
        navigation = whole * np.minimum(share, 1.0)
        squares[name] = float(navigation.mean()), float((whole - navigation).mean())
    return squares


def _spread(
    begin: FloatArray, budgeted: Budgeted
) -> tuple[FloatArray, NDArray[np.int64], Mapping[str, FloatArray], int]:
    """Covariance of the sums of the first apertures, which of the sums it is of, the factors of each figure on their
    mean squares, and how many apertures these are."""
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
    used = np.any([values != 0.0 for values in whole.values()], axis=0)
    used[-1] = True  # with both shifts together, their covariance
    columns = np.flatnonzero(used)
    sums = of_images(model, x, aperture.apertures_at(model, x, at, np.arange(len(at))))
    chosen = Sums(sums.first, sums.before[:, :, columns], sums.after[:, :, columns])
    C = covariance_of(model, budgeted.followed.run, budgeted.adjoint, chosen, budgeted.error)
    return C, columns, {name: values[columns] for name, values in whole.items()}, len(at)
