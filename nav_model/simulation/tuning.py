"""Assumptions of the filter of a study: its noises, and the covariance that it starts with."""

import math

import numpy as np
from numpy.typing import NDArray

from nav_model.simulation.fixes import FilterTuning
from nav_model.simulation.layout import BIASES
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
            alone = model.turn_on_bias == 0.0 and model.rate_random_walk == 0.0
            decay[first : first + 3] = 1.0 / model.correlation_time if alone else 0.0
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


def believed_covariance(spec: SimulationSpec) -> FloatArray:
    """Covariance (states, states) that the filter starts with, units as `initial_sigma`, slow errors in sigmas.

    One that knows the slow error of the fixes knows too that the INS starts from such a fix: its position is off by
    the slow error of that moment, beside its own sigma.
    """
    sigma = initial_sigma(spec) * spec.filter.initial_scale
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
