"""The instruments' errors have the statistics of their data sheet."""

import math

import numpy as np
import pytest

from nav_model.base.compiled import kernel
from nav_model.base.errors import InputError
from nav_model.simulation.sensors import Triad, draw_triad, measure
from nav_model.simulation.specification import GnssModel, ImuModel, TriadModel

RATE = 100.0


@kernel
def measure_all(triad: Triad, true: np.ndarray, dt: float, generator: np.random.Generator, out: np.ndarray) -> None:
    for k in range(len(true)):
        measure(triad, true[k], dt, generator, out[k])


def errors(model: TriadModel, samples: int, seed: int, true: np.ndarray | None = None, vibration: float = 1.0):
    """Reported increments minus the true ones, shape (samples, 3)."""
    generator = np.random.default_rng(seed)
    triad = draw_triad(model, RATE, vibration, generator)
    increments = np.zeros((samples, 3)) if true is None else true
    reported = np.empty_like(increments)
    measure_all(triad, increments, 1.0 / RATE, generator, reported)
    return reported - increments


def test_white_noise_walks_by_its_density_times_the_vibration_factor():
    angle = np.sum(errors(TriadModel(random_walk=2e-4), 1_000_000, 1, vibration=1.5).reshape(-1, 100, 3), axis=1)
    # 30,000 independent one-second angles: sigma of the estimate is 0.41 %.
    assert np.std(angle) == pytest.approx(3e-4, rel=4 * 0.0041)


def test_gauss_markov_bias_has_its_sigma_and_correlation_time():
    model = TriadModel(bias_instability=1e-3, correlation_time=2.0)
    bias = errors(model, 2_000_000, 2) * RATE
    # 20,000 s are 5,000 independent values (2 tau apart) per axis.
    assert np.var(bias) == pytest.approx(1e-6, rel=4 * math.sqrt(2 / 15_000))
    lag = 300
    correlation = np.mean(bias[lag:] * bias[:-lag]) / np.mean(bias**2)
    assert correlation == pytest.approx(math.exp(-3.0 / 2.0), abs=0.04)


def test_turn_on_bias_is_constant_within_a_run_and_drawn_for_each():
    model = TriadModel(turn_on_bias=1e-3)
    drawn = np.array([errors(model, 3, seed) * RATE for seed in range(300)])
    assert np.ptp(drawn, axis=1) == pytest.approx(0.0, abs=1e-15)
    assert np.std(drawn[:, 0]) == pytest.approx(1e-3, rel=4 / math.sqrt(2 * 900))


def test_rate_random_walk_grows_with_the_root_of_time():
    final = np.array([errors(TriadModel(rate_random_walk=1e-5), 2001, seed)[-1] * RATE for seed in range(300)])
    assert np.std(final) == pytest.approx(1e-5 * math.sqrt(20.0), rel=4 / math.sqrt(2 * 900))


def test_quantization_keeps_what_it_rounds():
    increments = np.full((5000, 3), 0.37e-6)
    error = errors(TriadModel(quantization=1e-6), 5000, 1, increments)
    reported = (error + increments) / 1e-6
    assert reported == pytest.approx(np.round(reported), abs=1e-9)
    assert np.max(np.abs(np.cumsum(error, axis=0))) <= 0.5e-6 * (1 + 1e-6)


def test_scale_factor_and_misalignment_are_a_matrix_of_the_stated_sigmas():
    model = TriadModel(scale_factor=1e-3, misalignment=2e-3)
    matrices = np.array([errors(model, 3, seed, np.eye(3)) for seed in range(400)])
    diagonal = np.eye(3, dtype=bool)
    assert np.std(matrices[:, diagonal]) == pytest.approx(1e-3, rel=4 / math.sqrt(2 * 1200))
    assert np.std(matrices[:, ~diagonal]) == pytest.approx(2e-3, rel=4 / math.sqrt(2 * 2400))


@pytest.mark.parametrize(
    ("build", "named"),
    [
        (lambda: TriadModel(random_walk=-1.0), "random_walk"),
        (lambda: TriadModel(correlation_time=0.0), "correlation_time"),
        (lambda: TriadModel(turn_on_bias=math.inf), "turn_on_bias"),
        (lambda: ImuModel(TriadModel(), TriadModel(), rate=5.0), "imu.rate"),
        (lambda: GnssModel(position_noise=0.0), "position_noise"),
        (lambda: GnssModel(velocity_noise=-1.0), "velocity_noise"),
        (lambda: GnssModel(lever_arm=(0.0, math.nan, 0.0)), "lever_arm"),
    ],
)
def test_instruments_that_cannot_be_are_refused(build, named):
    with pytest.raises(InputError, match="cannot be simulated; must be") as caught:
        build()
    assert caught.value.key == named
