"""Overlapping Allan deviation against NIST SP 1065 and Stable32."""

import json
from pathlib import Path

import numpy as np
import pytest

from nav_model.allan.deviation import averaging_times, overlapping_allan_deviation


def nbs14() -> np.ndarray:
    """The 1000-point set of SP 1065: a Park-Miller generator."""
    values, state = [], 1234567890
    for _ in range(1000):
        values.append(state / 2147483647)
        state = 16807 * state % 2147483647
    return np.array(values)


def test_equals_nbs14(compared, ratio_off):
    result = overlapping_allan_deviation(nbs14(), 1.0, np.array([1.0, 10.0, 100.0]))
    off = ratio_off(result.deviation, [2.922319e-01, 9.159953e-02, 3.241343e-02])
    compared(
        "Allan deviation of the 1000-point set",
        "",
        "published figure",
        "NIST SP 1065, NBS14",
        off,
        1e-6,
    )


@pytest.mark.parametrize("table", ["gps_oadev", "ocxo_oadev"])
def test_equals_stable32(shared_data: Path, table: str, compared, ratio_off):
    reference = json.loads((shared_data / "clock_stable32_and_nbs14_reference.json").read_text())
    with np.load(shared_data / "clock_gps1pps_phase_and_ocxo_freq.npz") as clocks:
        if table == "gps_oadev":
            signal = np.diff(clocks["gps_1pps_phase_s"])
        else:
            frequency = clocks["ocxo_freq_hz"]
            signal = frequency / frequency.mean() - 1.0
    rows = np.array(reference[table])
    rows = rows[3 * rows[:, 1] <= len(signal)]
    assert len(rows) >= 10
    result = overlapping_allan_deviation(signal, 1.0, rows[:, 1], alpha=rows[:, 3], confidence=0.683)
    oracle = "Stable32 1.60 on a GPS clock and an oven oscillator"
    off = ratio_off(result.deviation, rows[:, 5])
    compared("Allan deviation of real clocks", "", "another program", oracle, off, 2e-3)
    # Stable32's own limits rest on the same degrees of freedom, computed by another program.
    off = [ratio_off(result.low, rows[:, 4]), ratio_off(result.high, rows[:, 6])]
    compared("Confidence limits of the Allan deviation", "", "another program", oracle, off, 2e-2)


def test_limits_cover_white_noise():
    """95 % limits of 400 white logs: N/√τ lies inside between 91.5 % and 98.5 % of the time."""
    rng = np.random.default_rng(3)
    taus = np.array([1.0, 10.0, 100.0])
    inside = np.zeros(3)
    for _ in range(400):
        result = overlapping_allan_deviation(rng.standard_normal(1000), 1.0, taus)
        inside += (result.low <= 1.0 / np.sqrt(taus)) & (1.0 / np.sqrt(taus) <= result.high)
    assert np.all(inside >= 0.915 * 400)
    assert np.all(inside <= 0.985 * 400)


def test_default_times_are_whole_samples_up_to_a_quarter():
    taus = averaging_times(100_000, 0.01)
    np.testing.assert_allclose(taus / 0.01, np.round(taus / 0.01), atol=1e-6)
    assert taus[0] == pytest.approx(0.01)
    assert taus[-1] == pytest.approx(250.0)


@pytest.mark.parametrize("tau", [0.015, 0.0, 4.0])
def test_impossible_averaging_time_is_refused(tau: float):
    with pytest.raises(ValueError, match="tau_s"):
        overlapping_allan_deviation(np.arange(1000.0), 0.01, np.array([tau]))
