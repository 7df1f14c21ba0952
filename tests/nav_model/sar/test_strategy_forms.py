"""Closed forms of the strategies against symbolic limits, quadrature and root finding."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from quadratic_forms import beyond_quadratic_variance, exact_corrected_variance, fit_noise_variance
from scipy.integrate import dblquad

from nav_model.sar.strategy_forms import fit_quadratic_sigma, ins_variances, shrunk_residual_variance, shrunk_weight

G = 9.80665
SA, SW = 0.05 / 60, np.radians(0.5) / 60
TILT = np.radians(0.0351388) ** 2


def _detrended(covariance, order):
    """Mean variance left on [0, 1] of a process, after its projection on Legendre orders 0..order."""
    total = dblquad(lambda _, s: covariance(s, s), 0, 1, 0, 1)[0]
    for n in range(order + 1):
        polynomial = np.polynomial.Legendre.basis(n, domain=[0, 1])
        nodes, weights = np.polynomial.legendre.leggauss(80)
        t = (nodes + 1) / 2
        matrix = np.array([[covariance(a, b) for b in t] for a in t])
        scaled = polynomial(t) * weights / 2
        total -= (2 * n + 1) * scaled @ matrix @ scaled
    return total


def test_noise_terms_are_projections_of_the_integrated_noise(compared, ratio_off):
    def twice(a, b):
        a, b = min(a, b), max(a, b)
        return a**2 * (3 * b - a) / 6

    def thrice(a, b):
        a, b = min(a, b), max(a, b)
        return a**3 * (10 * b**2 - 5 * a * b + a**2) / 120

    after_line = ins_variances(1, 1, 0, 0).detrended, ins_variances(1, 0, 1, 0, gravity=1).detrended
    after_quadratic = beyond_quadratic_variance(1, 1, 0), beyond_quadratic_variance(1, 0, 1, gravity=1)
    line, quadratic = ([_detrended(process, n) for process in (twice, thrice)] for n in (1, 2))
    oracle = "Legendre projection of the integrated noise's covariance, by quadrature"
    compared(
        "Phase left after linear detrend, noise terms",
        "T-15",
        "our own derivation",
        oracle,
        ratio_off(after_line, line),
        1e-5,
    )
    compared(
        "Phase left after a fitted quadratic, noise terms",
        "T-14",
        "our own derivation",
        oracle,
        ratio_off(after_quadratic, quadratic),
        1e-4,
    )


def test_the_quadratic_and_the_rest_add_up_to_the_whole():
    arguments = (np.array([2.0, 9.0, 33.0]), SA, SW, TILT)
    biases = {"accelerometer_bias": 3e-4, "gyro_bias": 2e-6}
    whole = ins_variances(*arguments, 40.0, **biases).detrended
    quadratic = 4 / 45 * ins_variances(*arguments, 40.0, **biases).quadratic
    rest = beyond_quadratic_variance(*arguments[:3], gyro_bias=2e-6)
    np.testing.assert_allclose(whole, quadratic + rest, rtol=1e-12)
    # [T-14]: a gyro bias alone leaves g^2 d^2 T^6 / 2800.
    alone = ins_variances(7.0, 0, 0, 0, gyro_bias=1e-5).detrended
    assert alone == pytest.approx((G * 1e-5) ** 2 * 7.0**6 / 2800)


@pytest.mark.parametrize(("fixes", "interval"), [(6, 1.0), (21, 0.5), (3, 2.0)])
def test_the_fit_noise_is_least_squares(fixes, interval, compared, ratio_off):
    time = np.arange(fixes) * interval
    curvature = np.linalg.inv(np.vander(time, 3).T @ np.vander(time, 3))[0, 0]
    span = 11.0
    sigma = fit_quadratic_sigma(0.7, interval, span, fixes)
    compared(
        "GNSS noise through the quadratic fit",
        "S-7",
        "our own derivation",
        "normal equations of the fit, written out in the test",
        ratio_off(sigma, 0.7 * np.sqrt(curvature) * span**2 / 4),
        1e-9,
    )
    assert fit_noise_variance(0.7, interval, span, fixes) == pytest.approx(4 / 45 * sigma**2)


def test_the_fit_noise_knows_how_many_fixes_there_are(differs):
    """A fix on both ends of the aperture is one more than N = T / dt: less noise, by least squares."""
    result = {}
    for count, first in ((20, 1), (21, 0)):
        x = (first + np.arange(count) - 10) / 10
        result[count] = 1e3 * 0.13 * np.linalg.norm(np.linalg.pinv(np.vander(x, 3))[0])
        assert 1e3 * fit_quadratic_sigma(0.13, 1.0, 20.0, count) == pytest.approx(result[count], rel=1e-9)
    differs(
        "Quadratic that 0.13 m fixes at 1 Hz leave over 20 s", "S-7",
        f"20 fixes, as [C] counts them (T/dt), give {result[20]:.1f} mm; [C] prints no figure",
        f"{result[21]:.1f} mm with 21 fixes (T/dt + 1)", "both",
        "an aperture with a fix on both ends, as in the runs and on the maps, has one fix more than [C] counts; "
        "where the first fix comes an interval after the start, [C]'s count holds; the formula is the same, and "
        "least squares gives both figures",
    )  # fmt: skip


def test_few_fixes_leave_more_than_the_continuous_fit(differs):
    whole = float(beyond_quadratic_variance(10.0, SA, 0.0))
    late = {
        count: np.sqrt(exact_corrected_variance(10.0, SA, 0.0, 1e-12, np.arange(1, count + 1) * 10 / count) / whole)
        for count in (3, 21)
    }
    assert late[3] > 1.8
    assert late[21] < 1.03
    differs(
        "Inertial residual under the quadratic correction, first fix an interval after the start", "T-16",
        "the continuous fit", f"{late[3]:.2f} times that with 3 fixes, {late[21]:.3f} times with 21", "ours",
        "the covariance of the integrated noise carried through the fit at the fixes themselves, which random walks "
        "confirm; [T-16] is a good guide from some ten fixes on",
    )  # fmt: skip


def test_exact_variance_against_random_walks(compared):
    random = np.random.default_rng(9)
    x = np.linspace(0, 1, 201)
    rate = np.cumsum(random.standard_normal((4000, 200)), axis=1) / np.sqrt(200)
    path = np.concatenate([np.zeros((4000, 1)), np.cumsum(rate, axis=1) / 200], axis=1)
    fixes = np.array([0.25, 0.5, 0.75, 1.0])
    seen = path[:, [50, 100, 150, 200]] + 0.1 * random.standard_normal((4000, 4))
    fit = np.array([np.polyval(np.polyfit(fixes, row, 2), x) for row in seen])
    residual = path - fit
    residual -= np.polynomial.polynomial.polyval(x, np.polynomial.polynomial.polyfit(x, residual.T, 1))
    square = np.mean(residual**2, axis=1)
    exact = exact_corrected_variance(1.0, 1.0, 0.0, 0.1, fixes)
    assert abs(square.mean() - exact) < 4 * square.std() / np.sqrt(4000) + 0.01 * exact
    compared(
        "Quadratic correction at four fixes",
        "T-16",
        "our own derivation",
        "4000 drawn random walks, a quadratic fitted to each by NumPy",
        (square.mean() - exact) / (square.std() / np.sqrt(4000)),
        5,
        "standard errors",
    )


@settings(max_examples=60)
@given(ins=st.floats(1e-8, 1e2), fit=st.floats(1e-8, 1e2), rest=st.floats(0, 1.0))
def test_the_shrunk_fit_loses_to_neither_and_is_the_best_weight(ins, fit, rest):
    best = shrunk_residual_variance(ins, fit, rest)
    assert best <= 4 / 45 * min(ins, fit) + rest + 1e-15
    weight = float(shrunk_weight(ins, fit))
    for other in (weight * 0.9, weight * 1.1 + 1e-3):
        variance = 4 / 45 * ((1 - other) ** 2 * ins + other**2 * fit) + rest
        assert best <= variance * (1 + 1e-12)


def test_a_fit_that_determines_nothing_has_no_weight():
    assert shrunk_weight(1.0, np.inf) == 0.0
    assert shrunk_weight(0.0, 0.0) == 0.0
    assert shrunk_residual_variance(1.0, np.inf, 0.1) == pytest.approx(4 / 45 + 0.1)


def test_the_source_papers_gain_needs_thirteen_centimetres():
    """sar.md: 30 cm to 6 cm (largest error, two thirds of the QPE) at T = 20 s needs 0.13 m of GNSS noise."""
    needed = 0.06 / (2 / 3 * fit_quadratic_sigma(1.0, 1.0, 20.0, 21))
    assert needed == pytest.approx(0.13, abs=0.01)
