"""The path flown: a smooth spline of position and attitude, from which all other truth is derived.

Every flight ends up as one quintic spline of latitude, longitude, height, roll, pitch and yaw. The spline
*is* the truth: its velocity, acceleration and angular rate are exact derivatives, so the specific force and
rate computed from it are consistent with the position to rounding.
"""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np

from nav_model.base.arrays import Array as FloatArray
from nav_model.base.constants import STANDARD_GRAVITY
from nav_model.base.errors import InputError
from nav_model.earth.trajectory_file import FileBounds
from nav_model.earth.wgs84 import metres_per_radian
from nav_model.simulation.specification import HIGHEST_LATITUDE, TrajectorySpec, refused

MARGIN_S = 5.0
"""Flights are planned this far beyond both ends, so that the spline is never extrapolated."""


@dataclass(frozen=True, eq=False)
class QuinticPath:
    """Piecewise quintic path over `breaks` [s]: `coefficients`, shape (pieces, 6, 6), highest power first.

    Last axis: latitude [rad], longitude [rad], height [m], roll, pitch, yaw [rad, unwrapped], less `origin`
    (6): a spline through the latitude itself would jump by 1e-9 m/s at every break, out of rounding, and no
    accelerometer would see the jumps.
    """

    origin: FloatArray
    breaks: FloatArray
    coefficients: FloatArray

    def evaluate(self, time_s: FloatArray, derivative: int = 0) -> FloatArray:
        """The six coordinates or a derivative of them at times of any shape; result shape (..., 6)."""
        piece = np.clip(np.searchsorted(self.breaks, time_s, side="right") - 1, 0, len(self.breaks) - 2)
        u = (time_s - self.breaks[piece])[..., None]
        value = np.zeros((*np.shape(time_s), 6))
        for power in range(5, derivative - 1, -1):
            factor = np.prod(np.arange(power, power - derivative, -1, dtype=np.float64))
            value = value * u + factor * self.coefficients[piece, 5 - power]
        return value if derivative else value + self.origin

    def velocity(self, time_s: FloatArray) -> FloatArray:
        """Velocity over ground, north-east-down [m/s], shape (..., 3)."""
        q, dq = self.evaluate(time_s), self.evaluate(time_s, 1)
        north, east = metres_per_radian(q[..., 0], q[..., 2])
        return np.stack([dq[..., 0] * north, dq[..., 1] * east, -dq[..., 2]], axis=-1)


def spline_through(time_s: FloatArray, coordinates: FloatArray) -> QuinticPath:
    """Quintic interpolating spline through rows (latitude, longitude, height, roll, pitch, yaw)."""
    from scipy.interpolate import make_interp_spline

    origin = coordinates[0].copy()
    spline = make_interp_spline(time_s, coordinates - origin, k=5)
    breaks = np.unique(spline.t)
    powers = [spline(breaks[:-1], nu=power) / math.factorial(power) for power in range(5, -1, -1)]
    coefficients = np.ascontiguousarray(np.stack(powers, axis=1))
    return QuinticPath(origin, breaks, coefficients)


def cumulative(rate: FloatArray, step: float) -> FloatArray:
    """Integral from the first sample of an evenly sampled rate (Simpson-like, fourth order)."""
    from scipy.interpolate import CubicSpline

    integral: FloatArray = CubicSpline(np.arange(len(rate)) * step, rate).antiderivative()(
        np.arange(len(rate)) * step
    )
    return integral


def smooth_step(x: FloatArray) -> FloatArray:
    """0 below 0, 1 above 1, with two continuous derivatives between."""
    x = np.clip(x, 0.0, 1.0)
    return x**3 * (10.0 + x * (-15.0 + 6.0 * x))


def rise_and_fall(t: FloatArray, plateau: float, ramp: float) -> FloatArray:
    """From 0 to 1 and back, with smooth ramps that begin at 0 and at `plateau`; the area is the plateau."""
    return smooth_step(t / ramp) - smooth_step((t - plateau) / ramp)


def turbulence(time_s: FloatArray, rms: float, shortest_s: float, longest_s: float, key: int) -> FloatArray:
    """Band-limited motion of the given rms: nine sines of equal power, periods spread logarithmically.

    Parameters
    ----------
    time_s : array (n,)
        Seconds.
    rms : float
        Of the motion, in its unit.
    shortest_s, longest_s : float
        Periods.
    key : int
        Chooses the (fixed) phases and makes axes independent of each other; the spread by a few per cent keeps any
        two axes from sharing a period, which would be coning the aircraft does not do.
    """
    generator = np.random.default_rng([20190702, key])
    count = 9
    periods = np.geomspace(shortest_s, longest_s, count) * np.exp(generator.uniform(-0.08, 0.08, count))
    phases = generator.uniform(0.0, 2.0 * np.pi, count)
    waves = np.sin(2.0 * np.pi * time_s[:, None] / periods + phases)
    motion: FloatArray = rms * np.sqrt(2.0 / count) * waves.sum(axis=1)
    return motion


class FlatFlight(NamedTuple):
    """A flight before it is laid on the Earth: course [rad], ground speed [m/s], height above its start [m], roll and
    pitch [rad]."""

    course: FloatArray
    ground_speed: FloatArray
    height: FloatArray
    roll: FloatArray
    pitch: FloatArray


def coordinated(
    t: FloatArray, speed: float | FloatArray, heading: float, turn: FloatArray, climb: FloatArray
) -> FlatFlight:
    """The flight along a path without slip: bank = arctan(V rate / g).

    Parameters
    ----------
    t : array (n,)
        Seconds, evenly spaced.
    speed : float or array (n,)
        Along the path, m/s.
    heading : float
        At the start, rad.
    turn, climb : array (n,)
        Rates of turn [rad/s] and climb [m/s].
    """
    step = float(t[1] - t[0])
    ground = np.sqrt(speed**2 - climb**2)
    roll = np.arctan(speed * turn / STANDARD_GRAVITY)
    return FlatFlight(
        heading + cumulative(turn, step), ground, cumulative(climb, step), roll, np.arctan2(climb, ground)
    )


def _rates(spec: TrajectorySpec, t: FloatArray, duration: float) -> tuple[FloatArray, FloatArray]:
    """Rates of turn and climb of a named flight."""
    turn, climb = np.zeros_like(t), np.zeros_like(t)
    if spec.kind == "turns":  # +90, -180, +90 deg, then straight to the end
        entry, start, right_angle = 3.0, 10.0, 0.5 * np.pi / spec.turn_rate
        for sense, length in ((1.0, right_angle), (-1.0, 2.0 * right_angle), (1.0, right_angle)):
            # Rolling in and out each take `entry` seconds; the plateau makes up the whole angle.
            turn += sense * spec.turn_rate * rise_and_fall(t - start, length, entry)
            start += length + entry + 10.0
    elif spec.kind == "climb":  # centred on half way
        entry, length = 6.0, spec.climb_height / spec.climb_rate
        climb += spec.climb_rate * rise_and_fall(t - 0.5 * (duration - length - entry), length, entry)
    return turn, climb


def lay_on_earth(
    place: tuple[float, float], t: FloatArray, north_rate: FloatArray, east_rate: FloatArray, height: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Latitude and longitude [rad] of a path given by its ground velocity.

    Parameters
    ----------
    place : pair of float
        Latitude and longitude at t = 0, rad.
    t : array (n,)
        Seconds.
    north_rate, east_rate : array (n,)
        Ground velocity, m/s.
    height : array (n,)
        Above the ellipsoid, m.
    """
    step = float(t[1] - t[0])
    start = int(np.argmin(np.abs(t)))
    latitude = np.full_like(t, place[0])
    # Curvature changes so slowly with latitude that each pass gains four digits or more.
    for _ in range(5):
        integral = cumulative(north_rate / metres_per_radian(latitude, height)[0], step)
        latitude = place[0] + integral - integral[start]
    integral = cumulative(east_rate / metres_per_radian(latitude, height)[1], step)
    return latitude, place[1] + integral - integral[start]


@lru_cache(maxsize=8)
def plan_trajectory(spec: TrajectorySpec, duration: float, further: float = 0.0) -> QuinticPath:
    """The trajectory of `spec` over [0, duration] seconds, and of a named flight `further` seconds in the same way.

    Raises ValueError where the flight leaves the latitudes an NED mechanisation can serve, or a file is
    shorter than the duration.
    """
    if spec.kind == "file":
        table = _table(spec)
        if duration > table[-1, 0] + 1e-9:
            raise refused("duration", duration, f"must be at most the trajectory file's {table[-1, 0]:.15g} s")
        return spline_through(table[:, 0], table[:, 1:])
    step = 0.5
    before, after = round(MARGIN_S / step), int(np.ceil((duration + further) / step)) + round(MARGIN_S / step)
    t: FloatArray = np.linspace(-before * step, after * step, before + after + 1)
    motion = coordinated(t, spec.speed, spec.heading, *_rates(spec, t, duration))
    if spec.kind == "turns" and duration < 50.0 + 2.0 * np.pi / spec.turn_rate:
        needed = 50.0 + 2.0 * np.pi / spec.turn_rate
        raise refused("duration", duration, f"the turns take {needed:.1f} s, allow at least {math.ceil(needed)} s")
    if spec.kind == "climb" and duration < 20.0 + spec.climb_height / spec.climb_rate:
        needed = 20.0 + spec.climb_height / spec.climb_rate
        raise refused("duration", duration, f"the climb takes {needed:.1f} s, allow at least {math.ceil(needed)} s")
    wander, angle = (0.0, 0.0) if spec.kind == "straight" else (spec.wander, spec.attitude_wander)
    sideways = turbulence(t, wander, 25.0, 120.0, 1)
    height = spec.height + motion.height + turbulence(t, wander, 25.0, 120.0, 2)
    sideways_rate = np.gradient(sideways, t) if wander else np.zeros_like(t)
    north_rate = motion.ground_speed * np.cos(motion.course) - sideways_rate * np.sin(motion.course)
    east_rate = motion.ground_speed * np.sin(motion.course) + sideways_rate * np.cos(motion.course)
    latitude, longitude = lay_on_earth((spec.latitude, spec.longitude), t, north_rate, east_rate, height)
    if np.max(np.abs(latitude)) > HIGHEST_LATITUDE:
        raise InputError(
            "trajectory",
            f"latitude reaches {np.degrees(np.max(np.abs(latitude))):.1f} deg; "
            "must stay within 85 deg "
            "of the equator (NED mechanisation)",
        )
    attitude = [turbulence(t, angle, 4.0, 25.0, key) for key in (3, 4, 5)]
    coordinates = [latitude, longitude, height, motion.roll + attitude[0], motion.pitch + attitude[1]]
    coordinates.append(motion.course + attitude[2])
    return spline_through(t, np.column_stack(coordinates))


FILE_BOUNDS: Final = FileBounds(
    fewest_rows=8,
    most_rows=1_000_000,
    most_bytes=200_000_000,
    largest={
        "latitude_deg": math.degrees(HIGHEST_LATITUDE),
        "longitude_deg": 360.0,
        "height_m": 100_000.0,
        "roll_deg": 360.0,
        "pitch_deg": 80.0,
        "yaw_deg": 1e6,  # unwrapped through many turns
    },
)
"""Bounds of a trajectory file: hours of an aircraft's log, where north and heading are defined."""
_LARGEST_ACCELERATION: Final = 300.0
_LARGEST_RATE: Final = math.radians(1000.0)


def flight_through(samples: FloatArray, lines: list[int], name: str) -> TrajectorySpec:
    """The flight through rows of time from zero [s], latitude, longitude [rad], height [m], roll, pitch, yaw [rad].

    Angles may be unwrapped or not. lines: of the file, for messages.

    Raises InputError for a path that needs an acceleration above 300 m/s² or an angular rate above 1000 °/s.
    """
    for column in (2, 4, 6):
        samples[:, column] = np.unwrap(samples[:, column])
    _check_motion(samples, lines, name)
    return TrajectorySpec(kind="file", samples=samples.tobytes())


def _table(spec: TrajectorySpec) -> FloatArray:
    return np.frombuffer(spec.samples).reshape(-1, 7)


def _check_motion(samples: FloatArray, lines: list[int], name: str) -> None:
    """Refuse motion that no aircraft flies: a wrong unit or a glitch, on which the spline would ring."""
    spline = spline_through(samples[:, 0], samples[:, 1:])
    middle = 0.5 * (samples[1:, 0] + samples[:-1, 0])
    acceleration = np.linalg.norm(np.gradient(spline.velocity(middle), middle, axis=0), axis=1)
    rate = np.max(np.abs(spline.evaluate(middle, 1)[:, 3:]), axis=1)
    for values, limit, what, unit, scale in (
        (acceleration, _LARGEST_ACCELERATION, "acceleration", "m/s^2", 1.0),
        (rate, _LARGEST_RATE, "angular rate", "deg/s", math.degrees(1.0)),
    ):
        worst = int(np.argmax(values))
        if values[worst] > limit:
            needed, most = (f"{value * scale:.4g} {unit}" for value in (values[worst], limit))
            problem = f"the path needs an {what} of {needed}; at most {most} can be flown"
            raise InputError(name, f"line {lines[worst + 1]}: {problem}")
