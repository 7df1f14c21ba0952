"""The aperture as weights on the position and velocity errors at the nodes of a flight.

Between two nodes the position error is the cubic that has both positions and velocities: what the noise does inside a
step is left out, 0.4 % of a detrended phase with six nodes in the aperture and far less with more.
"""

import math
from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from nav_model.analytic.turning import LEFT_OF_ORDER
from nav_model.aperture.autofocus import KINDS
from nav_model.base.arrays import interpolated
from nav_model.base.errors import InputError
from nav_model.budget.inputs import Inputs
from nav_model.processing.geolocation import Shifts
from nav_model.processing.smoother import CUBICS, QUADRATICS
from nav_model.simulation.layout import ATTITUDE, BIASES, VELOCITY
from nav_model.simulation.specification import GnssModel
from nav_model.trajectory.errors import ErrorModel
from nav_model.trajectory.states import States

FloatArray = NDArray[np.float64]
ORDERS = 6
"""Legendre coefficients along the line of sight."""
COLUMNS = ORDERS + 6
_TURN = {"quadratic": (ORDERS + 1, ORDERS + 3, QUADRATICS), "cubic": (ORDERS + 2, ORDERS + 4, CUBICS)}
"""Sums of an aperture: these coefficients, the image's shift in azimuth, quadratic and cubic along the line of sight
as it turns, both of the error along the track alone [S-8], and the shifts in range and azimuth together. `_TURN` has
the places of a quadratic and a cubic, and what the coefficients of p, x p and x² p make of each."""
_POINTS, _WEIGHTS = legendre.leggauss(5)
_ROUNDING = 1e-6  # s
_MOST_WEIGHTS = 5_000_000  # nodes of all apertures: a few minutes, and some 4 GB
_SLOWEST = 0.1  # m/s, as of a design: what stands has no synthetic aperture
# Mean square that polynomials of order up to ORDERS - 1 leave of white noise integrated twice, over its density times
# T³, and thrice, over its density times T⁵: 1/420 and 17/30240 where the order is 1. [S-6], [P-15]
_BEYOND, _BEYOND_THRICE = 1 / 25740, 1 / 6126120
_FREQUENCY = math.sqrt(_BEYOND / _BEYOND_THRICE)  # rad: that of what they leave, times T
_SMOOTHED_AWAY = 0.05  # of what they leave of the free noise, by a smoother: less is left out


class Apertures(NamedTuple):
    """Apertures of a flight, one a row: the output it belongs to, where it begins [s], its line of sight (apertures,
    3), its first and last node, and weights on position and velocity errors from the first node on (apertures, nodes,
    COLUMNS, 6)."""

    output: NDArray[np.int64]
    begin: FloatArray
    sight: FloatArray
    first: NDArray[np.int64]
    last: NDArray[np.int64]
    weights: FloatArray


def apertures_of(model: ErrorModel, x: Inputs, interval: float) -> Apertures:
    """The apertures centred at the outputs of a flight that lie within it, where the aircraft moves.

    One begins at the last fix before where it would begin, as in the budget, and so is up to a fix interval early;
    without a fix there, it begins where it would. Raises InputError where they are too many and too long.
    """
    time_s, half = model.time_s, 0.5 * x.aperture
    begin = time_s[model.outputs] - half
    fixes = np.concatenate([[-np.inf], time_s[model.is_fix]])
    last_fix = fixes[np.searchsorted(fixes, begin + _ROUNDING, side="right") - 1]
    begin = np.where(begin - last_fix < interval * (1.0 + 1e-9), last_fix, begin)
    in_middle = interpolated(begin + half, time_s, model.truth.velocity)
    speed = np.linalg.norm(in_middle[:, :2], axis=1)
    inside = (begin >= 0.0) & (begin + x.aperture <= model.end_s) & (speed > _SLOWEST)
    return apertures_at(model, x, begin[inside], np.flatnonzero(inside))


def apertures_at(model: ErrorModel, x: Inputs, begin: FloatArray, output: NDArray[np.int64]) -> Apertures:
    """The apertures that begin at some times within a flight.

    Parameters
    ----------
    model : ErrorModel
    x : Inputs
    begin : array (apertures,)
        Seconds.
    output : array (apertures,)
        The output to which each belongs.

    Raises InputError where they are too many and too long.
    """
    time_s, half = model.time_s, 0.5 * x.aperture
    first = np.searchsorted(time_s, begin + _ROUNDING, side="right") - 1
    last = np.searchsorted(time_s, begin + x.aperture - _ROUNDING)
    nodes = int(np.max(last - first, initial=0)) + 1
    if len(output) * nodes > _MOST_WEIGHTS:
        reason = f"{len(output)} apertures of {nodes} steps are too many. Give fewer results or a shorter aperture."
        raise InputError("every", reason)
    in_middle = interpolated(begin + half, time_s, model.truth.velocity)
    sums, sight = sums_of(in_middle, x)
    weights = np.zeros((len(begin), nodes, COLUMNS, 6))
    for step, on, of_ends in steps_of(time_s, first, last, begin, float(x.aperture), sums):
        for end in (0, 1):
            weights[on, step + end] += of_ends[end]
    return Apertures(output, begin, sight, first, last, weights)


def steps_of(
    time_s: FloatArray,
    first: NDArray[np.int64],
    last: NDArray[np.int64],
    begin: FloatArray,
    length: float,
    sums: FloatArray,
) -> Iterator[tuple[int, NDArray[np.int64], FloatArray]]:
    """The steps of apertures from node to node: which one, of which apertures, and what the sums take of the errors
    of position and velocity at its beginning and at its end, (2, apertures, COLUMNS, 6).

    Parameters
    ----------
    time_s : array (k,)
        Nodes of the flight [s].
    first, last, begin : arrays (apertures,)
        As `Apertures` has them.
    length : float
        Of an aperture [s].
    sums : array (apertures, COLUMNS, ORDERS, 3)
        As `sums_of` gives them.
    """
    half, flat = 0.5 * length, np.ascontiguousarray(sums.swapaxes(2, 3)).reshape(-1, 3 * COLUMNS, ORDERS)
    for step in range(int(np.max(last - first, initial=0))):
        on = np.flatnonzero(first + step < last)
        left, right, start = time_s[first[on] + step], time_s[first[on] + step + 1], begin[on]
        low, high = np.maximum(left, start), np.minimum(right, start + length)
        times = 0.5 * (low + high)[:, None] + 0.5 * (high - low)[:, None] * _POINTS
        h = (right - left)[:, None]
        s = (times - left[:, None]) / h
        u = (times - start[:, None]) / half - 1.0
        measured = legendre_of(u) * (0.5 * (high - low)[:, None] * _WEIGHTS / half)[:, :, None]
        cubics = (1 - 3 * s**2 + 2 * s**3, h * (s - 2 * s**2 + s**3), 3 * s**2 - 2 * s**3, h * (s**3 - s**2))
        each = measured.swapaxes(1, 2) @ np.stack(cubics, axis=2)  # (apertures, ORDERS, position and velocity twice)
        yield (
            step,
            on,
            (flat[on] @ each)
            .reshape(len(on), COLUMNS, 3, 2, 2)
            .transpose(3, 0, 1, 4, 2)
            .reshape(2, len(on), COLUMNS, 6),
        )


def legendre_of(u: FloatArray) -> FloatArray:
    """Legendre polynomials at places -1 to 1 of an aperture (..., ORDERS): their integral with a function is that
    function's coefficient."""
    return np.asarray(legendre.legvander(u, ORDERS - 1) * (np.arange(ORDERS) + 0.5))


def sums_of(in_middle: FloatArray, x: Inputs) -> tuple[FloatArray, FloatArray]:
    """Weights of the sums of apertures on the Legendre coefficients of the position error along each axis.

    Parameters
    ----------
    in_middle : array (apertures, 3)
        Velocity in the middle of each, NED [m/s].
    x : Inputs

    Returns
    -------
    array (apertures, COLUMNS, ORDERS, 3)
        Weights of the coefficients in each sum.
    array (apertures, 3)
        Lines of sight.
    """
    sight, across = directions(in_middle, x)
    speed = np.linalg.norm(in_middle[:, :2], axis=1)
    turning, along = _turning(speed, _level(in_middle), sight, x)
    sums = np.zeros((len(in_middle), COLUMNS, ORDERS, 3))
    for order in range(ORDERS):
        sums[:, order, order] = sight
    # Shift in azimuth by the slope of the error, its Legendre coefficient of order 1. [P-7]
    slope = 2 * x.slant_range / (speed * math.cos(x.squint) * x.aperture)
    sums[:, ORDERS, 0] = across
    sums[:, ORDERS, 1] = -slope[:, None] * sight
    for of_image, of_track, functionals in _TURN.values():  # of p, x p and x² p
        sums[:, of_image] = np.einsum("jk,ajx->akx", functionals, turning)
        sums[:, of_track] = functionals[1][:, None] * along[:, None]
    sums[:, -1] = sums[:, 0] + sums[:, ORDERS]
    return sums, sight


def directions(velocity: FloatArray, x: Inputs) -> tuple[FloatArray, FloatArray]:
    """Line of sight, and the direction across it in the slant plane, for velocities (n, 3), all NED. [P-7]"""
    along = _level(velocity)
    right = np.column_stack([-along[:, 1], along[:, 0], along[:, 2]])
    s, psi = math.sin(x.squint), x.grazing_angle
    sight = s * along + math.sqrt(max(math.cos(psi) ** 2 - s**2, 0.0)) * right
    sight[:, 2] = math.sin(psi)
    return sight, (along - s * sight) / math.cos(x.squint)


def _turning(speed: FloatArray, track: FloatArray, sight: FloatArray, x: Inputs) -> tuple[FloatArray, FloatArray]:
    """The line of sight as it turns: its vectors of 1, x and x² (apertures, 3, 3), and what turns an error along the
    track alone (apertures, 3). [S-8]"""
    s, kappa = math.sin(x.squint), (speed * x.aperture / (2 * x.slant_range))[:, None]
    first = kappa * (s * sight - track)
    second = kappa**2 * ((3 * s**2 - 1) / 2 * sight - s * track)
    return np.stack([sight, first, second], axis=1), kappa * math.cos(x.squint) ** 2 * track


def _level(velocity: FloatArray) -> FloatArray:
    """Unit vectors along the track (n, 3), level, for velocities (n, 3), NED."""
    size = np.maximum(np.linalg.norm(velocity[:, :2], axis=1), 1e-9)[:, None]
    return np.hstack([velocity[:, :2] / size, np.zeros((len(velocity), 1))])


def free_rest(states: States, x: Inputs) -> FloatArray:
    """Mean square that the coefficients leave of a free INS over the aperture, by source (sources) [m²]. [P-15]

    What drives a bias acts as white noise where its correlation time is short against the periods that are left, and
    as white noise integrated once where it is long.
    """
    length, rest = float(x.aperture), np.zeros(len(states.sources))
    group = {first: name for name, first in states.first.items()} | {VELOCITY: "accelerometer", ATTITUDE: "gyro"}
    level = float((x.g * np.cos(x.grazing_angle)) ** 2) * length**2 * _BEYOND_THRICE
    sensors = {"accelerometer": _BEYOND, "gyro": level}
    slowest = _FREQUENCY / length
    for error in states.drives:
        density = error.drive
        if error.first >= BIASES:
            density /= slowest**2 + (1.0 / error.time**2 if error.time else 0.0)
        rest[error.source] += density * length**3 * sensors.get(group[error.first].split()[0], 0.0)
    return rest


def smoother_reaches(free: FloatArray, x: Inputs, gnss: GnssModel) -> bool:
    """True if fixes hold down what the coefficients leave of a free INS, `free` (sources) [m²]: if not, the smoothed
    trajectory has the same. A coefficient is known from fixes as well as white noise of their density lets it be."""
    length = float(x.aperture)
    known = 1.0 / (min(gnss.axis_noise) ** 2 * gnss.interval)
    if gnss.velocity_noise is not None:
        known += (_FREQUENCY / length) ** 2 / (min(gnss.axis_velocity_noise) ** 2 * gnss.interval)
    return bool(free.sum() * length * known > _SMOOTHED_AWAY)


def mean_square(squares: FloatArray, time_s: FloatArray, apertures: Apertures, length: float) -> FloatArray:
    """Mean square of the smoothed error along the line of sight over each aperture (sources, apertures) [m²].

    The covariance of position changes by that of position with velocity, so between two nodes it is nearly the cubic
    that has both at both ends.

    Parameters
    ----------
    squares : array (sources, nodes, 3, 6)
        Covariances of position with position and with velocity.
    time_s : array (nodes,)
        Seconds.
    apertures : Apertures
        Those that lie within the flight.
    length : float
        Of an aperture, s.
    """
    covariance = squares[..., :3]
    change = squares[..., 3:] + squares[..., 3:].swapaxes(2, 3)
    steps = np.diff(time_s)[:, None, None]
    whole = steps / 2 * (covariance[:, :-1] + covariance[:, 1:]) + steps**2 / 12 * (change[:, :-1] - change[:, 1:])
    integral = np.concatenate([0.0 * covariance[:, :1], np.cumsum(whole, axis=1)], axis=1)

    def until(at: FloatArray) -> FloatArray:
        node = np.clip(np.searchsorted(time_s, at, side="right") - 1, 0, len(time_s) - 2)
        h = np.diff(time_s)[node][:, None, None]
        u = (at - time_s[node])[:, None, None] / h
        return np.asarray(
            integral[:, node]
            + h * (u - u**3 + u**4 / 2) * covariance[:, node]
            + h * (u**3 - u**4 / 2) * covariance[:, node + 1]
            + h**2 * (u**2 / 2 - 2 * u**3 / 3 + u**4 / 4) * change[:, node]
            + h**2 * (u**4 / 4 - u**3 / 3) * change[:, node + 1]
        )

    mean = (until(apertures.begin + length) - until(apertures.begin)) / length
    return np.asarray(np.einsum("saij,ai,aj->sa", mean, apertures.sight, apertures.sight))


def smoothed_rest(whole: FloatArray, variances: FloatArray, free: FloatArray) -> FloatArray:
    """Mean square that the coefficients leave of smoothed errors, (sources, apertures) [m²].

    whole: mean square of these errors over the aperture (sources, apertures); variances: of their sums (sources,
    apertures, COLUMNS). No more is left in all than of a free INS.
    """
    rest = np.maximum(whole - sum(variances[..., n] / (2 * n + 1) for n in range(ORDERS)), 0.0)
    total = rest.sum(axis=0)
    return np.asarray(rest * np.minimum(1.0, free.sum() / np.where(total > 0.0, total, 1.0)))


def figures(variances: FloatArray, x: Inputs, rest: FloatArray) -> Mapping[str, FloatArray]:
    """Variances of the phases by name [rad²] and of the path before autofocus [m²], of those of the sums (sources,
    apertures, COLUMNS), without the autofocus's own error.

    rest: mean square that the coefficients leave, (sources, apertures) or (sources, 1) [m²].
    """
    phase = x.to_phase**2
    higher = sum(variances[..., n] / (2 * n + 1) for n in range(x.autofocus_order + 1, ORDERS))
    sight = {"quadratic": 9 / 4 * variances[..., 2], "cubic": 25 / 4 * variances[..., 3]}
    image, track = ({kind: variances[..., places[n]] for kind, places in _TURN.items()} for n in (0, 1))
    path = image["quadratic"]
    before = {"phase_before_autofocus": phase * path, "path_before_autofocus": path}
    if (residual := x.residual) is not None:
        beyond = sum(variances[..., n] / (2 * n + 1) for n in range(4, ORDERS)) + rest

        def of(parts: Mapping[str, FloatArray], beyond: FloatArray | float) -> tuple[FloatArray, ...]:
            measures = zip(residual.quadratic, residual.cubic, residual.beyond, strict=True)
            return tuple(phase * (q * parts["quadratic"] + c * parts["cubic"] + b * beyond) for q, c, b in measures)

        whole, of_sight, of_track = of(image, beyond), of(sight, beyond), of(track, 0.0)
        named = {"": whole, "line_of_sight_": of_sight, "along_track_": of_track}
        return before | {
            f"{part}{kind}_phase": values
            for part, measures in named.items()
            for kind, values in zip(KINDS, measures, strict=True)
        }
    # What autofocus leaves: of the image, the next order with the turn, and those beyond it along the line of sight.
    kind, factor = LEFT_OF_ORDER.get(x.autofocus_order, ("cubic", 0.0))
    return {
        **before,
        **{f"{kind}_phase": phase * variance for kind, variance in image.items()},
        "detrended_phase": phase * (higher + rest + factor * (image[kind] - sight[kind])),
        **{f"line_of_sight_{kind}_phase": phase * variance for kind, variance in sight.items()},
        "line_of_sight_detrended_phase": phase * (higher + rest),
        **{f"along_track_{kind}_phase": phase * variance for kind, variance in track.items()},
        "along_track_detrended_phase": phase * factor * track[kind],
    }


def shifts_of(variances: FloatArray) -> Shifts:
    """Variances of the image's shift [m²], of those of the sums (..., COLUMNS). [P-7]"""
    mean, azimuth, together = variances[..., 0], variances[..., ORDERS], variances[..., -1]
    return Shifts(mean, azimuth, 0.5 * (together - mean - azimuth), mean)
