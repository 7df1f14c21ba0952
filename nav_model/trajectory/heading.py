"""Heading along a flight: when it becomes observable, by what, and which manoeuvre would help."""

import math

import numpy as np
from numpy.typing import NDArray

from nav_model.simulation.truth import TruthStates
from nav_model.trajectory.result import Heading
from nav_model.trajectory.specification import CovarianceSpec

FloatArray = NDArray[np.float64]
_OBSERVED = 0.5  # of the heading that nothing observes
_TURN = math.radians(1.0)  # per second: a turn


def heading_of(spec: CovarianceSpec, truth: TruthStates, sigma: FloatArray) -> Heading:
    """The heading of a flight in real time, `sigma` its error (outputs) [rad].

    Heading shows against fixes where the aircraft accelerates, in a turn above all, or by two antennas.
    It counts as observed once below half of what a gyro alone would keep.
    """
    gyro, gnss, time_s = spec.study.imu.gyro, spec.study.gnss, truth.time_s
    density = gyro.random_walk * spec.study.imu.vibration_factor
    drift = math.hypot(gyro.turn_on_bias, float(spec.inputs.bias_w))
    alone = np.sqrt(spec.study.initial.yaw**2 + density**2 * time_s + (drift * time_s) ** 2)
    seen = np.flatnonzero(sigma < _OBSERVED * alone)
    course = np.unwrap(np.arctan2(truth.velocity[:, 1], truth.velocity[:, 0]))
    turning = np.abs(np.gradient(course, time_s)) > _TURN
    at = float(time_s[seen[0]]) if seen.size else None
    two = spec.study.aiding.has_heading
    cause = advice = ""
    if at is not None:
        has_turned = np.any(turning & (time_s <= at))
        cause = "two antennas" if two else "a turn" if has_turned else "acceleration against the fixes"
    elif not two:
        fixes = ", fixes of velocity," if gnss.velocity_noise is None else ""
        turn = "a turn of 90° or more, or a change of speed, before the first line"
        advice = f"Add {f'sharper turns{fixes} or two antennas' if turning.any() else turn}."
    return Heading(float(sigma[0]), float(sigma.min()), float(sigma[-1]), at, cause, advice)
