"""The slow error of heights, against a filter and a smoother of one axis written out here."""

import math

import numpy as np
import pytest
from scipy.linalg import expm

from nav_model.budget import analyse
from nav_model.budget.figures import figures
from nav_model.budget.inputs import inputs_of
from nav_model.design import Design
from nav_model.design.file import read_design
from nav_model.design.presets import preset_fill
from nav_model.explore.margins import value_of
from nav_model.sar.design_case import design_case
from nav_model.simulation.design_study import specification

EXAMPLE = read_design("examples/mems_x_band.toml").replace({"processing.leg_after": 2000.0})


def height(walk: float, fix: float, interval: float, slow: float, time: float) -> tuple[float, float]:
    """Height, 1σ [m]: just before a fix of the settled filter, and of the smoother far from both ends, on average
    between fixes. States: height, velocity, slow error.
    """
    step = interval / 4  # so that the smoother has moments between fixes
    decay = math.exp(-step / time)
    gravity_by_height = 2 * 9.80665 / 6.371e6
    phi = expm(step * np.array([[0, 1, 0], [gravity_by_height, 0, 0], [0, 0, -1 / time]]))
    noise = np.zeros((3, 3))
    noise[:2, :2] = walk**2 * np.array([[step**3 / 3, step**2 / 2], [step**2 / 2, step]])
    noise[2, 2] = slow**2 * (1 - decay**2)
    row = np.array([1.0, 0, 1.0])
    p = np.diag([(10 * slow) ** 2, 1.0, slow**2])
    before, after = [], []
    for k in range(4 * 3000):
        p = phi @ p @ phi.T + noise
        before.append(p)
        if k % 4 == 3:
            p = p - np.outer(p @ row, row @ p) / (row @ p @ row + fix**2)
        after.append(p)
    smoothed, middle = after[-1], []
    for k in range(len(after) - 2, 4 * 1500, -1):
        gain = after[k] @ phi.T @ np.linalg.inv(before[k + 1])
        smoothed = after[k] + gain @ (smoothed - before[k + 1]) @ gain.T
        middle.append(smoothed[0, 0])
    return math.sqrt(before[-1][0, 0]), math.sqrt(np.mean(middle[-40:]))


def heights(design: Design) -> tuple[float, float]:
    imu, gnss = design.imu, design.gnss
    up, walk = gnss.vertical_position_noise or gnss.position_noise, imu.velocity_random_walk * imu.vibration_factor
    slow = value_of(design, "gnss.vertical_correlated_noise")
    return height(walk, up, gnss.interval, slow, gnss.correlation_time)


@pytest.mark.parametrize(("name", "sheet"), [("DGNSS", 0.51), ("RTK", 0.025), ("SBAS", 0.63)])
def test_a_class_keeps_the_vertical_accuracy_of_its_sheet(name, sheet):
    """Smoothed with DGNSS over 10 km, heights were taken to 0.17 m: 0.41 m is right."""
    design = EXAMPLE.replace(preset_fill("gnss", name)[0])
    assert design.gnss.vertical_correlated_noise == pytest.approx(sheet, rel=1e-12)
    budget = analyse(design)
    filtered, smoothed = heights(design)
    assert budget["vertical_position", "real time"].sigma == pytest.approx(filtered, rel=1e-3)
    assert budget["vertical_position", "post-processed"].sigma == pytest.approx(smoothed, rel=2e-3)
    assert smoothed > 0.75 * sheet
    late = design.replace({"processing.mode": "post-processed"})
    assert float(figures(inputs_of(late), ["le90"])["le90"]) == pytest.approx(1.6449 * smoothed, rel=0.01)


SLOW = {"gnss.correlated": True, "gnss.correlated_noise": 0.8, "gnss.correlation_time": 60.0}


@pytest.mark.parametrize("mode", ["real time", "post-processed"])
def test_without_one_it_is_in_the_ratio_of_the_noise(mode):
    plain = EXAMPLE.replace({**SLOW, "gnss.position_noise": 0.5, "processing.mode": mode})
    for vertical, ratio in ((None, 1.0), (0.5, 1.0), (0.9, 1.8)):
        design = plain.replace({"gnss.vertical_position_noise": vertical})
        given = design.replace({"gnss.vertical_correlated_noise": 0.8 * ratio})
        assert value_of(design, "gnss.vertical_correlated_noise") == pytest.approx(0.8 * ratio)
        for name, value in figures(inputs_of(design)).items():
            assert float(value) == pytest.approx(float(figures(inputs_of(given))[name]), rel=1e-12), name
    larger = plain.replace({"gnss.vertical_correlated_noise": 1.6})
    now, then = (figures(inputs_of(each), ["vertical_position", "horizontal_position"]) for each in (plain, larger))
    assert then["vertical_position"] > 1.2 * now["vertical_position"]
    assert then["horizontal_position"] == now["horizontal_position"]


def test_a_design_without_one_keeps_its_hash():
    assert Design(SLOW).content_hash == "437e71ce798b1ed7195003f5b68c460e9cf6b330b19545c7223d3c3c3f87c2ab"
    assert Design({**SLOW, "gnss.vertical_correlated_noise": 0.8}).content_hash != Design(SLOW).content_hash


def test_runs_and_strategies_fly_it():
    design = EXAMPLE.replace({**SLOW, "gnss.vertical_correlated_noise": 1.7})
    assert specification(design).gnss.axis_markov_noise == (0.8, 0.8, 1.7)
    assert [model.slow_sigma for model in design_case(analyse(design)).models] == [0.8, 0.8, 1.7]


def test_the_share_of_the_slow_error_is_that_of_heights():
    """A share is the logarithmic derivative by the source's size, [T-18], here of the filter above."""
    design = EXAMPLE.replace({**SLOW, "gnss.vertical_correlated_noise": 5.0})
    less, more = (heights(design.replace({"gnss.vertical_correlated_noise": 5.0 * k}))[0] for k in (0.999, 1.001))
    share = analyse(design)["vertical_position", "real time"].shares["slow GNSS error"]
    assert share == pytest.approx(math.log(more / less) / math.log(1.001 / 0.999), abs=2e-3)
