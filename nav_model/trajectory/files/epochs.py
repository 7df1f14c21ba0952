"""Epochs that a reader takes from a recording of a navigation system, before any is left out."""

from dataclasses import dataclass, field, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nav_model.base.arrays import Array
from nav_model.trajectory.files.heights import Heights, counted
from nav_model.trajectory.files.recorded import RecordedSegment


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

    def segment(self) -> RecordedSegment:
        """The rows as they are flown, with attitude where all have one."""
        rows = [self.time - self.time[0], np.degrees(self.place[:, :2]), self.place[:, 2]]
        if self.attitude is not None and np.isfinite(self.attitude).all():
            rows.append(np.degrees(self.attitude))
        return RecordedSegment("", np.column_stack(rows))
