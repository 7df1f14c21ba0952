"""The covariance along a flight against another program, and its smoother against the textbook's."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from entered import entered
from pyins.filters import run_feedforward_filter
from pyins.inertial_sensor import EstimationModel
from pyins.measurements import Position

from nav_model.budget.inputs import inputs_of
from nav_model.design.file import read_design
from nav_model.simulation.design_study import specification
from nav_model.simulation.specification import Aids, GnssModel, ImuModel, InitialSigma, SimulationSpec, TriadModel
from nav_model.simulation.trajectory import plan_trajectory
from nav_model.simulation.truth import true_states
from nav_model.trajectory.covariance import covariance
from nav_model.trajectory.errors import ErrorModel, error_model
from nav_model.trajectory.passes import filtered, transitions
from nav_model.trajectory.plan import fly
from nav_model.trajectory.specification import CovarianceSpec
from nav_model.trajectory.waypoints import Plan, Waypoint

METRE = 1 / 6.38e6
MEMS = read_design("examples/mems_x_band.toml")
START = math.radians(45.0)


@pytest.mark.long
def test_through_two_turns_a_climb_and_an_outage_the_filter_is_that_of_another_program() -> None:
    """pyins 1.0.1, at two steps a second: 1 % of every sigma over the whole flight."""
    east = METRE / math.cos(START)
    legs = [(0, 0, 3000.0), (6000, 0, 3000.0), (6000, 8000, 3200.0), (14000, 8000, 3200.0)]
    flight = fly(Plan(tuple(Waypoint(START + n * METRE, e * east, up) for n, e, up in legs), 60.0))
    imu = ImuModel(TriadModel(random_walk=1.5e-4), TriadModel(random_walk=8e-4))
    duration, outage = math.floor(flight.duration), (150.0, 210.0)
    spec = SimulationSpec(imu, GnssModel(1.0), flight.trajectory, duration=float(duration), outages=(outage,))
    result = covariance(CovarianceSpec(spec, inputs_of(MEMS))).real_time
    mine = np.hstack([result.position, result.velocity, result.attitude])

    start = InitialSigma()
    t = np.arange(0.0, duration + 0.1, 0.5)
    now = true_states(plan_trajectory(spec.trajectory, spec.duration), t[t <= duration])
    angles = np.degrees(now.euler)
    table = pd.DataFrame(
        np.column_stack([np.degrees(now.position[:, :2]), now.position[:, 2], now.velocity, angles]),
        columns=["lat", "lon", "alt", "VN", "VE", "VD", "roll", "pitch", "heading"],
        index=np.round(t[t <= duration], 6),
    )
    whole = np.arange(1.0, float(duration))
    fixes = table.loc[whole[(whole <= outage[0]) | (whole > outage[1])], ["lat", "lon", "alt"]]
    sigma = (
        run_feedforward_filter(
            table,
            table,
            position_sd=start.position,
            velocity_sd=start.velocity,
            level_sd=math.degrees(start.tilt),
            azimuth_sd=math.degrees(start.yaw),
            gyro_model=EstimationModel(noise=imu.gyro.random_walk),
            accel_model=EstimationModel(noise=imu.accelerometer.random_walk),
            measurements=[Position(fixes, 1.0)],
            time_step=0.5,
        )
        .trajectory_sd.loc[whole]
        .to_numpy(copy=True)
    )
    sigma[:, 6:] = np.radians(sigma[:, 6:])
    np.testing.assert_allclose(mine[1:-1], sigma, rtol=0.01)


def smoothed_runs(model: ErrorModel, runs: int) -> np.ndarray:
    """Errors (outputs, 9, runs) of runs drawn from the model, filtered and smoothed back from node to node."""
    generator = np.random.default_rng(7)
    run, m, n = filtered(model), model.states.estimated, model.states.size
    draw = generator.standard_normal
    whole, estimated = ([*transitions(model, size)] for size in (n, m))
    now = model.states.initial @ draw((model.states.initial.shape[1], runs))
    before, after = [now], []
    for node in range(len(model.time_s)):
        if node:
            now = whole[node] @ now
            for place, error in enumerate(model.states.drives):
                added = model.factors[node - 1, place] @ draw((9, runs))
                now[:9] += added[:9]
                if error.first >= 9:
                    now[error.first : error.first + 3] += added[9:]
            before.append(now)
        noise = sum(np.sqrt(part)[:, None] * draw((len(part), runs)) for part in model.noise[node])
        now = now.copy()
        now[:m] -= run.gain[node] @ (model.rows[node] @ now - noise)
        after.append(now)
    smooth = after[-1][:m]
    result = {len(after) - 1: smooth}
    for node in range(len(after) - 2, -1, -1):
        step, p = estimated[node + 1], run.covariance[node]
        predicted = step @ p @ step.T + model.filter_noise[node]
        back = np.linalg.solve(predicted, step @ p).T
        smooth = after[node][:m] + back @ (smooth - before[node + 1][:m])
        result[node] = smooth
    return np.stack([result[int(node)][:9] for node in model.outputs])


@pytest.mark.parametrize("runs", [400, pytest.param(4000, marks=pytest.mark.slow)])
def test_runs_that_are_smoothed_back_from_fix_to_fix_lie_within_their_confidence(runs: int) -> None:
    """Errors that the filter does not estimate, a turn, an outage, heading and height among the fixes."""
    texts = {"gyro.bias_instability": "20 °/h", "gyro.correlation_time": "100 s", "gyro.scale_factor": "1000 ppm"}
    design = entered(MEMS, {**texts, "gyro.g_sensitivity": "30 °/h/g", "trajectory.lever_arm_error": "30 cm"})
    study = specification(design, trajectory="turns", duration=180.0, every=6.0, outages=[(100, 130)])
    spec = CovarianceSpec(replace(study, aiding=Aids(heading_noise=0.002, barometer_noise=2.0)), inputs_of(MEMS))
    result = covariance(spec).post_processed
    squares = np.mean(smoothed_runs(error_model(spec), runs)[:, :6] ** 2, axis=2)
    ratio = squares / np.hstack([result.position, result.velocity]) ** 2
    assert np.mean(ratio) == pytest.approx(1.0, abs=4.0 / np.sqrt(runs))
    assert np.all(np.abs(ratio - 1.0) < 5.0 * np.sqrt(2.0 / runs))
