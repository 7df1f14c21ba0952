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
_AIDS = (
    ("heading", "the two antennas", "heading", ATTITUDE + 2),
    ("barometer", "the barometer", "height", POSITION + 2),
)
"""Name of an aid in `Aids`, its sensor, what it shows, and the state of that."""


def too_much_trust(spec: CovarianceSpec) -> tuple[str, ...]:
    """Sentences on sensors of a flight whose errors stay longer than its filter assumes.

    Figures are those of the settled filter just after a fix, at the start of the flight. An aid without a slow part
    has the figure that it would have with the whole of its noise slow and a tenth of it white.
    """
    return (*_taken_for_white(spec), *_better_with_more_noise(spec))


def _taken_for_white(spec: CovarianceSpec) -> Iterator[str]:
    """A sentence for each aid without a slow part."""
    aids = spec.study.aiding
    for aid, sensor, figure, state in _AIDS:
        whole, slow, time = _parts(aids, aid)
        if whole is None or slow > 0.0:
            continue
        all_slow = replace(aids, **{f"{aid}_noise": _WHITE * whole, f"{aid}_slow_noise": whole})
        show = quantity(f"trajectory.{aid}_noise").show
        duration = quantity(f"trajectory.{aid}_correlation_time").show(time, 3)
        yield (
            f"The {show(whole, 3)} of {sensor} are taken for white noise, which leaves "
            f"{show(_settled(spec, aids)[state], 3)} of {figure} while fixes come. Most of such an accuracy stays: "
            f"with the whole of it slow over {duration} (trajectory.{aid}_slow_noise) that is "
            f"{show(_settled(spec, all_slow)[state], 3)}."
        )


def _better_with_more_noise(spec: CovarianceSpec) -> Iterator[str]:
    """A sentence for each sensor of which more noise would lower a figure."""
    for name, key, aids, imu in _with_more_noise(spec.study):
        gains = 1.0 - np.array(_settled(spec, aids, imu)) / _settled(spec, spec.study.aiding)
        better = {figure: float(gains[part].min()) for figure, part in _FIGURES.items()}
        if lower := [f"{figure} by {100 * gain:.2g} %" for figure, gain in better.items() if gain > _BETTER]:
            yield (
                f"The filter trusts {name} too much, as their errors are not white: {_MORE:g} times the noise "
                f"that it assumes ({key}) would lower {' and '.join(lower)}."
            )


def _with_more_noise(study: SimulationSpec) -> Iterator[tuple[str, str, Aids, ImuModel]]:
    """Sensors with an error that no filter knows: name, key of their noise, and aids and IMU with more of it."""
    aids, imu, more = study.aiding, study.imu, math.sqrt(_MORE**2 - 1.0)
    for aid, sensor, _, _ in _AIDS:
        whole, slow, _ = _parts(aids, aid)
        if slow > 0.0:
            white = whole or 0.0
            noise = math.hypot(white, more * math.hypot(white, slow))
            yield sensor, f"trajectory.{aid}_noise", replace(aids, **{f"{aid}_noise": noise}), imu
    if imu.accelerometer.scale_factor > 0.0:
        coarser = replace(imu.accelerometer, random_walk=_MORE * imu.accelerometer.random_walk)
        yield "the accelerometers", "imu.velocity_random_walk", aids, replace(imu, accelerometer=coarser)


def _parts(aids: Aids, aid: str) -> tuple[float | None, float, float]:
    """White noise and slow error of an aid, and how long that lasts [s]."""
    return getattr(aids, f"{aid}_noise"), getattr(aids, f"{aid}_slow_noise"), getattr(aids, f"{aid}_time")


def _settled(spec: CovarianceSpec, aids: Aids, imu: ImuModel | None = None) -> list[float]:
    """Sigma of position [m], velocity [m/s] and attitude [rad] with which the flight begins, of other aids or IMU."""
    study = short_as_white(replace(spec.study, aiding=aids, imu=imu or spec.study.imu))
    start = true_states(plan_trajectory(study.trajectory, study.duration), np.array([0.0]))
    initial = settled_start(study, states_of(study, residual_biases(spec.inputs)), start).initial
    sigmas: list[float] = np.sqrt((initial[:BIASES] ** 2).sum(axis=1)).tolist()
    return sigmas
