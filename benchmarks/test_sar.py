"""How long the SAR model takes, against the targets of its issue; never fails on a clock."""

import time

import numpy as np
import pytest

from nav_model.analytic.discrete import cycle
from nav_model.sar.axis_model import AxisModel
from nav_model.sar.decomposition import decompose, ensemble_responses
from nav_model.sar.fast_engine import simulate_axis
from nav_model.sar.image import back_project, simulate_phase_history
from nav_model.sar.impulse_response import aperture_positions, impulse_response, quadratic_response
from nav_model.sar.line_of_sight import ApertureGeometry, range_error
from nav_model.sar.strategies import Tuning
from nav_model.sar.study import study_aperture
from nav_model.sar.winners import Conditions, map_of_winners

HORIZONTAL = AxisModel(0.05 / 60, np.radians(0.5) / 60, 1.0, 1.0)
VERTICAL = AxisModel(0.05 / 60, np.radians(0.5) / 60, 1.0, 1.0, horizontal=False)


def timed(call, repeats=5):
    best = np.inf
    for _ in range(repeats):
        start = time.perf_counter()
        call()
        best = min(best, time.perf_counter() - start)
    return best


@pytest.mark.parametrize("window", ["uniform", "taylor"])
def test_impulse_response(benchmark, window):
    aperture = np.exp(1j * np.pi / 2 * aperture_positions(1024) ** 2)
    full = timed(lambda: impulse_response(aperture, window))
    quadratic_response(1.5, window)
    benchmark(quadratic_response, np.pi / 2, window)
    fast = timed(lambda: quadratic_response(np.pi / 2, window))
    benchmark.extra_info.update(full_x64_s=full, fast_s=fast, full_over_fast=full / fast)


def test_nine_strategies_500_seeds_one_axis(benchmark):
    benchmark.pedantic(simulate_axis, args=(HORIZONTAL, 20.0, 100.0, 500), rounds=3)
    benchmark.extra_info["target_s"] = 2.0


def test_nine_strategies_500_seeds_line_of_sight_with_decomposition(benchmark):
    geometry = ApertureGeometry(10e3, 100.0, 0.6)

    def whole():
        along, across, down = (
            simulate_axis(model, 20.0, 100.0, 500, seed)
            for seed, model in enumerate((HORIZONTAL, HORIZONTAL, VERTICAL))
        )
        error = range_error(geometry, along.time, along.error, across.error, down.error)
        return decompose(error, 2)

    benchmark.pedantic(whole, rounds=2)
    benchmark.extra_info["target_s"] = 2.0


def test_impulse_responses_of_nine_strategies_500_seeds(benchmark):
    phase = 4 * np.pi / 0.031 * simulate_axis(HORIZONTAL, 20.0, 100.0, 500).error
    benchmark.pedantic(ensemble_responses, args=(phase, "taylor"), rounds=1)
    benchmark.extra_info["responses"] = 9 * 500


def test_map_of_winners_100_by_100(benchmark):
    spans, noise = np.geomspace(2.5, 60, 100)[None], np.geomspace(0.005, 5, 100)[:, None]
    start = cycle(0.05 / 60, 1.5e-4, 9.80665, 1.0, noise, noise).posterior.horizontal
    benchmark(map_of_winners, Conditions(spans, noise, 1.0, 0.05 / 60, 1.5e-4, start, grazing_angle=0.6))
    benchmark.extra_info["target_s"] = 0.1


def test_image_256_by_256(benchmark):
    history = simulate_phase_history(
        ApertureGeometry(6000.0, 100.0, 0.6),
        np.linspace(-1, 1, 512),
        9.6e9 + np.linspace(-75e6, 75e6, 256),
        [[0.0, 0.0, 0.0], [10.0, 5.0, 0.0]],
    )
    axis = np.linspace(-40, 40, 256)
    back_project(history, axis[:2], axis[:2])
    benchmark.pedantic(back_project, args=(history, axis, axis), rounds=3)
    benchmark.extra_info["target_s"] = 2.0


def test_whole_study_500_runs_with_impulse_responses(benchmark):
    arguments = (HORIZONTAL, HORIZONTAL, VERTICAL, ApertureGeometry(10e3, 100.0, 0.6), 20.0, 0.031, "taylor")
    benchmark.pedantic(
        study_aperture,
        args=arguments,
        kwargs={"coast_time": 100.0, "runs": 500, "tuning": Tuning()},
        rounds=2,
        warmup_rounds=1,
    )
    benchmark.extra_info["target_s"] = 2.0
