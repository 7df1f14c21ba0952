"""The filter's algebra against matrix exponentials, Riccati solutions and the textbook update."""

import math

import numpy as np
import pytest
import riccati

from nav_model.simulation.kalman import error_dynamics, normalised_square, propagate, update
from nav_model.simulation.single_run import POSTERIOR, PRIOR, fly_without_errors
from nav_model.simulation.specification import FilterModel, GnssModel, SimulationSpec, TrajectorySpec
from nav_model.simulation.strapdown import initial_state

G = 9.80665


def random_covariance(n: int, seed: int) -> np.ndarray:
    generator = np.random.default_rng(seed)
    scale = np.repeat([2.0, 0.1, 1e-3, 1e-3, 1e-5, 1e-3, 1e-5], 3)[:n]
    factor = generator.standard_normal((n, n)) * scale[:, None]
    return factor @ factor.T


@pytest.mark.parametrize("n", [9, 15, 21])
@pytest.mark.parametrize("dt", [0.01, 0.1, 1.0])
def test_propagation_matches_van_loans_matrix_exponential(n, dt, compared):
    state = initial_state(np.array([0.7, 0.2, 4000.0]), np.array([60.0, -40.0, 3.0]), np.eye(3))
    force = np.array([0.4, -0.3, -9.8])
    dynamics = np.empty((9, n))
    error_dynamics(state, force, np.eye(3), dynamics)
    full = np.zeros((n, n))
    full[:9] = dynamics
    density = np.repeat([0.0, 1e-3**2, 2e-4**2, 0.0, 0.0, 0.0, 0.0], 3)[:n]
    phi, expected_noise = riccati.van_loan(full, np.diag(density), dt)
    start = random_covariance(n, 3)
    expected = phi @ start @ phi.T + expected_noise
    result = start.copy()
    propagate(result, dynamics, force, dt, 1e-3, 2e-4, np.zeros(12), np.zeros(12), np.empty((4, n, n)))
    sigma = np.sqrt(np.diag(expected))
    # Process noise sees only the main chain; Coriolis' share of it is below 1e-4 of the noise in a second.
    off = np.max(np.abs(result - expected) / np.outer(sigma, sigma))
    assert off < (2e-8 if dt == 1.0 else 1e-9)
    compared(
        "Covariance step of the simulator's filter, its dynamics given",
        "",
        "our own derivation",
        "SciPy's matrix exponential (Van Loan) of the filter's own dynamics matrix",
        off,
        2e-8,
        "largest difference, in sigmas",
    )
    noise_only = np.zeros((n, n))
    propagate(noise_only, dynamics, force, dt, 1e-3, 2e-4, np.zeros(12), np.zeros(12), np.empty((4, n, n)))
    sigma = np.sqrt(np.diag(expected_noise)[:9])
    assert np.max(np.abs(noise_only - expected_noise)[:9, :9] / np.outer(sigma, sigma)) < 2e-4 * max(dt, 0.1)


def test_biases_decay_and_are_driven():
    covariance = np.diag(np.repeat([1.0, 1.0, 1.0, 4.0, 9.0], 3))
    decay, drive = np.full(6, 0.01), np.full(6, 0.5)
    propagate(covariance, np.zeros((9, 15)), np.zeros(3), 2.0, 0.0, 0.0, decay, drive, np.empty((4, 15, 15)))
    factor = math.exp(-0.04)
    # A Gauss-Markov process of drive q settles on q tau / 2 = 25, and keeps the rest of its start.
    assert np.diag(covariance)[9:] == pytest.approx(25.0 + (np.repeat([4.0, 9.0], 3) - 25.0) * factor)
    covariance = np.zeros((15, 15))
    propagate(covariance, np.zeros((9, 15)), np.zeros(3), 2.0, 0.0, 0.0, np.zeros(6), drive, np.empty((4, 15, 15)))
    assert np.diag(covariance)[9:] == pytest.approx(1.0)  # a random walk: q t


def test_the_update_matches_the_textbook(compared):
    n = 15
    start, generator = random_covariance(n, 8), np.random.default_rng(9)
    rows = generator.standard_normal((3, n))
    residual, noise = generator.standard_normal(3), np.array([1.0, 2.0, 0.5])
    result, estimate, work = start.copy(), np.zeros(n), np.empty((4, n, n))
    nis = sum(update(result, rows[i], residual[i], noise[i], estimate, work) for i in range(3))
    innovation = rows @ start @ rows.T + np.diag(noise)
    gain = start @ rows.T @ np.linalg.inv(innovation)
    expected = start - gain @ rows @ start
    sigma = np.sqrt(np.diag(start))
    compared(
        "Update of the simulator's filter",
        "",
        "our own derivation",
        "textbook gain by matrix inversion, written out in the test",
        (result - expected) / np.outer(sigma, sigma),
        1e-10,
        "largest difference, in sigmas",
    )
    assert estimate / sigma == pytest.approx(gain @ residual / sigma, abs=1e-10)
    assert nis == pytest.approx(residual @ np.linalg.solve(innovation, residual))
    error = generator.standard_normal(n) * sigma
    assert normalised_square(start, error, np.empty((n, n))) == pytest.approx(error @ np.linalg.solve(start, error))
    assert math.isnan(normalised_square(-start, error, np.empty((n, n))))


def riccati_sigmas(f: np.ndarray, q: np.ndarray, fix: float) -> list[np.ndarray]:
    """Sigmas of one channel just before and just after a fix each second [T-8]."""
    ends = riccati.settled(*riccati.van_loan(f, q, 1.0), np.eye(len(f))[:1], fix**2)
    return [np.sqrt(np.diag(covariance)) for covariance in ends]


@pytest.mark.parametrize(("fix", "kind"), [(1.0, "wandering"), (0.02, "straight")])
def test_the_filter_settles_on_the_discrete_riccati_solution(paper_imu, fix, kind, compared, ratio_off):
    spec = SimulationSpec(
        paper_imu,
        GnssModel(position_noise=fix),
        TrajectorySpec(kind, speed=50.0),
        duration=400.0,
        every=100.0,
        runs=1,
    )
    sigma = fly_without_errors(spec).filter_sigma[:, -1]
    f, q = riccati.channel(0.05 / 60, math.radians(0.5) / 60, G)
    for phase, expected in zip((PRIOR, POSTERIOR), riccati_sigmas(f, q, fix), strict=True):
        compared(
            "Sigmas of the simulator's filter in steady state",
            "T-8",
            "solver written by others",
            "SciPy's discrete Riccati solver on [T-1], written out in the test",
            ratio_off(sigma[phase, [0, 1, 3, 4, 6, 7]], np.repeat(expected, 2)),
            0.01,
        )
    for phase, expected in zip((PRIOR, POSTERIOR), riccati_sigmas(f[:2, :2], q[:2, :2], fix), strict=True):
        assert sigma[phase, [2, 5]] == pytest.approx(expected, rel=0.01)


def test_the_propagation_rate_does_not_change_the_answer(paper_imu):
    sigmas = [
        fly_without_errors(
            SimulationSpec(
                paper_imu, filter=FilterModel(propagation_rate=rate), duration=200.0, outages=((150.0, 200.0),)
            )
        ).filter_sigma[:, -1]
        for rate in (10.0, 100.0)
    ]
    assert sigmas[0] == pytest.approx(sigmas[1], rel=1e-3)


@pytest.mark.slow
def test_the_covariance_stays_positive_definite_for_hours(make_imu):
    """Four hours of centimetre fixes with a tactical IMU and an outage: NEES is NaN as soon as Cholesky fails."""
    spec = SimulationSpec(
        make_imu(0.01, 0.005, gyro=0.1, accelerometer=0.02),
        GnssModel(position_noise=0.01, velocity_noise=0.01),
        filter=FilterModel(states=15),
        duration=14_400.0,
        every=60.0,
        outages=((7200.0, 7800.0),),
    )
    record = fly_without_errors(spec)
    assert np.all(np.isfinite(record.nees))
    assert np.all(record.filter_sigma > 0.0)
