"""Sensors that a filter trusts too much: what it takes for white stays for minutes, and more noise would help."""

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from nav_model.design.parts import quantity
from nav_model.simulation.layout import ATTITUDE, BIASES, POSITION, VELOCITY
from nav_model.simulation.specification import Aids, ImuModel, SimulationSpec
from nav_model.simulation.trajectory import plan_trajectory
from nav_model.simulation.truth import true_states
from nav_model.trajectory.residual import residual_biases
from nav_model.trajectory.specification import CovarianceSpec
from nav_model.trajectory.start import settled_start
from nav_model.trajectory.states import short_as_white, states_of

_MORE = 1.2  # times the noise that the filter assumes
_BETTER = 0.01  # part of a figure that is worth a sentence
_WHITE = 0.1  # of an accuracy whose rest is slow
_FIGURES = {
    "horizontal position": slice(POSITION, POSITION + 2),
    "vertical position": slice(POSITION + 2, VELOCITY),
    "horizontal velocity": slice(VELOCITY, VELOCITY + 2),
    "vertical velocity": slice(VELOCITY + 2, ATTITUDE),
    "tilt": slice(ATTITUDE, ATTITUDE + 2),
    "heading": slice(ATTITUDE + 2, ATTITUDE + 3),
}
_HEADING, _HEIGHT = ATTITUDE + 2, POSITION + 2


def too_much_trust(spec: CovarianceSpec) -> tuple[str, ...]:
    """Sentences on sensors of a flight whose errors stay longer than its filter assumes.

    Figures are those of the settled filter just after a fix, at the start of the flight. An aid without a slow part
    has the figure that it would have with the whole of its noise slow and a tenth of it white.
    """
    return (*_taken_for_white(spec), *_better_with_more_noise(spec))


def _taken_for_white(spec: CovarianceSpec) -> Iterator[str]:
    """A sentence for each aid without a slow part."""
    aids = spec.study.aiding
    show_angle, show_length = (quantity(f"trajectory.{name}").show for name in ("heading_noise", "barometer_noise"))
    if (whole := aids.heading_noise) is not None and aids.heading_slow_noise == 0.0:
        slow = replace(aids, heading_noise=_WHITE * whole, heading_slow_noise=whole)
        yield (
            f"The {show_angle(whole, 3)} of two antennas are taken for white noise, which leaves "
            f"{show_angle(_settled(spec, aids)[_HEADING], 3)} of heading. Most of such an accuracy stays for "
            f"minutes: with the whole of it slow over {aids.heading_time:g} s (trajectory.heading_slow_noise) the "
            f"heading is off by {show_angle(_settled(spec, slow)[_HEADING], 3)}."
        )
    if (whole := aids.barometer_noise) is not None and aids.barometer_slow_noise == 0.0:
        slow = replace(aids, barometer_noise=_WHITE * whole, barometer_slow_noise=whole)
        yield (
            f"The {show_length(whole, 3)} of the barometer are taken for white noise, which leaves "
            f"{show_length(_settled(spec, aids)[_HEIGHT], 3)} of height while fixes come. Most of such an accuracy "
            f"is weather: with the whole of it slow over {aids.barometer_time / 3600:.3g} h "
            f"(trajectory.barometer_slow_noise) it is {show_length(_settled(spec, slow)[_HEIGHT], 3)}, and without "
            "fixes all of it."
        )


def _better_with_more_noise(spec: CovarianceSpec) -> Iterator[str]:
    """A sentence for each sensor of which more noise would lower a figure."""
    for name, key, aids, imu in _with_more_noise(spec.study):
        gains = 1.0 - np.array(_settled(spec, aids, imu)) / _settled(spec, spec.study.aiding)
        better = {figure: float(gains[part].min()) for figure, part in _FIGURES.items()}
        if lower := [f"{figure} by {100 * gain:.2g} %" for figure, gain in better.items() if gain > _BETTER]:
            yield (
                f"The filter trusts the {name} too much, as their errors are not white: {_MORE:g} times the noise "
                f"that it assumes ({key}) would lower {' and '.join(lower)}."
            )


def _with_more_noise(study: SimulationSpec) -> Iterator[tuple[str, str, Aids, ImuModel]]:
    """Sensors with an error that no filter knows: name, key of their noise, and aids and IMU with more of it."""
    aids, imu, more = study.aiding, study.imu, math.sqrt(_MORE**2 - 1.0)
    if slow := aids.heading_slow_noise:
        white = aids.heading_noise or 0.0
        noise = math.hypot(white, more * math.hypot(white, slow))
        yield "two antennas", "trajectory.heading_noise", replace(aids, heading_noise=noise), imu
    if slow := aids.barometer_slow_noise:
        white = aids.barometer_noise or 0.0
        noise = math.hypot(white, more * math.hypot(white, slow))
        yield "barometer's readings", "trajectory.barometer_noise", replace(aids, barometer_noise=noise), imu
    if imu.accelerometer.scale_factor > 0.0:
        coarser = replace(imu.accelerometer, random_walk=_MORE * imu.accelerometer.random_walk)
        yield "accelerometers", "imu.velocity_random_walk", aids, replace(imu, accelerometer=coarser)


def _settled(spec: CovarianceSpec, aids: Aids, imu: ImuModel | None = None) -> list[float]:
    """Sigma of position [m], velocity [m/s] and attitude [rad] with which the flight begins, of other aids or IMU."""
    study = short_as_white(replace(spec.study, aiding=aids, imu=imu or spec.study.imu))
    start = true_states(plan_trajectory(study.trajectory, study.duration), np.array([0.0]))
    initial = settled_start(study, states_of(study, residual_biases(spec.inputs)), start).initial
    sigmas: list[float] = np.sqrt((initial[:BIASES] ** 2).sum(axis=1)).tolist()
    return sigmas
