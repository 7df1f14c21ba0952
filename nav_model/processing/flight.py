"""One axis of a flight with fixes: the settled filter before a moment, and what later fixes say about it.

Fixes come at whole steps from a fix of both kinds at time 0. Time is counted in these steps, length in the noise of a
position fix. Every design is a row. [T-8], [P-3]
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from nav_model.analytic import doubling
from nav_model.analytic.channel import Biases, Noise, drift
from nav_model.analytic.doubling import Counts, Powers, Rows, Segment, carried, settled, take, updated
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
    ``gradient`` is the decrease of gravity with height [1/s²], of the vertical channel alone. The rest is
    `nav_model.analytic.channel.Biases`, None where none varies.
    """

    accelerometer: Array
    gyro: Array | None
    fix: Array
    interval: Array
    velocity: Array | None = None
    velocity_interval: Array | None = None
    slow: Array | None = None
    slow_time: Array | None = None
    gradient: Array | None = None
    markov: Array | None = None
    markov_time: Array | None = None
    jerk: Array | None = None
    jerk_time: Array | None = None
    walk: Array | None = None
    jerk_walk: Array | None = None


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
    noise: Noise


def values_of(channel: Channel) -> dict[str, Array]:
    """Inputs by name; the vertical channel is a horizontal one without gyro noise."""
    inputs = dict(vars(channel))
    for name in ("gyro", "gradient"):  # one is of horizontal channels, the other of the vertical one
        inputs[name] = 0 * channel.accelerometer if inputs[name] is None else inputs[name]
    return {name: as_numbers(value) for name, value in inputs.items() if value is not None}


def axis_of(x: Mapping[str, Array]) -> Axis:
    """Noise and fixes in their own units. Where one interval holds no whole number of the other, the nearest."""
    interval = x["interval"]
    other = x.get("velocity_interval", interval)
    # The denser kind of fixes sets the step, the other comes every `parts` of them.
    position_is_dense = interval.real <= other.real
    short, long = np.where(position_is_dense, interval, other), np.where(position_is_dense, other, interval)
    parts = np.rint((long / short).real).astype(np.int64)
    step, length = long / parts, x["fix"]
    # The step is the unit of time and the noise of a fix that of length.
    noise = Noise(
        (x["accelerometer"] / length) ** 2 * step**3,
        (x["gyro"] / length) ** 2 * step**5,
        x["gradient"] * step**2,
        ((x["slow"] / length) ** 2, x["slow_time"] / step) if "slow" in x else None,
    )
    if "markov" in x:
        units = length / step**2, step, length / step**3, step, length / step**2.5, length / step**3.5
        in_units = (x[name] / unit for name, unit in zip(Biases._fields, units, strict=True))
        noise = noise._replace(biases=Biases(*in_units))
    size = noise.size
    position, velocity = np.zeros((2, len(step), size, size), np.result_type(*x.values()))
    position[:, 0, 0] = 1
    if "velocity" in x:
        velocity[:, 1, 1] = (length / (x["velocity"] * step)) ** 2
    choice = position_is_dense[:, None, None]
    # Steps that were rounded change the number of fixes, not what they say in all.
    dense = np.where(choice, position, velocity) * (step / short)[:, None, None]
    sparse = np.where(choice, velocity, position)
    together = (parts == 1)[:, None, None]
    return Axis(length, step, parts, np.where(together, dense + sparse, dense), np.where(together, 0, sparse), noise)


class DoubledFlight:
    """A flight, of two units that are doubled: a step, from a fix to the next one, and a period, from fixes of both
    kinds to the next of both. Each has the fix at its end, not the one at its beginning.

    Either is there twice: as a segment (``step``, ``period``), for what a filter needs, and as a stretch
    (``step_stretch``, ``period_stretch``), which costs more, for the error along the aperture.

    The time line of ``parts`` = 3, with fixes of both kinds ``#`` and of the dense kind ``|``::

        ---#---|---|---#---|---|---#---
           0   1   2   3   4   5   6      time in steps
           <---------->                   a period, without the fixes at 0 and with those at 3
    """

    def __init__(self, x: Mapping[str, Array]) -> None:
        self.axis = axis = axis_of(x)
        # Designs with the same noise and fixes, such as those of a map that differ in the radar, share their units.
        inputs = np.stack([x[name] for name in Channel.__dataclass_fields__ if name in x])
        _, self._first, self._which = np.unique(inputs, axis=1, return_index=True, return_inverse=True)
        self._seldom = bool(np.any(axis.parts > 1))
        step = doubling.measured(drift(np.ones_like(axis.step), axis.noise), axis.dense)
        self.step = self.period = self._powers(step, doubling.joined)
        if self._seldom:
            period = doubling.measured(self.step.prepend(axis.parts - 1, step), axis.sparse)
            self.period = self._powers(period, doubling.joined)

    @cached_property
    def step_stretch(self) -> Powers[Stretch]:
        """Steps as stretches."""
        return self._powers(self._step_stretch, stretch.joined)

    @cached_property
    def period_stretch(self) -> Powers[Stretch]:
        """Periods as stretches."""
        if not self._seldom:
            return self.step_stretch
        period = self.step_stretch.prepend(self.axis.parts - 1, self._step_stretch)
        return self._powers(stretch.measured(period, self.axis.sparse), stretch.joined)

    @cached_property
    def _step_stretch(self) -> Stretch:
        return stretch.measured(stretch.free(np.ones_like(self.axis.step), self.axis.noise), self.axis.dense)

    def _powers(self, unit: Rows, joined: Callable[[Rows, Rows], Rows]) -> Powers[Rows]:
        return Powers(take(unit, self._first), joined, self._which)

    def start(self, gap: Array) -> Array:
        """Covariance P [(rows, n, n)] just after the fixes at time 0, without those of a gap [steps] before it."""
        covariance, axis = settled(self.period)[self._which], self.axis
        if np.any(gap):
            # Of the fixes since the last time that both kinds shared, those within the gap are missing; a gap longer
            # than that begins where both kinds come.
            count = np.maximum(axis.parts - np.maximum(_first(np.minimum(gap.real, axis.parts)), 1), 0)
            without_fixes = drift(np.where(gap.real > axis.parts, gap, axis.parts) - count, axis.noise)
            covariance = carried(covariance, self.step.prepend(count, without_fixes))
            covariance = updated(covariance, axis.dense + axis.sparse)
        return covariance

    def stretch_to(self, end: Array) -> Stretch:
        """From time 0, without the fixes there, to a time [steps] that may be at a fix, without it."""
        fixes = _first(end) - 1
        # Whole periods, then whole steps, then the time after the last fix.
        tail = stretch.free(end - fixes, self.axis.noise)
        tail = self.step_stretch.prepend(fixes % self.axis.parts, tail)
        return self.period_stretch.prepend(fixes // self.axis.parts, tail)

    def segment_to(self, end: Array) -> Segment:
        """The segment of `stretch_to`, at less cost."""
        fixes = _first(end) - 1
        tail = self.step.prepend(fixes % self.axis.parts, drift(end - fixes, self.axis.noise))
        return self.period.prepend(fixes // self.axis.parts, tail)

    def information_after(self, time: Array, until: Array, end: Array | None = None) -> Array:
        """Information Y about the state at a time, from the fixes from then on until a later time: (rows, n, n).

        Times are in steps; `end` is information about the state at the last of these fixes from elsewhere.
        """
        axis = self.axis
        # Fixes from the first to the last, and among them the first that both kinds share, `to_shared` steps later.
        first, last = _first(time), np.asarray(np.floor(np.minimum(until.real, _FOREVER) + _ROUNDING), np.int64)
        count = last - first  # steps from the first fix to the last; negative without one
        to_shared = -first % axis.parts
        has_shared = count >= to_shared
        after_shared = np.where(has_shared, count - to_shared, 0)
        # From the last fix back to the first: `tail` is the flight after a moment, and grows at its front. It begins
        # with no time and the information from elsewhere; then come the steps after the last shared fix.
        nothing = np.zeros((len(time), axis.noise.size, axis.noise.size))
        tail = Segment(nothing if end is None else end, nothing + np.eye(axis.noise.size), nothing)
        tail = self.step.prepend(after_shared % axis.parts, tail)
        # Whole periods, between shared fixes; then the sparse part of the first of these: no period begins with it.
        tail = self.period.prepend(after_shared // axis.parts, tail)
        tail = tail._replace(info=tail.info + axis.sparse * has_shared[:, None, None])
        # Steps from the first fix to that one, or to the last where no fix is shared.
        tail = self.step.prepend(np.where(has_shared, to_shared, np.maximum(count, 0)), tail)
        # The dense part of the first fix: no step begins with it. Then back from it to the time itself.
        info = tail.info + axis.dense * (count >= 0)[:, None, None]
        return doubling.measured(drift(first - time, axis.noise), info).info


def _first(time: Array) -> Counts:
    """The first fix at a time or after it, counted from that at time 0."""
    return np.asarray(np.ceil(time.real - _ROUNDING), np.int64)
