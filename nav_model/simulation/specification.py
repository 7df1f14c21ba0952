"""The specification of one simulation: frozen data in SI, checked once, hashable and picklable.

Sigmas are 1 sigma. A triple of the IMU is the same for its three axes; horizontal and vertical are separate where the
instrument's are. Nothing here is compiled or slow to import.
"""

import math
from dataclasses import dataclass, field, fields
from itertools import pairwise
from typing import Final, Literal, get_args

from nav_model.base.errors import InputError
from nav_model.design.filter import FILTER_STATES

TrajectoryKind = Literal["wandering", "straight", "turns", "climb", "file"]
TRAJECTORY_KINDS: Final[tuple[str, ...]] = get_args(TrajectoryKind)
SLOW_STATES: Final = 3
HIGHEST_LATITUDE: Final = math.radians(85.0)


# Fields whose name differs from that of the input in a design, or of the option.
_GIVEN_AS: Final = {
    "ImuModel.rate": "imu.rate",
    "GnssModel.interval": "gnss.interval",
    "TrajectorySpec.speed": "flight.speed",
    "TrajectorySpec.latitude": "flight.latitude",
    "TrajectorySpec.height": "flight.altitude",
    "outages": "outage",
    "FilterModel.states": "filter.states",
}


def refused(name: str, value: object, allowed: str) -> InputError:
    """The error that `value` cannot be simulated, with the name and unit of the user's input.

    name: a field of `SimulationSpec`, or a field of one of its parts after the part's type and a dot.
    """
    key = _GIVEN_AS.get(name, name.rpartition(".")[2])
    text = repr(value)
    if "." in key and isinstance(value, float):
        from nav_model.design.parts import quantity

        text = quantity(key).show(float(value))
    return InputError(key, f"{text} cannot be simulated; {allowed}", value)


def _refuse(name: str, value: object, allowed: str) -> InputError:
    return refused(name, value, f"must be {allowed}")


def _check(
    owner: object, *, positive: tuple[str, ...] = (), non_negative: tuple[str, ...] = (), finite: tuple[str, ...] = ()
) -> None:
    """Raise InputError naming the first field of `owner` that is not finite, or not positive where it must be."""
    for names, lowest, allowed in (
        (positive, math.ulp(0.0), "positive and finite"),
        (non_negative, 0.0, "zero or positive, and finite"),
        (finite, -math.inf, "finite"),
    ):
        for name in names:
            value = getattr(owner, name)
            if not (math.isfinite(value) and value >= lowest):
                raise _refuse(f"{type(owner).__name__}.{name}", value, allowed)


HIGHEST_RATE = 10_000.0  # Hz, of an IMU that can be simulated


@dataclass(frozen=True)
class TriadModel:
    """Errors of one sensor triad: gyroscopes (unit rad/s) or accelerometers (unit m/s^2).

    random_walk: density of the white noise [unit sqrt(s)]: angle or velocity random walk.
    turn_on_bias: constant through a run, redrawn for each [unit].
    bias_instability, correlation_time: first-order Gauss-Markov bias [unit], [s].
    rate_random_walk: density of the white noise that drives a random walk of the output [unit / sqrt(s)].
    scale_factor, misalignment: drawn once per run, each axis [-], each of the six small angles [rad].
    quantization: size of one count of the integrated output (angle rad, velocity m/s); 0 for none.
    g_sensitivity: of gyros, output by specific force along each axis, drawn once per run [rad/s per m/s²].
    residual_bias: what the filter has not absorbed at the last fix [unit]; it acts from there on while no fix comes.
    """

    random_walk: float = 0.0
    turn_on_bias: float = 0.0
    bias_instability: float = 0.0
    correlation_time: float = 3600.0
    rate_random_walk: float = 0.0
    scale_factor: float = 0.0
    misalignment: float = 0.0
    quantization: float = 0.0
    g_sensitivity: float = 0.0
    residual_bias: float = 0.0

    def __post_init__(self) -> None:
        others = tuple(f.name for f in fields(self) if f.name != "correlation_time")
        _check(self, positive=("correlation_time",), non_negative=others)

    @property
    def constant(self) -> bool:
        """True if it has an error that is a constant bias while the flight is straight and level."""
        return bool(self.turn_on_bias or self.scale_factor or self.misalignment or self.g_sensitivity)

    @property
    def biased(self) -> bool:
        """True if it has an error that a filter estimates as a bias, constant or varying."""
        return bool(self.constant or self.bias_instability or self.rate_random_walk)

    @property
    def mixed(self) -> bool:
        """True if it has a Gauss-Markov bias and another, of which one state holds the sum as a random walk alone."""
        return bool(self.bias_instability and (self.constant or self.rate_random_walk))


@dataclass(frozen=True)
class ImuModel:
    """An inertial measurement unit; `vibration_factor` multiplies both random walks (in motion over bench)."""

    gyro: TriadModel
    accelerometer: TriadModel
    rate: float = 100.0
    vibration_factor: float = 1.0

    def __post_init__(self) -> None:
        _check(self, positive=("rate", "vibration_factor"))
        if not 10.0 <= self.rate <= HIGHEST_RATE:
            raise _refuse("ImuModel.rate", self.rate, f"between 10 and {HIGHEST_RATE:g} Hz")


@dataclass(frozen=True)
class GnssModel:
    """A GNSS receiver: white noise per fix and per axis, plus Gauss-Markov noise between fixes.

    lever_arm: antenna from the IMU, body axes forward-right-down [m]; the filter knows it.
    velocity_noise: sigma per axis [m/s]; None for a receiver that gives position only. Each vertical noise is that
    of the other axes where it is not given.
    lever_arm_error: of the lever arm per axis [m]; time_offset: of the fixes against the IMU [s]; 1 sigma, constant
    through a run, not known to the filter. bank_limit: fixes are lost beyond this bank angle [rad]. after_loss:
    (duration [s], position noise [m]) of the solutions that follow each loss in turn, as code, then float, before the
    receiver is fixed again; the filter knows which it has.
    Fixes come at the IMU sample nearest to each multiple of `interval`.
    """

    position_noise: float = 1.0
    vertical_position_noise: float | None = None
    interval: float = 1.0
    markov_noise: float = 0.0
    vertical_markov_noise: float = 0.0
    markov_time: float = 300.0
    velocity_noise: float | None = None
    vertical_velocity_noise: float | None = None
    lever_arm: tuple[float, float, float] = (0.0, 0.0, 0.0)
    lever_arm_error: float = 0.0
    time_offset: float = 0.0
    bank_limit: float | None = None
    after_loss: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        names = ("vertical_position_noise", "velocity_noise", "vertical_velocity_noise", "bank_limit")
        optional = tuple(name for name in names if getattr(self, name) is not None)
        _check(
            self,
            positive=("position_noise", "interval", "markov_time", *optional),
            non_negative=("markov_noise", "vertical_markov_noise", "lever_arm_error", "time_offset"),
        )
        if len(self.lever_arm) != 3 or not all(math.isfinite(x) for x in self.lever_arm):
            raise _refuse("GnssModel.lever_arm", self.lever_arm, "three finite numbers")
        if not all(math.isfinite(x) and x > 0.0 for solution in self.after_loss for x in solution):
            raise _refuse("GnssModel.after_loss", self.after_loss, "positive and finite")

    @property
    def axis_noise(self) -> tuple[float, float, float]:
        """White position noise north, east, down [m]."""
        vertical = self.position_noise if self.vertical_position_noise is None else self.vertical_position_noise
        return self.position_noise, self.position_noise, vertical

    @property
    def axis_markov_noise(self) -> tuple[float, float, float]:
        """Slow error north, east, down [m]; zeros for a receiver without one."""
        return self.markov_noise, self.markov_noise, self.vertical_markov_noise

    @property
    def axis_velocity_noise(self) -> tuple[float, ...]:
        """White velocity noise north, east, down [m/s]; empty for a receiver that gives position only."""
        if self.velocity_noise is None:
            return ()
        vertical = self.velocity_noise if self.vertical_velocity_noise is None else self.vertical_velocity_noise
        return self.velocity_noise, self.velocity_noise, vertical


@dataclass(frozen=True)
class Aids:
    """Sensors that aid the INS beyond GNSS, 1 sigma; None where there is no such sensor.

    heading_noise: of one heading by two antennas [rad]; barometer_noise: of one height [m]. Both come with the fixes.
    The heading is lost with them, the height is not. Each may have a slow error beside this white noise, or it alone,
    a Gauss-Markov process of a correlation time [s]; the filter takes the root of both variances as white.
    """

    heading_noise: float | None = None
    barometer_noise: float | None = None
    heading_slow_noise: float = 0.0
    heading_time: float = 60.0
    barometer_slow_noise: float = 0.0
    barometer_time: float = 3600.0

    def __post_init__(self) -> None:
        optional = tuple(name for name in ("heading_noise", "barometer_noise") if getattr(self, name) is not None)
        _check(
            self,
            positive=("heading_time", "barometer_time", *optional),
            non_negative=("heading_slow_noise", "barometer_slow_noise"),
        )

    @property
    def has_heading(self) -> bool:
        """True with two antennas."""
        return self.heading_noise is not None or self.heading_slow_noise > 0.0

    @property
    def has_height(self) -> bool:
        """True with a barometer."""
        return self.barometer_noise is not None or self.barometer_slow_noise > 0.0


@dataclass(frozen=True)
class TrajectorySpec:
    """The flight. Angles in rad, lengths in m, speeds in m/s.

    kind:
      wandering: constant speed and heading, with `wander` m of lateral and vertical rms excursion and
                 `attitude_wander` rad rms of roll, pitch and yaw (the source paper's flight [A]);
      straight:  exactly straight and level at constant heading; speed 0 is a stationary INS;
      turns:     coordinated turns (`turn_rate`) of +90, -180, +90 deg, then the long straight leg;
      climb:     level, then `climb_height` gained at `climb_rate` half way through, then level;
      file:      `samples` (see `nav_model.trajectory.files.reader`).
    """

    kind: TrajectoryKind = "wandering"
    speed: float = 50.0
    latitude: float = math.radians(45.0)
    longitude: float = 0.0
    height: float = 3000.0
    heading: float = 0.0
    wander: float = 3.0
    attitude_wander: float = math.radians(1.0)
    turn_rate: float = math.radians(3.0)
    climb_rate: float = 5.0
    climb_height: float = 500.0
    samples: bytes = field(default=b"", repr=False)

    def __post_init__(self) -> None:
        if self.kind not in TRAJECTORY_KINDS:
            raise _refuse("TrajectorySpec.kind", self.kind, "one of " + ", ".join(TRAJECTORY_KINDS))
        _check(
            self,
            positive=("turn_rate", "climb_rate"),
            non_negative=("speed", "wander", "attitude_wander", "climb_height"),
            finite=("latitude", "longitude", "height", "heading"),
        )
        if abs(self.latitude) > HIGHEST_LATITUDE:
            raise _refuse(
                "TrajectorySpec.latitude", self.latitude, "within 85 deg of the equator (NED mechanisation)"
            )
        if not -1000.0 <= self.height <= 100_000.0:
            raise _refuse("TrajectorySpec.height", self.height, "between -1 km and 100 km")
        if self.speed > 3000.0:
            raise _refuse("TrajectorySpec.speed", self.speed, "at most 3000 m/s")
        if self.kind == "climb" and self.climb_rate >= 0.7 * max(self.speed, 1e-9):
            needed = f"more than {self.climb_rate / 0.7:.4g} m/s to climb at {self.climb_rate:g} m/s"
            raise _refuse("TrajectorySpec.speed", self.speed, needed)
        if self.attitude_wander > math.radians(15.0):
            raise _refuse("TrajectorySpec.attitude_wander", self.attitude_wander, "at most 15 deg rms")
        if (self.kind == "file") != bool(self.samples):
            raise _refuse("TrajectorySpec.samples", len(self.samples), "given for kind 'file', and only for it")


@dataclass(frozen=True)
class InitialSigma:
    """Sigma of the INS's errors at time 0, per axis; each run draws its own, the filter starts from the same."""

    position: float = 1.0
    velocity: float = 0.1
    tilt: float = math.radians(0.05)
    yaw: float = math.radians(0.1)

    def __post_init__(self) -> None:
        _check(self, positive=("position", "velocity", "tilt", "yaw"))


@dataclass(frozen=True)
class FilterModel:
    """The error-state filter: 9 states (position, velocity, attitude), 15 (and both biases) or 21, each with 3 more
    where it knows the slow GNSS error.

    With 15 one state holds all of a sensor's bias; where a Gauss-Markov bias comes on top of a constant or a
    random walk it is a random walk of the same drive, and the filter pessimistic (NEES 12.9 to 14.4 of 15 for
    a MEMS unit after 4 to 15 of its correlation times of 100 s, or 0.4 to 1.5 of 1000 s). 21 states keep the
    two apart and are consistent. The last three of 12, 18 and 24 are the slow error of the fixes over its sigma, a
    Gauss-Markov process of the receiver's correlation time.

    The multipliers scale the standard deviations that the filter assumes relative to those of the sensors:
    1 is matched tuning, `process_noise_scale` = sqrt(0.5) halves the process noise.
    propagation_rate: covariance steps per second; the transition and process noise of a step are exact
    to the order the coupling needs ([T-1]'s chain to all orders), so 10 Hz loses nothing at 100 Hz.
    """

    states: int = 9
    propagation_rate: float = 10.0
    process_noise_scale: float = 1.0
    gnss_noise_scale: float = 1.0
    bias_scale: float = 1.0
    initial_scale: float = 1.0

    def __post_init__(self) -> None:
        _check(
            self,
            positive=("propagation_rate", "process_noise_scale", "gnss_noise_scale", "bias_scale", "initial_scale"),
        )
        if self.states not in FILTER_STATES:
            raise _refuse("FilterModel.states", self.states, ", ".join(map(str, FILTER_STATES)))

    @property
    def slow(self) -> int:
        """Number of states for the slow GNSS error: 0 or 3."""
        return SLOW_STATES if self.states % 6 == 0 else 0

    @property
    def inertial(self) -> int:
        """Number of states of the INS: 9, 15 or 21."""
        return self.states - self.slow


@dataclass(frozen=True)
class SimulationSpec:
    """One Monte Carlo study. `outages`: fixes with start < t <= stop are lost, so a run coasts stop - start
    s.

    every: spacing of the result's `time_s` [s]; the times are the IMU samples nearest to its multiples.
    record_from: nothing is kept before [s], but for time 0.
    radar_time_offset: of the radar against the IMU [s], 1 sigma, constant through a run: results are what the radar
    takes for its navigation, of a time that is wrong by it.
    keep_runs: also keep every run's error history (memory then grows with the number of runs).
    """

    imu: ImuModel
    gnss: GnssModel = GnssModel()
    trajectory: TrajectorySpec = TrajectorySpec()
    filter: FilterModel = FilterModel()
    initial: InitialSigma = InitialSigma()
    runs: int = 100
    seed: int = 1
    duration: float = 500.0
    outages: tuple[tuple[float, float], ...] = ()
    every: float = 1.0
    keep_runs: bool = False
    record_from: float = 0.0
    aiding: Aids = Aids()
    radar_time_offset: float = 0.0

    def __post_init__(self) -> None:
        _check(self, positive=("duration", "every"), non_negative=("record_from", "radar_time_offset"))
        if not (isinstance(self.runs, int) and 1 <= self.runs <= 10_000_000):
            raise _refuse("runs", self.runs, "a whole number from 1 to 10000000")
        if not (isinstance(self.seed, int) and 0 <= self.seed < 2**63):
            raise _refuse("seed", self.seed, "a whole number, zero or positive")
        for start, stop in self.outages:
            if not (math.isfinite(start) and math.isfinite(stop) and 0.0 <= start < stop):
                raise _refuse("outages", (start, stop), "pairs 0 <= start < stop, in seconds")
        if self.filter.slow and not any(self.gnss.axis_markov_noise):
            raise _refuse("FilterModel.states", self.filter.states, "9, 15 or 21 without a slow GNSS error")
        ordered = sorted(self.outages)
        if any(before[1] > after[0] for before, after in pairwise(ordered)):
            raise _refuse("outages", self.outages, "windows that do not overlap")
        if self.every > self.duration:
            raise _refuse("every", self.every, f"at most the duration, {self.duration!r} s")
        sample = 1.0 / self.imu.rate
        for name, value in (("every", self.every), ("GnssModel.interval", self.gnss.interval)):
            if value < sample * (1.0 - 1e-9):
                raise _refuse(name, value, f"at least one IMU sample, {sample!r} s")
        if self.duration * self.imu.rate > 1e8:
            raise _refuse("duration", self.duration, "at most 1e8 IMU samples long")
        if self.steps < 1:
            raise _refuse("duration", self.duration, f"at least one IMU sample, {sample!r} s")

    @property
    def steps(self) -> int:
        """Number of IMU samples."""
        return round(self.duration * self.imu.rate)
