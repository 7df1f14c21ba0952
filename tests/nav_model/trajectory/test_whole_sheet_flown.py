"""Simulated flights with every error that a data sheet prints, and a filter of the states of their design."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest
from entered import entered

from nav_model.design import Design
from nav_model.design.file import read_design
from nav_model.sar.smoother import rts_smooth
from nav_model.simulation.design_study import specification
from nav_model.simulation.schedule import plan
from nav_model.simulation.single_run import POSTERIOR, PRIOR, fly
from nav_model.simulation.specification import SimulationSpec
from nav_model.trajectory.covariance import covariance
from nav_model.trajectory.design_study import covariance_specification
from nav_model.trajectory.errors import error_model
from nav_model.trajectory.passes import filtered, transitions
from nav_model.trajectory.result import Processed, TrajectoryResult

pytestmark = pytest.mark.long

RUNS = 100
SHEET = {
    "gyro.turn_on_bias": "30 °/h",
    "gyro.bias_instability": "20 °/h",
    "gyro.correlation_time": "100 s",
    "gyro.rate_random_walk": "20 °/h/√h",
    "gyro.scale_factor": "1000 ppm",
    "gyro.misalignment": "0.5 mrad",
    "gyro.g_sensitivity": "30 °/h/g",
    "accelerometer.turn_on_bias": "0.5 mg",
    "accelerometer.bias_instability": "0.3 mg",
    "accelerometer.correlation_time": "100 s",
    "accelerometer.rate_random_walk": "1 mg/√h",
    "accelerometer.scale_factor": "400 ppm",
    "accelerometer.misalignment": "0.5 mrad",
    "gnss.velocity_noise": "3 cm/s",
    "gnss.lever_forward": "2 m",
}
OTHERS = {
    "gnss.correlated": True,
    "gnss.correlated_noise": 0.5,
    "gnss.correlation_time": 60.0,
    "trajectory.lever_arm_error": 0.3,
    "trajectory.time_offset": 0.005,
    "trajectory.radar_time_offset": 0.005,
    "trajectory.heading_noise": 3e-3,
    "trajectory.heading_slow_noise": 3e-3,
    "trajectory.heading_correlation_time": 30.0,
    "trajectory.barometer_noise": 0.5,
    "trajectory.barometer_slow_noise": 2.0,
    "trajectory.barometer_correlation_time": 100.0,
}
MEMS = read_design("examples/mems_x_band.toml")


def flown(flight: str, more: Mapping[str, object], every: float) -> TrajectoryResult:
    """The covariance along a flight that begins and ends as simulated runs do."""
    design: Design = entered(MEMS.replace(more), SHEET)
    outage = [(170.0, 200.0)]
    study = specification(design, trajectory=flight, duration=220.0, every=every, outages=outage)
    return covariance(replace(covariance_specification(design, study), settled=False, flown_further=0.0))


def within_confidence(errors: np.ndarray, part: Processed) -> None:
    """Fail where mean squares of some runs' errors (runs, times, 9) are no variances of a flight's.

    The mean over times and axes, of many correlated ratios, and each of these within five of its own sigmas.
    """
    sigma = np.hstack([part.position, part.velocity, part.attitude])
    ratio = np.mean(errors**2, axis=0)[1:] / sigma[1:] ** 2
    assert np.mean(ratio) == pytest.approx(1.0, abs=0.6 / np.sqrt(len(errors)))
    assert np.all(np.abs(ratio - 1.0) < 5.0 * np.sqrt(2.0 / len(errors)) + 0.01)


@pytest.mark.parametrize("flight", ["straight", "turns"])
@pytest.mark.parametrize(("more", "states"), [({}, 21), (OTHERS, 24)], ids=["sheet", "all"])
def test_runs_in_real_time(flight: str, more: dict[str, object], states: int) -> None:
    result = flown(flight, more, 10.0)
    study = result.spec.study
    assert study.filter.states == states
    runs = [fly(study, run) for run in range(RUNS)]
    within_confidence(np.stack([run.error[POSTERIOR][:, :9] for run in runs]), result.real_time)
    if (
        not more and flight == "straight"
    ):  # what is fixed acts as constant biases there: the filter believes the truth
        nees = np.mean([run.nees for run in runs], axis=0)
        assert np.all(np.abs(nees - states) < 4.5 * np.sqrt(2.0 * states / RUNS))


@pytest.mark.parametrize("flight", ["straight", "turns"])
def test_runs_that_are_smoothed(flight: str) -> None:
    """By the recursion of Rauch, Tung and Striebel, from fix to fix, of each run's own estimates."""
    result = flown(flight, {}, 1.0)
    within_confidence(smoothed(result, result.spec.study), result.post_processed)


def smoothed(result: TrajectoryResult, study: SimulationSpec) -> np.ndarray:
    """Errors of smoothed runs (runs, times, 9) at the times of a flight, at each of which a fix may come."""
    model = error_model(result.spec)
    m = model.states.estimated
    after = filtered(model).covariance
    to_rotation = plan(study).error_map  # roll, pitch and yaw of a rotation
    before, between, steps = [after[0]], list[np.ndarray](), np.eye(m)
    p, outputs = after[0], set(model.outputs.tolist())
    for node, phi in enumerate(transitions(model, m)):
        if node == 0:
            continue
        p, steps = phi @ p @ phi.T + model.filter_noise[node - 1], phi @ steps
        if node in outputs:
            before.append(p)
            between.append(steps)
            p, steps = after[node], np.eye(m)
        assert node in outputs or not model.is_fix[node]
    runs = [fly(study, run) for run in range(RUNS)]
    states = np.stack([run.error for run in runs], axis=2)  # before and after each fix, times, runs
    states[..., 6:9] = np.linalg.solve(to_rotation[:, None], states[..., 6:9, None])[..., 0]
    errors = rts_smooth(states[POSTERIOR], after[model.outputs], states[PRIOR], np.array(before), np.array(between))
    errors[..., 6:9] = (to_rotation[:, None] @ errors[..., 6:9, None])[..., 0]
    return errors[..., :9].swapaxes(0, 1)
