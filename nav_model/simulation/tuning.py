"""Assumptions of the filter of a study: its noises, and the covariance that it starts with."""

import math

import numpy as np
from numpy.typing import NDArray

from nav_model.base.constants import EARTH_RATE, STANDARD_GRAVITY
from nav_model.simulation.fixes import FilterTuning
from nav_model.simulation.layout import BIASES, TRIADS
from nav_model.simulation.specification import SimulationSpec

FloatArray = NDArray[np.float64]


def tuning_of(spec: SimulationSpec) -> FilterTuning:
    """Tuning of the filter of a study, with the units of `FilterTuning`; its noises are those of the sensors times
    the vibration factor and the scale of the process noise."""
    scale, inertial, gnss = spec.filter.process_noise_scale, spec.filter.inertial, spec.gnss
    decay, drive = np.zeros(15), np.zeros(15)
    for first, model in ((0, spec.imu.accelerometer), (3, spec.imu.gyro)):
        moved = 2.0 * model.bias_instability**2 / model.correlation_time
        if inertial == 21:
            decay[first + 6 : first + 9] = 1.0 / model.correlation_time if moved else 0.0
            drive[first + 6 : first + 9] = scale**2 * moved
            drive[first : first + 3] = scale**2 * model.rate_random_walk**2
            continue
        if model.bias_instability > 0.0:
            # One state holds the whole bias: a Gauss-Markov process where that is all there is, a random walk
            # of the same drive where a constant or a walk comes with it.
            decay[first : first + 3] = 0.0 if model.mixed else 1.0 / model.correlation_time
        drive[first : first + 3] = scale**2 * (moved + model.rate_random_walk**2)
    of_slow = slice(inertial - BIASES, spec.filter.states - BIASES)
    decay[of_slow], drive[of_slow] = 1.0 / gnss.markov_time, 2.0 / gnss.markov_time
    vibration = spec.imu.vibration_factor * scale
    gyro_density = spec.imu.gyro.random_walk * vibration
    return FilterTuning(
        accelerometer_density=spec.imu.accelerometer.random_walk * vibration,
        gyro_density=gyro_density,
        rate_variance=gyro_density**2 * spec.imu.rate,
        decay_rate=decay,
        drive=drive,
        slow_sigma=np.array(gnss.axis_markov_noise),
        residual_accelerometer=spec.imu.accelerometer.residual_bias,
        residual_gyro=spec.imu.gyro.residual_bias,
    )


def initial_sigma(spec: SimulationSpec) -> FloatArray:
    """Sigma of the true initial error of the INS, (9, 15 or 21): position [m], velocity [m/s], attitude [rad], then
    the biases [m/s², rad/s]."""
    start, triads = spec.initial, (spec.imu.accelerometer, spec.imu.gyro)
    biases: list[float] = {
        9: [],
        15: [math.hypot(m.turn_on_bias, m.bias_instability) for m in triads],
        21: [*(m.turn_on_bias for m in triads), *(m.bias_instability for m in triads)],
    }[spec.filter.inertial]
    values = [start.position, start.velocity, start.tilt, *biases]
    sigma = np.repeat(np.array(values), 3)
    sigma[8] = start.yaw
    return sigma


def fixed_errors(spec: SimulationSpec) -> FloatArray:
    """Sigma (6) of the constant biases [m/s², rad/s] that scale factor, misalignment and g-sensitivity make while the
    flight is straight and level, of gravity and of the Earth's rate, on the mean over headings."""
    latitude = spec.trajectory.latitude
    force = np.array([0.0, 0.0, STANDARD_GRAVITY**2])
    rate = EARTH_RATE**2 * np.array([*[math.cos(latitude) ** 2 / 2] * 2, math.sin(latitude) ** 2])
    variances: list[FloatArray] = []
    for model, sensed in ((spec.imu.accelerometer, force), (spec.imu.gyro, rate)):
        across = sensed.sum() - sensed
        variances.append(
            model.scale_factor**2 * sensed + model.misalignment**2 * across + model.g_sensitivity**2 * force
        )
    sigma: FloatArray = np.sqrt(np.concatenate(variances))
    return sigma


def believed_covariance(spec: SimulationSpec) -> FloatArray:
    """Covariance (states, states) that the filter starts with, units as `initial_sigma`, slow errors in sigmas.

    One that knows the slow error of the fixes knows too that the INS starts from such a fix: its position is off by
    the slow error of that moment, beside its own sigma. One with biases takes `fixed_errors` for constant ones.
    """
    sigma = initial_sigma(spec)
    if spec.filter.inertial > BIASES:
        constant = slice(BIASES, BIASES + TRIADS)
        sigma[constant] = np.hypot(sigma[constant], fixed_errors(spec))
    sigma *= spec.filter.initial_scale
    sigma[9:] = np.maximum(sigma[9:] * spec.filter.bias_scale, least_biases(spec.filter.inertial))
    believed = np.diag(np.concatenate([sigma, np.ones(spec.filter.slow)]) ** 2)
    for axis, state in enumerate(range(spec.filter.inertial, spec.filter.states)):
        slow = spec.gnss.axis_markov_noise[axis]
        believed[axis, axis] += slow**2
        believed[axis, state] = believed[state, axis] = -slow
    return believed


def least_biases(states: int) -> FloatArray:
    """Sigma (states - 9) to which a bias that is zero is known [m/s², rad/s]: the covariance stays regular."""
    return np.resize([1e-9, 1e-9, 1e-9, 1e-13, 1e-13, 1e-13], states - 9)
