"""The turning line of sight against exact ranges and against the functionals' own integrals."""

import numpy as np
import pytest

from nav_model.analytic.steady_state import Horizontal, Vertical
from nav_model.analytic.turning import Bend, free_bend, turn_of
from nav_model.sar.line_of_sight import ApertureGeometry, range_error

SPAN, SPEED, FAR = 6.0, 100.0, 7000.0
NOTHING = Horizontal(*(np.zeros(()),) * 6)
G = 9.80665


def power_of(time, error, order):
    return np.polynomial.polynomial.polyfit(2 * time / SPAN - 1, error, order)[order]


def starting(state, size, kind=Horizontal):
    """A horizontal axis or the vertical in which one of position, velocity and tilt is wrong."""
    field = {Horizontal: ("p11", "p22", "p33"), Vertical: ("v11", "v22", "v22")}[kind][state]
    none = kind(*(np.zeros(()),) * len(kind._fields))
    return none._replace(**{field: np.array(size**2)})


@pytest.mark.parametrize("squint", [-0.6, 0.0, 0.7])
@pytest.mark.parametrize("grazing", [0.0, 0.5])
@pytest.mark.parametrize("order", [2, 3])
@pytest.mark.parametrize("state", [0, 1, 2])
def test_a_constant_state_makes_the_power_of_the_exact_ranges(squint, grazing, order, state):
    """A position, velocity or acceleration error of every axis at the last fix, 3 s before the aperture: what the
    turn adds to the part along the line of sight of mid-aperture."""
    geometry = ApertureGeometry(FAR, SPEED, grazing, squint)
    size, coast, kind = (1e-2, 1e-3, 1e-4)[state], 3.0, ("quadratic", "cubic")[order - 2]
    time = np.linspace(0, SPAN, 2001)
    error = size * (time + coast) ** state / (1, 1, 2)[state]
    axes = ("along", "across") if state == 2 else ("along", "across", "down")  # a tilt is of the horizontal axes
    exact = [power_of(time, range_error(geometry, time, **{axis: error}), order) ** 2 for axis in axes]
    sight = geometry.target / geometry.slant_range
    still = sum((part * power_of(time, error, order)) ** 2 for part, _ in zip(sight, axes, strict=False))
    inside = G, coast, SPAN
    tilted = starting(state, size / (G if state == 2 else 1))
    upright = starting(state, size, Vertical) if state < 2 else Vertical(*(np.zeros(()),) * 3)
    result = turn_of(grazing, squint, SPEED / FAR, SPAN).bent(
        free_bend(kind, tilted, 0.0, 0.0, 0.0, 0.0, *inside), free_bend(kind, upright, 0.0, 0.0, 0.0, 0.0, *inside)
    )
    # Third order in the half aperture angle, 0.043, is left out.
    assert np.sqrt(max(still + result, 0)) == pytest.approx(np.sqrt(sum(exact)), rel=0.01, abs=size * 3e-4)


@pytest.mark.parametrize(("bias", "jerk"), [(1e-4, 0.0), (0.0, 1e-5)])
@pytest.mark.parametrize("order", [2, 3])
def test_residual_biases_too(bias, jerk, order):
    geometry, time, coast = ApertureGeometry(FAR, SPEED, 0.4, 0.5), np.linspace(0, SPAN, 2001), 20.0
    kind, error = ("quadratic", "cubic")[order - 2], bias * (time + coast) ** 2 / 2 + jerk * (time + coast) ** 3 / 6
    exact = [power_of(time, range_error(geometry, time, **{a: error}), order) ** 2 for a in ("along", "across")]
    s, across, _ = geometry.target / geometry.slant_range
    still = (s**2 + across**2) * power_of(time, error, order) ** 2
    result = turn_of(0.4, 0.5, SPEED / FAR, SPAN).bent(
        free_bend(kind, NOTHING, 0.0, 0.0, bias, jerk / G, G, coast, SPAN), Bend(*np.zeros(5))
    )
    assert np.sqrt(still + result) == pytest.approx(np.sqrt(sum(exact)), rel=0.01)


@pytest.mark.parametrize("order", [2, 3])
def test_noise_is_the_integral_over_its_impulses(order):
    """Both noises at once, by the midpoint rule over the moments at which an impulse may come."""
    time = (np.arange(600) + 0.5) / 600 * SPAN
    x = 2 * time / SPAN - 1
    lead = np.polynomial.legendre.leg2poly(np.eye(4)[order])[order]
    shape = np.polynomial.legendre.legvander(x, order)[:, order] * lead * (order + 0.5) * (2 / 600)
    age = np.maximum(time[:, None] - time, 0.0)
    kernels = [shape * x**power for power in range(3)]
    step = SPAN / 600

    def covariance(i, j):
        accelerated, tilted = ([kernel @ sway for kernel in (kernels[i], kernels[j])] for sway in (age, age**2 / 2))
        return 4e-6 * step * np.dot(*accelerated) + 9e-8 * step * np.dot(*tilted)

    expected = Bend(covariance(1, 1), covariance(2, 2), covariance(0, 1), covariance(0, 2), covariance(1, 2))
    result = free_bend(("quadratic", "cubic")[order - 2], NOTHING, 2e-3, 3e-4 / G, 0.0, 0.0, G, 0.0, SPAN)
    for ours, theirs in zip(result, expected, strict=True):
        assert ours == pytest.approx(theirs, rel=3e-3, abs=1e-9)


def test_without_a_turn_there_is_nothing():
    bend = free_bend("quadratic", starting(1, 0.2), 1e-3, 2e-5, 1e-3, 3e-6, G, 15.0, SPAN)
    assert turn_of(0.4, 0.3, 0.0, SPAN).bent(bend, bend) == 0.0
