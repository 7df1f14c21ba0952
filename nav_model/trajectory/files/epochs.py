"""Epochs that a reader takes from a recording of a navigation system, before any is left out."""

from collections.abc import Sequence
from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import Array
from nav_model.trajectory.files.heights import Heights, counted
from nav_model.trajectory.files.recorded import USUAL_SHARE, RecordedSegment

_MOST_KINDS = 100


@dataclass(frozen=True, eq=False)
class Epochs:
    """Recorded rows, one for each time [s of `clock`]; NaN where one has nothing.

    place: latitude, longitude [rad], height above the ellipsoid [m]; velocity: north, east, down [m/s]; attitude:
    roll, pitch, true heading [rad]; the sigmas in the same axes [m, m/s, rad]. fix: place in `fix_names`. Others as
    in `nav_model.flown.solution.Solution`.
    """

    format: str
    clock: str
    time: Array
    place: Array
    velocity: Array | None = None
    attitude: Array | None = None
    sigma_position: Array | None = None
    sigma_velocity: Array | None = None
    sigma_attitude: Array | None = None
    accuracy: str = "sigma"
    fix: NDArray[np.int8] | None = None
    fix_names: tuple[str, ...] = field(default=())
    kind: str = ""
    smoothing: str = ""

    def at(self, rows: NDArray[np.intp] | NDArray[np.bool_] | slice) -> "Epochs":
        """Some of the rows."""
        arrays = {f.name: getattr(self, f.name) for f in fields(self)}
        chosen: dict[str, Any] = {name: a[rows] for name, a in arrays.items() if isinstance(a, np.ndarray)}
        return replace(self, **chosen)

    def in_order(self, heights: Heights) -> "Epochs":
        """The rows with a time later than all before, and a place on the Earth; the others are counted in a note.

        Raises InputError under the file's name where fewer than two are left.
        """
        with np.errstate(invalid="ignore"):
            whole = np.isfinite(self.time) & np.isfinite(self.place).all(axis=1)
            whole &= (np.abs(self.place[:, 0]) <= 0.5 * np.pi) & (np.abs(self.place[:, 1]) <= 2.0 * np.pi)
        if lost := int(np.sum(~whole)):
            heights.note(f"{counted(lost, 'record')} without a finite time and place on the Earth left out")
        time = np.where(whole, self.time, -np.inf)
        late = whole & (time > np.maximum.accumulate(np.concatenate([[-np.inf], time[:-1]])))
        if back := int(whole.sum() - late.sum()):
            heights.note(f"{counted(back, 'record')} left out, not later than those before")
        if late.sum() < 2:
            raise heights.refuse("holds no two places at different times")
        return self if late.all() else self.at(late)

    def claiming(self, sigmas: Array) -> "Epochs":
        """With sigmas (n, 9) of position, velocity and attitude."""
        return replace(
            self, sigma_position=sigmas[:, :3], sigma_velocity=sigmas[:, 3:6], sigma_attitude=sigmas[:, 6:]
        )

    def segment(self, heights: Heights) -> RecordedSegment:
        """The rows as they are flown, with attitude where all have one; of fixes of several kinds, those of the kind
        that most are of, where others are few."""
        if self.fix is not None and len(self.fix_names) > 1:
            counts = np.bincount(self.fix)
            usual = int(np.argmax(counts))
            if counts[usual] < len(self.fix) and counts[usual] >= USUAL_SHARE * len(self.fix):
                others = ", ".join(name for place, name in enumerate(self.fix_names) if place != usual)
                heights.note(f"{self.fix_names[usual]} fixes alone; those with {others} left out")
                return self.at(self.fix == usual).segment(heights)
        rows = [self.time - self.time[0], np.degrees(self.place[:, :2]), self.place[:, 2]]
        if self.attitude is not None and np.isfinite(self.attitude).all():
            rows.append(np.degrees(self.attitude))
        return RecordedSegment("", np.column_stack(rows))


def at_times(time: Array, stamps: Array, values: Array, heights: Heights, name: str) -> Array:
    """Values (m, k) at `stamps`, at the times of a solution: linear between, NaN before the first and after the last.

    Parameters
    ----------
    time, stamps : array
        Of the solution (n,), and of the values (m,) [s].
    values : array (m, k)
        Accuracies or velocities.
    heights : Heights
        Sentences on how it was read.
    name : str
        Origin of the values, in messages.

    Raises
    ------
    InputError
        Under the file's name, where the two have no time in common.
    """
    good = np.isfinite(stamps) & np.isfinite(values).all(axis=1)
    order = np.argsort(stamps[good], kind="stable")
    stamps, values = stamps[good][order], values[good][order]
    inside = (time >= stamps[0]) & (time <= stamps[-1]) if len(stamps) else np.zeros(len(time), dtype=bool)
    if not inside.any():
        spans = " and ".join(f"{t[0]:.0f} to {t[-1]:.0f} s" for t in (time, stamps) if len(t))
        raise heights.refuse(f"has no time in common with {name} ({spans}). Give those of one flight.")
    if outside := int(np.sum(~inside)):
        heights.note(f"{name} covers {len(time) - outside} of {len(time)} times")
    columns = [np.interp(time, stamps, column, left=np.nan, right=np.nan) for column in values.T]
    return np.column_stack(columns)


def coded(names: Sequence[str]) -> tuple[NDArray[np.int8], tuple[str, ...]]:
    """Names as places in a list of the different ones, the first before the others."""
    different = [*dict.fromkeys(names)][:_MOST_KINDS]
    place_of = {name: place for place, name in enumerate(different)}
    codes = [place_of.get(name, len(different)) for name in names]
    return np.array(codes, dtype=np.int8), (*different, *(["other"] if max(codes, default=0) == _MOST_KINDS else []))
