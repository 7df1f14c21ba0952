"""A flight from a trajectory file, and a flight written as one."""

from pathlib import Path

import numpy as np

from nav_model.earth.gravity import gravitation
from nav_model.suborbital.flight import MAX_STEPS, Flight, assemble, step_nodes
from nav_model.suborbital.frames import (
    EARTH_RADIUS,
    EARTH_RATE,
    earth_velocity,
    local_axes,
    ned_to_inertial,
    quaternion_from_rotation,
    require,
    require_finite,
    rotation_from_euler,
    rotation_from_quaternion,
)

FILE_COLUMNS = ["time_s", "latitude_deg", "longitude_deg", "height_m", "roll_deg", "pitch_deg", "yaw_deg"]
"""Header of a trajectory file (CSV): position on the sphere, attitude from the local north-east-down axes."""


def save_trajectory(flight: Flight, path: str | Path, every: int = 1) -> None:
    """Write a flight in the CSV form `load_trajectory` reads, one row per `every` steps."""
    c_bn = np.swapaxes(local_axes(flight.position_i), -1, -2) @ flight.attitude_bi
    pitch = np.arcsin(np.clip(-c_bn[:, 2, 0], -1.0, 1.0))
    # Straight up or down only the sum of roll and yaw means anything: give all of it to yaw.
    vertical = np.hypot(c_bn[:, 0, 0], c_bn[:, 1, 0]) < 1e-9
    roll = np.where(vertical, 0.0, np.arctan2(c_bn[:, 2, 1], c_bn[:, 2, 2]))
    yaw = np.where(vertical, np.arctan2(-c_bn[:, 0, 1], c_bn[:, 1, 1]), np.arctan2(c_bn[:, 1, 0], c_bn[:, 0, 0]))
    columns = [
        flight.time_s,
        np.degrees(flight.latitude_rad),
        np.degrees(flight.longitude_rad),
        flight.height_m,
        np.degrees(roll),
        np.degrees(pitch),
        np.degrees(yaw),
    ]
    np.savetxt(
        path,
        np.stack(columns, axis=1)[::every],
        delimiter=",",
        header=",".join(FILE_COLUMNS),
        comments="",
        fmt=["%.6f", "%.12f", "%.12f", "%.6f", "%.10f", "%.10f", "%.10f"],
    )


MAX_BYTES = 16_000_000
MAX_ROWS = 200_000
"""Limits of a file: what a flight of ten thousand seconds at 0.1 s needs, and no memory beyond it."""


def load_trajectory(path: str | Path, step_s: float = 0.1, gravity: str = "spherical") -> Flight:
    """`parse_trajectory` of a CSV file. Raises its ValueErrors, and one for a file that is not UTF-8 text."""
    return parse_trajectory(Path(path).read_bytes(), Path(path).name, step_s, gravity)


def parse_trajectory(content: bytes, name: str, step_s: float = 0.1, gravity: str = "spherical") -> Flight:
    """Flight from CSV text with the columns `FILE_COLUMNS` (angles in degrees, at this edge only).

    Cubic spline of the inertial position and a rotation spline of the attitude give specific force and
    angular rate; the flight is then integrated from its first point, so that an error-free INS follows it
    exactly. Time starts at zero for the inertial axes. Rows should be at most a second apart during thrust,
    positions good to a millimetre: a spline differentiates their noise twice. Raises ValueError for a
    missing column, fewer than four rows, time that does not rise, numbers that are not finite, or a step
    that does not divide the duration.
    """
    from scipy.interpolate import CubicSpline
    from scipy.spatial.transform import Rotation, RotationSpline

    require(len(content) <= MAX_BYTES, f"{name}: larger than {MAX_BYTES // 1_000_000} MB; not a trajectory")
    try:
        first_line, *lines = content.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise ValueError(f"{name}: not a text file (UTF-8)") from error
    except ValueError as error:
        raise ValueError(f"{name}: the file is empty") from error
    header = [column.strip() for column in first_line.lstrip("#").split(",")]
    missing = [column for column in FILE_COLUMNS if column not in header]
    require(not missing, f"{name}: columns {', '.join(missing)} are missing; found {_excerpt(header)}")
    lines = [line for line in lines if line.strip()]
    require(len(lines) <= MAX_ROWS, f"{name}: {len(lines)} rows; at most {MAX_ROWS} are taken")
    require(len(lines) >= 4, f"{name}: {len(lines)} rows; a trajectory needs at least 4")
    try:
        table = np.loadtxt(lines, delimiter=",", ndmin=2)
    except ValueError as error:
        raise ValueError(f"{name}: every row must hold {len(header)} numbers ({error})") from error
    require(table.shape[1] == len(header), f"{name}: rows of {table.shape[1]} numbers under {len(header)} columns")
    require_finite(name, table)
    time, lat, lon, height, roll, pitch, yaw = (table[:, header.index(column)] for column in FILE_COLUMNS)
    require(bool(np.all(np.diff(time) > 0.0)), f"{name}: time_s must rise from row to row")
    time = time - time[0]
    require(step_s > 0.0, f"step_s = {step_s!r}: must be positive")
    require(
        time[-1] <= MAX_STEPS * step_s,
        f"{name}: lasts {time[-1]:g} s; at most {MAX_STEPS * step_s:g} s are flown in steps of {step_s:g} s",
    )
    n = round(time[-1] / step_s)
    require(
        n >= 1 and abs(n * step_s - time[-1]) < 1e-6,
        f"{name}: lasts {time[-1]:g} s, which must be a whole number of steps of {step_s:g} s",
    )
    axes = ned_to_inertial(np.radians(lat), np.radians(lon) + EARTH_RATE * time)
    track = CubicSpline(time, -axes[:, :, 2] * (EARTH_RADIUS + height)[:, None])
    c_bi = axes @ rotation_from_euler(np.radians(roll), np.radians(pitch), np.radians(yaw))
    turn = RotationSpline(time, Rotation.from_quat(np.roll(quaternion_from_rotation(c_bi), -1, axis=-1)))
    half_time = np.minimum(0.5 * step_s * np.arange(2 * n + 1), time[-1])
    attitude = rotation_from_quaternion(np.roll(turn(half_time).as_quat(), 1, axis=-1))
    force_i = track(half_time, 2) - gravitation(track(half_time), gravity)
    ground = track(half_time, 1) - earth_velocity(track(half_time))
    local = np.einsum("tji,tj->ti", local_axes(track(half_time)), ground)
    moving = np.flatnonzero(np.hypot(local[:, 0], local[:, 1]) >= 1.0)
    first = local[moving[0]] if moving.size else np.array([1.0, 0.0, 0.0])
    return assemble(
        name,
        step_s,
        track(0.0),
        track(0.0, 1),
        attitude,
        step_nodes(np.einsum("tji,tj->ti", attitude, force_i)),
        # RotationSpline's rates are already those of the body seen from inertial axes, in body axes.
        step_nodes(turn(half_time, 1)),
        gravity,
        float(np.arctan2(first[1], first[0])),
        None,
        f"trajectory file {name}, spline through {len(time)} rows, RK4 at {step_s:g} s, {gravity} gravity",
    )


def _excerpt(header: list[str]) -> str:
    text = ", ".join(header)
    return text if len(text) <= 120 else text[:117] + "..."
