"""Per-axis model against the discrete Riccati solver, matrix exponentials and a dense Kalman smoother."""

import batch
import numpy as np
import pytest
import riccati

from nav_model.processing.flight import Channel
from nav_model.sar.axis_model import (
    AxisModel,
    inertial_drift,
    information_after,
    noise_path,
)
from nav_model.sar.smoother import rts_smooth


def test_noise_path_has_the_covariance_of_integrated_noise(table_designs):
    model, _ = table_designs["GNSS 1 m"]
    time = np.sort(np.concatenate([np.linspace(0, 5, 26), [3.33]]))
    noise = np.diag([0.0, model.accelerometer_noise**2, model.tilt_noise**2])
    path = noise_path(model, time, 20_000, np.random.default_rng(3))
    for index in (np.searchsorted(time, 3.33), -1):
        sample = np.cov(path[:, :, index])
        expected = riccati.van_loan(np.diag([1.0, 1.0], 1), noise, time[index])[1]
        error = np.sqrt((expected**2 + np.outer(np.diag(expected), np.diag(expected))) / 20_000)
        assert np.all(np.abs(sample - expected) < 4.5 * error)


def test_smoother_is_the_weighted_least_squares_solution(compared):
    """Smoothed states of a short track equal the joint Gaussian posterior given all fixes at once."""
    model = AxisModel(0.3, 0.02, 0.7, 1.0)
    random = np.random.default_rng(11)
    count, (phi, noise) = 6, inertial_drift(model, 1.0)
    first = np.diag([2.0, 1.0, 0.5])
    joint = np.zeros((3 * count, 3 * count))
    joint[:3, :3] = first
    for k in range(1, count):
        rows = slice(3 * k, 3 * k + 3)
        before = slice(3 * k - 3, 3 * k)
        joint[rows, : 3 * k] = phi @ joint[before, : 3 * k]
        joint[: 3 * k, rows] = joint[rows, : 3 * k].T
        joint[rows, rows] = phi @ joint[before, before] @ phi.T + noise
    fixes = random.standard_normal(count)
    picks = np.zeros((count, 3 * count))
    picks[range(count), range(0, 3 * count, 3)] = 1
    gain = joint @ picks.T @ np.linalg.inv(picks @ joint @ picks.T + 0.49 * np.eye(count))
    expected = (gain @ fixes).reshape(count, 3)

    state, covariance = np.zeros(3), first
    forward = ([], [], [], [])
    for k in range(count):
        if k:
            state, covariance = phi @ state, phi @ covariance @ phi.T + noise
        forward[2].append(state)
        forward[3].append(covariance)
        weight = covariance[:, 0] / (covariance[0, 0] + 0.49)
        state = state + weight * (fixes[k] - state[0])
        covariance = covariance - np.outer(weight, covariance[0])
        forward[0].append(state)
        forward[1].append(covariance)
    smoothed = rts_smooth(*(np.array(part) for part in forward), np.broadcast_to(phi, (count - 1, 3, 3)))
    compared(
        "RTS smoother on a track of six fixes",
        "",
        "our own derivation",
        "least squares of all six fixes at once, with the product's transition and process noise",
        smoothed - expected,
        1e-9,
        "largest difference, m, m/s, m/s²",
    )


@pytest.mark.parametrize(
    "extra", [{}, {"velocity_sigma": 0.03}, {"velocity_sigma": 0.03, "slow_sigma": 0.7, "slow_time": 30.0}]
)
@pytest.mark.parametrize("after", [-1.0, 0.0, 0.5, 7.3, 40.0])
def test_what_later_fixes_say(extra, after):
    model = AxisModel(1.3e-3, 1.4e-4, 1.0, 0.3, **extra)
    slow = (model.slow_sigma, model.slow_time) if model.slow_sigma else (None, None)
    velocity = (model.velocity_sigma, model.fix_interval) if model.velocity_sigma else (None, None)
    values = (model.accelerometer_noise, model.tilt_noise, model.gnss_sigma, model.fix_interval, *velocity, *slow)
    channel = Channel(*(None if value is None else np.array(value) for value in values))
    ours = information_after(model, after)
    theirs = batch.information(channel, after)[: len(ours), : len(ours)] if after >= 0 else np.zeros(ours.shape)
    unit = np.sqrt(np.diag(theirs))
    assert np.all(abs(ours - theirs) <= 1e-10 * np.outer(unit, unit))
