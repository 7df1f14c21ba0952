"""The best strategy along the line of sight, against the per-axis forms, root finding and random walks."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from quadratic_forms import corrected_residual_variance
from scipy.optimize import brentq

from nav_model.analytic.discrete import cycle
from nav_model.analytic.steady_state import Horizontal
from nav_model.sar.advice import advise, recommendation
from nav_model.sar.strategies import NAMES
from nav_model.sar.strategy_forms import fit_quadratic_sigma, ins_variances, shrunk_residual_variance
from nav_model.sar.winners import Conditions, break_even_aperture, map_of_winners, strategy_variances

SA, SW = 0.05 / 60, np.radians(0.5) / 60
G = 9.80665
TILT = np.radians(0.0351388) ** 2


def settled(tilt, velocity=0.0):
    return Horizontal(0.0, 0.0, 0.0, velocity, 0.0, tilt)


PLAIN = Conditions(20.0, 0.3, 1.0, SA, SW, settled(TILT))


@pytest.mark.parametrize("sigma", [0.02, 0.3, 3.0])
def test_break_even_is_where_t15_equals_t16(sigma, compared, ratio_off):
    def excess(span):
        corrected = corrected_residual_variance(span, SA, SW, sigma, 1.0, fixes=span + 1)
        return float(ins_variances(span, SA, SW, TILT).detrended - corrected)

    root = brentq(excess, 2.01, 500)
    compared(
        "Shortest aperture for which the quadratic correction is better",
        "T-16",
        "our own derivation",
        "SciPy's root finder on the difference of the product's own [T-15] and [T-16]",
        ratio_off(break_even_aperture(replace(PLAIN, gnss_sigma=sigma)), root),
        1e-9,
    )
    assert break_even_aperture(replace(PLAIN, gnss_sigma=np.array([sigma, sigma]))).shape == (2,)


def test_axes_add_with_the_weights_of_s1():
    psi, span, n = 0.7, 20.0, 21
    up = strategy_variances(replace(PLAIN, grazing_angle=psi, vertical_gnss_sigma=0.8)).detrended
    level, upright = np.cos(psi) ** 2, np.sin(psi) ** 2
    expected = {
        0: level * ins_variances(span, SA, SW, TILT).detrended + upright * ins_variances(span, SA, 0, 0).detrended,
        2: level * corrected_residual_variance(span, SA, SW, 0.3, 1.0, fixes=n)
        + upright * corrected_residual_variance(span, SA, 0, 0.8, 1.0, fixes=n),
        3: level
        * shrunk_residual_variance(
            ins_variances(span, SA, SW, TILT).quadratic, fit_quadratic_sigma(0.3, 1.0, span, n) ** 2,
            SA**2 * span**3 / 2520 + (G * SW) ** 2 * span**5 / 55440,
        )
        + upright
        * shrunk_residual_variance(
            ins_variances(span, SA, 0, 0).quadratic, fit_quadratic_sigma(0.8, 1.0, span, n) ** 2,
            SA**2 * span**3 / 2520,
        ),
    }  # fmt: skip
    for index, value in expected.items():
        assert up[index] == pytest.approx(float(value), rel=1e-9)


def test_the_turning_line_of_sight_bends_an_along_track_velocity():
    """[S-2] from exact ranges: a constant along-track velocity error, seen at 7 km from 100 m/s."""
    speed, far, span, wrong = 100.0, 7000.0, 5.0, 0.2
    time = np.linspace(-span / 2, span / 2, 2001)
    error = np.hypot(far, speed * time + wrong * (time + span / 2)) - np.hypot(far, speed * time)
    start = settled(0.0, wrong**2)
    quiet = replace(PLAIN, aperture_time=span, start=start, accelerometer_noise=1e-12, gyro_noise=1e-15)
    turning = replace(quiet, turn_rate=speed / far)
    assert strategy_variances(quiet).quadratic[0] < 1e-12
    line = error - np.polynomial.polynomial.polyval(time, np.polynomial.polynomial.polyfit(time, error, 1))
    assert np.sqrt(strategy_variances(turning).detrended[0]) == pytest.approx(np.sqrt(np.mean(line**2)), rel=0.01)


def test_the_shrunk_fit_can_lose_along_the_line_of_sight(differs):
    """A navigation-grade unit at 5 km from 100 m/s: fixes of 1 m bring their velocity noise into the line."""
    sensors = (SA / 10, SW / 100)
    start = cycle(*sensors, G, 1.0, 1.0, 1.0).posterior.horizontal
    near = replace(
        PLAIN, aperture_time=10.0, gnss_sigma=1.0, accelerometer_noise=sensors[0], gyro_noise=sensors[1], start=start,
        turn_rate=0.02,
    )  # fmt: skip
    at_middle = strategy_variances(replace(near, turn_rate=0.0)).detrended
    ins, shrunk = (1e3 * np.sqrt(float(strategy_variances(near).detrended[i])) for i in (0, 3))
    assert at_middle[3] <= at_middle[0]
    assert shrunk > 2 * ins
    differs(
        "Noise-weighted quadratic fit against the INS alone", "S-2", "unpublished: the weighted fit never loses",
        f"the fit leaves {shrunk:.1f} mm, the INS {ins:.1f} mm (navigation grade, 1 m fixes, 10 s, 5 km, 100 m/s)",
        "ours",
        "on one axis the fit is never worse; along the line of sight its line brings the fixes' velocity noise, "
        "which the turning line of sight bends into a quadratic, as exact ranges show",
    )  # fmt: skip


def test_a_fit_is_chosen_only_where_it_holds_more_than_its_velocity_noise_costs():
    """2000 cases: no winner is worse than the INS alone along the line of sight as it turns."""
    random = np.random.default_rng(1)

    def spread(low, high):
        return np.exp(random.uniform(np.log(low), np.log(high), 2000))

    sensors, noise, interval = (spread(1e-3, 0.2) / 60, spread(1e-5, 2e-2) / 60), spread(0.005, 3), spread(0.1, 2)
    start = cycle(*sensors, G, interval, noise, noise).posterior
    case = Conditions(
        spread(2, 80), noise, interval, *sensors, start.horizontal, start_vertical=start.vertical,
        turn_rate=spread(0.002, 0.1), grazing_angle=0.5,
    )  # fmt: skip
    whole = strategy_variances(case).detrended
    winner = map_of_winners(case).winner
    assert len(np.unique(winner)) == 3
    chosen = np.take_along_axis(whole, winner[None], axis=0)[0]
    assert np.all(chosen <= 1.05**2 * whole[0])


def test_map_of_winners_on_a_grid():
    spans = np.geomspace(2.5, 60, 100)[None, :]
    noise = np.geomspace(0.005, 5, 100)[:, None]
    start = settled(TILT * noise ** (1 / 3))
    case = replace(PLAIN, aperture_time=spans, gnss_sigma=noise, start=start, coast_time=30.0)
    result = map_of_winners(case)
    assert result.winner.shape == result.best_sigma.shape == (100, 100)
    names = np.array(result.strategies)[result.winner]
    assert names[-1, 0] == "2"  # noisy fixes, short aperture
    assert names[0, -1] == "5"  # good fixes, long aperture
    assert "5w" in names  # between the two
    assert "3" not in names  # with a coast, never
    assert np.all(result.best_sigma <= 1.05 * result.sigma.min(axis=0) * (1 + 1e-12))


def test_autofocus_leaves_nothing_to_choose_between():
    variances = strategy_variances(replace(PLAIN, autofocus_order=2, coast_time=100.0)).detrended
    np.testing.assert_allclose(variances, SA**2 * 20.0**3 / 2520 + (G * SW) ** 2 * 20.0**5 / 55440, rtol=1e-9)
    cubic = strategy_variances(replace(PLAIN, autofocus_order=3)).detrended
    np.testing.assert_allclose(cubic, SA**2 * 20.0**3 / 6930 + (G * SW) ** 2 * 20.0**5 / 540540, rtol=1e-9)
    few = strategy_variances(replace(PLAIN, autofocus_order=2, aperture_time=1.5)).detrended
    assert np.isinf(few[2])
    assert np.isfinite(few[[0, 1, 3]]).all()


@given(
    st.dictionaries(st.sampled_from(["2", "4", "5", "8", "9"]), st.floats(0.01, 10.0), min_size=1),
    st.floats(0.01, 10.0),
    st.one_of(st.none(), st.floats(0.01, 10.0)),
)
def test_advice_names_nothing_that_fails_or_is_worse_than_what_is_in_use(others, used, limit):
    """In any ranking: what it says of the limit is so, and what it names is at least as good as what is in use."""
    phase = {"3": used, **others}
    key, sentence = recommendation(phase, "3", "real time", limit)
    assert phase[key] <= used * 1.01  # of equals, to the digits that are shown, the one in use
    least = min(phase.values())
    if limit is None:
        assert "meets" not in sentence
    elif least > limit:
        assert sentence.startswith("No strategy meets ")
        assert phase[key] <= least * 1.01
    else:
        name = NAMES["3"] if used <= limit else NAMES[key]
        assert sentence.startswith(f"{name} meets ")
        assert phase[key] <= limit
    assert "Use " not in sentence


def test_advice_says_which_why_and_what_would_change():
    short = advise(Conditions(5.0, 0.02, 1.0, 0.07 / 60, np.radians(0.15) / 60, settled(1e-8)), 0.031)
    assert short.strategy == "2"
    assert short.sentence.endswith("INS from filter: free INS from the last fix.")
    assert short.break_even_aperture > 5.0
    case = Conditions(20.0, 0.02, 1.0, SA, SW, settled(2e-7), coast_time=100.0)
    good = advise(case, 0.031, required_phase=0.1)
    assert good.strategy == "5"
    assert good.break_even_aperture < 20.0
    assert good.sentence.startswith("No strategy meets 5.73° in real time. Closest: Quadratic fit, ")
    assert "INS after outage (100 s without fixes)" in good.because
    assert good.break_even_gnss_sigma > 0.02
    # At the noise named, the two are equal.
    equal = strategy_variances(replace(case, gnss_sigma=good.break_even_gnss_sigma)).detrended
    assert equal[2] == pytest.approx(equal[0], rel=1e-9)
    none = advise(replace(case, aperture_time=1.5), 0.031)
    assert none.strategy == "2"
    assert "no quadratic to fit" in none.because
    with_autofocus = advise(replace(case, autofocus_order=2), 0.031)
    assert "hardly matters" in with_autofocus.would_change
