"""The smoother along a flight against the textbook's."""

from __future__ import annotations

import numpy as np
import pytest

from nav_model.design.file import read_design
from nav_model.simulation.design_study import specification
from nav_model.simulation.study_inputs import read_study_inputs
from nav_model.trajectory.covariance import _filtered, _transition, covariance
from nav_model.trajectory.errors import ErrorModel, error_model
from nav_model.trajectory.specification import Aiding, CovarianceSpec


def smoothed_runs(model: ErrorModel, runs: int) -> np.ndarray:
    """Errors (outputs, 9, runs) of runs drawn from the model, filtered and smoothed back from node to node."""
    generator = np.random.default_rng(7)
    run, m, n = _filtered(model), model.states, model.rows.shape[2]
    draw = generator.standard_normal
    now = sum(np.sqrt(np.diagonal(part))[:, None] * draw((n, runs)) for part in model.initial)
    before, after = [now], []
    for node in range(len(model.time_s)):
        if node:
            now = _transition(model, node, n) @ now
            for place, own in enumerate(model.own):
                added = model.factors[node - 1, place] @ draw((9, runs))
                now[:9] += added[:9]
                if own:
                    now[own : own + 3] += added[9:]
            before.append(now)
        noise = sum(np.sqrt(part)[:, None] * draw((len(part), runs)) for part in model.noise[node])
        now = now - run.gain[node] @ (model.rows[node] @ now - noise)
        after.append(now)
    smooth = after[-1][:m]
    found = {len(after) - 1: smooth}
    for node in range(len(after) - 2, -1, -1):
        step, p = _transition(model, node + 1, m), run.covariance[node]
        predicted = step @ p @ step.T + model.filter_noise[node]
        back = np.linalg.solve(predicted, step @ p).T
        smooth = after[node][:m] + back @ (smooth - before[node + 1][:m])
        found[node] = smooth
    return np.stack([found[int(node)][:9] for node in model.outputs])


@pytest.mark.parametrize("runs", [400, pytest.param(4000, marks=pytest.mark.slow)])
def test_runs_that_are_smoothed_back_from_fix_to_fix_lie_within_their_confidence(runs: int) -> None:
    """Errors that the filter does not estimate, a turn, an outage, heading and height among the fixes."""
    design = read_design("examples/mems_x_band.toml")
    more = read_study_inputs(
        {"gyro.bias_instability": "20 °/h", "gyro.correlation_time": "100 s", "gyro.scale_factor": "1000 ppm"}
    )
    study = specification(design, trajectory="turns", duration=180.0, every=6.0, outages=[(100, 130)], more=more)
    spec = CovarianceSpec(study, None, Aiding(heading_noise=0.002, barometer_noise=2.0, lever_arm_error=0.3))
    found = covariance(spec).post_processed
    squares = np.mean(smoothed_runs(error_model(spec), runs)[:, :6] ** 2, axis=2)
    ratio = squares / np.hstack([found.position, found.velocity]) ** 2
    assert np.mean(ratio) == pytest.approx(1.0, abs=4.0 / np.sqrt(runs))
    assert np.all(np.abs(ratio - 1.0) < 5.0 * np.sqrt(2.0 / runs))
