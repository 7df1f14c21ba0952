"""Strategies after an autofocus: formulas against runs, runs against the autofocus at work, and the budget."""

import math

import numpy as np
import pytest

from nav_model import Design, analyse, read_design
from nav_model.aperture.autofocus import noise_of_map_drift, noise_of_phase_gradient
from nav_model.sar.design_study import closed_forms, image_study
from nav_model.sar.focusing import Focusing, after_autofocus, focused
from nav_model.sar.strategies import STRATEGY_KEYS
from tests.support.phase_gradient import lines_between, phases_of, without_line

MEMS = read_design("examples/mems_x_band.toml")


def focusing(design: Design, points: float, decibels: float) -> Focusing:
    used, contrast = design.autofocus, 10 ** (decibels / 10)
    arguments = np.array(points), np.array(contrast)
    gradient = used.method == "phase gradient"
    noise = (
        noise_of_phase_gradient(used.blocks, *arguments) if gradient else noise_of_map_drift(used.order, *arguments)
    )
    return Focusing(used, points, contrast, float(noise.sigma * np.sqrt(noise.weights[2])), math.inf)


@pytest.mark.parametrize(
    ("method", "points", "decibels"),
    [("phase gradient", 50, 15.0), ("phase gradient", 5, 25.0), ("map drift", 5, 20.0), ("map drift", 50, 15.0)],
)
def test_an_autofocus_at_work_leaves_what_is_predicted(method: str, points: int, decibels: float) -> None:
    """It has to find the points, whose places the prediction takes as known; within 20 % over 20 draws."""
    design = MEMS.replace({"autofocus.method": method})
    given = focusing(design, points, decibels)
    errors = without_line(phases_of(MEMS, 40, 480, np.random.default_rng(3)))
    errors = errors[np.abs(errors).max(axis=1) < 2 * math.pi][:20]
    results = [np.var(focused(error, given, seed)) for seed, error in enumerate(errors)]
    predicted = np.mean(after_autofocus(errors, design.autofocus) ** 2) + given.estimation**2
    assert math.sqrt(np.mean(results)) == pytest.approx(math.sqrt(predicted), rel=0.2)


def test_points_that_do_not_stand_out_focus_nothing() -> None:
    """In a forest the brightest pixel of a range bin is clutter."""
    error = without_line(phases_of(MEMS, 1, 480, np.random.default_rng(3)))[0]
    for method in ("phase gradient", "map drift"):
        given = focusing(MEMS.replace({"autofocus.method": method}), 200, 3.0)
        assert np.std(focused(error, given, 1)) > 0.5 * np.std(error)


@pytest.mark.parametrize("samples", [512, 500])
def test_a_noiseless_phase_gradient_takes_lines_out_whole(samples: int) -> None:
    used = MEMS.replace({"autofocus.method": "phase gradient"}).autofocus
    ramp = np.linspace(-40, 90, samples)
    assert np.abs(after_autofocus(ramp, used)).max() < 1e-9
    error = phases_of(MEMS, 1, 512, np.random.default_rng(1))[0]
    blocks = error.reshape(used.blocks, -1).mean(axis=1)
    expected = without_line(error - lines_between(blocks, 512))
    assert after_autofocus(error, used) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("method", ["phase gradient", "map drift"])
@pytest.mark.parametrize("mode", ["real time", "post-processed"])
def test_the_formula_of_the_strategy_in_use_is_the_budget_s(method: str, mode: str) -> None:
    design = MEMS.replace({"autofocus.method": method, "autofocus.scene": "urban", "processing.mode": mode})
    budget = analyse(design)
    closed = closed_forms(budget)
    for key, processing in (("3" if design.coast.before_aperture else "2", "real time"), ("9", "post-processed")):
        phase = budget["detrended_phase", processing].sigma
        before = budget["phase_before_autofocus", processing].sigma
        assert closed.detrended[key] * budget.x.to_phase == pytest.approx(phase, rel=1e-6)
        assert closed.quadratic[key] * budget.x.to_phase == pytest.approx(before, rel=1e-6)


@pytest.mark.long
@pytest.mark.parametrize("method", ["phase gradient", "map drift"])
def test_runs_leave_what_the_formulas_say(method: str) -> None:
    """Of the INS within four standard errors; the filter starts just after a fix in runs."""
    design = MEMS.replace({"autofocus.method": method, "autofocus.blocks": 16, "autofocus.scene": "urban"})
    design = design.replace({"autofocus.signal_to_clutter": 100.0, "autofocus.range_bins": 50.0})
    study = image_study(design, 200)
    for key in ("2", "5", "5w"):
        row = STRATEGY_KEYS.index(key)
        expected = study.closed.detrended[key]
        assert study.rms[row] == pytest.approx(expected, abs=4 * study.rms_error[row] + 0.03 * expected), key
    row = STRATEGY_KEYS.index("2")
    assert not study.beyond[row]
    assert study.rms[row] < 0.2 * study.unfocused[row]
    result = math.sqrt(np.mean(study.typical.residual[row] ** 2))
    assert result == pytest.approx(study.rms[row], rel=0.5)  # one run, its points found


def test_beyond_its_limits_an_autofocus_removes_nothing() -> None:
    urban = {"autofocus.method": "phase gradient", "autofocus.scene": "urban"}
    biased = MEMS.replace({"imu.accelerometer_bias": 0.0980665})
    before, after = (closed_forms(analyse(design)) for design in (biased, biased.replace(urban)))
    assert after.detrended["2"] == pytest.approx(before.detrended["2"], rel=1e-9)
    study = image_study(biased.replace(urban), 20)
    assert study.beyond[1]
    assert study.rms[1] == study.unfocused[1]
    assert study.rms[0] < study.unfocused[1]
