"""Differences between the simulated world of a study and that of the closed forms."""

import math

from nav_model.budget.fast import not_flown
from nav_model.budget.inputs import CONSTANT_KEYS, VARYING_KEYS
from nav_model.design import Design
from nav_model.design.declaration import in_sentence
from nav_model.design.parts import Trajectory, quantity
from nav_model.design.trajectory import AIDING
from nav_model.earth.wgs84 import normal_gravity
from nav_model.simulation.departures import unmodelled
from nav_model.simulation.design_study import beside_noise
from nav_model.simulation.specification import SimulationSpec


def conditions(design: Design, spec: SimulationSpec) -> tuple[str, ...]:
    """A sentence each, the most general first."""
    flight, sentences = design.flight, []
    if spec.trajectory.kind == "file":
        sentences.append(
            "The flight comes from the file or plan; the formulas take the design's speed, latitude, altitude and "
            "heading."
        )
    else:
        local = float(normal_gravity(math.sin(flight.latitude), flight.altitude))
        sentences.append(
            f"The simulator uses WGS 84 normal gravity, {local:.5f} m/s² at the start of the flight; the "
            f"formulas use the design's {flight.gravity:.5f} m/s² ({100 * (flight.gravity / local - 1):+.2f} %)."
        )
    in_formulas = {*VARYING_KEYS, *CONSTANT_KEYS, "gyro.correlation_time", "accelerometer.correlation_time"}
    beside = beside_noise(design)
    more = {k: v for k, v in beside.items() if k not in in_formulas and not k.startswith("filter.")}
    if more:
        listed = ", ".join(f"{_named(key)} {quantity(key).show(value)}" for key, value in more.items())
        sentences.append(f"Simulated and not in the formulas: {listed}.")
    if any(key in beside for key in CONSTANT_KEYS):
        sentences.append(
            "Constant errors of the sensors count in the formulas as they settle on a straight leg; in the runs they "
            "turn with the aircraft."
        )
    if spec.imu.accelerometer.residual_bias or spec.imu.gyro.residual_bias:
        sentences.append(
            "Residual biases, drawn for each run, act from the last fix on while no fix comes. The formulas include "
            "the tilt that cancels an accelerometer bias while fixes come, the runs do not."
        )
    if design.gnss.correlated:
        known = (
            f"estimated by the filter of {spec.filter.states} states"
            if spec.filter.slow
            else "simulated, but this filter does not model it: expect an optimistic verdict"
        )
        sentences.append(
            f"The slow GNSS error is {known}. The formulas [T-3], [T-9] include white fix noise only; the curve with "
            "Schuler and Coriolis terms [T-17] starts from a filter that models it."
        )
    sentences += not_flown(design)
    declared = [Trajectory.param[name] for name in AIDING]
    given = [in_sentence(q.label) for q in declared if getattr(design.trajectory, str(q.name)) != q.default]
    if given:
        sentences.append(f"From the plan, the runs include {', '.join(given)}; the formulas do not.")
    sentences += _of_the_filter(design, spec)
    sentences.append(
        "Errors start at the formula's steady-state sigmas "
        f"(yaw {quantity('filter.initial_yaw').show(spec.initial.yaw)}), without correlations, which build "
        "up first. Fixes come at the IMU sample nearest to each multiple of the interval."
    )
    return tuple(sentences)


def _of_the_filter(design: Design, spec: SimulationSpec) -> list[str]:
    """Differences of this filter from the exact one for the simulated errors."""
    sentences = []
    missing = [it for it in unmodelled(spec) if "bias" not in it and "GNSS" not in it and "tuning" not in it]
    if missing:
        sentences.append(
            f"The filter has no state for {', '.join(missing)}: expect an optimistic verdict where it matters."
        )
    mixed = [name for name, m in (("gyro", spec.imu.gyro), ("accelerometer", spec.imu.accelerometer)) if m.mixed]
    if spec.filter.inertial == 15 and mixed:
        sentences.append(
            f"The {' and '.join(mixed)} bias is a Gauss-Markov process on top of a constant or a random walk, and "
            "the filter has one state for the sum, a random walk of the same drive 2σ²/τ: exact for times short "
            "against the correlation time, pessimistic for long ones. The filter of 21 states keeps the two apart."
        )
    scales = {key: value for key, value in beside_noise(design).items() if key.endswith("noise_scale")}
    if scales:
        listed = " and ".join(f"{_named(key)} {value:g}" for key, value in scales.items())
        sentences.append(f"The filter is mistuned on purpose: {listed}, applied to standard deviations.")
    return sentences


def _named(key: str) -> str:
    return in_sentence(quantity(key).label)
