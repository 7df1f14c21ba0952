"""One axis of a flight with fixes: the settled filter before a moment, and what later fixes say about it.

Fixes come at whole steps from a fix of both kinds at time 0. Time is counted in these steps, length in the noise of a
position fix. Every design is a row. [T-8], [P-3]
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from nav_model.analytic import doubling
from nav_model.analytic.doubling import Counts, Doubles, Segment, carried, drift, settled, take, updated
from nav_model.base.arrays import Array, as_numbers
from nav_model.processing import stretch
from nav_model.processing.stretch import Stretch

_ROUNDING = 1e-9  # of a step: a fix at the end of the aperture is at its end
_FOREVER = 2.0**40  # steps: farther fixes say nothing


@dataclass(frozen=True)
class Channel:
    """One axis: noise of the inertial sensors and of the receiver; arrays that broadcast together.

    ``accelerometer`` is the velocity random walk [m/s/√s], ``gyro`` gravity times the angle random walk
    [m/s²/√s], None for the vertical. ``fix`` and ``interval`` are one position fix, 1σ [m], and the time between two
    [s]; ``velocity`` and ``velocity_interval`` the same for velocity [m/s], [s], None without it. ``slow`` and
    ``slow_time`` are the slow error of the position fixes, 1σ [m], and its correlation time [s], None without it.
    """

    accelerometer: Array
    gyro: Array | None
    fix: Array
    interval: Array
    velocity: Array | None = None
    velocity_interval: Array | None = None
    slow: Array | None = None
    slow_time: Array | None = None


class Axis(NamedTuple):
    """Noise and fixes of one axis, one design a row, in its own units, ``length`` [m] and ``step`` [s].

    Of the two kinds of fixes, of position and of velocity, one comes every step and the other every ``parts`` steps:
    `dense` and `sparse` are the information of one such fix about the state, (rows, n, n). Both come at time 0.
    """

    length: Array
    step: Array
    parts: Counts
    dense: Array
    sparse: Array
    noise: tuple[Array, Array, tuple[Array, Array] | None]  # as `drift` takes them


def values_of(channel: Channel) -> dict[str, Array]:
    """Inputs by name; the vertical channel is a horizontal one without gyro noise."""
    inputs = dict(vars(channel))
    inputs["gyro"] = 0 * channel.accelerometer if channel.gyro is None else channel.gyro
    return {name: as_numbers(value) for name, value in inputs.items() if value is not None}


def axis_of(x: Mapping[str, Array]) -> Axis:
    """Noise and fixes in their own units. Where one interval holds no whole number of the other, the nearest."""
    interval = x["interval"]
    other = x.get("velocity_interval", interval)
    positions_often = interval.real <= other.real
    often, seldom = np.where(positions_often, interval, other), np.where(positions_often, other, interval)
    parts = np.rint((seldom / often).real).astype(np.int64)
    step, length = seldom / parts, x["fix"]
    slow = None
    if "slow" in x:
        slow = (x["slow"] / length) ** 2, x["slow_time"] / step
    size = 3 if slow is None else 4
    noise = (x["accelerometer"] / length) ** 2 * step**3, (x["gyro"] / length) ** 2 * step**5, slow
    position, velocity = np.zeros((2, len(step), size, size), np.result_type(*x.values()))
    position[:, 0, 0] = 1
    if "velocity" in x:
        velocity[:, 1, 1] = (length / (x["velocity"] * step)) ** 2
    first = positions_often[:, None, None]
    # Steps that were rounded change the number of fixes, not what they say in all.
    dense = np.where(first, position, velocity) * (step / often)[:, None, None]
    sparse = np.where(first, velocity, position)
    alone = (parts == 1)[:, None, None]
    return Axis(length, step, parts, np.where(alone, dense + sparse, dense), np.where(alone, 0, sparse), noise)


class Flight:
    """A flight, of two units that are doubled: a step, from a fix to the next one, and a period, from fixes of both
    kinds to the next of both. Each has the fix at its end, not the one at its beginning.

    Either is there twice: as a segment (``step``, ``period``), for what a filter needs, and as a stretch
    (``step_along``, ``period_along``), which costs more, for what becomes of the error along the aperture.
    """

    def __init__(self, x: Mapping[str, Array]) -> None:
        self.axis = axis = axis_of(x)
        # Designs with the same noise and fixes, such as those of a map that differ in the radar, share their units.
        inputs = np.stack([x[name] for name in Channel.__dataclass_fields__ if name in x])
        _, first, self._which = np.unique(inputs, axis=1, return_index=True, return_inverse=True)
        one = stretch.measured(stretch.free(np.ones_like(axis.step), *axis.noise), axis.dense)
        self.step_along, self.step = self.period_along, self.period = self._doubles(take(one, first))
        if np.any(axis.parts > 1):
            many = stretch.measured(self.step_along.before(axis.parts - 1, one), axis.sparse)
            self.period_along, self.period = self._doubles(take(many, first))

    def _doubles(self, unit: Stretch) -> tuple[Doubles[Stretch], Doubles[Segment]]:
        along = Doubles(unit, stretch.joined, self._which)
        return along, Doubles(unit.segment, doubling.joined, self._which)

    def start(self, gap: Array) -> Array:
        """Covariance just after the fixes at time 0, without those of a gap before it."""
        found, axis = settled(self.period)[self._which], self.axis
        if np.any(gap):
            # Of the fixes since the last time that both kinds shared, those within the gap are missing; a gap longer
            # than that begins where both kinds come.
            count = np.maximum(axis.parts - np.maximum(_first(np.minimum(gap.real, axis.parts)), 1), 0)
            row = drift(np.where(gap.real > axis.parts, gap, axis.parts) - count, *axis.noise)
            found = updated(carried(found, self.step.before(count, row)), axis.dense + axis.sparse)
        return found

    def along(self, until: Array) -> Stretch:
        """From time 0, without the fixes there, to a time that may be at a fix, without it."""
        fixes = _first(until) - 1
        # Whole periods, then whole steps, then what is left without a fix.
        row = self.step_along.before(fixes % self.axis.parts, stretch.free(until - fixes, *self.axis.noise))
        return self.period_along.before(fixes // self.axis.parts, row)

    def to(self, until: Array) -> Segment:
        """The same without what becomes of the error along the way."""
        fixes = _first(until) - 1
        row = self.step.before(fixes % self.axis.parts, drift(until - fixes, *self.axis.noise))
        return self.period.before(fixes // self.axis.parts, row)

    def ahead(self, time: Array, until: Array, beyond: Array | None = None) -> Array:
        """Information about the state at a time, from the fixes from then on up to a later time: (rows, n, n).

        `beyond` is what is known about the state at the last of them besides.
        """
        axis = self.axis
        first, last = _first(time), np.asarray(np.floor(np.minimum(until.real, _FOREVER) + _ROUNDING), np.int64)
        count = last - first  # steps between fixes; negative without one
        lead = -first % axis.parts  # steps to the next fix that both kinds share
        shared = count >= lead
        rest = np.where(shared, count - lead, 0)
        # From the last fix back to the first: `row` is what is after a moment, and grows at its front. It begins with
        # nothing but what is known beyond, then come steps, whole periods, and the steps to the first shared fix.
        row = drift(0 * time, *axis.noise)
        if beyond is not None:
            row = row._replace(info=row.info + beyond)
        row = self.period.before(rest // axis.parts, self.step.before(rest % axis.parts, row))
        row = row._replace(info=row.info + axis.sparse * shared[:, None, None])
        row = self.step.before(np.where(shared, lead, np.maximum(count, 0)), row)
        # Units do not have the fix at their beginning: here it is the first of all. Then back from it to the time.
        known = row.info + axis.dense * (count >= 0)[:, None, None]
        return doubling.measured(drift(first - time, *axis.noise), known).info


def _first(time: Array) -> Counts:
    """The first fix at a time or after it, counted from that at time 0."""
    return np.asarray(np.ceil(time.real - _ROUNDING), np.int64)
