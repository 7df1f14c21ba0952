"""Biases that vary while the filter estimates them: in-run instability and rate random walk. [T-19] to [T-21]"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from nav_model.analytic.discrete import Sawtooth
from nav_model.analytic.rise import gravity_gradient
from nav_model.analytic.steady_state import Horizontal, Vertical
from nav_model.base.arrays import Array, as_numbers
from nav_model.base.traced import Traced
from nav_model.budget.inputs import Inputs
from nav_model.processing.flight import Channel
from nav_model.processing.free import FreeError

VARYING = "varying biases"
"""Name of what they add to the phase along the line of sight, where all of them are one line."""
Columns = Mapping[str, tuple[Array, Array]]
_SIZES = ("instability_a", "instability_w", "walk_a", "walk_w")


def channels(x: Inputs) -> tuple[Channel, Channel]:
    """Inputs of the smoother for a horizontal axis and the vertical one."""
    level = upright = time = None
    if x.slow is not None:
        level, upright, time = map(as_numbers, x.slow)
    horizontal, vertical, interval = x.velocity, x.velocity_vertical, x.velocity_interval
    if horizontal is None:
        vertical = interval = None
    biases = x.instability_a, x.time_a, x.instability_w, x.time_w, x.walk_a, x.walk_w
    of_level: tuple[Array | None, ...] = biases
    of_upright: tuple[Array | None, ...] = biases
    if x.instability_w is not None and x.walk_w is not None:
        jerk, walk = x.g * x.instability_w, x.g * x.walk_w
        of_level = *biases[:2], jerk, x.time_w, x.walk_a, walk
        of_upright = *biases[:2], 0 * jerk, x.time_w, x.walk_a, 0 * walk
    fixes = x.interval, horizontal, interval, level, time
    return (
        Channel(x.sigma_a, x.g * x.sigma_w, x.fix, *fixes, None, *of_level),
        Channel(
            x.sigma_a,
            None,
            x.fix_vertical,
            x.interval,
            vertical,
            interval,
            upright,
            time,
            gravity_gradient(x.g),
            *of_upright,
        ),
    )


class VaryingBiases:
    """Additions to the variances of real time: those of a filter that estimates them less those of one without.

    Every column is a pair, of a horizontal axis and the vertical one, in SI.

    Parameters
    ----------
    x : Inputs
    number : callable, optional
        What to make of each array; the workbook makes a cell of it.
    """

    def __init__(self, x: Inputs, number: Callable[[Array], Any] = np.asarray) -> None:
        self._x, self._number = x, number
        self._later: dict[tuple[object, ...], Columns] = {}

    @cached_property
    def _error(self) -> FreeError:
        x = self._x  # real time takes velocity with each position fix
        velocity, vertical = x.velocity_of_fix or (None, None)
        x = replace(x, velocity=velocity, velocity_vertical=vertical, velocity_interval=x.interval)
        constant = replace(x, **{name: 0 * getattr(x, name) for name in _SIZES})
        return FreeError([*channels(x), *channels(constant)])

    def unstepped(self, x: Inputs) -> VaryingBiases:
        """Additions for the inputs whose sources are stepped here, but for the last design, with the same filter."""
        other = VaryingBiases(x)
        other._error = self._error.last()
        other._at_fix = _last(self._at_fix[0]), _last(self._at_fix[1])
        other.over_aperture = _last(self.over_aperture)
        return other

    def _added(self, columns: Mapping[str, Array]) -> Columns:
        """Columns of the channels with them, less those without."""
        return {
            name: (self._number(column[0] - column[2]), self._number(column[1] - column[3]))
            for name, column in columns.items()
        }

    @cached_property
    def _at_fix(self) -> tuple[Columns, Columns]:
        before, after = self._error.at_fix()
        return self._added(before), self._added(after)

    def on(self, saw: Sawtooth, *, after: bool, tilt: bool = False) -> Sawtooth:
        """The filter with them, from that without, just before a fix or just after it.

        ``p33`` is that of the acceleration error over gravity, or, with `tilt`, that of the tilt. [T-20]
        """
        columns, g, p, v = self._at_fix[after], self._x.g, saw.horizontal, saw.vertical
        level, upright = ({name: pair[axis] for name, pair in columns.items()} for axis in (0, 1))
        return Sawtooth(
            Horizontal(
                p.p11 + level["11"],
                p.p12 + level["12"],
                p.p13 + level["13"] / g,
                p.p22 + level["22"],
                p.p23 + level["23"] / g,
                p.p33 + level["tilt" if tilt else "33"] / g**2,
            ),
            Vertical(v.v11 + upright["11"], v.v12 + upright["12"], v.v22 + upright["22"]),
        )

    @cached_property
    def over_aperture(self) -> Columns:
        """Columns of the aperture, as `nav_model.processing.smoother` has them."""
        return self._added(self._error.over_aperture(self._x.before_aperture, self._x.aperture))

    def later(self, time: ArrayLike | Traced) -> Columns:
        """Columns of `FreeError.later` a time [s] after the last fix."""
        now = as_numbers(time.value if isinstance(time, Traced) else time)
        key = now.shape, now.tobytes()
        if key not in self._later:
            self._later[key] = self._added(self._error.later(now, gravity_gradient(self._x.g)))
        return self._later[key]


def _last(columns: Columns) -> Columns:
    """Columns of the last design alone, without its imaginary steps."""
    return {
        name: (np.asarray(level.flat[-1].real), np.asarray(upright.flat[-1].real))
        for name, (level, upright) in columns.items()
    }
