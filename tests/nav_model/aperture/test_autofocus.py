"""Autofocus against an eigenvector phase gradient, written here, on simulated histories of points in clutter."""

import math

import numpy as np
import pytest

from nav_model import Design, read_design
from nav_model.aperture.autofocus import (
    after_map_drift,
    after_phase_gradient,
    noise_of_map_drift,
    noise_of_phase_gradient,
)
from nav_model.aperture.phase import phase_budget, total
from nav_model.budget.inputs import inputs_of
from nav_model.budget.real_time import RealTime
from tests.support.phase_gradient import lines_between, next_phase, phases_of, without_line

MEMS = read_design("examples/mems_x_band.toml")
IN_BLOCK = 16


def phase_gradient(history: np.ndarray, blocks: int) -> np.ndarray:
    """Phase that is removed from a history (range bins, pulses), the points of which are known, in five rounds."""
    removed = np.zeros(history.shape[1])
    for _ in range(5):
        removed = next_phase(history, removed, blocks)
    return removed


def left_over(design: Design, blocks: int, points: int, decibels: float, draws: int, seed: int) -> float:
    """Rms of the phase that a phase gradient leaves over draws of the design's errors, the line out [rad]."""
    rng, pulses = np.random.default_rng(seed), blocks * IN_BLOCK
    phases, squares = phases_of(design, draws, pulses, rng), []
    clutter = math.sqrt(pulses / 10 ** (decibels / 10) / 2)
    for phase in without_line(phases):  # the point's place in the image
        noise = clutter * (rng.normal(size=(points, pulses)) + 1j * rng.normal(size=(points, pulses)))
        history = np.exp(1j * (phase + rng.uniform(0, 2 * np.pi, (points, 1)))) + noise
        squares.append(np.mean(without_line(phase - phase_gradient(history, blocks)) ** 2))
    return math.sqrt(np.mean(squares))


def predicted(design: Design, blocks: int, points: int, decibels: float) -> float:
    x = inputs_of(design)
    left = after_phase_gradient(blocks)
    within = total(RealTime(x).phase_by_source(left)).detrended * x.to_phase**2
    noise = noise_of_phase_gradient(blocks, np.array(float(points)), np.array(10 ** (decibels / 10)))
    return float(np.sqrt(within + noise.weights[2] * noise.sigma**2))


@pytest.mark.parametrize(
    ("blocks", "points", "decibels", "draws"),
    [
        (16, 50, 20.0, 40),
        (32, 50, 20.0, 40),
        (16, 5, 25.0, 100),
        *(
            pytest.param(blocks, points, decibels, 100, marks=pytest.mark.slow)
            for blocks in (16, 32, 64)
            for points in (50, 500)
            for decibels in (15.0, 20.0, 25.0)
        ),
    ],
)
def test_a_phase_gradient_leaves_what_is_predicted(
    blocks: int, points: int, decibels: float, draws: int, compared, ratio_off
) -> None:
    """Within 20 %: the draws leave the rms uncertain by 3 % at most."""
    result = left_over(MEMS, blocks, points, decibels, draws, seed=blocks + points)
    compared(
        "Phase after a phase gradient, simulated",
        "S-9",
        "our own derivation",
        "an eigenvector phase gradient written in the test, on simulated points in clutter, 40 draws or more",
        ratio_off(result, predicted(MEMS, blocks, points, decibels)),
        0.2,
        "ratio − 1",
    )


@pytest.mark.parametrize(("blocks", "degrees"), [(8, 2.5), (16, 0.67), (32, 0.21)])
def test_lines_between_blocks_leave_what_simulated_errors_have(blocks: int, degrees: float) -> None:
    """The residual of simulated errors, of 400 draws, whose mean square has a relative 1σ of less than 8 %."""
    x = inputs_of(MEMS)
    within = total(RealTime(x).phase_by_source(after_phase_gradient(blocks))).detrended
    result = math.degrees(float(x.to_phase) * math.sqrt(within))
    assert result == pytest.approx(degrees, rel=0.03)
    pulses = blocks * 32
    squares = [
        np.mean(without_line(phase - lines_between(phase.reshape(blocks, -1).mean(axis=1), pulses)) ** 2)
        for phase in phases_of(MEMS, 400, pulses, np.random.default_rng(blocks))
    ]
    assert math.degrees(math.sqrt(np.mean(squares))) == pytest.approx(result, rel=0.12)


@pytest.mark.parametrize("order", [2, 3])
def test_map_drift_leaves_what_a_polynomial_does(order: int) -> None:
    inputs = (1e-6, 1e-3, 1e-5, 0.01, 1e-5, 9.8, 5.0, 2.0, 0.6)
    by_order, left = (total(phase_budget(*inputs, after)) for after in (order, after_map_drift(order)))
    assert left.detrended == pytest.approx(by_order.detrended, rel=1e-12)
    assert left.quadratic == 0
    assert left.cubic == pytest.approx(by_order.cubic if order == 2 else 0.0, rel=1e-12)


def test_two_looks_shift_by_the_quadratic_over_pi() -> None:
    """Looks of a phase q x² are q/π of their cells apart, so an error of their shift is π times that in q."""
    points, contrast = np.array(50.0), np.array(100.0)
    gamma = 50 / 51
    shift = math.sqrt(3 / 100) * math.sqrt(1 - gamma**2) / (math.pi * gamma) * math.sqrt(1 + 9 / 50**2)
    noise = noise_of_map_drift(2, points, contrast)
    assert noise.sigma * math.sqrt(noise.weights[0]) == pytest.approx(math.pi * shift, rel=1e-12)


def test_a_block_below_the_least_ratio_is_beyond_the_largest_error() -> None:
    for blocks in (8, 16, 32, 64, 128):
        points = np.geomspace(1, 1e6, 50)
        least = blocks * 2 / np.sqrt(points * blocks)  # of a focused point
        assert np.all(noise_of_phase_gradient(blocks, points, least).sigma > 0.3)
