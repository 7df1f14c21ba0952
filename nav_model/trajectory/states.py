"""The states and the sources of a study's errors, which are the same for every flight. [P-13]

First come the states that the filter estimates (errors of position, velocity and attitude, and its bias estimates),
then what is really there: biases, scale factors, misalignments, slow errors of fixes and aids, lever arm error, time
offsets.
The filter's gains act on the first part; the second is considered. A source that is zero has no state and no noise.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.budget.shares import (
    ACCELEROMETER_NOISE,
    GNSS_NOISE,
    GNSS_VELOCITY,
    GYRO_BIAS,
    GYRO_NOISE,
    SLOW_GNSS,
)
from nav_model.simulation.layout import ATTITUDE, BAROMETER, BIASES, HEADING, POSITION, VELOCITY
from nav_model.simulation.specification import SimulationSpec, TriadModel
from nav_model.simulation.tuning import believed_covariance, initial_sigma, tuning_of
from nav_model.trajectory.residual import HEADING_DRIFT

FloatArray = NDArray[np.float64]
MEASURED_BY: Mapping[str, slice] = {
    GNSS_NOISE: slice(POSITION, POSITION + 3),
    GNSS_VELOCITY: slice(VELOCITY, VELOCITY + 3),
    "heading aiding": slice(HEADING, HEADING + 1),
    "barometer": slice(BAROMETER, BAROMETER + 1),
}
"""Sources of noise in what a fix measures, and which measurements have it."""
RADAR_TIME = "radar time offset"
SLOW_AIDS: Mapping[str, int] = {"slow heading error": HEADING, "slow barometer error": BAROMETER}
"""Sources of slow errors of the aids, and which measurement has them."""
G_SENSITIVITY = "gyro g-sensitivity"
_SHORTEST = 0.01  # s: correlation time of a process with states of its own


class Error(NamedTuple):
    """Effect of one source (index) on as many `states` from `first` on: sigma at the start, density that drives them
    [unit²/s], correlation time [s]; zero for none."""

    source: int
    first: int
    states: int
    sigma: float = 0.0
    drive: float = 0.0
    time: float = 0.0


@dataclass(frozen=True, eq=False)
class States:
    """n states, of which the filter has the first m, and s sources.

    The filter's are those of the simulator's, `inertial` of them, and where it knows the slow GNSS error its three.
    Sources with noise come first, `noisy` of them, then those that are constant through a flight; so do the states:
    noise moves the first `moving` ones. first: state of each group of considered ones. drives: errors with process
    noise; assumed: first state and density of those that the filter assumes. decay (n - 9): rate of each state beyond
    the first nine [1/s]. initial (n, starts): what one sigma of each independent error at time 0 does to every state,
    and owner (starts) its source; believed (m, m): covariance with which the filter starts.
    """

    sources: tuple[str, ...]
    noisy: int
    inertial: int
    estimated: int
    moving: int
    size: int
    first: Mapping[str, int]
    drives: tuple[Error, ...]
    assumed: tuple[tuple[int, float], ...]
    decay: FloatArray
    initial: FloatArray
    owner: NDArray[np.int64]
    believed: FloatArray


def short_as_white(study: SimulationSpec) -> SimulationSpec:
    """A study whose biases with a correlation time far below any step are the white noise that they act as.

    Of sigma and time tau, a Gauss-Markov process has the density 2 sigma² tau at periods that are long against tau.
    """

    def changed(model: TriadModel) -> TriadModel:
        if model.bias_instability == 0.0 or model.correlation_time >= _SHORTEST:
            return model
        white = model.bias_instability * math.sqrt(2.0 * model.correlation_time) / study.imu.vibration_factor
        return replace(model, random_walk=math.hypot(model.random_walk, white), bias_instability=0.0)

    imu = replace(study.imu, gyro=changed(study.imu.gyro), accelerometer=changed(study.imu.accelerometer))
    return replace(study, imu=imu)


def states_of(study: SimulationSpec, residual: Mapping[str, float]) -> States:
    """The states and sources of a study, with sources for its `residual` biases, of which only the vertical gyro's
    has a state."""
    imu, gnss, aiding = study.imu, study.gnss, study.aiding
    triads = (("accelerometer", imu.accelerometer), ("gyro", imu.gyro))
    inertial, size = study.filter.inertial, study.filter.states
    m = size
    sources: dict[str, int] = {}
    first: dict[str, int] = {}
    errors: list[Error] = []

    def put(source: str, *values: Any) -> None:
        errors.append(Error(sources.setdefault(source, len(sources)), *values))

    def add(group: str, source: str, count: int, sigma: float, drive: float = 0.0, time: float = 0.0) -> None:
        nonlocal size
        if sigma > 0.0 or drive > 0.0:
            if group not in first:
                first[group] = size
                size += count
            put(source, first[group], count, sigma, drive, time)

    white = ((ACCELEROMETER_NOISE, VELOCITY, imu.accelerometer), (GYRO_NOISE, ATTITUDE, imu.gyro))
    for source, state, model in white:
        if model.random_walk > 0.0:
            put(source, state, 3, 0.0, (model.random_walk * imu.vibration_factor) ** 2)
    measured = (gnss.position_noise, gnss.velocity_noise, aiding.heading_noise, aiding.barometer_noise)
    for source, sigma in zip(MEASURED_BY, measured, strict=True):
        if sigma:
            sources.setdefault(source, len(sources))
    for name, model in triads:
        add(f"{name} bias", f"{name} bias random walk", 3, 0.0, model.rate_random_walk**2)
        source, drive = f"{name} bias instability", 2.0 * model.bias_instability**2 / model.correlation_time
        add(source, source, 3, model.bias_instability, drive, model.correlation_time)
    if any(gnss.axis_markov_noise):  # its size is in what a fix measures
        add(SLOW_GNSS, SLOW_GNSS, 3, 1.0, 2.0 / gnss.markov_time, gnss.markov_time)
    slow_aids = (aiding.heading_slow_noise, aiding.heading_time), (aiding.barometer_slow_noise, aiding.barometer_time)
    for source, (sigma, time) in zip(SLOW_AIDS, slow_aids, strict=True):
        add(source, source, 1, sigma, 2.0 * sigma**2 / time, time)
    moving, noisy = size, len(sources)
    constant = [("lever arm error", 3, gnss.lever_arm_error), ("time offset", 1, gnss.time_offset)]
    constant += [(RADAR_TIME, 1, study.radar_time_offset)]
    for name, model in triads:
        add(f"{name} bias", f"{name} turn-on bias", 3, model.turn_on_bias)
        constant += [(f"{name} scale factor", 3, model.scale_factor), (f"{name} misalignment", 6, model.misalignment)]
    constant += [(G_SENSITIVITY, 3, imu.gyro.g_sensitivity)]
    for name, count, size_of_one in constant:
        add(name, name, count, size_of_one)
    for name in residual:
        sources.setdefault(name, len(sources))
    add(HEADING_DRIFT, GYRO_BIAS, 1, residual.get(GYRO_BIAS, 0.0))
    names = [*["initial position and velocity"] * 6, *["initial tilt"] * 2, "initial heading"]
    for state, (name, start) in enumerate(zip(names, initial_sigma(study)[:BIASES], strict=True)):
        put(name, state, 1, float(start))

    tuning, decay = tuning_of(study), np.zeros(size - BIASES)
    assumed = [(VELOCITY, tuning.accelerometer_density**2), (ATTITUDE, tuning.gyro_density**2)]
    assumed += [(state, float(tuning.drive[state - BIASES])) for state in range(BIASES, m, 3)]
    decay[: m - BIASES] = tuning.decay_rate[: m - BIASES]
    starts = [(error, error.first + n) for error in errors if error.sigma > 0.0 for n in range(error.states)]
    initial = np.zeros((size, len(starts)))
    for column, (error, state) in enumerate(starts):
        initial[state, column] = error.sigma
        if m > inertial and error.first == first[SLOW_GNSS]:  # with which the position begins
            initial[state - error.first, column] = gnss.axis_markov_noise[state - error.first]
    for error in errors:
        if error.time > 0.0:
            decay[error.first - BIASES : error.first - BIASES + error.states] = 1.0 / error.time
    return States(
        sources=tuple(sources),
        noisy=noisy,
        inertial=inertial,
        estimated=m,
        moving=moving,
        size=size,
        first=first,
        drives=tuple(error for error in errors if error.drive > 0.0),
        assumed=tuple(each for each in assumed if each[1] > 0.0),
        decay=decay,
        initial=initial,
        owner=np.array([error.source for error, _ in starts], dtype=np.int64),
        believed=believed_covariance(study),
    )
