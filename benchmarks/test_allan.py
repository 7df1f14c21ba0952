"""Whole-size static log: 1,000,000 samples x 6 axes, 100 Hz; reading it from CSV; the deviation alone."""

import io
import time
import tracemalloc

import numpy as np
import pytest

from nav_model.allan.deviation import averaging_times, overlapping_allan_deviation
from nav_model.allan.imu_log import ImuLog
from nav_model.allan.log_file import read_log
from nav_model.allan.static_log import analyse_log

SAMPLES = 1_000_000


@pytest.fixture(scope="module")
def signal() -> np.ndarray:
    rng = np.random.default_rng(0)
    return rng.standard_normal((SAMPLES, 6)) * 1e-3 + np.cumsum(rng.standard_normal((SAMPLES, 6)), axis=0) * 1e-7


def test_six_axis_log(benchmark, signal: np.ndarray):
    """Budget of the product: 10 s and 500 MB."""
    log = ImuLog(signal[:, :3], signal[:, 3:] + 5.66, 100.0)
    benchmark.pedantic(analyse_log, args=(log,), rounds=3)
    tracemalloc.start()
    analyse_log(log)
    benchmark.extra_info["peak_traced_MB"] = tracemalloc.get_traced_memory()[1] / 1e6
    tracemalloc.stop()


def test_csv_of_the_same_log(benchmark, signal: np.ndarray):
    names = [f"{sensor}_{axis} [{unit}]" for sensor, unit in (("gyro", "rad/s"), ("acc", "m/s2")) for axis in "xyz"]
    stream = io.StringIO()
    stream.write("# rate: 100 Hz\n" + ",".join(names) + "\n")
    np.savetxt(stream, signal, delimiter=",", fmt="%.6e")
    content = stream.getvalue().encode()
    del stream
    benchmark.pedantic(read_log, args=(content,), rounds=1)
    benchmark.extra_info["file_MB"] = len(content) / 1e6


def plain_oadev(rate_signal: np.ndarray, interval_s: float, tau_s: np.ndarray) -> np.ndarray:
    """The textbook sum on the integrated signal, as the named alternative."""
    phase = np.concatenate([[0.0], np.cumsum(rate_signal - rate_signal.mean())]) * interval_s
    times = []
    for factor in np.round(tau_s / interval_s).astype(int):
        second = phase[2 * factor :] - 2.0 * phase[factor:-factor] + phase[: -2 * factor]
        times.append(np.sqrt(second @ second / len(second) / 2.0) / (factor * interval_s))
    return np.array(times)


def test_overlapping_deviation_of_one_axis(benchmark, signal: np.ndarray):
    axis = np.ascontiguousarray(signal[:, 0])
    taus = averaging_times(SAMPLES, 0.01)
    deviation = benchmark.pedantic(overlapping_allan_deviation, args=(axis, 0.01, taus), rounds=3, warmup_rounds=1)
    start = time.perf_counter()
    alternative = plain_oadev(axis, 0.01, taus)
    benchmark.extra_info["plain_numpy_s"] = time.perf_counter() - start
    benchmark.extra_info["averaging_times"] = len(taus)
    np.testing.assert_allclose(deviation.deviation, alternative, rtol=1e-9)
