"""SBET of any size, and smrmsg, the accuracies that a post-processor writes beside it."""

import math
from dataclasses import replace

import numpy as np

from nav_model.base.arrays import Array
from nav_model.earth.wgs84 import metres_per_radian
from nav_model.trajectory.files.epochs import Epochs, at_times
from nav_model.trajectory.files.heights import Heights
from nav_model.trajectory.files.recorded import unrolled
from nav_model.trajectory.files.sbet import ACCURACIES, DOUBLES, LARGEST_ANGLE, Buffer, in_degrees, records_of

MOST_RECORDS = 2_000_000
"""Records of an SBET that are read; of a longer file every second, third, ..."""
_ARC_MINUTE = math.radians(1.0 / 60.0)
_LEAST_TILT = 0.05  # arc minutes, of roll; no system knows it better
_MOVING = 3.0  # m/s
_FITS = 0.1  # of the speed
_MOST_COMPARED = 20_000  # records


@np.errstate(invalid="ignore", over="ignore")
def read_sbet(content: Buffer, heights: Heights, order: str = "<") -> Epochs:
    """The epochs of an SBET.

    Its velocities are in the wander frame: x ahead, y to the left, z up of a frame that is turned from north by the
    wander angle; the same angle is taken off the platform heading. Where the places show that a writer did not do so,
    the velocities are taken in the axes that fit.
    """
    records = records_of(content, DOUBLES, order)
    heights.note(f"SBET, {len(records)} records" + ("" if order == "<" else ", written big-endian"))
    if rest := memoryview(content).nbytes % (8 * DOUBLES):
        heights.note(f"the last record is cut off after {rest} bytes and left out")
    if (every := -(-len(records) // MOST_RECORDS)) > 1:
        heights.note(f"of every {every} records one is read, as there are more than {MOST_RECORDS}")
        records = records[::every]
    time, latitude, longitude, height, vx, vy, vz, roll, pitch, heading, wander = (
        np.array(records[:, at], dtype=np.float64) for at in range(11)
    )
    epochs = Epochs(
        "sbet", "gps week seconds", unrolled(time, heights), np.column_stack([latitude, longitude, height]),
        np.column_stack([vx, vy, vz]), np.column_stack([roll, pitch, heading - wander]), kind="post-processed",
    )  # fmt: skip
    good = np.isfinite(time) & np.isfinite(epochs.place).all(axis=1)
    radians = (np.abs(latitude) <= 0.5 * math.pi) & (np.abs(longitude) <= 2.0 * math.pi)
    good &= radians if radians.mean() > 0.5 else ~radians  # a damaged place says nothing of the unit
    samples = np.column_stack([time, epochs.place])[good]
    samples[:, 0] -= samples[:1, 0]
    speed = np.hypot(vx, vy)[good]
    if len(samples) > 1 and in_degrees(samples, np.where(np.isfinite(speed), speed, 0.0)):
        heights.note("positions in degrees, as the velocities say")
        epochs = replace(epochs, place=epochs.place * (math.radians(1.0), math.radians(1.0), 1.0))
        if (np.abs([roll, pitch, heading]) > LARGEST_ANGLE).any(axis=0).mean() > 0.1:
            heights.note("attitude in degrees, by its size")
            assert epochs.attitude is not None
            epochs = replace(epochs, attitude=np.radians(epochs.attitude))
            wander = np.radians(wander)
    north, east = vx * np.cos(wander) - vy * np.sin(wander), -(vx * np.sin(wander) + vy * np.cos(wander))
    axes = {
        "the wander frame": np.column_stack([north, east, -vz]),
        "north, east, down": np.column_stack([vx, vy, vz]),
        "east, north, up": np.column_stack([vy, vx, -vz]),
    }
    return replace(epochs, velocity=axes[_fitting(axes, epochs, heights)])


def _fitting(axes: dict[str, Array], epochs: Epochs, heights: Heights) -> str:
    """The axes of the velocities that agree with the places, those of the format where nothing moves."""
    usual = next(iter(axes))
    every = max(1, len(epochs.time) // _MOST_COMPARED)
    time, place = epochs.time[::every], epochs.place[::every]
    with np.errstate(invalid="ignore", divide="ignore"):
        scale = np.column_stack([*metres_per_radian(place[:-1, 0], place[:-1, 2]), np.full(len(place) - 1, -1.0)])
        moved = np.diff(place, axis=0) * scale / np.diff(time)[:, None]
        speed = _median(moved)
        if speed <= _MOVING:
            return usual
        misfit = {name: _median(0.5 * (v[::every][1:] + v[::every][:-1]) - moved) for name, v in axes.items()}
    best = min(misfit, key=misfit.__getitem__)
    if misfit[usual] <= _FITS * speed or misfit[usual] == math.inf:
        return usual
    if misfit[best] > _FITS * speed:
        heights.note(f"velocities differ from the places by {misfit[usual]:.3g} m/s in the usual axes, and in others")
        return usual
    heights.note(f"velocities taken as {best}, as the places say")
    return best


def _median(vectors: Array) -> float:
    """Median length of the vectors that are finite; infinite without one."""
    lengths = np.linalg.norm(vectors, axis=1)
    finite = lengths[np.isfinite(lengths)]
    return float(np.median(finite)) if len(finite) else math.inf


def add_accuracies(epochs: Epochs, content: Buffer, heights: Heights, name: str) -> Epochs:
    """Epochs with the accuracies of a smrmsg at their times.

    Parameters
    ----------
    epochs : Epochs
        Of the SBET.
    content : bytes
        Of the smrmsg.
    heights : Heights
        Sentences on how it was read.
    name : str
        Of the smrmsg, in messages.

    Raises
    ------
    InputError
        Where the two have no time in common.
    """
    records = np.array(records_of(content, ACCURACIES), dtype=np.float64)
    time = unrolled(records[:, 0], heights)
    size = _ARC_MINUTE
    if np.median(records[:, 7]) < _LEAST_TILT:
        size = math.radians(1.0)
        heights.note("attitude accuracies taken as degrees, as a live POS writes them: too small for arc minutes")
    sigmas = records[:, 1:] * ([1.0] * 6 + [size] * 3)
    heights.note(f"accuracies of {len(records)} records of {name}")
    return replace(epochs.claiming(at_times(epochs.time, time, sigmas, heights, name)), smoothing="combined")
