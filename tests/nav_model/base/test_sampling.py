"""Stamps judged along a line, and values that are held: made stamps whose rate and lost samples are known."""

import numpy as np
import pytest

from nav_model.base.errors import InputError
from nav_model.base.sampling import Sampling, held_values, judge_stamps

RATE = 200.0
RNG = np.random.default_rng(40)
INDEX = np.arange(20_000.0)
KEPT = np.sort(RNG.choice(INDEX, len(INDEX) - len(INDEX) // 200, replace=False))  # one in 200 is lost
BREAKS = np.flatnonzero(np.diff(KEPT) > 1.0) + 1
NO_GAP = np.empty(0, dtype=np.int64)


def judge(stamps: np.ndarray) -> Sampling:
    return judge_stamps(stamps, "log.csv", lambda row: f"line {row + 2}")


def late(index: np.ndarray) -> dict[str, np.ndarray]:
    """Stamps of samples with their usual faults, by name."""
    time, jitter = index / RATE, np.random.default_rng(1)
    hiccup = time.copy()
    hiccup[500:508] = np.maximum(hiccup[500:508], hiccup[508])  # a host that was busy and caught up
    return {
        "exact": time,
        "1 ms of jitter": time + 1e-3 * jitter.standard_normal(len(time)),
        "late by up to 4 ms": time + jitter.uniform(0.0, 4e-3, len(time)),
        "pairs 8 and 2 ms apart": time + np.where(index % 2, -3e-3, 0.0),
        "pairs with one stamp": np.floor(index / 2.0) * 2.0 / RATE,
        "bursts of eight": np.floor(index / 8.0) * 8.0 / RATE,
        "whole milliseconds at 345.75 Hz": np.round(index / 345.75, 3),
        "caught up with": hiccup,
        "a clock 20 ppm fast that wanders": time * (1 + 2e-5) + 0.02 * np.sin(time / 60.0),
    }


@pytest.mark.parametrize("fault", late(INDEX))
def test_the_rate_is_that_of_the_line(fault: str):
    sampling = judge(late(INDEX)[fault])
    rate = 345.75 if "345" in fault else RATE
    assert 1.0 / sampling.interval_s == pytest.approx(rate, rel=1e-3 if "wanders" in fault else 1e-5)
    assert sampling.lost == 0
    assert not len(sampling.breaks)


@pytest.mark.parametrize("fault", [name for name in late(INDEX) if name not in ("bursts of eight", "caught up with")])
def test_lost_samples_are_seen_through_the_faults_of_stamps(fault: str):
    sampling = judge(late(KEPT)[fault])
    lost = len(INDEX) - len(KEPT)
    assert abs(sampling.lost - lost) <= (0 if fault == "exact" else 0.04 * lost)
    near = [np.min(np.abs(sampling.breaks - true)) for true in BREAKS]
    assert np.mean(np.array(near) <= 3) > 0.9
    if fault == "exact":
        np.testing.assert_array_equal(sampling.breaks, BREAKS)


def test_jitter_is_told_and_a_pause_is_a_gap():
    assert judge(late(INDEX)["1 ms of jitter"]).jitter_s == pytest.approx(1e-3, rel=0.05)
    for jitter in (0.0, 1e-3):
        paused = late(INDEX)["exact"] + jitter * RNG.standard_normal(len(INDEX))
        paused[8000:] += 3600.123
        sampling = judge(paused)
        assert sampling.breaks.tolist() == [8000]
        assert sampling.lost == pytest.approx(3600.123 * RATE, rel=1e-4)
        assert 1.0 / sampling.interval_s == pytest.approx(RATE, rel=1e-5)


@pytest.mark.parametrize(
    ("stamps", "complaint"),
    [
        (np.where(INDEX % 3 == 0, 1000.0, 0.0) + INDEX / RATE, "stamps of two clocks"),
        (np.where(INDEX < 50, 0.0, 1.5e9) + INDEX / RATE, "line 52: .*stamps of two clocks"),
        (np.concatenate([INDEX, INDEX]) / RATE, r"line 20002: .*Two logs are behind one another"),
        (np.insert(INDEX, 77, 76.0) / RATE, "line 79: the time does not increase"),
        (np.zeros(100), "the time does not increase"),
        (-INDEX / RATE, "the time does not increase"),
    ],
)
def test_two_clocks_and_time_that_runs_back_are_refused_by_name(stamps: np.ndarray, complaint: str):
    with pytest.raises(InputError, match=complaint):
        judge(stamps)


@pytest.mark.parametrize("length", [1.6, 2.0, 2.08, 2.5, 4.0, 40.0])
def test_held_values_are_found_at_their_own_rate(length: float):
    samples = RNG.standard_normal((5000, 3))
    samples[100] = samples[99]  # twice by chance
    rows = samples[(np.arange(int(5000 * length)) / length).astype(int)]
    result = held_values(rows, NO_GAP)
    assert result is not None
    first, rows_per_sample = result
    assert rows_per_sample == pytest.approx(length, rel=2e-3)
    np.testing.assert_array_equal(rows[first], samples[: len(first)])


@pytest.mark.parametrize("step", [0.1, 0.5, 1.0, 2.0, 4.0])
@pytest.mark.parametrize("axes", [1, 3])
def test_coarse_values_that_are_equal_by_chance_are_not_held(step: float, axes: int):
    assert held_values(np.round(RNG.standard_normal((20_000, axes)) / step), NO_GAP) is None


def test_a_still_or_a_free_sensor_is_not_held():
    assert held_values(np.ones((1000, 3)), NO_GAP) is None
    assert held_values(RNG.standard_normal((1000, 3)), NO_GAP) is None
    drifting = np.round(np.cumsum(RNG.standard_normal(20_000)) / 30.0)[:, None]  # long runs of every length
    assert held_values(drifting, NO_GAP) is None


def test_stamps_of_no_clock_are_judged_without_an_overflow():
    assert judge(np.arange(300) * 1e300).interval_s == pytest.approx(1e300)
