"""Probabilities: against closed forms, plain Monte Carlo and their own error bars."""

import numpy as np
import pytest

from nav_model.base.errors import InputError
from nav_model.explore.solve import solve
from nav_model.explore.uncertainty import Uncertain, read_uncertain, uncertain_verdict

ARW = "imu.angle_random_walk"
DEG = np.pi / 180 / 60


def test_one_uniform_input_has_a_probability_in_closed_form(open_design):
    """Everything below the solved largest value closes."""
    threshold = next(s for s in solve(open_design) if s.key == ARW).together.value
    low, high = 0.02 * DEG, 0.06 * DEG
    result = uncertain_verdict(open_design, {ARW: Uncertain("uniform", low, high)}).closes
    exact = (threshold - low) / (high - low)
    assert result.low <= exact <= result.high
    assert result.value == pytest.approx(exact, abs=2e-3)
    result = uncertain_verdict(open_design, {ARW: Uncertain("log-uniform", low, high)}).closes
    assert result.value == pytest.approx(np.log(threshold / low) / np.log(high / low), abs=2e-3)


def test_the_interval_covers_at_its_rate(open_design):
    """Exact probability inside the 95 % interval in at least 88 of 100 seeds (binomial, 1 in 500 below)."""
    threshold = next(s for s in solve(open_design) if s.key == ARW).together.value
    from scipy.special import ndtr

    exact = ndtr(np.log(threshold / (0.04 * DEG)) / np.log(1.5))
    spread = {ARW: Uncertain("lognormal", 0.04 * DEG, 1.5)}
    result = [uncertain_verdict(open_design, spread, seed, points=64).closes for seed in range(100)]
    assert sum(p.low <= exact <= p.high for p in result) >= 88


def test_certainty_still_has_an_error_bar(closed_design):
    sure = uncertain_verdict(closed_design, {ARW: Uncertain("uniform", 0.01 * DEG, 0.02 * DEG)}).closes
    assert sure.value == 1
    assert sure.low == pytest.approx(1 - 3 / 10240)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("0.1 °/√h", "not a range"),
        ("0.2 °/√h .. 0.1 °/√h", "below the upper"),
        ("0.1 m .. 0.2 m", "not a unit"),
        ("0.1 °/√h */ 0.5", "factor"),
        ("0.1 °/√h */ much", "factor"),
        ("-1 °/√h .. 0.1 °/√h", "more than|at least"),
    ],
)
def test_refused_ranges(text, message):
    with pytest.raises(InputError, match=message):
        read_uncertain(ARW, text)


def test_refused_inputs(closed_design):
    with pytest.raises(InputError, match="cannot be uncertain"):
        read_uncertain("imu.rate", "1 Hz .. 2 Hz")
    with pytest.raises(InputError, match="choice"):
        read_uncertain("radar.window", "a .. b")
    with pytest.raises(InputError, match="No input"):
        uncertain_verdict(closed_design, {})
    with pytest.raises(InputError, match="reaches beyond the allowed range"):
        uncertain_verdict(closed_design, {"imu.vibration_factor": Uncertain("lognormal", 500.0, 3.0)})


@pytest.mark.parametrize("text", ["x" * 5000, "0.1 °/√h */ " + "9" * 5000, "2 °/√h .. 1 °/√h" + " " * 5000])
def test_a_long_text_is_quoted_in_short(text: str):
    with pytest.raises(InputError) as refused:
        read_uncertain("imu.angle_random_walk", text)
    assert len(str(refused.value)) < 250
