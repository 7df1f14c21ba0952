"""A suborbital flight from a trajectory file."""

import numpy as np

from nav_model.base.constants import EARTH_RATE, SPHERE_RADIUS
from nav_model.base.errors import InputError
from nav_model.earth.gravity import gravitation
from nav_model.earth.rotation import matrix_from_euler
from nav_model.earth.sphere import earth_velocity, local_axes, ned_to_inertial
from nav_model.earth.trajectory_file import FileBounds, read_trajectory_table
from nav_model.suborbital.flight import MAX_STEPS, TrueFlight, fly, step_nodes

BOUNDS = FileBounds(
    fewest_rows=4,
    most_rows=200_000,
    most_bytes=16_000_000,
    largest={"latitude_deg": 90.0, "longitude_deg": 360.0, "height_m": 5e6},
)
"""Enough for a flight of ten thousand seconds at 0.1 s, and no memory beyond it."""

_LARGEST_FORCE = 1e6  # m/s^2: no vehicle bears it, and no square of it is too large for a float


def parse_flight(content: bytes, name: str, step_s: float = 0.1, gravity: str = "spherical") -> TrueFlight:
    """The flight of a trajectory file (position on the sphere, attitude from the local north-east-down axes).

    A cubic spline of the inertial position and a rotation spline of the attitude give specific force and
    angular rate; the flight is then integrated from its first point, so that an error-free INS follows it
    exactly. Time starts at zero for the inertial axes. Rows should be at most a second apart during thrust,
    positions good to a millimetre: a spline differentiates their noise twice.

    Parameters
    ----------
    content : bytes
        The file.
    name : str
        Its name, for messages.
    step_s : float, optional
        Step of the flight, a divisor of its duration.
    gravity : str, optional
        Name of a gravity model.

    Raises
    ------
    InputError
        As `nav_model.earth.trajectory_file.read_trajectory_table`; for a flight that is too long, whose duration
        `step_s` does not divide or that no vehicle can fly; for the name of a gravity model that does not exist.
    """
    from scipy.interpolate import CubicSpline
    from scipy.spatial.transform import Rotation, RotationSpline

    samples = read_trajectory_table(content, name, BOUNDS)[0]
    time, lat, lon, height, roll, pitch, yaw = samples.T
    if step_s <= 0.0:
        raise InputError("step_s", f"{step_s:g} s is not positive", step_s)
    if time[-1] > MAX_STEPS * step_s:
        most = f"at most {MAX_STEPS * step_s:g} s are flown in steps of {step_s:g} s"
        raise InputError(name, f"lasts {time[-1]:g} s; {most}")
    n = round(time[-1] / step_s)
    if n < 1 or abs(n * step_s - time[-1]) >= 1e-6:
        raise InputError(name, f"lasts {time[-1]:g} s, which must be a whole number of steps of {step_s:g} s")
    axes = ned_to_inertial(lat, lon + EARTH_RATE * time)
    track = CubicSpline(time, -axes[:, :, 2] * (SPHERE_RADIUS + height)[:, None])
    c_bi = axes @ matrix_from_euler(roll, pitch, yaw)
    turn = RotationSpline(time, Rotation.from_matrix(c_bi, assume_valid=True))
    half_time = np.minimum(0.5 * step_s * np.arange(2 * n + 1), time[-1])
    attitude = turn(half_time).as_matrix()
    force_i = track(half_time, 2) - gravitation(track(half_time), gravity)
    at = int(np.argmax(np.abs(force_i).max(axis=1)))
    if not (largest := float(np.abs(force_i[at]).max())) <= _LARGEST_FORCE:
        where = f"{half_time[at]:g} s after its first row"
        raise InputError(name, f"asks for {largest:.1e} m/s² {where}. Check the units of its columns and its times.")
    ground = track(half_time, 1) - earth_velocity(track(half_time))
    local = np.einsum("tji,tj->ti", local_axes(track(half_time)), ground)
    moving = np.flatnonzero(np.hypot(local[:, 0], local[:, 1]) >= 1.0)
    first = local[moving[0]] if moving.size else np.array([1.0, 0.0, 0.0])
    force_b = step_nodes(np.einsum("tji,tj->ti", attitude, force_i))
    flown, position, velocity = fly(track(0.0), track(0.0, 1), attitude, force_b, gravity, step_s)
    return TrueFlight(
        name=name,
        step_s=step_s,
        time_s=flown,
        position_i=position,
        velocity_i=velocity,
        half_attitude_bi=attitude,
        specific_force_b=force_b,
        # RotationSpline's rates are already those of the body seen from inertial axes, in body axes.
        angular_rate_b=step_nodes(turn(half_time, 1)),
        gravity=gravity,
        initial_track_rad=float(np.arctan2(first[1], first[0])),
        burnout_s=None,
        source=f"trajectory file {name}, spline through {len(time)} rows, RK4 at {step_s:g} s, {gravity} gravity",
    )
