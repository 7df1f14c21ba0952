"""The error-state extended Kalman filter: transition, propagation, Joseph update, consistency.

Errors are estimate minus truth: position [m] and velocity [m/s] north, east, down; attitude psi [rad] in
C_estimate = (I - [psi x]) C; then, with 15 states, accelerometer [m/s^2] and gyro [rad/s] bias, and with 21
a second such six, so that a constant or walking bias and a Gauss-Markov one have a state each; last, where the
filter knows it, the slow error of the fixes north, east, down over its sigma. For level flight this is [T-1]
(with psi of the other sign, which no variance sees) plus the Earth's and transport's terms.

Sources: Titterton and Weston, 2nd ed., ch. 12; Groves, *Principles of GNSS, Inertial, and Multisensor
Integrated Navigation Systems*, 2nd ed., ch. 14; Bucy and Joseph 1968 for the update.
"""

import math

import numpy as np
from numpy.typing import NDArray

from nav_model.base.compiled import kernel, part
from nav_model.base.constants import EARTH_RATE
from nav_model.earth.wgs84 import curvature_radii_kernel, normal_gravity_kernel
from nav_model.simulation.layout import (
    ACCELEROMETER,
    ATTITUDE,
    BIASES,
    GYRO,
    HEIGHT,
    LATITUDE,
    POSITION,
    TRIADS,
    VELOCITY,
)

FloatArray = NDArray[np.float64]


@kernel
def error_dynamics(state: FloatArray, force: FloatArray, matrix: FloatArray, out: FloatArray) -> None:
    """Write the first nine rows of the continuous error dynamics F, n states of the INS.

    Parameters
    ----------
    state : array
        Navigation state.
    force : array (3,)
        Specific force, north, east, down [m/s²].
    matrix : array (3, 3)
        Body to north, east, down.
    out : array (9, n)
        Takes the rows.
    """
    for i in range(BIASES):
        for j in range(out.shape[1]):
            out[i, j] = 0.0
    sin_lat, cos_lat = math.sin(state[LATITUDE]), math.cos(state[LATITUDE])
    tangent = sin_lat / cos_lat
    meridian, prime = curvature_radii_kernel(sin_lat)
    rn, re = meridian + state[HEIGHT], prime + state[HEIGHT]
    vn, ve, vd = state[VELOCITY], state[VELOCITY + 1], state[VELOCITY + 2]
    # Position: NED metres at the moving point.
    out[0, 0], out[0, 2] = -vd / rn, vn / rn
    out[1, 0], out[1, 1], out[1, 2] = ve * tangent / rn, -vd / re - tangent * vn / rn, ve / re
    for i in range(3):
        out[POSITION + i, VELOCITY + i] = 1.0
    # How transport and Earth rates change with position (columns 0, 2) and velocity (3, 4).
    for column in (0, 2, 3, 4):
        tn, te, td, en, ed = 0.0, 0.0, 0.0, 0.0, 0.0
        if column == 0:
            td = -ve * (1.0 + tangent * tangent) / (re * rn)
            en, ed = -EARTH_RATE * sin_lat / rn, -EARTH_RATE * cos_lat / rn
        elif column == 2:
            tn, te, td = ve / (re * re), -vn / (rn * rn), -ve * tangent / (re * re)
        elif column == 3:
            te = -1.0 / rn
        else:
            tn, td = 1.0 / re, -tangent / re
        wn, we, wd = 2.0 * en + tn, te, 2.0 * ed + td
        out[VELOCITY, column] -= we * vd - wd * ve
        out[VELOCITY + 1, column] -= wd * vn - wn * vd
        out[VELOCITY + 2, column] -= wn * ve - we * vn
        out[ATTITUDE, column] = en + tn
        out[ATTITUDE + 1, column] = te
        out[ATTITUDE + 2, column] = ed + td
    out[VELOCITY + 2, POSITION + 2] += 2.0 * normal_gravity_kernel(sin_lat, state[HEIGHT]) / math.sqrt(rn * re)
    earth_n, earth_d = EARTH_RATE * cos_lat, -EARTH_RATE * sin_lat
    tn, te, td = ve / re, -vn / rn, -ve * tangent / re
    coriolis = (2.0 * earth_n + tn, te, 2.0 * earth_d + td)
    frame = (earth_n + tn, te, earth_d + td)
    for i in range(3):
        # -[w x], row i: columns i + 1 and i + 2 hold w[i + 2] and -w[i + 1].
        j, k = (i + 1) % 3, (i + 2) % 3
        out[VELOCITY + i, VELOCITY + j] += coriolis[k]
        out[VELOCITY + i, VELOCITY + k] -= coriolis[j]
        out[ATTITUDE + i, ATTITUDE + j] += frame[k]
        out[ATTITUDE + i, ATTITUDE + k] -= frame[j]
        out[VELOCITY + i, ATTITUDE + j] -= force[k]
        out[VELOCITY + i, ATTITUDE + k] += force[j]
    for first in range(BIASES, out.shape[1], TRIADS):
        for i in range(3):
            for j in range(3):
                out[VELOCITY + i, first + ACCELEROMETER + j] = -matrix[i, j]
                out[ATTITUDE + i, first + GYRO + j] = matrix[i, j]


@part
def _times(left: FloatArray, right: FloatArray, rows: int, scale: float, out: FloatArray) -> None:
    """out = scale * left[:, :9] @ right, skipping zeros of `left`: the dynamics are sparse."""
    for i in range(rows):
        for j in range(right.shape[1]):
            out[i, j] = 0.0
        for k in range(rows):
            weight = scale * left[i, k]
            if weight != 0.0:
                for j in range(right.shape[1]):
                    out[i, j] += weight * right[k, j]


@kernel
def propagate(
    covariance: FloatArray,
    dynamics: FloatArray,
    force: FloatArray,
    dt: float,
    accelerometer_density: float,
    gyro_density: float,
    decay_rate: FloatArray,
    drive: FloatArray,
    work: FloatArray,
) -> None:
    """P <- Phi P Phi' + Q over a step, in place, exactly symmetric.

    The exponential of the dynamics is taken to third order, which is exact for the chain gyro bias -> attitude ->
    velocity -> position. Q holds the white noises through the same chain, all orders.

    Parameters
    ----------
    covariance : array (n, n)
        P.
    dynamics : array
        As `error_dynamics` writes it, zero for the states beyond its columns.
    force : array (3,)
        Specific force, north, east, down [m/s²].
    dt : float
        Seconds.
    accelerometer_density, gyro_density : float
        Of the white noises [m/s/√s], [rad/√s].
    decay_rate, drive : array (n - 9,) at least
        Of the states beyond the first nine [1/s], [unit²/s].
    work : array (4, n, n)
        Working space.
    """
    n, (rows, inertial) = covariance.shape[0], dynamics.shape
    step, square, cube, product = work[0], work[1], work[2], work[3]
    for i in range(rows):
        for j in range(n):
            step[i, j] = dynamics[i, j] * dt if j < inertial else 0.0
    _times(step, step, rows, 0.5, square)
    _times(step, square, rows, 1.0 / 3.0, cube)
    for i in range(rows):
        for j in range(n):
            step[i, j] += square[i, j] + cube[i, j]
        step[i, i] += 1.0
    # product = Phi P; the bias rows of Phi are diagonal.
    for i in range(rows):
        for j in range(n):
            product[i, j] = 0.0
        for k in range(n):
            weight = step[i, k]
            if weight != 0.0:
                for j in range(n):
                    product[i, j] += weight * covariance[k, j]
    for i in range(rows):
        for j in range(i, rows):
            total = 0.0
            for k in range(n):
                total += product[i, k] * step[j, k]
            covariance[i, j] = total
            covariance[j, i] = total
    for j in range(rows, n):
        factor = math.exp(-decay_rate[j - BIASES] * dt)
        for i in range(rows):
            covariance[i, j] = factor * product[i, j]
            covariance[j, i] = covariance[i, j]
        for i in range(rows, j + 1):
            covariance[i, j] *= factor * math.exp(-decay_rate[i - BIASES] * dt)
            covariance[j, i] = covariance[i, j]
        # Exact for a Gauss-Markov bias, however long the step.
        decay = 2.0 * decay_rate[j - BIASES]
        covariance[j, j] += drive[j - BIASES] * (-math.expm1(-decay * dt) / decay if decay > 0.0 else dt)
    _add_white_noise(covariance, force, dt, accelerometer_density**2, gyro_density**2)


@part
def _add_white_noise(covariance: FloatArray, f: FloatArray, dt: float, qa: float, qg: float) -> None:
    d2, d3 = dt * dt, dt * dt * dt
    norm = f[0] * f[0] + f[1] * f[1] + f[2] * f[2]
    for i in range(3):
        p, v = POSITION + i, VELOCITY + i
        covariance[p, p] += qa * d3 / 3.0
        covariance[v, v] += qa * dt
        covariance[ATTITUDE + i, ATTITUDE + i] += qg * dt
        covariance[p, v] += qa * d2 / 2.0
        covariance[v, p] += qa * d2 / 2.0
        for j in range(3):
            spread = -f[i] * f[j]
            if i == j:
                spread += norm
            covariance[p, POSITION + j] += qg * spread * d3 * d2 / 20.0
            covariance[p, VELOCITY + j] += qg * spread * d2 * d2 / 8.0
            covariance[VELOCITY + j, p] += qg * spread * d2 * d2 / 8.0
            covariance[v, VELOCITY + j] += qg * spread * d3 / 3.0
    for i in range(3):
        # [f x], row i: columns i + 1 and i + 2 hold -f[i + 2] and f[i + 1].
        j, k = (i + 1) % 3, (i + 2) % 3
        for column, value in ((ATTITUDE + j, -f[k]), (ATTITUDE + k, f[j])):
            covariance[POSITION + i, column] += qg * value * d3 / 6.0
            covariance[column, POSITION + i] += qg * value * d3 / 6.0
            covariance[VELOCITY + i, column] += qg * value * d2 / 2.0
            covariance[column, VELOCITY + i] += qg * value * d2 / 2.0


@kernel
def update(
    covariance: FloatArray, row: FloatArray, residual: float, variance: float, estimate: FloatArray, work: FloatArray
) -> float:
    """One scalar measurement, Joseph form; returns its share of the NIS.

    Taken one after the other, the normalised squares of a fix's measurements sum to its NIS.

    Parameters
    ----------
    covariance : array (n, n)
        P, changed in place.
    row : array (n,)
        H.
    residual, variance : float
        Predicted minus measured, and the variance of its noise.
    estimate : array (n,)
        Error estimate, built up over the measurements of a fix.
    work : array
        Working space.
    """
    n = covariance.shape[0]
    cross, gain = work[0, 0], work[0, 1]
    predicted, innovation = variance, residual
    for i in range(n):
        total = 0.0
        for j in range(n):
            total += covariance[i, j] * row[j]
        cross[i] = total
    for i in range(n):
        predicted += row[i] * cross[i]
        innovation -= row[i] * estimate[i]
    for i in range(n):
        gain[i] = cross[i] / predicted
        estimate[i] += gain[i] * innovation
    # (I - K H) P first, then (...)(I - K H)' + K R K', each product carried out.
    half = work[1]
    for i in range(n):
        for j in range(n):
            half[i, j] = covariance[i, j] - gain[i] * cross[j]
    for i in range(n):
        total = 0.0
        for j in range(n):
            total += half[i, j] * row[j]
        cross[i] = total
    for i in range(n):
        for j in range(i, n):
            value = 0.5 * (half[i, j] - cross[i] * gain[j] + half[j, i] - cross[j] * gain[i])
            value += gain[i] * variance * gain[j]
            covariance[i, j] = value
            covariance[j, i] = value
    return innovation * innovation / predicted


@kernel
def normalised_square(covariance: FloatArray, error: FloatArray, work: FloatArray) -> float:
    """error' P^-1 error by Cholesky, P the covariance of the first n states, which `error` (n) has; NaN where P is
    not positive definite. work: (n, n) at least."""
    n = len(error)
    total = 0.0
    for i in range(n):
        for j in range(i + 1):
            value = covariance[i, j]
            for k in range(j):
                value -= work[i, k] * work[j, k]
            if i == j:
                if not value > 0.0:
                    return math.nan
                work[i, i] = math.sqrt(value)
            else:
                work[i, j] = value / work[j, j]
    solution = np.empty(n)
    for i in range(n):
        value = error[i]
        for k in range(i):
            value -= work[i, k] * solution[k]
        solution[i] = value / work[i, i]
        total += solution[i] * solution[i]
    return total
