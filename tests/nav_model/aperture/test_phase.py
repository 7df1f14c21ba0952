"""The phase budget against a dense numerical projection of the covariance of the error processes.

Errors are random functions of time with their covariance computed from integrals of white noise; a
least-squares polynomial is removed on a quadrature grid. No Legendre coefficient of the page is used.
"""

import math
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from nav_model.analytic.steady_state import Horizontal
from nav_model.analytic.turning import free_bend
from nav_model.aperture.phase import SOURCES, phase_budget, total

G = 9.81
NODES = 1200


def along_track_quadratic(velocity, speed, aperture, wavelength, slant_range):
    """[S-2] of a constant velocity error along the track."""
    none = np.zeros(())
    start = Horizontal(none, none, none, np.array(velocity**2), none, none)
    bend = free_bend("quadratic", start, 0.0, 0.0, 0.0, 0.0, G, 0.0, aperture)
    return 4 * math.pi / wavelength * speed * aperture / (2 * slant_range) * math.sqrt(bend.turned)


@cache
def _grid():
    """Midpoints, equal weights: the kernels have kinks on the diagonal, so a fine even grid serves."""
    x = (np.arange(NODES) + 0.5) / NODES * 2 - 1
    return x, np.full(NODES, 1 / NODES)


def _twice(t):
    """Covariance of twice-integrated unit white noise: integral of (t-u)(s-u) over u < min."""
    low, high = np.minimum.outer(t, t), np.maximum.outer(t, t)
    return low**2 * (3 * high - low) / 6


def _thrice(t):
    """Covariance of thrice-integrated unit white noise: integral of (t-u)^2 (s-u)^2 / 4 over u < min."""
    low, high = np.minimum.outer(t, t), np.maximum.outer(t, t)
    d = high - low
    return (low**5 / 5 + d * low**4 / 2 + d**2 * low**3 / 3) / 4


def _project(covariance, order):
    """(mean variance left, variance of the coefficient of x^order) of a least-squares polynomial fit."""
    x, weight = _grid()
    basis = np.vander(x, order + 1, increasing=True)
    fit = np.linalg.solve(basis.T @ (weight[:, None] * basis), basis.T * weight)
    half = fit @ covariance
    coefficients = half @ fit.T
    residual = np.trace(covariance) - 2 * np.sum(half.T * basis) + np.sum((basis @ coefficients) * basis)
    return residual / NODES, coefficients[-1, -1]


def _processes(t_ap, t_c, p33, a, w, b, d):
    """Horizontal and vertical covariance on the grid of every source, `t_c` seconds after the last fix."""
    x, _ = _grid()
    u = (x + 1) / 2 * t_ap
    t = u + t_c
    return {
        "initial tilt": (G**2 * p33 * np.outer(t**2, t**2) / 4, 0),
        "accelerometer noise": (a**2 * _twice(t), a**2 * _twice(t)),
        "gyro, all": ((G * w) ** 2 * _thrice(t), 0),
        "accelerometer bias": (b**2 * np.outer(t**2, t**2) / 4, b**2 * np.outer(t**2, t**2) / 4),
        "gyro bias": ((G * d) ** 2 * np.outer(t**3, t**3) / 36, 0),
    }


CASES = [
    (5.0, 0.0, 0.6, 1),
    (5.0, 0.0, 0.6, 2),
    (8.0, 0.0, 0.0, 3),
    (3.0, 4.0, 0.6, 1),
    (3.0, 4.0, 1.2, 2),
    (6.0, 2.0, 0.3, 3),
]


@pytest.mark.parametrize(("t_ap", "t_c", "angle", "order"), CASES)
def test_every_source_against_the_projection(t_ap, t_c, angle, order, compared, ratio_off):
    off = {"detrended": [0.0], "quadratic": [], "cubic": [0.0]}
    p33, a, w, b, d = 4e-8, 8e-4, 1.5e-4, 2e-3, 3e-6
    budget = phase_budget(p33, a, w, b, d, G, t_ap, t_c, angle, order)
    ours = dict(budget)
    gyro, coasted = ours.pop("gyro noise"), ours.pop("coast before aperture")
    ours["gyro, all"] = type(gyro)(*(x + y for x, y in zip(gyro, coasted, strict=True)))
    level, upright = math.cos(angle) ** 2, math.sin(angle) ** 2
    for source, (horizontal, vertical) in _processes(t_ap, t_c, p33, a, w, b, d).items():
        covariance = level * horizontal + upright * vertical
        size = level * w**2 * G**2 * t_ap**5 * 1e-12
        residual, _ = _project(covariance, order)
        _, quadratic = _project(covariance, 2)
        _, cubic = _project(covariance, 3)
        assert float(ours[source].detrended) == pytest.approx(residual, rel=2e-5, abs=size), source
        off["quadratic"].append(ratio_off(ours[source].quadratic, quadratic))
        for name, theirs in (("detrended", residual), ("cubic", cubic)):
            if theirs > 1e6 * size:  # below, quadrature leaves nothing to compare
                off[name].append(ratio_off(getattr(ours[source], name), theirs))
        assert float(ours[source].cubic) == pytest.approx(cubic, rel=2e-5, abs=size), source
    oracle = "least-squares projection of each error's covariance, written out in the test"
    compared("Quadratic phase, source by source", "S-5", "our own derivation", oracle, off["quadratic"], 2e-5)
    compared(
        "Phase after autofocus, source by source",
        "S-6",
        "our own derivation",
        oracle,
        off["detrended"],
        2e-5,
    )
    compared("Cubic phase, source by source", "S-6", "our own derivation", oracle, off["cubic"], 2e-5)


@pytest.mark.parametrize("order", [0, 4, -1, 1.5])
def test_orders_without_a_closed_form(order):
    with pytest.raises(ValueError, match="autofocus_order"):
        phase_budget(1, 1, 1, 1, 1, 1, 1, 1, 0.5, order)


INPUTS = st.tuples(
    st.floats(1e-12, 1e-4), st.floats(1e-6, 1e-2), st.floats(1e-8, 1e-3), st.floats(1e-8, 1e-1),
    st.floats(1e-9, 1e-3), st.floats(9, 10), st.floats(0.1, 60), st.floats(0.01, 300),
)  # fmt: skip


@given(INPUTS, st.floats(0, 1.57))
def test_autofocus_never_harms_and_totals_add_up(inputs, angle):
    budgets = [phase_budget(*inputs, angle, order) for order in (1, 2, 3)]
    for source in SOURCES:
        values = [float(budget[source].detrended) for budget in budgets]
        assert values[0] >= values[1] >= values[2] >= 0
        assert len({float(budget[source].quadratic) for budget in budgets}) == 1  # quoted before autofocus
    whole = total(budgets[0])
    for i, column in enumerate(zip(*budgets[0].values(), strict=True)):
        assert float(whole[i]) == pytest.approx(math.fsum(float(x) for x in column), rel=1e-14)


@pytest.mark.parametrize(
    ("wavelength", "slant_range", "speed", "aperture"),
    [(0.0312, 7000, 90, 5.0), (0.238, 17000, 220, 8.0), (0.018, 6000, 36, 10.0)],
)
def test_along_track_against_exact_ranges(wavelength, slant_range, speed, aperture, compared, ratio_off):
    """[S-2]: the range to a scatterer abeam, flown at V but processed at V + dV, has this quadratic phase."""
    error = 1e-3
    t = np.linspace(-aperture / 2, aperture / 2, 2001)
    phase = 4 * math.pi / wavelength * (np.hypot(slant_range, (speed + error) * t) - np.hypot(slant_range, speed * t))
    quadratic = np.polynomial.polynomial.polyfit(t / (aperture / 2), phase, 4)[2]
    ours = along_track_quadratic(error, speed, aperture, wavelength, slant_range)
    compared(
        "Quadratic phase from along-track velocity",
        "S-2",
        "our own derivation",
        "exact ranges, a quadratic fitted to them by NumPy",
        ratio_off(ours, quadratic),
        3e-3,
    )


@pytest.mark.parametrize(("t_ap", "t_c"), [(5.0, 0.0), (3.0, 4.0), (20.0, 1.5)])
def test_the_velocity_that_bends_the_phase_against_the_projection(t_ap, t_c):
    """The quadratic of x times the error along the track, x from -1 to 1 as the line of sight turns, by source."""
    p22, p23, p33, a, w, b, d = 4e-4, 3e-6, 4e-8, 8e-4, 1.5e-4, 2e-3, 3e-6
    x, _ = _grid()
    t = (x + 1) / 2 * t_ap + t_c
    sway = G * t**2 / 2
    together = np.outer(t, sway) + np.outer(sway, t)
    by_source = {source: level for source, (level, _) in _processes(t_ap, t_c, p33, a, w, b, d).items()}
    by_source["start"] = p22 * np.outer(t, t) + p23 * together + p33 * np.outer(sway, sway)
    errors = {
        "start": (p22, p23, p33, 0.0, 0.0, 0.0, 0.0),
        "accelerometer noise": (0.0, 0.0, 0.0, a, 0.0, 0.0, 0.0),
        "gyro, all": (0.0, 0.0, 0.0, 0.0, w, 0.0, 0.0),
        "accelerometer bias": (0.0, 0.0, 0.0, 0.0, 0.0, b, 0.0),
        "gyro bias": (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, d),
    }
    for source, (velocity, both, tilt, *noises) in errors.items():
        _, quadratic = _project(by_source[source] * np.outer(x, x), 2)
        start = Horizontal(0.0, 0.0, 0.0, velocity, both, tilt)
        ours = free_bend("quadratic", start, *noises, G, t_c, t_ap).turned
        assert float(ours) == pytest.approx(quadratic, rel=2e-5), source


def test_a_constant_velocity_error_is_not_harmless(differs):
    """Exact ranges of a platform processed at 0.0655 m/s too much: more than a shift and a scale."""
    time = np.linspace(-2.7, 2.7, 4001)
    error = np.hypot(6500.0, 90.0655 * time) - np.hypot(6500.0, 90 * time)
    exact = 4 * math.pi / 0.0312 * np.polynomial.polynomial.polyfit(time / 2.7, error, 2)[2]
    ours = along_track_quadratic(0.0655, 90.0, 5.4, 0.0312, 6500.0)
    assert ours == pytest.approx(exact, rel=3e-3)
    differs(
        "Velocity error of 0.0655 m/s along the track, X band, 6.5 km, 5.4 s", "S-2",
        "[C]: first-order errors shift and scale the image only", f"{math.degrees(ours):.0f}° of quadratic phase",
        "ours",
        "the line of sight turns over the aperture and bends a first-order error; exact ranges give the same",
    )  # fmt: skip
