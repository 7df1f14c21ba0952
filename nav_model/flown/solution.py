"""Solution of a navigation system along a flight, and the accuracies that it claims."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import Array

_GAP = 5.0  # median steps


@dataclass(frozen=True, eq=False)
class Claims:
    """Accuracies that a file claims for its own solution, at the times of it: 1 sigma per axis, NaN at times without.

    kind: as the file prints them: "sigma", "cep", "drms" (both brought to 1 sigma).
    position: north, east, down [m]. velocity: north, east, down [m/s]. attitude: roll, pitch, true heading
    [rad]. Shape (n, 3) each; None: no claim.
    """

    kind: str
    position: Array | None = None
    velocity: Array | None = None
    attitude: Array | None = None

    @property
    def by_axis(self) -> Array:
        """Sigmas of position, velocity and attitude (n, 9), NaN where there is no claim."""
        return nine_columns(self.position, self.velocity, self.attitude)


def wrapped(angle: Array) -> Array:
    """Angles [rad] within half a turn of 0."""
    return np.asarray(angle - 2.0 * np.pi * np.round(angle / (2.0 * np.pi)))


def gaps_of(time_s: Array) -> Array:
    """Start and end [s] of each gap of some times, longer than five median steps: (gaps, 2)."""
    steps = np.diff(time_s)
    at = np.flatnonzero(steps > _GAP * np.median(steps))
    return np.column_stack([time_s[at], time_s[at + 1]])


def nine_columns(position: Array | None, velocity: Array | None, attitude: Array | None) -> Array:
    """Position, velocity and attitude beside each other (n, 9), NaN for what is None; one at least is not."""
    parts = (position, velocity, attitude)
    empty = np.full_like(next(part for part in parts if part is not None), np.nan)
    return np.hstack([empty if part is None else part for part in parts])


@dataclass(frozen=True, eq=False)
class Solution:
    """Times, places, velocities and attitude as a file has them; what it does not have is None.

    Parameters
    ----------
    format : str
        "sbet", "rtklib", "novatel", "nmea", "ulog", "gpx", "kml" or "table".
    kind : str
        "real-time", "post-processed", or empty where the file does not tell.
    time_s : array (n,)
        Strictly increasing, of `clock` [s].
    clock : str
        "gps" (seconds of GPS time since 1980-01-06), "gps week seconds", "utc" (since 1970-01-01, without leap
        seconds), "day seconds", or empty: from some start. Times go on over the end of a week or a day.
    place : array (n, 3)
        Latitude [rad], longitude [rad] without jumps of a turn, the first within half a turn, height above the
        ellipsoid [m].
    velocity : array (n, 3) or None
        North, east, down [m/s].
    attitude : array (n, 3) or None
        Roll, pitch, true heading [rad]; roll and heading without jumps of a turn.
    claims : Claims or None
        Accuracies.
    fix : array of int8 (n,) or None
        Kind of fix at each time, a place in `fix_names`.
    fix_names : sequence of str
        Names of the kinds of fix: "fixed", "float", "single", "dgps", "sbas", "ppp", or the file's own.
    smoothing : str
        Direction of the processing as the file tells: "forward", "backward", "combined" or empty.
    notes : sequence of str
        Sentences on how the file was read, the most important first.
    """

    format: str
    kind: str
    time_s: Array
    clock: str
    place: Array
    velocity: Array | None = None
    attitude: Array | None = None
    claims: Claims | None = None
    fix: NDArray[np.int8] | None = None
    fix_names: Sequence[str] = ()
    smoothing: str = ""
    notes: Sequence[str] = ()

    @property
    def duration_s(self) -> float:
        """Time from the first to the last place [s]."""
        return float(self.time_s[-1] - self.time_s[0])

    @property
    def rate_hz(self) -> float:
        """Places in a second [Hz], by the median step."""
        return 1.0 / float(np.median(np.diff(self.time_s)))

    @property
    def gaps(self) -> list[tuple[float, float]]:
        """Times [s] between which nothing was recorded, for longer than five median steps."""
        return [(start, stop) for start, stop in gaps_of(self.time_s).tolist()]
