"""The error of a free INS after the last fix, with the filter's states of sensors whose biases vary. [T-21]

Every figure of real time is a variance of the state at the last fix, of a time later, or of the position error along
an aperture after it. Closed forms have these for white noise; what varying biases add is the difference of the same
variance with them and without.
"""

from collections.abc import Mapping, Sequence
from copy import copy
from typing import Self

import numpy as np

from nav_model.analytic import taylor
from nav_model.analytic.channel import SENSOR_STATES, drift, system, tilt_variance
from nav_model.analytic.doubling import Counts, Segment, continued, without_slow_error
from nav_model.analytic.taylor import System
from nav_model.base.arrays import Array
from nav_model.processing import stretch
from nav_model.processing.flight import Channel, DoubledFlight, axis_of
from nav_model.processing.smoother import batches_of, of_the_aperture, rows_of

AT_FIX = {"11": (0, 0), "12": (0, 1), "13": (0, 2), "22": (1, 1), "23": (1, 2), "33": (2, 2)}
"""Elements of the covariance of position, velocity and acceleration error."""


class FreeError:
    """The error of channels after the last of endlessly many fixes, arrays of (channels, ...) in SI."""

    def __init__(self, channels: Sequence[Channel]) -> None:
        rows, self._shape = rows_of(channels)
        axis = axis_of(rows)
        self._length, self._step, self._noise = axis.length, axis.step, axis.noise
        batches = batches_of(len(axis.step))
        flights = [DoubledFlight({name: part[batch] for name, part in rows.items()}) for batch in batches]
        self._start = np.concatenate([flight.start(0 * flight.axis.step) for flight in flights])

    def last(self) -> Self:
        """Error of the last design alone, without its imaginary steps."""
        other, which = copy(self), np.arange(len(self._start)).reshape(self._shape[0], -1)[:, -1]
        other._shape, other._noise = self._shape[:1], self._noise.changed(lambda part: part[which].real)
        other._start, other._length, other._step = (
            part[which].real for part in (self._start, self._length, self._step)
        )
        return other

    def _at(self, *numbers: Array) -> tuple[Counts, list[Array], tuple[int, ...]]:
        """Row of each result, the numbers that it depends on besides, and the shape of the results."""
        channels, *designs = self._shape
        shape = channels, *np.broadcast_shapes(tuple(designs), *(number.shape for number in numbers))
        which = np.arange(len(self._start)).reshape(channels, *(1,) * (len(shape) - len(self._shape)), *designs)
        return (
            np.broadcast_to(which, shape).ravel(),
            [np.broadcast_to(number, shape).ravel() for number in numbers],
            shape,
        )

    def at_fix(self) -> tuple[dict[str, Array], dict[str, Array]]:
        """Elements `AT_FIX` of the covariance just before a fix and just after it, and "tilt" [T-20]."""
        step = drift(np.ones_like(self._step), self._noise)
        moments = []
        for p in (_carried(self._start, step), self._start):
            plain = without_slow_error(p)
            elements = {
                name: plain[:, i, j] * self._length**2 / self._step ** (i + j) for name, (i, j) in AT_FIX.items()
            }
            elements["tilt"] = tilt_variance(p, self._noise) * self._length**2 / self._step**4
            moments.append({name: part.reshape(self._shape) for name, part in elements.items()})
        return moments[0], moments[1]

    def over_aperture(self, coast: Array, aperture: Array) -> dict[str, Array]:
        """Columns of `nav_model.processing.smoother` of an aperture [s] that begins `coast` [s] after the fix."""
        which, (coast, aperture), shape = self._at(coast, aperture)
        parts = []
        for batch in batches_of(len(which)):
            rows, step = which[batch], self._step[which[batch]]
            noise = self._noise.of(rows)
            start = _carried(self._start[rows], drift(coast[batch] / step, noise))
            whole = stretch.free(aperture[batch] / step, noise)
            parts.append(of_the_aperture(whole, start, self._length[rows], aperture[batch]))
        return _joined(parts, shape)

    def later(self, time: Array, gradient: Array) -> dict[str, Array]:
        """Variances a time [s] after the fix, with the Schuler oscillation and its coupling to the vertical. [T-17]

        Parameters
        ----------
        time : array
            Seconds.
        gradient : array
            Decrease of gravity with height [1/s²]; half of it is what draws a level axis back.

        Returns
        -------
        dict
            "position", "velocity"; "coupled", of the height that a unit coupling of the horizontal velocity makes
            [m² s²]; "tilt", growth of the variance of gravity times the tilt since the fix.
        """
        # The curve of one design, at even times from zero on, is a row of equal steps.
        evenly = (
            time.ndim == 1
            and len(self._shape) == 1
            and len(time) > 1
            and np.allclose(time, np.arange(len(time)) * time[1], rtol=1e-12, atol=0.0)
        )
        which, (after, gradient), shape = self._at(time[1] if evenly else time, gradient)
        parts = []
        for batch in batches_of(len(which)):
            rows, step, length = which[batch], self._step[which[batch]], self._length[which[batch]]
            gamma, noise = gradient[batch] * step**2, self._noise.of(rows)
            noise = noise._replace(gradient=np.where(noise.gradient == 0, -gamma / 2, noise.gradient))
            n = noise.size
            start = np.zeros((len(rows), n + 2, n + 2), self._start.dtype)
            start[:, :n, :n] = self._start[rows]
            part = taylor.drift(_coupled(system(noise), gamma), after[batch] / step)
            p = _row(start, part, len(time)) if evenly else _carried(start, part)
            of_axis = p[..., :n, :n]
            parts.append(
                {
                    "position": without_slow_error(of_axis)[..., 0, 0] * length**2,
                    "velocity": p[..., 1, 1] * (length / step) ** 2,
                    "coupled": p[..., n, n] * (length * step) ** 2,
                    "tilt": (_of_tilt(of_axis) - _of_tilt(start[:, :n, :n])) * (length / step**2) ** 2,
                }
            )
        if evenly:
            return {name: column.T for name, column in parts[0].items()}
        return _joined(parts, shape)


def _row(start: Array, step: Segment, count: int) -> Array:
    """Covariances after none, one, two and more equal steps, (count, ...): each pass doubles how many there are."""
    row = start[None]
    while len(row) < count:
        row = np.concatenate([row, _carried(row, step)])
        step = continued(step, step)
    return row[:count]


def _carried(covariance: Array, segment: Segment) -> Array:
    """Covariance of the last state of a segment without fixes."""
    return np.asarray(segment.transition @ covariance @ segment.transition.mT + segment.noise)


def _of_tilt(covariance: Array) -> Array:
    """Variance of the acceleration error less the accelerometer's bias."""
    a, b = 2, -SENSOR_STATES
    return np.asarray(covariance[..., a, a] - 2 * covariance[..., a, b] + covariance[..., b, b])


def _coupled(axis: System, gradient: Array) -> System:
    """An axis with two states more: height and its rate, which the axis's velocity drives with a coupling of one."""
    n = axis.dynamics.shape[-1]
    dynamics = np.zeros((len(gradient), n + 2, n + 2), axis.dynamics.dtype)
    drive = np.zeros((len(gradient), n + 2, axis.drive.shape[-1]), axis.dynamics.dtype)
    dynamics[:, :n, :n], drive[:, :n] = axis.dynamics, axis.drive
    dynamics[:, n, n + 1] = dynamics[:, n + 1, 1] = 1
    dynamics[:, n + 1, n] = gradient
    return System(dynamics, drive, np.maximum(axis.fastest, np.sqrt(np.abs(gradient))))


def _joined(parts: Sequence[Mapping[str, Array]], shape: tuple[int, ...]) -> dict[str, Array]:
    return {name: np.concatenate([part[name] for part in parts]).reshape(shape) for name in parts[0]}
