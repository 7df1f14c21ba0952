"""Costs of one slider step and of one trade map."""

import time

import numpy as np
import pytest

from nav_model.analytic.coast import horizontal_growth, vertical_growth
from nav_model.analytic.steady_state import horizontal, vertical
from nav_model.aperture.phase import phase_budget, total
from nav_model.budget import analyse
from nav_model.design import Design

DESIGN = Design({"radar.aperture_time": 3.0})
SIGMA_A, SIGMA_W, S, G = 0.05 / 60, np.radians(0.5) / 60, 1.0, 9.80665


def test_full_analyse(benchmark):
    """A design to its whole budget with a 300-point outage; wanted below 2 ms."""
    benchmark.extra_info["wanted_s"] = 2e-3
    benchmark(analyse, DESIGN)


def test_full_analyse_with_slow_gnss_error(benchmark):
    benchmark(analyse, DESIGN.replace({"gnss.correlated": True}))


def test_closed_forms_of_one_design(benchmark):
    """Steady state, the two outage polynomials at one time and the phase budget; wanted below 100 µs."""

    def closed_forms():
        p, v = horizontal(SIGMA_A, SIGMA_W, S, G), vertical(SIGMA_A, S)
        horizontal_growth(p, SIGMA_A, SIGMA_W, G, 100.0)
        vertical_growth(v, SIGMA_A, 100.0)
        return total(phase_budget(p.p33, SIGMA_A, SIGMA_W, 0.0, 0.0, G, 3.0, 0.0, 0.6))

    benchmark.extra_info["wanted_s"] = 1e-4
    benchmark(closed_forms)


def test_closed_forms_per_design_in_a_batch(benchmark):
    """Closed forms for 10,000 designs at once, the way a trade study asks."""
    sigma_w = np.geomspace(1e-7, 1e-3, 10_000)

    def closed_forms():
        p, v = horizontal(SIGMA_A, sigma_w, S, G), vertical(SIGMA_A, S)
        horizontal_growth(p, SIGMA_A, sigma_w, G, 100.0)
        vertical_growth(v, SIGMA_A, 100.0)
        return total(phase_budget(p.p33, SIGMA_A, sigma_w, 0.0, 0.0, G, 3.0, 0.0, 0.6))

    benchmark(closed_forms)
    if benchmark.stats:
        benchmark.extra_info["s_per_design"] = benchmark.stats["median"] / len(sigma_w)


def test_quadratic_phase_map_against_riccati_per_cell(benchmark):
    """200 x 200 cells of angle random walk and fix noise; wanted below 50 ms.

    The alternative solves the continuous Riccati equation in every cell; 400 cells of it are timed in the
    same run and scaled up.
    """
    from scipy.linalg import solve_continuous_are

    sigma_w, s = np.geomspace(1e-7, 1e-3, 200)[:, None], np.geomspace(0.01, 10, 200)

    def closed():
        p33 = horizontal(SIGMA_A, sigma_w, s, G).p33
        return np.sqrt(total(phase_budget(p33, SIGMA_A, sigma_w, 0.0, 0.0, G, 3.0, 0.0, 0.6)).quadratic)

    def riccati(w, density):
        tau = min(np.sqrt(density / SIGMA_A), np.cbrt(density / (G * w)))
        q = np.diag([0, SIGMA_A**2 * tau**4 / density**2, (G * w) ** 2 * tau**6 / density**2])
        f = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
        p = solve_continuous_are(f, np.array([[1.0], [0], [0]]), q, np.eye(1))
        p33 = p[2, 2] * (density / (G * tau**2.5)) ** 2
        return np.sqrt(total(phase_budget(p33, SIGMA_A, w, 0.0, 0.0, G, 3.0, 0.0, 0.6)).quadratic)

    cells = [(i, j) for i in range(0, 200, 10) for j in range(0, 200, 10)]
    start = time.perf_counter()
    solved = [riccati(float(sigma_w[i, 0]), float(s[j])) for i, j in cells]
    per_cell = (time.perf_counter() - start) / len(cells)
    picture = benchmark(closed)
    assert picture.shape == (200, 200)
    assert [picture[cell] for cell in cells] == pytest.approx(solved, rel=1e-8)
    benchmark.extra_info |= {
        "wanted_s": 0.05,
        "riccati_cells_timed": len(cells),
        "riccati_scaled_s": per_cell * 40_000,
    }
    if benchmark.stats:
        benchmark.extra_info["ratio"] = per_cell * 40_000 / benchmark.stats["median"]
