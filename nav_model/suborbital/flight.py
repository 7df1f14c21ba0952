"""The flight: reference trajectory of star_tracker.md with its parameters as inputs.

A flight carries, besides its path, what a perfect strapdown unit would measure: specific force and inertial
angular rate in body axes at the three nodes (start, middle, end) of every integration step. The specific
force is one-sided at the ends, so a burn-out that falls on a step is integrated exactly as it happens.
"""

from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property

import numpy as np

from nav_model.base.arrays import Array
from nav_model.base.compiled import kernel
from nav_model.base.constants import EARTH_RATE, SPHERE_RADIUS
from nav_model.base.errors import InputError
from nav_model.base.units import to_si
from nav_model.earth.gravity import field_kernel, zonals
from nav_model.earth.rotation import matrix_from_euler
from nav_model.earth.sphere import earth_velocity, local_axes, ned_to_inertial, spherical_position
from nav_model.suborbital.runge_kutta import after_step, node_of, state_at

MAX_STEPS = 100_000
"""Of a flight: ten thousand seconds at 0.1 s, and no memory beyond it."""


@dataclass(frozen=True)
class FlightParameters:
    """Reference flight (X). Attitude angles are yaw-pitch-roll from the launch site's north-east-down axes,
    which are frozen in inertial space at lift-off. Thrust acts along body x; there is no drag."""

    latitude_rad: float = np.radians(37.94)
    longitude_rad: float = np.radians(-75.46)
    azimuth_rad: float = np.radians(110.0)
    initial_thrust_m_s2: float = 20.0
    final_thrust_m_s2: float = 90.0
    burn_time_s: float = 195.0
    pitch_start_s: float = 10.0
    pitch_end_s: float = 150.0
    initial_pitch_rad: float = np.radians(90.0)
    burnout_pitch_rad: float = np.radians(19.0)
    coast_pitch_rate_rad_s: float = to_si(Fraction("0.045"), "°/s", "angular rate")
    coast_ramp_s: float = 60.0
    yaw_amplitude_rad: float = np.radians(1.0)
    yaw_period_s: float = 300.0
    roll_amplitude_rad: float = np.radians(2.0)
    roll_period_s: float = 200.0
    duration_s: float = 1500.0
    step_s: float = 0.1
    gravity: str = "spherical"

    def __post_init__(self) -> None:
        rising = {
            "pitch_start_s": self.pitch_start_s >= 0.0,
            "pitch_end_s": self.pitch_start_s < self.pitch_end_s,
            "burn_time_s": self.pitch_end_s <= self.burn_time_s,
            "duration_s": self.burn_time_s < self.duration_s,
        }
        for name, later in rising.items():
            if not later:
                values = ", ".join(f"{each} = {getattr(self, each):g}" for each in rising)
                raise InputError(name, f"{values} must rise in this order", getattr(self, name))
        for name in ("burn_time_s", "duration_s"):
            value = getattr(self, name)
            steps = value / self.step_s
            if abs(steps - round(steps)) >= 1e-6:
                reason = f"{value:g} s is not a whole number of steps of {self.step_s:g} s"
                raise InputError(name, f"{reason} (burn-out inside a step would be smeared over it)", value)
        steps = self.duration_s / self.step_s
        if steps > MAX_STEPS:
            reason = (
                f"{self.duration_s:g} s are {steps:.0f} steps of {self.step_s:g} s; at most {MAX_STEPS} are flown"
            )
            raise InputError("duration_s", reason, self.duration_s)
        zonals(self.gravity)


@dataclass(frozen=True)
class TrueFlight:
    """True flight of n steps, SI.

    time_s (n+1,); position_i, velocity_i (n+1, 3) in inertial axes; half_attitude_bi (2n+1, 3, 3) at every
    half step; specific_force_b, angular_rate_b (n, 3, 3): step, node (start, middle, end), body axis.
    """

    name: str
    step_s: float
    time_s: Array = field(repr=False)
    position_i: Array = field(repr=False)
    velocity_i: Array = field(repr=False)
    half_attitude_bi: Array = field(repr=False)
    specific_force_b: Array = field(repr=False)
    angular_rate_b: Array = field(repr=False)
    gravity: str
    initial_track_rad: float
    burnout_s: float | None
    source: str

    @property
    def steps(self) -> int:
        """Number of integration steps."""
        return len(self.time_s) - 1

    def require_spacing(self, every: int) -> None:
        """InputError unless points of a history, `every` steps apart, divide the flight."""
        if every < 1 or self.steps % every:
            raise InputError("every", f"{every} does not divide the flight's {self.steps} steps", every)

    @property
    def from_file(self) -> bool:
        """True for a loaded trajectory, which is the same in any gravity field."""
        return self.burnout_s is None

    @property
    def attitude_bi(self) -> Array:
        """Body to inertial rotation at every step, (n+1, 3, 3)."""
        return self.half_attitude_bi[::2]

    @cached_property
    def latitude_rad(self) -> Array:
        """Latitude on the sphere, (n+1,)."""
        return spherical_position(self.position_i)[0]

    @cached_property
    def longitude_rad(self) -> Array:
        """Longitude on the turning Earth, (n+1,), in [-pi, pi)."""
        inertial = spherical_position(self.position_i)[1]
        return np.asarray((inertial - EARTH_RATE * self.time_s + np.pi) % (2.0 * np.pi) - np.pi)

    @cached_property
    def height_m(self) -> Array:
        """Height above the sphere, (n+1,)."""
        return spherical_position(self.position_i)[2]

    @cached_property
    def velocity_ned(self) -> Array:
        """Velocity over the turning Earth in local axes, (n+1, 3), m/s."""
        relative = self.velocity_i - earth_velocity(self.position_i)
        return np.asarray(np.einsum("tji,tj->ti", local_axes(self.position_i), relative))

    @cached_property
    def track_rad(self) -> Array:
        """Direction of travel over ground, from north, (n+1,). Below 1 m/s of ground speed the track is
        that of the launch azimuth (or of the first moving sample of a file)."""
        north, east = self.velocity_ned[:, 0], self.velocity_ned[:, 1]
        return np.where(np.hypot(north, east) >= 1.0, np.arctan2(east, north), self.initial_track_rad)

    @cached_property
    def ground_range_m(self) -> Array:
        """Great-circle distance over the turning Earth from the first point, (n+1,), m."""
        lat, lon = self.latitude_rad, self.longitude_rad
        dlon = lon - lon[0]
        y = np.hypot(
            np.cos(lat) * np.sin(dlon),
            np.cos(lat[0]) * np.sin(lat) - np.sin(lat[0]) * np.cos(lat) * np.cos(dlon),
        )
        x = np.sin(lat[0]) * np.sin(lat) + np.cos(lat[0]) * np.cos(lat) * np.cos(dlon)
        return np.asarray(SPHERE_RADIUS * np.arctan2(y, x))

    @property
    def apogee(self) -> tuple[float, float]:
        """Time (s) and height (m) of the highest step."""
        top = int(np.argmax(self.height_m))
        return float(self.time_s[top]), float(self.height_m[top])


@kernel
def _integrate(r0: Array, v0: Array, force_i: Array, j: Array, h: float) -> tuple[Array, Array]:
    """RK4 of r'' = f - gravitation(r), f (n, 3 nodes, 3) given in inertial axes."""
    n, k = force_i.shape[0], np.empty((4, 6))
    states = np.empty((n + 1, 6))  # position, velocity
    states[0, :3], states[0, 3:] = r0, v0
    for i in range(n):
        for slope in range(4):
            y = state_at(states[i], k, slope, h)
            radius = np.sqrt(y[0] ** 2 + y[1] ** 2 + y[2] ** 2)
            sine = y[2] / radius
            radial, axial = field_kernel(radius, sine, j)
            k[slope, :3] = y[3:]
            k[slope, 3:] = force_i[i, node_of(slope)] + (radial - axial * sine) / radius * y[:3]
            k[slope, 5] += axial
        states[i + 1] = after_step(states[i], k, h)
    return states[:, :3].copy(), states[:, 3:].copy()


def step_nodes(half: Array) -> Array:
    """Samples at half steps (2n+1, ...) regrouped as (n, 3, ...): start, middle, end of each step."""
    return np.stack([half[:-2:2], half[1:-1:2], half[2::2]], axis=1)


def thrust(parameters: FlightParameters, time_s: Array) -> Array:
    """Thrust acceleration along body x, m/s², burn-out included: a0 / (1 - t (1 - a0/a1) / t_burn)."""
    ratio = 1.0 - parameters.initial_thrust_m_s2 / parameters.final_thrust_m_s2
    inside = np.minimum(time_s, parameters.burn_time_s) / parameters.burn_time_s
    value = parameters.initial_thrust_m_s2 / (1.0 - ratio * inside)
    return np.where(time_s <= parameters.burn_time_s + 1e-9, value, 0.0)


def attitude_program(parameters: FlightParameters, time_s: Array) -> tuple[Array, Array]:
    """Roll, pitch, yaw (..., 3) rad and their rates, rad/s, from launch-site axes frozen at lift-off."""
    p = parameters
    span = p.pitch_end_s - p.pitch_start_s
    u = np.clip((time_s - p.pitch_start_s) / span, 0.0, 1.0)
    turn = p.burnout_pitch_rad - p.initial_pitch_rad
    pitch = p.initial_pitch_rad + turn * u**3 * (10.0 - 15.0 * u + 6.0 * u * u)
    pitch_rate = turn * 30.0 * u**2 * (1.0 - u) ** 2 / span
    # The pitch-down rate grows as a cubic smooth step; its integral carries the angle.
    w = np.clip((time_s - p.burn_time_s) / p.coast_ramp_s, 0.0, 1.0)
    after = np.maximum(time_s - p.burn_time_s - p.coast_ramp_s, 0.0)
    pitch = pitch - p.coast_pitch_rate_rad_s * (p.coast_ramp_s * (w**3 - 0.5 * w**4) + after)
    pitch_rate = pitch_rate - p.coast_pitch_rate_rad_s * w * w * (3.0 - 2.0 * w)
    yaw_w, roll_w = 2.0 * np.pi / p.yaw_period_s, 2.0 * np.pi / p.roll_period_s
    yaw = p.azimuth_rad + p.yaw_amplitude_rad * np.sin(yaw_w * time_s)
    roll = p.roll_amplitude_rad * np.sin(roll_w * time_s)
    rates = np.stack(
        [
            p.roll_amplitude_rad * roll_w * np.cos(roll_w * time_s),
            pitch_rate,
            p.yaw_amplitude_rad * yaw_w * np.cos(yaw_w * time_s),
        ],
        axis=-1,
    )
    return np.stack([roll, pitch, yaw], axis=-1), rates


def reference_flight(parameters: FlightParameters | None = None) -> TrueFlight:
    """Fly the reference trajectory with RK4 at `step_s`. Raises InputError when it hits the ground on the
    way."""
    p = parameters or FlightParameters()
    n = round(p.duration_s / p.step_s)
    half_time = 0.5 * p.step_s * np.arange(2 * n + 1, dtype=np.float64)
    angles, rates = attitude_program(p, half_time)
    roll, pitch, yaw = np.moveaxis(angles, -1, 0)
    launch = ned_to_inertial(p.latitude_rad, p.longitude_rad)
    attitude = launch @ matrix_from_euler(roll, pitch, yaw)
    roll_rate, pitch_rate, yaw_rate = np.moveaxis(rates, -1, 0)
    rate = np.stack(
        [
            roll_rate - yaw_rate * np.sin(pitch),
            pitch_rate * np.cos(roll) + yaw_rate * np.cos(pitch) * np.sin(roll),
            -pitch_rate * np.sin(roll) + yaw_rate * np.cos(pitch) * np.cos(roll),
        ],
        axis=-1,
    )
    force = np.zeros((n, 3, 3))
    force[:, :, 0] = step_nodes(thrust(p, half_time))
    # Burn-out belongs to the step it ends, not to the one it starts.
    force[round(p.burn_time_s / p.step_s) :] = 0.0
    start = launch @ np.array([0.0, 0.0, -SPHERE_RADIUS])
    time, position, velocity = fly(start, earth_velocity(start), attitude, force, p.gravity, p.step_s)
    return TrueFlight(
        name=f"reference flight from {np.degrees(p.latitude_rad):.2f}°, {np.degrees(p.longitude_rad):.2f}°",
        step_s=p.step_s,
        time_s=time,
        position_i=position,
        velocity_i=velocity,
        half_attitude_bi=attitude,
        specific_force_b=force,
        angular_rate_b=step_nodes(rate),
        gravity=p.gravity,
        initial_track_rad=p.azimuth_rad,
        burnout_s=p.burn_time_s,
        source=f"reference flight, RK4 at {p.step_s:g} s, {p.gravity} gravity",
    )


def in_gravity(flight: TrueFlight, gravity: str) -> TrueFlight:
    """The flight in another gravity field: same start, attitudes and specific forces, so another path.

    InputError for another model than those of `ZONALS`, and when it reaches the ground.
    """
    if gravity == flight.gravity:
        return flight
    time, position, velocity = fly(
        flight.position_i[0], flight.velocity_i[0], flight.half_attitude_bi, flight.specific_force_b, gravity,
        flight.step_s,
    )  # fmt: skip
    source = f"{flight.source}, flown again in {gravity} gravity"
    return replace(flight, time_s=time, position_i=position, velocity_i=velocity, gravity=gravity, source=source)


def fly(
    position: Array, velocity: Array, attitude: Array, force: Array, gravity: str, step_s: float
) -> tuple[Array, Array, Array]:
    """time_s, position_i and velocity_i of a `TrueFlight`, integrated from its start.

    Parameters
    ----------
    position, velocity : array (3,)
        At the start, inertial axes [m, m/s].
    attitude : array (2n+1, 3, 3)
        Body to inertial axes, at half steps.
    force : array (n, 3, 3)
        Specific force in body axes at the nodes of each step [m/s²].
    gravity : str
        Name of a gravity model.
    step_s : float
        Step.

    Raises
    ------
    InputError
        When it reaches the ground before its end.
    """
    force_i = np.einsum("tnij,tnj->tni", step_nodes(attitude), force)
    r, v = _integrate(position, velocity, force_i, zonals(gravity), step_s)
    time = step_s * np.arange(len(r), dtype=np.float64)
    height = np.linalg.norm(r, axis=-1) - SPHERE_RADIUS
    ground = np.flatnonzero(height < height[0] - 1.0) if height[0] < 1.0 else np.flatnonzero(height < -1.0)
    if ground.size:
        reason = (
            f"the flight of {time[-1]:g} s reaches the ground at {time[ground[0]]:.1f} s; it must end before that"
        )
        raise InputError("duration_s", reason, time[-1])
    return time, r, v
