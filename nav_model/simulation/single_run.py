"""One flight: sensors, strapdown INS, GNSS fixes and the closed-loop filter, from (spec, seed, run) alone."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from nav_model.base.compiled import kernel, part
from nav_model.earth.rotation import write_matrix
from nav_model.earth.wgs84 import curvature_radii_kernel
from nav_model.simulation.fixes import FilterTuning, correct, first_order, reported, take_fix
from nav_model.simulation.kalman import error_dynamics, normalised_square, propagate
from nav_model.simulation.layout import (
    ACCELEROMETER,
    ATTITUDE,
    BAROMETER,
    BIASES,
    GYRO,
    HEADING,
    HEIGHT,
    LATITUDE,
    LONGITUDE,
    MEASURED,
    POSITION,
    QUATERNION,
    TRIADS,
    VELOCITY,
)
from nav_model.simulation.schedule import FIX, OUTPUT, Schedule, assumed_noise, plan
from nav_model.simulation.sensors import Triad, draw_triad, measure
from nav_model.simulation.specification import ImuModel, SimulationSpec, TriadModel
from nav_model.simulation.strapdown import advance, initial_state
from nav_model.simulation.trajectory import plan_trajectory
from nav_model.simulation.truth import true_states
from nav_model.simulation.tuning import believed_covariance, initial_sigma, least_biases, tuning_of

FloatArray = NDArray[np.float64]
PRIOR, POSTERIOR = 0, 1


class _Truth(NamedTuple):
    """True states at the outputs, as the kernel reads them; see `TruthStates`."""

    position: FloatArray
    velocity: FloatArray
    matrix: FloatArray


class _Record(NamedTuple):
    """Where a run writes: errors and variances (2, outputs, states), prior then posterior; NEES per output; NIS per
    fix."""

    error: FloatArray
    variance: FloatArray
    nees: FloatArray
    nis: FloatArray


@dataclass(frozen=True, eq=False)
class RunRecord:
    """One run at the output times. Errors are estimate minus truth.

    error, filter_sigma: shape (2, outputs, states), [0] just before the fix at that time and [1] just after
    (the same where no fix falls); states are position [m] and velocity [m/s] north, east, down, then roll,
    pitch, yaw [rad], then with 15 states accelerometer [m/s^2] and gyro [rad/s] biases, those that scale factor,
    misalignment and g-sensitivity make on the flight's mean among them; with 21 those are the constant and walking
    part, and the Gauss-Markov part of both follows. The states of a slow GNSS error are left
    out, here and in the NEES; the NIS has them.
    nees: (outputs,), after the fix. nis: (fixes,), of `measured` numbers in all. fix_error: (fixes, 3), noise of the
    positions, north, east, down [m].
    """

    run: int
    error: FloatArray
    filter_sigma: FloatArray
    nees: FloatArray
    nis: FloatArray
    measured: int
    fix_error: FloatArray


@part
def _write(
    state: FloatArray,
    truth: _Truth,
    k: int,
    bias_error: FloatArray,
    error_map: FloatArray,
    matrix: FloatArray,
    covariance: FloatArray,
    error: FloatArray,
    variance: FloatArray,
    state_error: FloatArray,
) -> None:
    """Errors and variances at output `k`, attitude as roll, pitch, yaw; the error in the filter's own states goes
    to `state_error`."""
    n = len(state_error)
    latitude = truth.position[k, 0]
    meridian, prime = curvature_radii_kernel(math.sin(latitude))
    height = truth.position[k, 2]
    state_error[POSITION] = (state[LATITUDE] - latitude) * (meridian + height)
    state_error[POSITION + 1] = (state[LONGITUDE] - truth.position[k, 1]) * (prime + height) * math.cos(latitude)
    state_error[POSITION + 2] = height - state[HEIGHT]
    for i in range(3):
        state_error[VELOCITY + i] = state[VELOCITY + i] - truth.velocity[k, i]
        # Half the difference of two opposite elements of C C_true', a rotation that is close to none.
        row, column = (i + 1) % 3, (i + 2) % 3
        rotation, other = 0.0, 0.0
        for j in range(3):
            rotation += matrix[row, j] * truth.matrix[k, column, j]
            other += matrix[column, j] * truth.matrix[k, row, j]
        state_error[ATTITUDE + i] = 0.5 * (rotation - other)
    for i in range(BIASES, n):
        state_error[i] = bias_error[i - BIASES]
    for i in range(n):
        error[i] = state_error[i]
        variance[i] = covariance[i, i]
    for i in range(3):
        angle, spread = 0.0, 0.0
        for j in range(3):
            angle += error_map[k, i, j] * state_error[ATTITUDE + j]
            for m in range(3):
                spread += error_map[k, i, j] * covariance[ATTITUDE + j, ATTITUDE + m] * error_map[k, i, m]
        error[ATTITUDE + i], variance[ATTITUDE + i] = angle, spread


@part
def coast(
    covariance: FloatArray,
    unabsorbed: FloatArray,
    phi: FloatArray,
    dynamics: FloatArray,
    dt: float,
    accelerometer: float,
    gyro: float,
) -> None:
    """Residual biases over a step of `dt` s without a fix, in a covariance that has been propagated.

    Parameters
    ----------
    covariance : array (n, n)
        Changed: of the error after the step.
    unabsorbed : array (6, 9)
        Changed: what one sigma of each bias, accelerometers then gyros, has made of the first nine states.
    phi, dynamics : arrays (n, n), (9, n)
        Transition of the step, and F.
    dt : float
        s.
    accelerometer, gyro : float
        Residual biases, 1 sigma [m/s²], [rad/s].
    """
    drive, moved = np.empty(BIASES), np.empty(BIASES)
    for channel in range(TRIADS):
        axis, made = channel % 3, unabsorbed[channel]
        # b t of velocity and b t²/2 of position; d t of attitude, which tilts the specific force.
        for i in range(BIASES):
            drive[i] = 0.0
        if channel < GYRO:
            drive[VELOCITY + axis], drive[POSITION + axis] = accelerometer * dt, accelerometer * dt * dt / 2.0
        else:
            drive[ATTITUDE + axis] = gyro * dt
            for i in range(3):
                jerk = gyro * dynamics[VELOCITY + i, ATTITUDE + axis]
                drive[VELOCITY + i], drive[POSITION + i] = jerk * dt * dt / 2.0, jerk * dt * dt * dt / 6.0
        for i in range(BIASES):
            moved[i] = 0.0
            for j in range(BIASES):
                moved[i] += phi[i, j] * made[j]
        for i in range(BIASES):
            for j in range(BIASES):
                covariance[i, j] += moved[i] * drive[j] + drive[i] * moved[j] + drive[i] * drive[j]
        for i in range(BIASES):
            made[i] = moved[i] + drive[i]


@kernel
def _advance_run(
    state: FloatArray,
    bias: FloatArray,
    slow: FloatArray,
    covariance: FloatArray,
    increments: FloatArray,
    dt: float,
    events: NDArray[np.uint8],
    unaided: FloatArray,
    gyro: Triad,
    accelerometer: Triad,
    imu_noise: np.random.Generator,
    tuning: FilterTuning,
    reports: FloatArray,
    believed: FloatArray,
    arm: FloatArray,
    outputs: _Truth,
    error_map: FloatArray,
    record: _Record,
) -> None:
    """Fly one run: every IMU sample through the INS, the filter at its events. Changes what it is given.

    reports, believed: of the fixes, as `take_fix` has them of one.
    """
    n = covariance.shape[0]
    inertial = n - len(slow)
    work, dynamics = np.empty((4, n, n)), np.empty((BIASES, inertial))
    matrix, mean_matrix = np.empty((3, 3)), np.empty((3, 3))
    # Samples in turn; then vectors of working space.
    window, scratch, force, rate = np.zeros((3, 6)), np.empty(6), np.zeros(3), np.empty(3)
    estimate, state_error, bias_error = np.zeros(n), np.empty(inertial), np.empty(len(bias))
    unabsorbed = np.zeros((TRIADS, BIASES))
    quaternion = state[QUATERNION : QUATERNION + 4]
    write_matrix(quaternion, matrix)
    # Not a literal 0, for which Numba would compile what takes these indices a second time.
    none: int = np.int64(0)  # type: ignore[assignment]
    last_step, fix, output = none, none, none
    for k in range(-1, len(events)):
        # Rows 0 and 1 of the increments end at time 0: they only fill the window.
        sample, now = increments[k + 1], window[(k + 1) % 3]
        # What the sensors report of this sample, less the biases that the filter has estimated.
        measure(accelerometer, sample[:3], dt, imu_noise, now[:3])
        measure(gyro, sample[3:], dt, imu_noise, now[3:])
        for i in range(6):
            now[i] -= (bias[i] + bias[TRIADS + i]) * dt
        if k == 0:  # a walk starts here, not with the samples before
            for i in range(3):
                accelerometer.walk[i] = 0.0
                gyro.walk[i] = 0.0
        if k > 0:
            advance(state, now, window[k % 3], window[(k - 1) % 3], dt, force, scratch)
        if k < 0 or events[k] == 0:
            continue
        # The filter steps from event to event, not from sample to sample, with the mean force and attitude since the
        # last one. Over the same time, what is estimated of biases and slow error decays.
        if k > last_step:
            elapsed = (k - last_step) * dt
            for i in range(3):
                force[i] /= elapsed
                for j in range(3):
                    mean_matrix[i, j] = matrix[i, j]
            write_matrix(quaternion, matrix)
            for i in range(3):
                for j in range(3):
                    mean_matrix[i, j] = (mean_matrix[i, j] + matrix[i, j]) * 0.5
            error_dynamics(state, force, mean_matrix, dynamics)
            propagate(
                covariance,
                dynamics,
                force,
                elapsed,
                tuning.accelerometer_density,
                tuning.gyro_density,
                tuning.decay_rate,
                tuning.drive,
                work,
            )
            if unaided[k] > 0.0:
                coast(
                    covariance,
                    unabsorbed,
                    work[0],
                    dynamics,
                    elapsed,
                    tuning.residual_accelerometer,
                    tuning.residual_gyro,
                )
            for i in range(3):
                force[i] = 0.0
            for i in range(inertial - BIASES):
                bias[i] *= math.exp(-tuning.decay_rate[i] * elapsed)
            for i in range(len(slow)):
                slow[i] *= math.exp(-tuning.decay_rate[inertial - BIASES + i] * elapsed)
            last_step = k
        # An output is written before the fix and after it.
        for phase in range(2):
            if phase == 1 and events[k] & FIX:
                for i in range(3):
                    rate[i] = now[GYRO + i] / dt
                record.nis[fix] = take_fix(
                    state,
                    reports[fix],
                    believed[fix],
                    arm,
                    rate,
                    matrix,
                    covariance,
                    tuning,
                    slow,
                    estimate,
                    work,
                )
                correct(state, bias, slow, estimate)
                write_matrix(quaternion, matrix)
                # What residual biases had made is estimated now; a barometer alone shows the vertical one.
                all_axes = math.isfinite(believed[fix, POSITION])
                for i in range(TRIADS):
                    for j in range(BIASES):
                        unabsorbed[i, j] *= 0.0 if all_axes or i == ACCELEROMETER + 2 else 1.0
                fix += 1
            # A filter with one state for the bias of a sensor estimates the sum of its constant and its varying part.
            if events[k] & OUTPUT:
                for i in range(3):
                    a, g = ACCELEROMETER + i, GYRO + i
                    bias_error[a] = bias[a] - accelerometer.constant[i] - accelerometer.walk[i]
                    bias_error[g] = bias[g] - gyro.constant[i] - gyro.walk[i]
                    bias_error[TRIADS + a] = bias[TRIADS + a] - accelerometer.markov[i]
                    bias_error[TRIADS + g] = bias[TRIADS + g] - gyro.markov[i]
                if inertial == BIASES + TRIADS:
                    for i in range(TRIADS):
                        bias_error[i] += bias_error[TRIADS + i]
                _write(
                    state,
                    outputs,
                    output,
                    bias_error,
                    error_map,
                    matrix,
                    covariance,
                    record.error[phase, output],
                    record.variance[phase, output],
                    state_error,
                )
                if phase == 1:
                    record.nees[output] = normalised_square(covariance, state_error, work[0])
        if events[k] & OUTPUT:
            output += 1


def _fly_with(spec: SimulationSpec, imu: ImuModel, run: int, noisy: bool) -> RunRecord:
    """Fly run `run` with the sensors of `imu` and the filter tuned for `spec`."""
    schedule: Schedule = plan(spec)
    n = spec.filter.inertial
    sequence = np.random.SeedSequence(spec.seed, spawn_key=(run,))
    start_noise, imu_noise, gnss_noise = (np.random.Generator(np.random.PCG64(s)) for s in sequence.spawn(3))
    gyro = draw_triad(imu.gyro, imu.rate, imu.vibration_factor, start_noise)
    accelerometer = draw_triad(imu.accelerometer, imu.rate, imu.vibration_factor, start_noise)
    increments, residual = schedule.increments, (imu.accelerometer.residual_bias, imu.gyro.residual_bias)
    if any(residual):
        acting = np.concatenate([[0.0], schedule.unaided > 0.0]) / imu.rate
        increments = increments + acting[:, None] * np.repeat(residual, 3) * start_noise.standard_normal(6)
    by_force = np.zeros(3)
    if imu.gyro.g_sensitivity:
        by_force = imu.gyro.g_sensitivity * start_noise.standard_normal(3)
        increments = np.hstack([increments[:, :GYRO], increments[:, GYRO:] + by_force * increments[:, :GYRO]])
    # Of the flight's mean force and rate, a filter takes what the constant errors make for a constant bias.
    force, rate = np.split(schedule.increments.mean(axis=0) * imu.rate, 2)
    gyro = gyro._replace(constant=gyro.fixed + gyro.distortion @ (rate + by_force * force) - rate)
    accelerometer = accelerometer._replace(constant=accelerometer.fixed + accelerometer.distortion @ force - force)
    sigma = initial_sigma(spec)
    draw = sigma[:9] * start_noise.standard_normal(9) * (1.0 if noisy else 0.0)
    bias = np.zeros(12)
    if noisy:  # a bias of zero is drawn as well as the filter knows it: its NEES would otherwise be too small
        bias[: n - 9] = np.where(sigma[9:] == 0.0, least_biases(n), 0.0) * start_noise.standard_normal(n - 9)
    report, fix_error, slow_before = _reports(spec, schedule, start_noise, gnss_noise, noisy)
    truth, slow = schedule.outputs, np.zeros(spec.filter.slow)
    state = initial_state(truth.position[0], truth.velocity[0], truth.matrix[0])
    if spec.filter.slow:
        draw[:3] += slow_before
    # `correct` takes an error out; its negative puts one in.
    correct(state, np.zeros(12), np.zeros(0), -draw)
    if noisy and spec.radar_time_offset:
        late = spec.radar_time_offset * start_noise.standard_normal()
        truth = true_states(plan_trajectory(spec.trajectory, spec.duration), truth.time_s + late)
    outputs, fixes = len(truth.time_s), len(report)
    both = (2, outputs, n)
    record = _Record(np.empty(both), np.empty(both), np.empty(outputs), np.empty(fixes))
    _advance_run(
        state,
        bias,
        slow,
        believed_covariance(spec),
        increments,
        1.0 / imu.rate,
        schedule.events,
        schedule.unaided,
        gyro,
        accelerometer,
        imu_noise,
        tuning_of(spec),
        report,
        assumed_noise(spec, schedule.fix_noise) ** 2,
        np.array(spec.gnss.lever_arm),
        _Truth(*map(np.ascontiguousarray, (truth.position, truth.velocity, truth.matrix))),
        schedule.error_map,
        record,
    )
    if not np.all(np.isfinite(record.nees)):
        first = float(truth.time_s[int(np.argmin(np.isfinite(record.nees)))])
        raise ArithmeticError(f"run {run}: the filter's covariance is not positive definite at {first:g} s")
    measured = int(np.isfinite(schedule.fix_noise).sum())
    return RunRecord(run, record.error, np.sqrt(record.variance), record.nees, record.nis, measured, fix_error)


def _reports(
    spec: SimulationSpec,
    schedule: Schedule,
    constants: np.random.Generator,
    generator: np.random.Generator,
    noisy: bool,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Reports at the fixes of a run (fixes, MEASURED), the noise of its positions (fixes, 3), and their slow
    error at the start (3), which moves on from there.

    `constants` are drawn once: the errors of the lever arm and of the receiver's time.
    """
    gnss, truth, arm = spec.gnss, schedule.fixes, np.array(spec.gnss.lever_arm)
    if not noisy:
        nothing = np.zeros((len(truth.time_s), MEASURED))
        return reported(truth, nothing, arm), nothing[:, :3], np.zeros(3)
    if gnss.lever_arm_error or gnss.time_offset:
        arm = arm + gnss.lever_arm_error * constants.standard_normal(3)
        late = gnss.time_offset * constants.standard_normal()
        truth = true_states(plan_trajectory(spec.trajectory, spec.duration), truth.time_s + late)
    comes = np.isfinite(schedule.fix_noise)
    used = np.flatnonzero(comes.any(axis=0))
    before = generator.standard_normal((1, 3))
    drawn = generator.standard_normal((len(truth.time_s), 3 + len(used)))
    time_s = schedule.fixes.time_s
    slow = _slow_errors(time_s, np.array(gnss.axis_markov_noise), gnss.markov_time, np.vstack([before, drawn[:, :3]]))
    noise = np.zeros((len(drawn), MEASURED))
    noise[:, used] = np.where(comes, schedule.fix_noise, 0.0)[:, used] * drawn[:, 3:]
    noise[:, :3] += slow[1:]
    aids = spec.aiding
    for measured, sigma, tau in (
        (HEADING, aids.heading_slow_noise, aids.heading_time),
        (BAROMETER, aids.barometer_slow_noise, aids.barometer_time),
    ):
        if sigma > 0.0:  # else nothing is drawn, and runs without it stay the same
            unit = generator.standard_normal((1 + len(time_s), 1))
            noise[:, measured] += _slow_errors(time_s, np.array([sigma]), tau, unit)[1:, 0]
    return reported(truth, noise, arm), noise[:, :3], slow[0]


def _slow_errors(time_s: FloatArray, sigma: FloatArray, tau: float, unit: FloatArray) -> FloatArray:
    """Gauss-Markov processes of correlation time `tau` [s] at time 0 and at some times (1 + n, axes), of white noise
    `unit` of as many."""
    correlation = np.concatenate([[0.0], np.exp(-np.diff(time_s, prepend=0.0) / tau)])
    slow: FloatArray = np.sqrt(1.0 - correlation * correlation)[:, None] * unit * sigma
    first_order(correlation, slow)
    return slow


def fly(spec: SimulationSpec, run: int) -> RunRecord:
    """Run number `run` of a study: reproducible, whichever process flies it.

    Raises ArithmeticError where the covariance stops being positive definite, ValueError for a trajectory
    that cannot be flown.
    """
    return _fly_with(spec, spec.imu, run, noisy=True)


def fly_without_errors(spec: SimulationSpec) -> RunRecord:
    """The filter's covariance along the true path: no sensor or initial error, so `filter_sigma` is the
    answer.

    This is a covariance analysis with the full model; its errors are only those of the mechanisation.
    """
    perfect = ImuModel(TriadModel(), TriadModel(), spec.imu.rate)
    return _fly_with(spec, perfect, 0, noisy=False)
