"""The schedule of a run: events by IMU sample, the same for every run of a study, and the truth at them."""

from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Final

import numpy as np
from numpy.typing import NDArray

from nav_model.earth.rotation import euler_error_map
from nav_model.simulation.layout import BAROMETER, HEADING, MEASURED, POSITION, VELOCITY
from nav_model.simulation.specification import SimulationSpec
from nav_model.simulation.trajectory import plan_trajectory
from nav_model.simulation.truth import TruthStates, perfect_increments, true_states

FloatArray = NDArray[np.float64]
PROPAGATE: Final = 1
FIX: Final = 2
OUTPUT: Final = 4


@dataclass(frozen=True, eq=False)
class Schedule:
    """Events per IMU sample (`steps` + 1, bit flags), perfect increments, and truth at fixes and outputs.

    fix_noise: (fixes, MEASURED), as `fix_noise` gives it. error_map: (outputs, 3, 3), filter's attitude error to
    roll, pitch and yaw error.
    coast_s: time since the start of the outage an output falls in, 0 outside outages. unaided: time since the last
    fix of a position at each sample (`steps` + 1) [s], 0 where the next one comes in time.
    """

    events: NDArray[np.uint8]
    increments: FloatArray
    fixes: TruthStates
    outputs: TruthStates
    fix_noise: FloatArray
    error_map: FloatArray
    coast_s: FloatArray
    unaided: FloatArray


def samples_at_multiples(interval: float, spec: SimulationSpec) -> NDArray[np.int64]:
    """IMU samples nearest to interval, 2 interval, ... within the run."""
    count = int(np.floor(spec.duration / interval * (1.0 + 1e-12)))
    samples = np.rint(np.arange(1, count + 1) * interval * spec.imu.rate).astype(np.int64)
    within: NDArray[np.int64] = samples[samples <= spec.steps]
    return within


def output_samples(spec: SimulationSpec) -> NDArray[np.int64]:
    """IMU samples at which a result is kept: 0 and the multiples of `every`, from `record_from` on."""
    samples = samples_at_multiples(spec.every, spec)
    return np.concatenate([[0], samples[samples >= round(spec.record_from * spec.imu.rate)]])


def in_outage(spec: SimulationSpec, time_s: FloatArray) -> tuple[NDArray[np.bool_], FloatArray]:
    """Mask of the times that lose their fix (start < t <= stop), and for those the time since the outage's start."""
    lost = np.zeros(time_s.shape, dtype=np.bool_)
    coast = np.zeros(time_s.shape)
    slack = 0.5 / spec.imu.rate
    for start, stop in spec.outages:
        inside = (time_s > start + slack) & (time_s <= stop + slack)
        lost |= inside
        coast = np.where(inside, time_s - start, coast)
    return lost, coast


def fix_noise(spec: SimulationSpec, truth: TruthStates) -> FloatArray:
    """White noise of what the scheduled fixes measure, at their true states, (n, MEASURED): position [m], velocity
    [m/s], heading [rad] and height [m]; infinite for what does not come. `assumed_noise` is the filter's.

    All but the height is lost in an outage and beyond the bank that the antenna allows. After a loss the position
    solutions of `GnssModel.after_loss` follow.
    """
    gnss, time_s = spec.gnss, truth.time_s
    lost = in_outage(spec, time_s)[0]
    if gnss.bank_limit is not None:
        lost |= np.abs(truth.euler[:, 0]) > gnss.bank_limit
    noise = np.full((len(lost), MEASURED), np.inf)
    position = noise[:, POSITION : POSITION + 3]
    position[:] = gnss.axis_noise
    since, until = time_s - np.maximum.accumulate(np.where(lost, time_s, -np.inf)), 0.0
    for duration, sigma in gnss.after_loss:
        degraded = (since > until) & (since <= until + duration)
        position[degraded] = np.maximum(position[degraded], sigma)
        until += duration
    if gnss.velocity_noise is not None:
        noise[:, VELOCITY : VELOCITY + 3] = gnss.axis_velocity_noise
    if spec.aiding.has_heading:
        noise[:, HEADING] = spec.aiding.heading_noise or 0.0
    noise[lost] = np.inf
    if spec.aiding.has_height:
        noise[:, BAROMETER] = spec.aiding.barometer_noise or 0.0
    return noise


def assumed_noise(spec: SimulationSpec, white: FloatArray) -> FloatArray:
    """Sigma (n, MEASURED) that the filter takes for white, of what fixes measure with the noise `white` and the slow
    errors of the aids."""
    slow = np.zeros(MEASURED)
    slow[HEADING], slow[BAROMETER] = spec.aiding.heading_slow_noise, spec.aiding.barometer_slow_noise
    return spec.filter.gnss_noise_scale * np.hypot(white, slow)


@lru_cache(maxsize=2)
def _plan(spec: SimulationSpec) -> Schedule:
    rate = spec.imu.rate
    trajectory = plan_trajectory(spec.trajectory, spec.duration)
    events = np.zeros(spec.steps + 1, dtype=np.uint8)
    stride = max(1, round(rate / spec.filter.propagation_rate))
    events[stride::stride] |= PROPAGATE
    fixes = samples_at_multiples(spec.gnss.interval, spec)
    noise = fix_noise(spec, true_states(trajectory, fixes / rate))
    comes = np.isfinite(noise).any(axis=1)
    fixes, noise = fixes[comes], noise[comes]
    events[fixes] |= FIX
    outputs = output_samples(spec)
    events[outputs] |= OUTPUT
    truth = true_states(trajectory, outputs / rate)
    return Schedule(
        events=events,
        increments=perfect_increments(spec.trajectory, spec.duration, rate),
        fixes=true_states(trajectory, fixes / rate),
        outputs=truth,
        fix_noise=noise,
        error_map=euler_error_map(truth.euler[:, 1], truth.euler[:, 2]),
        coast_s=in_outage(spec, outputs / rate)[1],
        unaided=since_last(fixes[np.isfinite(noise[:, POSITION])] / rate, np.arange(spec.steps + 1) / rate, spec),
    )


def since_last(fixes: FloatArray, time_s: FloatArray, spec: SimulationSpec) -> FloatArray:
    """Time since the last of some `fixes` [s] at each time of a flight, 0 where the next comes within an interval.

    The flight begins with a fix. At a fix after a longer time it is that time.
    """
    ends = np.concatenate([[0.0], fixes, [np.inf]])
    after = np.maximum(np.searchsorted(ends, time_s - 0.5 / spec.imu.rate), 1)
    gap = np.minimum(ends[after], spec.duration) - ends[after - 1]
    longest = spec.gnss.interval + 1.0 / spec.imu.rate
    return np.asarray(np.where(gap > longest, time_s - ends[after - 1], 0.0))


def plan(spec: SimulationSpec) -> Schedule:
    """The schedule of a study; studies that differ only in runs and seed share one.

    Raises ValueError where the trajectory cannot be flown (see `plan_trajectory`).
    """
    return _plan(replace(spec, runs=1, seed=0, keep_runs=False))
