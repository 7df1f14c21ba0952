"""What a reader of a study must know: where the simulated world is not the one of the closed forms."""

from __future__ import annotations

import math

from nav_model.design import Design
from nav_model.earth.wgs84 import normal_gravity
from nav_model.simulation.departures import untold
from nav_model.simulation.specification import SimulationSpec, TriadModel
from nav_model.simulation.study_inputs import STUDY_KEYS, added


def conditions(design: Design, spec: SimulationSpec) -> tuple[str, ...]:
    """A sentence each, the most general first."""
    flight, said = design.flight, []
    if spec.trajectory.kind == "file":
        said.append("The flight is the file's: the design's speed, latitude, altitude and heading are not flown.")
    else:
        local = float(normal_gravity(math.sin(flight.latitude), flight.altitude))
        said.append(
            f"Gravity in the simulator is WGS 84's normal gravity, {local:.5f} m/s² at the start of the flight; the "
            f"closed forms use the design's {flight.gravity:.5f} m/s² ({100 * (flight.gravity / local - 1):+.2f} %)."
        )
    more = {key: value for key, value in added(spec).items() if not key.startswith("filter.")}
    if more:
        listed = ", ".join(f"{_named(key)} {STUDY_KEYS[key].show(value)}" for key, value in more.items())
        said.append(f"Flown beyond the design, and not in the closed forms: {listed}.")
    if design.imu.accelerometer_bias or design.imu.gyro_bias:
        filter_knows = (
            f"the filter of {spec.filter.states} states estimates them: an outage starts with less of them than the "
            "closed forms assume"
            if spec.filter.states > 9
            else "the filter of 9 states does not know them, so its covariance is optimistic; in level flight tilt "
            "takes up most of an accelerometer bias"
        )
        said.append(f"Residual biases are constant turn-on biases, drawn for each run: {filter_knows}.")
    if design.gnss.correlated:
        said.append(
            "The slow GNSS error is flown, but this filter does not model it: expect an optimistic verdict. The "
            "closed forms [T-3], [T-9] hold white fix noise only; the refined curve [T-17] starts from a filter "
            "that does model it."
        )
    said += _of_the_filter(spec)
    said.append(
        "Errors start at the closed form's steady-state sigmas "
        f"(yaw {STUDY_KEYS['filter.initial_yaw'].show(spec.initial.yaw)}), without its correlations, which settle "
        "first. Fixes come at the IMU sample nearest to each multiple of the interval."
    )
    return tuple(said)


def _of_the_filter(spec: SimulationSpec) -> list[str]:
    """How this filter is not the exact one for what is flown."""
    said = []
    missing = [what for what in untold(spec) if "bias" not in what and "GNSS" not in what and "tuning" not in what]
    if missing:
        said.append(
            f"The filter has no state for {', '.join(missing)}: expect an optimistic verdict where it matters."
        )
    mixed = [name for name, m in (("gyro", spec.imu.gyro), ("accelerometer", spec.imu.accelerometer)) if _mixed(m)]
    if spec.filter.states == 15 and mixed:
        said.append(
            f"The {' and '.join(mixed)} bias is a Gauss-Markov process on top of a constant or a random walk, and "
            "the filter has one state for the sum, a random walk of the same drive 2σ²/τ: exact for times short "
            "against the correlation time, pessimistic for long ones. The filter of 21 states keeps the two apart."
        )
    told = {key: value for key, value in added(spec).items() if key.endswith("noise_scale")}
    if told:
        listed = " and ".join(f"{_named(key)} {value:g}" for key, value in told.items())
        said.append(f"The filter is mistuned on purpose: {listed}, on standard deviations.")
    return said


def _mixed(model: TriadModel) -> bool:
    return model.bias_instability > 0.0 and (model.turn_on_bias > 0.0 or model.rate_random_walk > 0.0)


def _named(key: str) -> str:
    section = key.partition(".")[0]
    label = str(STUDY_KEYS[key].label)
    label = label[:1].lower() + label[1:]
    return label if section in ("receiver", "filter") else f"{section} {label}"
