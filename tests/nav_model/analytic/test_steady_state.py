"""Closed-form steady state against Riccati solutions, high precision and its own asymptotes."""

import math
from pathlib import Path

import numpy as np
import pytest
from mpmath import mp

from nav_model.analytic.regime import catalogue_points, design_point
from nav_model.analytic.steady_state import (
    gyro_dominated,
    horizontal,
    position_ratio,
    vertical,
)
from nav_model.budget import analyse
from nav_model.design.file import read_design

EXAMPLES = Path(__file__).parents[3] / "examples"


def test_horizontal_against_the_riccati_equation(fleet, reference, compared, ratio_off):
    ours = horizontal(fleet.sigma_a, fleet.sigma_w, fleet.s, fleet.g).matrix()
    assert fleet.size >= 200
    each = zip(fleet.sigma_a, fleet.sigma_w, fleet.s, fleet.g, strict=True)
    off = ratio_off(ours, [reference.continuous(*design) for design in each])
    compared(
        "Steady-state covariance, horizontal, 240 designs",
        "T-3",
        "solver written by others",
        "SciPy's continuous Riccati solver on [T-1], written out in the test",
        off,
        1e-9,
    )


def test_vertical_against_the_riccati_equation(fleet, reference, compared, ratio_off):
    v = vertical(fleet.sigma_a, fleet.s)
    each = zip(fleet.sigma_a, fleet.s, fleet.g, strict=True)
    theirs = np.array([reference.continuous(a, 0.0, s, g, order=2) for a, s, g in each])
    off = ratio_off([[v.v11, v.v12], [v.v12, v.v22]], np.moveaxis(theirs, 0, -1))
    compared(
        "Steady-state covariance, vertical, 240 designs",
        "T-4",
        "solver written by others",
        "SciPy's continuous Riccati solver on [T-1], written out in the test",
        off,
        1e-9,
    )


def _root(gyro, accelerometer, near):
    """The positive root of p11^4/4 = gyro p11 + accelerometer, by secants in the digits in force."""
    return mp.findroot(lambda x: x**4 / 4 - gyro * x - accelerometer, near)


def test_elements_in_fifty_digits(fleet, compared, ratio_off):
    """[T-3] as printed, with its quartic solved in 50 digits: the floats are right to the last few bits."""
    p = horizontal(fleet.sigma_a, fleet.sigma_w, fleet.s, fleet.g)
    off = []
    with mp.workdps(50):
        for i in range(0, fleet.size, 3):
            a, w, s, g = (mp.mpf(float(x[i])) for x in (fleet.sigma_a, fleet.sigma_w, fleet.s, fleet.g))
            p11 = _root(2 * g * w * s**5, s**6 * a**2, 1.001 * float(p.p11[i]))
            assert p11 > 0
            printed = (
                p11,
                p11**2 / (2 * s**2),
                w * s,
                p11**3 / (2 * s**4) - g * w * s,
                p11 * w / s,
                p11**2 * w / (2 * g * s**3),
            )
            off.append(ratio_off([ours[i] for ours in p], [float(theirs) for theirs in printed]))
    compared(
        "Quartic of the steady state by formula",
        "T-3",
        "solver written by others",
        "mpmath's root finder on [T-3], 50 digits",
        off,
        1e-14,
    )


def test_position_ratio_over_twenty_decades(compared, ratio_off):
    kappa = np.geomspace(1e-8, 1e12, 81)
    with mp.workdps(40):
        roots = [float(mp.findroot(lambda x, k=k: x**4 - 1 - mp.mpf(k) * x, mp.mpf(max(1, k) ** (1 / 3)) + 0.1))
                 for k in kappa]  # fmt: skip
    compared(
        "Gyro dominance: the position ratio it gives",
        "T-6",
        "solver written by others",
        "mpmath's root finder on [T-6], 40 digits",
        ratio_off(position_ratio(kappa), roots),
        1e-14,
    )


def test_gyro_dominated_limit_against_the_riccati_equation(reference, compared, ratio_off):
    """At a gyro dominance of 1e5, where the limit's own error is κ^(-4/3), 2e-7."""
    g, s, w = 9.80665, 1.0, 1e-4
    a = (2 * math.sqrt(2) * g * w * math.sqrt(s) / 1e5) ** (2 / 3)
    off = ratio_off(gyro_dominated(w, s, g), np.diag(reference.continuous(a, w, s, g)))
    compared(
        "Gyro-dominated limit at a gyro dominance of 10⁵",
        "T-7",
        "solver written by others",
        "SciPy's continuous Riccati solver on [T-1], written out in the test",
        off,
        1e-6,
    )


@pytest.mark.parametrize("velocity", [None, 0.03])
def test_regime_points_are_the_budgets_own_ratio(velocity):
    """With velocity fixes too, which take the gyro's lead away."""
    design = read_design(EXAMPLES / "mems_x_band.toml").replace({"gnss.velocity_noise": velocity})
    budget = analyse(design)
    closed = budget.steady_state.closed
    kappa, ratio = design_point(design)
    assert kappa == pytest.approx(budget.steady_state.gyro_dominance)
    # Of equal channels [T-6]: gravity by height makes the vertical position 0.03 to 0.08 % larger.
    assert ratio == pytest.approx((closed["horizontal_position"] / closed["vertical_position"]) ** 2, rel=2e-3)
    _, _, ratios = catalogue_points(design)
    assert (velocity is None) == bool(max(ratios) > 5)
