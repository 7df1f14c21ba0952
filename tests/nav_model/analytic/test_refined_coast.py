"""The refined outage against the same physics in north, east, down, solved by a matrix exponential."""

import math

import numpy as np
import pytest
import riccati

from nav_model.analytic.coast import horizontal_growth, vertical_growth
from nav_model.analytic.discrete import cycle
from nav_model.analytic.refined_coast import refined_growth
from nav_model.analytic.steady_state import horizontal, vertical

OMEGA, RADIUS = 7.2921150e-5, 6371008.8


def _north_east_down(g, altitude, speed, latitude, heading):
    """States: pN vN pE vE pD vD and g-tilts aN aE that accelerate north and east."""
    r = RADIUS + altitude
    f = np.zeros((8, 8))
    f[0, 1] = f[2, 3] = f[4, 5] = 1
    f[1, 6] = f[3, 7] = g
    f[1, 0] = f[3, 2] = -g / r
    f[5, 4] = 2 * g / r
    # the level acceleration 2 Omega cos(lat) v_east + |v|^2 / R, differentiated
    f[5, 1] = 2 * speed * math.cos(heading) / r
    f[5, 3] = 2 * speed * math.sin(heading) / r + 2 * OMEGA * math.cos(latitude)
    return f


def _start(p, v):
    start = np.zeros((8, 8))
    for axis in (0, 2):
        index = [axis, axis + 1, 6 + axis // 2]
        start[np.ix_(index, index)] = p.matrix()
    start[4, 4], start[4, 5], start[5, 4], start[5, 5] = v.v11, v.v12, v.v12, v.v22
    return start


def _turned(covariance, heading):
    """Along and cross variances of position and velocity, from north and east."""
    along = np.array([math.cos(heading), math.sin(heading)])
    cross = np.array([-math.sin(heading), math.cos(heading)])
    for pair in ((0, 2), (1, 3)):
        block = covariance[np.ix_(pair, pair)]
        yield along @ block @ along
        yield cross @ block @ cross


@pytest.mark.parametrize("seed", range(12))
def test_against_the_matrix_exponential(seed, reference, compared, ratio_off):
    rng = np.random.default_rng(seed)
    a, w = 10 ** rng.uniform(-4.5, -2.5), 10 ** rng.uniform(-6.5, -4)
    sigma, g = 10 ** rng.uniform(-2, 0.7), 9.8
    speed, latitude = rng.uniform(10, 300), rng.uniform(-1.4, 1.4)
    heading, altitude = rng.uniform(-math.pi, math.pi), rng.uniform(0, 15e3)
    after = cycle(a, w, g, 1.0, sigma, 1.7 * sigma).posterior
    times = np.array([0.0, 3.0, 60.0, 900.0, 7200.0])  # a Schuler period and more
    ours = refined_growth(
        after.horizontal, after.vertical, a, w, g, times,
        speed=speed, latitude=latitude, altitude=altitude, heading=heading,
    )  # fmt: skip
    f = _north_east_down(g, altitude, speed, latitude, heading)
    q = np.diag([0, a**2, 0, a**2, 0, a**2, w**2, w**2])
    tau = 10.0  # units that bring transition and covariance near one
    scale = np.array([1, 1 / tau] * 3 + [1 / (g * tau**2)] * 2)
    f_scaled, q_scaled = f * scale / scale[:, None], q / np.outer(scale, scale)
    start = _start(after.horizontal, after.vertical) / np.outer(scale, scale)
    off = []
    for i, t in enumerate(times):
        phi, added = np.eye(8), np.zeros((8, 8))
        if t:
            small_phi, small_q = riccati.van_loan(f_scaled, q_scaled, t / 100)
            for _ in range(100):
                phi, added = small_phi @ phi, small_phi @ added @ small_phi.T + small_q
        p = (phi @ start @ phi.T + added) * np.outer(scale, scale)
        along, cross, *_ = _turned(p, heading)
        off.append(ratio_off([ours.horizontal[i], ours.horizontal[i], ours.vertical[i]], [along, cross, p[4, 4]]))
    compared(
        "Refined outage over two hours, 12 flights",
        "T-17",
        "solver written by others",
        "SciPy's matrix exponential of the error equations in north, east, down, written out in the test",
        off,
        1e-9,
    )


def test_without_the_earth_it_is_the_polynomial(worked):
    """A huge radius and a polar, motionless flight leave nothing but [T-9] and [T-10]."""
    p = horizontal(worked.sigma_a, worked.sigma_w, worked.s, worked.g)
    v = vertical(worked.sigma_a, worked.s)
    t = np.linspace(0, 300, 7)
    ours = refined_growth(
        p, v, worked.sigma_a, worked.sigma_w, worked.g, t, speed=0.0, latitude=math.pi / 2, altitude=1e22
    )
    level = horizontal_growth(p, worked.sigma_a, worked.sigma_w, worked.g, t)
    np.testing.assert_allclose(ours.horizontal, level.position, rtol=1e-12)
    np.testing.assert_allclose(ours.vertical, vertical_growth(v, worked.sigma_a, t).position, rtol=1e-12)


def test_check_values_of_the_page(worked, differs):
    """[T-17]: 50 m/s, latitude 45°, from the posterior: 0.900 and 2.39 m vertical, 47.4 m horizontal.

    Gravity by height, which the filter has too, makes them 0.08 % larger.
    """
    after = cycle(worked.sigma_a, worked.sigma_w, worked.g, 1.0, 1.0, 1.0).posterior
    ours = refined_growth(
        after.horizontal, after.vertical, worked.sigma_a, worked.sigma_w, worked.g, np.array([100.0, 200.0]),
        speed=50.0, latitude=math.radians(45),
    )  # fmt: skip
    # The matrix exponential above sides with it.
    assert math.sqrt(ours.vertical[0]) == pytest.approx(0.8991, abs=5e-5)
    differs(
        "Vertical position 100 s after the last fix, 50 m/s north at 45° latitude", "T-17",
        "0.900 m, unpublished", f"{math.sqrt(ours.vertical[0]):.4f} m", "ours",
        "the equation printed beside 0.900 m gives 0.8991 m heading north and 0.9022 m north-east, also by matrix "
        "exponential; no heading was printed",
    )  # fmt: skip
    assert math.sqrt(ours.vertical[0]) == pytest.approx(0.900, abs=0.002)
    assert math.sqrt(ours.vertical[1]) == pytest.approx(2.39, abs=0.005)
    assert math.sqrt(ours.horizontal[0]) == pytest.approx(47.4, abs=0.1)


def test_a_curve_remembered_is_the_one_worked_out(worked):
    """A column of times is not remembered: it goes another way."""
    p = horizontal(worked.sigma_a, worked.sigma_w, worked.s, worked.g)
    v = vertical(worked.sigma_a, worked.s)
    time = np.linspace(0.0, 300.0, 50)
    for altitude in (0.0, 1e4, 0.0):
        curve, column = (
            refined_growth(
                p, v, worked.sigma_a, worked.sigma_w, worked.g, t, speed=100.0, latitude=0.5, altitude=altitude
            )
            for t in (time, time[:, None])
        )
        assert curve.horizontal == pytest.approx(column.horizontal[:, 0], rel=1e-14)
        assert curve.vertical == pytest.approx(column.vertical[:, 0], rel=1e-14)
