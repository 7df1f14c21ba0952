"""Flights written as trajectory files, to be read again."""

import io

import numpy as np
from numpy.typing import NDArray

from nav_model.earth.sphere import local_axes
from nav_model.earth.trajectory_file import COLUMNS
from nav_model.suborbital.flight import TrueFlight


def trajectory_table(samples: NDArray[np.float64]) -> bytes:
    """The file of samples (n, 7) as `read_trajectory_table` gives them, rounded to a micrometre."""
    degrees = [name.endswith("_deg") for name in COLUMNS]
    table = np.where(degrees, np.degrees(samples), samples)
    text = io.StringIO()
    digits = ["%.6f", "%.12f", "%.12f", "%.6f", "%.10f", "%.10f", "%.10f"]
    np.savetxt(text, table, delimiter=",", header=",".join(COLUMNS), comments="", fmt=digits)
    return text.getvalue().encode("utf-8")


def format_flight(flight: TrueFlight, every: int = 1) -> bytes:
    """A flight as a trajectory file that `parse_flight` reads, one row per `every` steps."""
    c_bn = np.swapaxes(local_axes(flight.position_i), -1, -2) @ flight.attitude_bi
    roll, yaw = np.arctan2(c_bn[:, 2, 1], c_bn[:, 2, 2]), np.arctan2(c_bn[:, 1, 0], c_bn[:, 0, 0])
    pitch = np.arcsin(np.clip(-c_bn[:, 2, 0], -1.0, 1.0))
    # Straight up or down only the sum of roll and yaw means anything: give all of it to yaw.
    vertical = np.hypot(c_bn[:, 0, 0], c_bn[:, 1, 0]) < 1e-9
    roll = np.where(vertical, 0.0, roll)
    yaw = np.where(vertical, np.arctan2(-c_bn[:, 0, 1], c_bn[:, 1, 1]), yaw)
    columns = [flight.time_s, flight.latitude_rad, flight.longitude_rad, flight.height_m, roll, pitch, yaw]
    return trajectory_table(np.stack(columns, axis=1)[::every])
