"""Image location errors: quantiles by sampling, the free INS by Monte Carlo, exact geometry."""

import math

import numpy as np
import pytest
from scipy.optimize import fsolve
from scipy.stats import chi2

from nav_model.analytic.steady_state import horizontal
from nav_model.budget import analyse
from nav_model.processing.geolocation import (
    AxisError,
    circular_error,
    free_line,
    ground_covariance,
    shifts,
)


def test_circular_error_of_a_circle_and_of_a_line(compared):
    for share in (0.5, 0.9, 0.95):
        off = [
            float(circular_error(4.0, 4.0, 0.0, share)) / (2 * math.sqrt(chi2.ppf(share, 2))) - 1,
            float(circular_error(4.0, 1e-12, 0.0, share)) / (2 * math.sqrt(chi2.ppf(share, 1))) - 1,
        ]
        compared(
            "Circular error of a circle and of a line",
            "P-7",
            "solver written by others",
            "SciPy's chi2",
            off,
            1e-4,
        )


@pytest.mark.parametrize(("first", "second", "both"), [(1.0, 0.3, 0.2), (9.0, 0.04, 0.5), (2.0, 2.0, -1.9)])
def test_circular_error_by_sampling(first, second, both):
    rng = np.random.default_rng(1)
    points = rng.multivariate_normal([0, 0], [[first, both], [both, second]], 400_000)
    inside = np.mean(np.hypot(*points.T) <= float(circular_error(first, second, both)))
    assert inside == pytest.approx(0.9, abs=4 * math.sqrt(0.09 / 400_000))  # four sigmas


def test_line_of_a_free_ins_by_monte_carlo():
    a, w, g, coast, aperture = 2e-3, 3e-4, 9.80665, 3.0, 6.0
    start = horizontal(a, w, 1.0, g)
    bias_a, bias_w = 2e-3, 2e-5
    rng = np.random.default_rng(7)
    runs, steps = 20_000, 900
    dt = (coast + aperture) / steps
    p, v, tilt = rng.multivariate_normal(np.zeros(3), start.matrix(), runs).T
    b, d = bias_a * rng.standard_normal(runs), bias_w * rng.standard_normal(runs)
    inside = []
    for n in range(steps + 1):
        if n * dt >= coast - 1e-9:
            inside.append(p.copy())
        now = g * tilt + b
        p = p + v * dt + now * dt**2 / 2
        v = v + now * dt + a * math.sqrt(dt) * rng.standard_normal(runs)
        tilt = tilt + d * dt + w * math.sqrt(dt) * rng.standard_normal(runs)
    path = np.array(inside)
    t = np.linspace(0, aperture, len(path)) - aperture / 2
    weights = np.full(len(path), 1.0)
    weights[[0, -1]] = 0.5
    mean = weights @ path / weights.sum()
    slope = (weights * t) @ path / np.sum(weights * t**2)
    line = free_line(start, a, w, bias_a, bias_w, g, coast, aperture)
    spread = 4 * math.sqrt(2 / runs)  # four sigmas of a variance
    assert np.var(mean) == pytest.approx(float(line.mean), rel=spread + 0.005)
    assert np.var(slope) == pytest.approx(float(line.slope), rel=spread + 0.005)
    assert np.mean(mean * slope) == pytest.approx(float(line.covariance), rel=spread + 0.01)


def test_shifts_of_the_image_by_exact_geometry():
    """Range and Doppler as the radar measured them, solved for the ground with the position it believes."""
    grazing, slant, speed, height = math.radians(35), 7000.0, 90.0, 7000.0 * math.sin(math.radians(35))
    target = np.array([0.0, slant * math.cos(grazing), 0.0])

    def shift(moved, faster, scene):
        position, velocity = np.array([0.0, 0.0, -height]), np.array([speed, 0.0, 0.0])
        sight = target - position
        distance, rate = np.linalg.norm(sight), velocity @ sight / np.linalg.norm(sight)

        def off(ground):
            line = np.array([ground[0], ground[1], scene]) - (position + moved)
            return [np.linalg.norm(line) - distance, (velocity + faster) @ line / np.linalg.norm(line) - rate]

        return fsolve(off, target[:2], xtol=1e-13) - target[:2]

    def ours(mean, slope, scene):
        """Shift of unit errors as the square roots of the variances: along the track, across."""
        level, upright = (
            AxisError(np.array(m), np.array(s), np.array(0.0)) for m, s in zip(mean, slope, strict=True)
        )
        moved = shifts(level, upright, grazing, slant, speed)
        ground = ground_covariance(moved, grazing, scene)
        return math.sqrt(float(ground[0])), math.sqrt(float(ground[1]))

    small = 1e-3
    across = shift(np.array([0, small, 0.0]), np.zeros(3), 0.0)
    assert abs(across[1]) == pytest.approx(small, rel=1e-4)
    up = shift(np.array([0, 0, small]), np.zeros(3), 0.0)
    assert abs(up[1]) == pytest.approx(ours((0, small**2), (0, 0), 0.0)[1], rel=1e-4)
    scene = shift(np.zeros(3), np.zeros(3), -small)
    assert abs(scene[1]) == pytest.approx(ours((0, 0), (0, 0), small)[1], rel=1e-4)
    for axis, lines in ((1, (small**2, 0)), (2, (0, small**2))):
        faster = np.zeros(3)
        faster[axis] = small
        assert abs(shift(np.zeros(3), faster, 0.0)[0]) == pytest.approx(ours((0, 0), lines, 0.0)[0], rel=1e-4)


def test_the_headline_example(open_design):
    """2.7 m of azimuth shift while the position is good to 0.39 m."""
    budget = analyse(open_design)
    assert budget["azimuth_shift", "real time"].sigma == pytest.approx(2.7, abs=0.05)
    assert budget.steady_state.closed["horizontal_position"] == pytest.approx(0.39, abs=0.01)
    assert budget["ce90", "real time"].sigma > 1.6 * budget["azimuth_shift", "real time"].sigma
    assert budget["ce90", "real time"].sigma / budget["cep", "real time"].sigma > 2
