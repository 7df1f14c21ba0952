"""The smoothed error of an axis over an aperture. [P-3], [P-5]

A flight's filter has run since take-off, and its smoother has every fix of the flight. So, by `DoubledFlight`:

- before the aperture, the covariance of the settled filter just after the fix at its start (`start`);
- after it, the information of the fixes of `after` seconds about the state at its end (`information_after`);
- between the two, a stretch of flight with the Legendre coefficients of its position error (`stretch_to`).

Everything broadcasts and takes complex steps, and every design is solved by this one method.
"""

from collections.abc import Collection, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from nav_model.analytic.channel import tilt_variance
from nav_model.analytic.doubling import Counts, carried, updated, without_slow_error
from nav_model.analytic.taylor import ORDERS
from nav_model.base.arrays import Array, as_numbers
from nav_model.processing import stretch
from nav_model.processing.flight import Channel, DoubledFlight, values_of
from nav_model.processing.stretch import Stretch

COLUMNS = (
    "quadratic", "cubic", "left_1", "left_2", "left_3", "slope", "turned", "curved", "with_curved", "mean",
    "position", "velocity", "tilt", "mean_slope", "with_turned", "turned_curved", "cubic_turned", "cubic_curved",
    "cubic_with_turned", "cubic_with_curved", "cubic_turned_curved",
)  # fmt: skip
"""Columns of `smoothed_error`, for an axis."""
IN_THE_MIDDLE = ("position", "velocity", "tilt")
"""Columns in the middle of the aperture; the others describe the whole."""

QUADRATICS = np.array([[0, 0, 3 / 2, 0, 0, 0], [0, 1, 0, 9 / 14, 0, 0], [1, 0, 11 / 14, 0, 2 / 7, 0]])
CUBICS = np.array([[0, 0, 0, 5 / 2, 0, 0], [0, 0, 3 / 2, 0, 10 / 9, 0], [0, 1, 0, 23 / 18, 0, 50 / 99]])
"""Quadratics, and cubics, by the Legendre coefficients of orders 0 to 5, of the error, of its turn, and of the square
of its turn, (3, 6)."""
_AT_ONCE = 1024  # designs


def smoothed_error(
    channels: Sequence[Channel], aperture: Array, after: Array, gap: Array, names: Collection[str]
) -> list[dict[str, Array]]:
    """The smoothed error over an aperture that begins at a fix. [P-3], [P-5]

    Parameters
    ----------
    channels : sequence of Channel
    aperture : array
        Seconds.
    after : array
        Seconds of fixes after the aperture, for which the smoother waits.
    gap : array
        Seconds without fixes right before the aperture.
    names : collection of str
        Of `COLUMNS`.

    Returns
    -------
    list of dict
        For each channel: name -> array that broadcasts to the shape of all inputs together. Variances [m²] of the
        ``quadratic`` and ``cubic`` coefficients, of the mean square that polynomials up to orders 1, 2 and 3 leave
        (``left_1`` to 3) and of the ``mean``; of the ``slope`` [m²/s²]; ``mean_slope`` is the covariance of the two.
        ``turned`` and ``curved`` are variances of the quadratics of the error times x and x² (x from -1 to 1), the
        turn of the line of sight and its square, ``with_turned``, ``with_curved`` and ``turned_curved`` covariances
        of the three, with ``cubic_`` those of the cubics. Variances of ``position`` [m²], ``velocity`` [m²/s²] and of
        ``tilt`` times gravity [m²/s⁴] are those in the middle.

    Examples
    --------
    >>> navigation = Channel(*(np.array(x) for x in (1e-4, 1e-5, 0.03, 0.1)))
    >>> (found,) = smoothed_error([navigation], np.array(3.0), np.array(200.0), np.array(0.0), ["position"])
    >>> f"{float(found['position']) ** 0.5 * 1e3:.3f} mm"
    '2.170 mm'
    """
    error = SmoothedError(channels, aperture, after, gap)
    return [{name: error[name][n] for name in names} for n in range(len(channels))]


def rows_of(channels: Sequence[Channel], **times: Array) -> tuple[dict[str, Array], tuple[int, ...]]:
    """Inputs and times of channels by name, a row for each channel of each design; and the shape of the rows."""
    many = [values_of(channel) | times for channel in channels]
    shape = np.broadcast_shapes(*(value.shape for values in many for value in values.values()))
    names = many[0]
    rows = {name: np.concatenate([np.broadcast_to(values[name], shape).ravel() for values in many]) for name in names}
    return rows, (len(many), *shape)


def batches_of(count: int) -> list[Counts]:
    """Rows to work on together, so that their matrices stay in the cache."""
    return np.array_split(np.arange(count), max(1, -(-count // _AT_ONCE)))


class SmoothedError:
    """As `smoothed_error`, column by column: ``error[name][n]`` is that of channel n. Those of the aperture are
    computed when one of them is first read, and so are those in its middle; both begin with the same filter."""

    def __init__(self, channels: Sequence[Channel], aperture: Array, after: Array, gap: Array) -> None:
        times = as_numbers(aperture), as_numbers(after), as_numbers(gap)
        rows, self._shape = rows_of(channels, aperture=times[0], after=times[1], gap=times[2])
        batches = batches_of(len(rows["fix"]))
        self._batches = [_Batch({name: value[batch] for name, value in rows.items()}) for batch in batches]

    def __getitem__(self, name: str) -> Array:
        return (self._middle if name in IN_THE_MIDDLE else self._aperture)[name]

    @cached_property
    def _aperture(self) -> Mapping[str, Array]:
        return self._joined([batch.of_the_aperture() for batch in self._batches])

    @cached_property
    def _middle(self) -> Mapping[str, Array]:
        return self._joined([batch.in_the_middle() for batch in self._batches])

    def _joined(self, parts: Sequence[Mapping[str, Array]]) -> Mapping[str, Array]:
        return {name: np.concatenate([part[name] for part in parts]).reshape(self._shape) for name in parts[0]}


class _Batch:
    """Some rows, each an axis of a design with the times of its aperture."""

    def __init__(self, x: Mapping[str, Array]) -> None:
        self._flight = DoubledFlight(x)
        axis = self._axis = self._flight.axis
        self._seconds = x["aperture"]
        self._aperture, self._after, gap = (x[name] / axis.step for name in ("aperture", "after", "gap"))
        self._start = self._flight.start(gap)

    def of_the_aperture(self) -> dict[str, Array]:
        """The columns of the whole aperture, (rows)."""
        flight, axis, aperture, after, start = self._flight, self._axis, self._aperture, self._after, self._start
        # The aperture with its fixes and those after it; given these, its coefficients are lines x0 + noise.
        whole = stretch.measured(flight.stretch_to(aperture), flight.information_after(aperture, aperture + after))
        # P' = (1 + P Y)⁻¹ P, of the state at the aperture's start with every fix.
        return of_the_aperture(whole, updated(start, whole.info), axis.length, self._seconds)

    def in_the_middle(self) -> dict[str, Array]:
        """The columns in the middle of the aperture, (rows)."""
        flight, axis, start = self._flight, self._axis, self._start
        middle = self._aperture / 2  # forward to it with the fixes before, then the information of those after
        forward = carried(start, flight.segment_to(middle))
        smoothed = updated(forward, flight.information_after(middle, self._aperture + self._after))
        variance = np.einsum("nii->ni", without_slow_error(smoothed))
        variance[:, 2] = tilt_variance(smoothed, axis.noise)
        return {name: variance[:, n] * (axis.length / axis.step**n) ** 2 for n, name in enumerate(IN_THE_MIDDLE)}


def of_the_aperture(whole: Stretch, start: Array, length: Array, t: Array) -> dict[str, Array]:
    """The columns that describe a whole aperture.

    Parameters
    ----------
    whole : Stretch
        The aperture, of (rows).
    start : array (rows, n, n)
        Covariance of the state at its start.
    length : array (rows)
        The stretch's unit of length [m].
    t : array (rows)
        Aperture [s].
    """
    n = start.shape[-1]
    lines = whole.lines[..., :n]
    spread = whole.spread + lines @ start @ lines.mT
    rest = whole.rest + np.einsum("nij,nij->n", start, whole.gram[:, :n, :n])
    # From orthonormal polynomials to those of Legendre, and from the axis's units to metres.
    root = np.sqrt(2 * np.arange(ORDERS) + 1)
    named = spread * (root[:, None] * root) * (length**2)[:, None, None]
    left_3 = (spread[:, 4, 4] + spread[:, 5, 5] + rest) * length**2
    of_turn, of_cubic = (rows @ named @ rows.T for rows in (QUADRATICS, CUBICS))
    quadratic, cubic = named[:, 2, 2] * 9 / 4, named[:, 3, 3] * 25 / 4
    left_2 = left_3 + cubic * (4 / 25 / 7)
    columns: dict[str, Any] = {
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
    }
    # A mean square that rounding has made negative has no digits: such a design, of an array of them, has no number.
    for name in ("left_1", "left_2", "left_3"):
        columns[name] = np.where(columns[name].real < 0, np.nan, columns[name])
    return columns
