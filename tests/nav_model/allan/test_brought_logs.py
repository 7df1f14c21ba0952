"""Logs as people bring them, from file to random walk: made logs of known noise, and the small files kept beside the
checkout."""

import math
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from nav_model.allan.deviation import overlapping_allan_deviation
from nav_model.allan.imu_log import ImuLog
from nav_model.allan.log_content import LogOptions
from nav_model.allan.log_file import read_log
from nav_model.allan.result import LogAnalysis, to_json
from nav_model.allan.static_log import analyse_log

ANGLE = math.radians(0.3) / 60.0
VELOCITY = 0.06 / 60.0
TRUTH = {"gyro": ANGLE, "accelerometer": VELOCITY}
HEADER = "time [s],gyro_x [rad/s],gyro_y [rad/s],gyro_z [rad/s],acc_x [m/s2],acc_y [m/s2],acc_z [m/s2]\n"
RATE, SAMPLES = 100.0, 6000


def lost(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    indices = np.sort(rng.choice(SAMPLES, SAMPLES - SAMPLES // 200, replace=False))
    return indices / RATE, white(rng)[indices]


def jittered(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    return np.arange(SAMPLES) / RATE + 1e-3 * rng.standard_normal(SAMPLES), white(rng)


def paired(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    index = np.arange(SAMPLES)
    return index / RATE - 6e-3 * (index % 2), white(rng)


def held(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    signal, quarter = white(rng), white(rng, RATE / 4.0)
    signal[:, 3:] = np.repeat(quarter[: SAMPLES // 4, 3:], 4, axis=0)
    return np.arange(SAMPLES) / RATE, signal


def white(rng: np.random.Generator, rate: float = RATE) -> np.ndarray:
    signal = rng.standard_normal((SAMPLES, 6)) * np.sqrt(rate) * np.repeat([ANGLE, VELOCITY], 3)
    return signal + np.array([0.0, 0.0, 0.0, 0.04, -0.02, 9.8])


def file_of(time: np.ndarray, signal: np.ndarray) -> bytes:
    rows = "\n".join(",".join(f"{value:.9g}" for value in row) for row in np.column_stack([time, signal]))
    return (HEADER + rows).encode()


@pytest.mark.slow
@pytest.mark.parametrize("fault", [lost, jittered, paired, held])
def test_the_truth_is_inside_the_interval_in_44_of_48_logs(fault: Callable[..., tuple[np.ndarray, np.ndarray]]):
    inside = np.zeros(6)
    for seed in range(48):
        rng = np.random.default_rng([seed, *fault.__name__.encode()])
        axes = analyse_log(read_log(file_of(*fault(rng)))).axes
        walks = [axis.coefficients["random_walk"] for axis in axes]
        inside += [w is not None and w.low <= TRUTH[a.quantity] <= w.high for w, a in zip(walks, axes, strict=True)]
    assert inside.sum() >= 6 * 44  # of intervals of 95 %, fewer in one of 200 such tests


@pytest.mark.long
@pytest.mark.parametrize("fault", [lost, jittered, paired, held])
def test_the_random_walk_is_that_of_the_noise(fault: Callable[..., tuple[np.ndarray, np.ndarray]]):
    for axis in analyse_log(read_log(file_of(*fault(np.random.default_rng(11))))).axes:
        walk = axis.coefficients["random_walk"]
        assert walk is not None
        assert walk.value == pytest.approx(TRUTH[axis.quantity], rel=0.06)
        assert not axis.warnings


def in_stretches(signal: np.ndarray, breaks: list[int]) -> LogAnalysis:
    starts = np.array(breaks, dtype=np.int64)
    return analyse_log(ImuLog(signal, None, 10.0, breaks={"gyro": starts} if breaks else {}))


@pytest.mark.long
def test_a_pause_costs_nothing_but_its_samples(simulate):
    """The walk restarts where it likes after the pause: joined as one, the step would be read as noise."""
    first, second = (simulate(seed, 40_000, 0.1, random_walk=1e-4, rate_random_walk=2e-6) for seed in (1, 2))
    joined = np.concatenate([first, second + 5e-3])[:, None]
    (axis,) = in_stretches(joined, [40_000]).axes
    for term, truth in (("random_walk", 1e-4), ("rate_random_walk", 2e-6)):
        coefficient = axis.coefficients[term]
        assert coefficient is not None
        assert coefficient.low <= truth <= coefficient.high
    (wrong,) = in_stretches(joined, []).axes
    walk = wrong.coefficients["rate_random_walk"]
    assert walk is None or walk.low > 2e-6


@pytest.mark.long
def test_deviations_over_gaps_are_the_mean_over_stretches_with_the_freedom_that_repetition_shows():
    """The mean square over all pairs within stretches, written out; the scatter of many logs as the oracle of its
    degrees of freedom, chi-square: variance of the ratio to the truth is 2 over them."""
    rng = np.random.default_rng(6)
    breaks = np.sort(rng.choice(np.arange(20, 3000), 12, replace=False))
    edges, taus = [0, *breaks.tolist(), 3000], np.array([1.0, 4.0, 16.0, 64.0])
    ratios = []
    for _ in range(400):
        signal = rng.standard_normal(3000)
        result = overlapping_allan_deviation(signal, 1.0, taus, breaks=breaks)
        ratios.append(result.deviation**2 * taus)
    for tau, deviation in zip((1, 4, 16, 64), result.deviation, strict=True):
        squares = [
            (signal[i + tau : i + 2 * tau].mean() - signal[i : i + tau].mean()) ** 2 / 2.0
            for start, stop in pairwise(edges)
            for i in range(start, stop - 2 * tau + 1)
        ]
        assert deviation == pytest.approx(math.sqrt(np.mean(squares)), rel=1e-9)
    ratios = np.array(ratios)
    np.testing.assert_allclose(ratios.mean(axis=0), 1.0, atol=0.05)
    from scipy.special import chdtri

    for column, low, deviation in zip(ratios.T, result.low, result.deviation, strict=True):
        freedom = 2.0 / column.var()
        assert low / deviation == pytest.approx(math.sqrt(freedom / chdtri(freedom, 0.025)), rel=0.06)


@pytest.mark.long
def test_the_json_says_what_was_read_and_the_rate_of_each_axis():
    data = to_json(analyse_log(read_log(file_of(*held(np.random.default_rng(3))))))
    assert [axis["rate_hz"] for axis in data["axes"]] == pytest.approx([100.0] * 3 + [25.0] * 3)
    assert any("analysed at its own 25 Hz" in note for note in data["provenance"]["reading"])
    gaps = to_json(analyse_log(read_log(file_of(*lost(np.random.default_rng(3))))))
    assert gaps["axes"][0]["stretches"] > 20


def brought() -> list[Path]:
    folder = Path(__file__).resolve().parents[3].parent / "shared" / "data" / "brought"
    return sorted(
        path for path in folder.glob("[01]*") if path.name[:2] in ("03", "04", "05", "06", "09", "13", "14", "15")
    )


@pytest.mark.long
@pytest.mark.skipif(not brought(), reason="the files that people brought are not beside the checkout")
@pytest.mark.parametrize("path", brought(), ids=lambda path: path.stem)
def test_what_people_brought_is_read(path: Path):
    options = LogOptions(rate_hz=50.0) if path.name.startswith("03") else None  # its stamps are empty
    axes = analyse_log(read_log(path, options)).axes
    assert len(axes) == (3 if path.name.startswith("13") else 6)
    for axis in axes:
        walk = axis.coefficients["random_walk"]
        assert walk is not None
        margin = 1.5  # of 90 intervals of 95 % some miss
        truth = TRUTH[axis.quantity]
        assert (
            walk.value - margin * (walk.value - walk.low) <= truth <= walk.value + margin * (walk.high - walk.value)
        )
