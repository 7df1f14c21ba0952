"""SBET: what an inertial post-processor writes, told from other files by its content."""

import math
from mmap import mmap

import numpy as np

from nav_model.base.arrays import Array
from nav_model.earth.wgs84 import metres_per_radian
from nav_model.trajectory.files.heights import Heights
from nav_model.trajectory.files.recorded import as_flown, unrolled
from nav_model.trajectory.plan import PlannedFlight

DOUBLES, ACCURACIES = 17, 10
"""In a record of SBET, and of smrmsg."""
Buffer = bytes | memoryview | mmap
_LOOKED_AT = 2000  # records
_LIKELY = 0.9  # of the records; others may be damaged
_MOVING = 1.0  # m/s
LARGEST_ANGLE = 4.0 * math.pi  # rad, of a heading that counts its turns, less a wander angle


@np.errstate(invalid="ignore", over="ignore")
def name_of(content: Buffer, order: str = "<") -> str:
    """SBET, or smrmsg, the accuracies of one, where records of doubles make sense: time that goes on, then places on
    the Earth or standard deviations; empty for any other file. order: of the bytes, "<" or ">"."""
    records, accuracies = (records_of(content, doubles, order)[:_LOOKED_AT] for doubles in (DOUBLES, ACCURACIES))
    whole, deviations = not memoryview(content).nbytes % (8 * ACCURACIES), accuracies[:, 1:]
    if whole and _goes_on(accuracies) and ((deviations >= 0.0) & (deviations < 1e6)).all():
        return "smrmsg"
    places = (np.abs(records[:, 1:3]) <= (90.0, 360.0)).all(axis=1)
    return "SBET" if _goes_on(records) and places.mean() > _LIKELY else ""


def read_sbet(content: bytes, heights: Heights) -> PlannedFlight:
    """The flight of an SBET file, heading less the wander angle.

    Raises InputError under the file's name, with the record: no finite numbers, and what `as_flown` refuses.
    """
    records = records_of(content, DOUBLES)
    if len(broken := np.flatnonzero(~np.isfinite(records[:, :11]).all(axis=1))):
        raise heights.refuse(f"record {broken[0] + 1} has no finite numbers")
    heights.note(f"SBET, {len(records)} records")
    if rest := len(content) % (8 * DOUBLES):
        heights.note(f"the last record is cut off after {rest} bytes and left out")
    time = unrolled(records[:, 0], heights)
    samples = np.column_stack([time - time[0], records[:, [1, 2, 3, 7, 8]], records[:, 9] - records[:, 10]])
    if in_degrees(samples, np.hypot(records[:, 4], records[:, 5])):
        samples[:, 1:3] = np.radians(samples[:, 1:3])
        heights.note("positions in degrees, as the velocities say")
        if degrees := np.abs(samples[:, 4:]).max() > LARGEST_ANGLE:
            samples[:, 4:] = np.radians(samples[:, 4:])
        heights.note(f"attitude in {'degrees' if degrees else 'radians'}, by its size")
    return as_flown(samples, heights, "record")


def records_of(content: Buffer, doubles: int, order: str = "<") -> Array:
    """Whole records of so many doubles, not copied."""
    count = memoryview(content).nbytes // (8 * doubles) * doubles
    return np.frombuffer(content, dtype=f"{order}f8", count=count).reshape(-1, doubles)


def _goes_on(records: Array) -> bool:
    """True if records begin with times of a week or a day that mostly increase, by less than a minute."""
    if len(records) < 2:
        return False
    steps = np.diff(records[:, 0])
    likely = (steps > -1.0) & (steps < 60.0)
    return bool((np.abs(records[:, 0]) < 1e7).all() and np.median(steps) > 1e-6 and likely.mean() > _LIKELY)


def in_degrees(samples: Array, speed: Array) -> bool:
    """True if latitudes and longitudes are degrees: beyond the poles in radians, or the way between places is that of
    the velocities only so. Without motion they are radians, as the format says."""
    if np.abs(samples[:, 1]).max() > 0.5 * math.pi or np.abs(samples[:, 2]).max() > 2.0 * math.pi:
        return True
    time = samples[:, 0]
    flown = float(np.sum(0.5 * (speed[1:] + speed[:-1]) * np.diff(time)))
    if flown <= _MOVING * time[-1]:
        return False
    ways = []
    for size in (1.0, math.radians(1.0)):
        north, east = metres_per_radian(size * samples[:, 1], 0.0)
        steps = size * np.diff(np.unwrap(samples[:, 1:3], axis=0, period=2.0 * math.pi / size), axis=0)
        ways.append(float(np.hypot(steps[:, 0] * north[1:], steps[:, 1] * east[1:]).sum()))
    as_radians, as_degrees = (abs(math.log(max(way, 1e-9) / flown)) for way in ways)
    return as_degrees < as_radians
