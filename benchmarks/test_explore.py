"""Durations of exploring, against the targets of its issue; never fails on a clock."""

from importlib.resources import files

import numpy as np
import pytest

from nav_model.analytic.sampled_filter import horizontal_cycle
from nav_model.analytic.settled_filter import settled_cycle
from nav_model.budget import analyse
from nav_model.design.catalogue import catalogue
from nav_model.design.file import parse_design
from nav_model.explore.rank import rank
from nav_model.explore.search import search
from nav_model.explore.solve import solve
from nav_model.explore.trade_map import trade_map
from nav_model.explore.uncertainty import read_uncertain, uncertain_verdict

DESIGN = parse_design(files("app").joinpath("examples", "mems_x_band.toml").read_text(encoding="utf-8"))


def test_analyse(benchmark):
    benchmark(analyse, DESIGN)
    benchmark.extra_info["target_s"] = 0.002


@pytest.mark.parametrize("y", ["gnss.position_noise", "gnss.interval", "coast.duration"])
def test_map(benchmark, y):
    benchmark(trade_map, DESIGN, "imu.angle_random_walk", y)
    benchmark.extra_info["target_s"] = 0.05


def test_map_with_a_slow_error(benchmark):
    benchmark(trade_map, DESIGN.replace({"gnss.correlated": True}), "imu.angle_random_walk", "gnss.position_noise")
    benchmark.extra_info["target_s"] = 0.05


def test_catalogue_search(benchmark):
    imus, receivers = catalogue("imu"), catalogue("gnss")
    benchmark(search, DESIGN, imus, receivers)
    benchmark.extra_info["target_s"] = 0.02


def test_uncertainty_10240_designs(benchmark):
    ranges = {
        "imu.angle_random_walk": "0.02 °/√h .. 0.06 °/√h",
        "imu.velocity_random_walk": "0.06 m/s/√h */ 1.3",
        "gnss.position_noise": "0.5 m .. 3 m log",
    }
    inputs = {key: read_uncertain(key, text) for key, text in ranges.items()}
    uncertain_verdict(DESIGN, inputs)
    benchmark(uncertain_verdict, DESIGN, inputs)
    benchmark.extra_info["target_s"] = 0.2


def test_rank(benchmark):
    benchmark(rank, DESIGN, "quadratic_phase")


@pytest.mark.parametrize("verify", [False, True])
def test_solve(benchmark, verify):
    benchmark(solve, DESIGN, verify=verify)


@pytest.mark.parametrize("way", ["white", "slow error"])
def test_sampled_filter_of_40000_designs(benchmark, way):
    rng = np.random.default_rng(1)
    a, w, r = (
        np.exp(rng.uniform(np.log(lo), np.log(hi), 40_000)) for lo, hi in ((1e-4, 1e-2), (1e-6, 1e-3), (0.1, 5))
    )
    if way == "white":
        benchmark(horizontal_cycle, a, w, 9.8, 1.0, r)
    else:
        benchmark(settled_cycle, a, w, 9.8, 1.0, (r, r), None, (1.0, 300.0))
