"""The turning line of sight against exact ranges and against the functionals' own integrals."""

import numpy as np
import pytest

from nav_model.analytic.turning import bent_variance, free_quadratic_variance, turn_weights
from nav_model.aperture.phase import phase_budget, total
from nav_model.sar.line_of_sight import ApertureGeometry, range_error

SPAN, SPEED, FAR = 6.0, 100.0, 7000.0


def quadratic_of(time, error):
    x = 2 * time / SPAN - 1
    return np.polynomial.polynomial.polyfit(x, error, 2)[2]


@pytest.mark.parametrize("squint", [-0.6, 0.0, 0.7])
@pytest.mark.parametrize("grazing", [0.0, 0.5])
@pytest.mark.parametrize("axis", ["along", "across", "down"])
@pytest.mark.parametrize("state", [0, 1, 2])
def test_a_constant_state_makes_the_quadratic_of_the_exact_ranges(squint, grazing, axis, state):
    """A position, velocity or acceleration error at the last fix, 3 s before the aperture."""
    geometry = ApertureGeometry(FAR, SPEED, grazing, squint)
    size, coast = (1e-2, 1e-3, 1e-4)[state], 3.0
    time = np.linspace(0, SPAN, 2001)
    error = size * (time + coast) ** state / (1, 1, 2)[state]
    exact = quadratic_of(time, range_error(geometry, time, **{axis: error}))
    start = np.zeros((3, 3))
    start[state, state] = size**2
    weights = getattr(turn_weights(grazing, squint, SPEED / FAR, SPAN), axis)
    result = np.sqrt(free_quadratic_variance(weights, start, 0.0, 0.0, SPAN, coast))
    # Third order in the half aperture angle, 0.043, is left out.
    assert result == pytest.approx(abs(exact), rel=0.01, abs=size * 3e-4)


def test_a_jerk_too():
    geometry, time, coast = ApertureGeometry(FAR, SPEED, 0.4, 0.5), np.linspace(0, SPAN, 2001), 20.0
    exact = quadratic_of(time, range_error(geometry, time, along=1e-5 * (time + coast) ** 3 / 6))
    weights = turn_weights(0.4, 0.5, SPEED / FAR, SPAN).along
    result = free_quadratic_variance(weights, np.zeros((3, 3)), 0.0, 0.0, SPAN, coast, 1e-5)
    assert np.sqrt(result) == pytest.approx(abs(exact), rel=0.01)


def test_noise_is_the_integral_over_its_impulses():
    """Both noises at once, by the midpoint rule over the moments at which an impulse may come."""
    time = (np.arange(600) + 0.5) / 600 * SPAN
    x = 2 * time / SPAN - 1
    weights = np.array([0.8, 0.3, -0.2])
    shape = np.polynomial.legendre.legvander(x, 2)[:, 2] * 3.75 * (2 / 600)
    kernel = shape * (weights @ np.stack([x**0, x, x**2]))
    age = np.maximum(time[:, None] - time, 0.0)
    accelerated, tilted = kernel @ age, kernel @ (age**2 / 2)
    step = SPAN / 600
    expected = 4e-6 * step * (accelerated**2).sum() + 9e-8 * step * (tilted**2).sum()
    assert free_quadratic_variance(weights, np.zeros((3, 3)), 2e-3, 3e-4, SPAN) == pytest.approx(expected, rel=1e-3)


def test_without_a_turn_it_is_s5():
    start = np.diag([1.0, 0.04, 1e-6])
    sources = (1e-6 / 9.80665**2, 1e-3, 2e-5, 0.0, 3e-6, 9.80665, SPAN, 15.0, 0.0)
    weights = turn_weights(0.0, 0.0, 0.0, SPAN).across
    free = (start, 1e-3, 9.80665 * 2e-5, SPAN, 15.0, 9.80665 * 3e-6)
    assert free_quadratic_variance(weights, *free) == pytest.approx(
        total(phase_budget(*sources)).quadratic, rel=1e-12
    )
    assert bent_variance(weights, *free) == 0.0
