"""Exploring compared with the Riccati equation of [T-1], written out here and solved by SciPy, design by design.

One figure carries every comparison: the horizontal position just before a fix. Nothing of the product computes it
here, so that a fault in the figure, in the broadcasting or in the exploring itself shows.
"""

import math

import numpy as np
import pytest
import riccati
from mpmath import mp
from scipy.integrate import quad
from scipy.linalg import block_diag
from scipy.optimize import brentq
from scipy.stats import lognorm

from nav_model.design import Design
from nav_model.design.catalogue import catalogue
from nav_model.explore.rank import rank
from nav_model.explore.search import OWN_GNSS, search
from nav_model.explore.solve import solve
from nav_model.explore.trade_map import trade_map
from nav_model.explore.uncertainty import Uncertain, uncertain_verdict

VRW, ARW, FIX, INTERVAL = (
    "imu.velocity_random_walk",
    "imu.angle_random_walk",
    "gnss.position_noise",
    "gnss.interval",
)
G, LIMIT = 9.80665, 0.3
OWN = {VRW: 0.05 / 60, ARW: math.radians(0.3) / 60, FIX: 0.7, INTERVAL: 0.5}
SOLVER = "solver written by others"


@pytest.fixture(scope="module")
def design():
    """Meets its one requirement, 0.3 m of horizontal position at one sigma."""
    return Design({**OWN, "flight.gravity": G, "requirements.horizontal_position": LIMIT})


def before_a_fix(changes):
    """Position sigma [m] just before a fix."""
    x = {**OWN, **changes}
    f, q = riccati.channel(x[VRW], x[ARW], G)
    seen, unit = np.eye(3)[:1], (1.0, 1.0, G)
    if x.get("gnss.correlated"):  # a fourth state, the slow error of the fixes
        slow, time = x["gnss.correlated_noise"], x["gnss.correlation_time"]
        f, q = block_diag(f, -1 / time), block_diag(q, 2 * slow**2 / time)
        seen, unit = np.array([[1.0, 0, 0, 1]]), (*unit, 1.0)
    prior, _ = riccati.settled(*riccati.van_loan(f, q, x[INTERVAL]), seen, x[FIX] ** 2, unit)
    return math.sqrt(prior[0, 0])


def largest(key, changes):
    """Largest value of an input that keeps `before_a_fix` within the limit."""
    end = math.log(OWN[key])
    return math.exp(
        brentq(lambda e: before_a_fix({**changes, key: math.exp(e)}) - LIMIT, end - 6, end + 6, xtol=1e-13)
    )


def test_the_largest_value_is_the_root(design, compared, ratio_off):
    values = {answer.key: answer.together.value for answer in solve(design)}
    compared(
        "Solve: largest allowed random walks, fix noise and fix interval",
        "T-8",
        SOLVER,
        "SciPy's root finder on its discrete Riccati solution of [T-1], written out in the test",
        ratio_off([values[key] for key in OWN], [largest(key, {}) for key in OWN]),
        1e-8,
    )


def test_the_slopes_are_those_of_the_quartic(design, compared):
    """d ln(sigma) / d ln(noise) of position, velocity and tilt, in the steady state of [T-3]."""

    def sigma(element, a, w, r):
        s = r * mp.sqrt(OWN[INTERVAL])
        start = (8 * G * w * s**5) ** (mp.mpf(1) / 3) + mp.sqrt(2 * s**3 * a)
        p = mp.findroot(lambda x: x**4 / 4 - 2 * G * w * s**5 * x - s**6 * a**2, start)
        variances = (p, p**3 / (2 * s**4) - G * w * s, p**2 * w / (2 * G * s**3))
        return mp.sqrt(variances[element])

    off = []
    settled = design.replace({"requirements.steady_state": "closed"})
    noises = (VRW, ARW, FIX)
    with mp.workdps(40):
        point = [mp.mpf(OWN[key]) for key in noises]
        for element, figure in enumerate(("horizontal_position", "horizontal_velocity", "tilt")):
            slopes = {item.key: item.slope for item in rank(settled, figure)}
            for which, key in enumerate(noises):
                order = tuple(int(i == which) for i in range(3))
                slope = mp.diff(lambda *x, e=element: sigma(e, *x), point, order)
                off.append(slopes[key] - float(slope * point[which] / sigma(element, *point)))
    compared(
        "Rank: effect of each noise on position, velocity and tilt",
        "T-3",
        SOLVER,
        "mpmath's root finder on [T-3] and its numerical derivative, 40 digits",
        off,
        1e-12,
        "largest difference of d ln(figure) / d ln(input)",
    )


def test_the_map_is_one_riccati_equation_a_cell(design, compared, ratio_off):
    trade = trade_map(design, ARW, FIX, "horizontal_position", size=9)
    theirs = [[before_a_fix({ARW: x, FIX: y}) for x in trade.x] for y in trade.y]
    compared(
        "Map: gyro noise against fix noise, 81 cells",
        "T-8",
        SOLVER,
        "SciPy's discrete Riccati solver on [T-1], written out in the test, cell by cell",
        ratio_off(trade.z, theirs),
        1e-7,
    )


def test_the_search_judges_every_pair_by_its_own_sheet(design, compared):
    units, receivers = catalogue("imu"), catalogue("gnss")
    ranking = search(design, units, receivers)
    assert len(ranking) > 50
    off = []
    for row in ranking:
        sheets = [("imu", units[row.imu])] + ([] if row.gnss == OWN_GNSS else [("gnss", receivers[row.gnss])])
        values = {f"{kind}.{name}": item.value for kind, sheet in sheets for name, item in sheet.values.items()}
        off.append(row.margin - (1 - before_a_fix(values) / LIMIT))
    compared(
        "Search: margin of every unit with every receiver",
        "T-8",
        SOLVER,
        "SciPy's discrete Riccati solver on [T-1], written out in the test, pair by pair",
        off,
        1e-7,
        "largest difference of a margin",
    )


def test_the_probability_is_the_integral(design, compared):
    """Gyro noise lognormal, fix noise log-uniform: over the fixes, the chance that the gyro is good enough."""
    low, high, factor = 0.8, 1.4, 1.6
    probability = uncertain_verdict(
        design, {ARW: Uncertain("lognormal", OWN[ARW], factor), FIX: Uncertain("log-uniform", low, high)}
    ).closes

    def good_enough(log_noise):
        most = largest(ARW, {FIX: math.exp(log_noise)})
        return lognorm.cdf(most, s=math.log(factor), scale=OWN[ARW])

    span = math.log(high / low)
    exact = quad(good_enough, math.log(low), math.log(high), epsabs=1e-6, limit=20)[0] / span
    assert 0.1 < exact < 0.3  # off the middle, where every symmetrical distribution gives a half
    assert probability.low <= exact <= probability.high
    compared(
        "Uncertainty: probability that a design closes, two uncertain inputs",
        "T-8",
        SOLVER,
        "SciPy's quadrature and lognormal distribution, on its Riccati solution of [T-1] written out in the test",
        probability.value - exact,
        2e-3,
        "difference of the probability",
    )
