"""Decomposition of residuals: known signals in, their parts out."""

import numpy as np
import pytest

from nav_model.aperture.impulse_response import aperture_of_phase, impulse_response
from nav_model.sar.axis_model import steady_covariance
from nav_model.sar.decomposition import (
    autofocus,
    band,
    decompose,
    fix_rate_harmonics,
    polynomial_basis,
    run_responses,
)
from nav_model.sar.fast_engine import simulate_axis

N = 4001
X = np.linspace(-1, 1, N)


def test_each_part_is_found_in_its_place():
    ripple = 0.05 * np.sin(2 * np.pi * 40 * X)
    history = 1e4 + 300 * X + 0.7 * X**2 - 0.3 * X**3 + ripple
    parts = decompose(history)
    assert parts.quadratic == pytest.approx(0.7, rel=1e-3)
    assert parts.cubic == pytest.approx(-0.3, rel=2e-2)
    assert parts.quadratic_rms == pytest.approx(0.7 * np.sqrt(4 / 45), rel=2e-3)
    assert parts.cubic_rms == pytest.approx(0.3 * np.sqrt(4 / 175), rel=2e-2)
    assert parts.higher_rms < 0.1 * parts.high_frequency_rms
    assert parts.high_frequency_rms == pytest.approx(0.05 / np.sqrt(2), rel=0.01)
    assert parts.detrended_max == pytest.approx(np.abs(autofocus(history)).max())


def test_the_squares_add_up_and_autofocus_takes_orders_away():
    random = np.random.default_rng(4)
    history = np.cumsum(np.cumsum(random.standard_normal((20, 500)), axis=1), axis=1)
    parts = decompose(history)
    squares = sum(getattr(parts, f"{name}_rms") ** 2 for name in ("quadratic", "cubic", "higher", "high_frequency"))
    np.testing.assert_allclose(squares, parts.detrended_rms**2, rtol=1e-9)
    np.testing.assert_allclose(parts.residual_rms, parts.detrended_rms)
    for order in (2, 3, 5):
        fit = np.polynomial.polynomial.polyfit(np.linspace(-1, 1, 500), history.T, order)
        expected = history - np.polynomial.polynomial.polyval(np.linspace(-1, 1, 500), fit)
        np.testing.assert_allclose(autofocus(history, order), expected, atol=1e-6)
        rms = np.sqrt(np.mean(expected**2, axis=1))
        np.testing.assert_allclose(decompose(history, order).residual_rms, rms, rtol=1e-6)
    with pytest.raises(ValueError, match="autofocus_order"):
        autofocus(history, 0)
    with pytest.raises(ValueError, match="samples"):
        polynomial_basis(5, 8)


def test_autofocus_of_an_ins_leaves_what_s6_says(table_designs):
    """[S-6]: after order 2, 1/2520 and 1/55440; after order 3, 1/6930 and 1/540540."""
    model, aperture = table_designs["GNSS 1 m"]
    errors = simulate_axis(model, aperture, runs=3000, seed=6, rate=20.0).of("2")
    noise, tilt_noise = model.accelerometer_noise**2, model.tilt_noise**2
    assert steady_covariance(model)[2, 2] > 0
    for order, (a, b) in {2: (2520, 55440), 3: (6930, 540540)}.items():
        expected = noise * aperture**3 / a + tilt_noise * aperture**5 / b
        sample = decompose(errors, order).residual_rms ** 2
        assert abs(sample.mean() - expected) < 4 * sample.std() / np.sqrt(3000) + 0.01 * expected


def test_a_saw_of_the_fix_rate_shows_at_its_harmonics():
    time = np.linspace(0, 20, 40_001)
    harmonics = fix_rate_harmonics(0.02 * (time % 1.0), time, 1.0, 3)
    np.testing.assert_allclose(harmonics, 0.02 / np.pi / np.arange(1, 4), rtol=0.04)  # the smooth part takes 3 %
    with pytest.raises(ValueError, match="harmonics"):
        fix_rate_harmonics(time, time[:21] * 1000, 1.0, 3)


def test_a_saw_makes_the_echoes_and_islr_of_the_limits_table():
    """Echoes 20 log10(A / (2 pi k)), ISLR 10 log10(A^2/12), one fix every tenth of the aperture."""
    amplitude, count = 0.2, 10
    x = np.linspace(0, count, 8193)[:-1] + count / 16384
    aperture = np.exp(1j * amplitude * (x % 1.0))
    spectrum = np.abs(np.fft.fft(aperture)) / len(aperture)
    for k in (1, 2, 3):
        pair = np.sqrt(spectrum[k * count] * spectrum[-k * count]) / spectrum[0]
        assert 20 * np.log10(pair) == pytest.approx(20 * np.log10(amplitude / (2 * np.pi * k)), abs=0.05)
    clean, saw = (impulse_response(a, "taylor", 16).islr_fixed_db for a in (np.ones(8192), aperture))
    added = (1 + 10 ** (saw / 10)) / (1 + 10 ** (clean / 10)) - 1
    assert 10 * np.log10(added) == pytest.approx(10 * np.log10(amplitude**2 / 12), abs=0.1)


def test_bands_are_percentiles_of_the_runs():
    result = band(np.arange(101.0)[None].repeat(3, axis=0))
    np.testing.assert_array_equal([result.low[1], result.median[1], result.high[1]], [5, 50, 95])


def test_responses_of_runs_agree_with_the_full_ones(table_designs):
    model, aperture = table_designs["short"]
    phase = 4 * np.pi / 0.03 * simulate_axis(model, aperture, runs=15, seed=2).error[[1, 3]]
    quick = run_responses(phase, "taylor")
    full = impulse_response(aperture_of_phase(autofocus(phase)), "taylor")
    np.testing.assert_allclose(
        np.median(quick["width_cells"], axis=-1), np.median(full.width_cells, axis=-1), atol=1e-3
    )
    np.testing.assert_allclose(
        np.median(quick["pslr_fixed_db"], axis=-1), np.median(full.pslr_fixed_db, axis=-1), atol=0.04
    )
