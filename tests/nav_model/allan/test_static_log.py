"""Static analysis: coverage on simulated logs, real logs, disturbances, JSON."""

import subprocess
import sys
import textwrap
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from nav_model.allan.imu_log import ImuLog
from nav_model.allan.log_file import read_log
from nav_model.allan.noise_terms import TERMS
from nav_model.allan.result import fitted_lines, to_json, triad_coefficient
from nav_model.allan.static_log import analyse_log

pytestmark = pytest.mark.long

Simulator = Callable[..., np.ndarray]

# Simulated axes, and how many intervals must hold the truth: where 95 % do in the long run, fewer do once in a
# thousand times.
FEW, MANY = (30, 25), (201, 181)

CASES = {
    "quantization, random walk, flicker": {
        "quantization": 1e-3,
        "random_walk": 1e-2,
        "bias_instability": 6e-3,
    },
    "random walk, rate random walk": {"random_walk": 1e-2, "rate_random_walk": 2e-3},
    "random walk, ramp": {"random_walk": 1e-2, "ramp": 1e-5},
    "all five": {
        "quantization": 1e-3,
        "random_walk": 1e-2,
        "bias_instability": 3e-3,
        "rate_random_walk": 2e-4,
        "ramp": 2e-6,
    },
    "drift in competition": {"random_walk": 1e-2, "rate_random_walk": 1e-4, "ramp": 5e-6},
}
# Terms that a log of the given size must show, not merely bound.
SHOWN = {
    "quantization, random walk, flicker": ("quantization", "random_walk", "bias_instability"),
    "random walk, rate random walk": ("random_walk", "rate_random_walk"),
    "random walk, ramp": ("random_walk", "ramp"),
    "all five": ("quantization", "random_walk", "bias_instability"),
    "drift in competition": ("random_walk",),
}


def measure_coverage(simulate: Simulator, case: str, samples: int, logs: tuple[int, int]) -> None:
    """Analyse simulated axes: shown coefficients hold the truth, absent ones stay unresolved."""
    truth = CASES[case]
    inside = dict.fromkeys(TERMS, 0)
    resolved = dict.fromkeys(TERMS, 0)
    widths: dict[str, list[float]] = {term: [] for term in TERMS}
    axes, fewest = logs
    for log in range(axes // 3):
        signal = np.stack([simulate(3 * log + axis, samples, 0.1, **truth) for axis in range(3)], axis=1)
        for axis in analyse_log(ImuLog(signal, None, 10.0)).axes:
            for term in TERMS:
                coefficient = axis.coefficients[term]
                if coefficient is None:
                    assert axis.not_resolved[term].startswith("not resolved")
                    continue
                resolved[term] += 1
                inside[term] += coefficient.low <= truth.get(term, 0.0) <= coefficient.high
                widths[term].append(coefficient.high / coefficient.low)
    for term in SHOWN[case]:
        assert inside[term] >= fewest, (term, inside, resolved)
        # An interval that covers by being wide is no result.
        assert np.median(widths[term]) < (1.1 if term == "random_walk" else 4.0), (term, widths[term])
    for term in set(TERMS) - set(truth):
        assert resolved[term] <= axes - fewest, (term, resolved)


@pytest.mark.parametrize("logs", [FEW, pytest.param(MANY, marks=pytest.mark.slow)])
def test_known_coefficients_lie_in_their_intervals(simulate: Simulator, logs: tuple[int, int]):
    measure_coverage(simulate, "random walk, rate random walk", 8192, logs)


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_known_coefficients_lie_in_their_intervals_long(simulate: Simulator, case: str):
    measure_coverage(simulate, case, 20_000, MANY)


def walks_of_white_noise(axes: int, samples: int) -> np.ndarray:
    """Random walk of white noise and nothing else over the true one, less one: value, low, high of each axis."""
    rng, rows = np.random.default_rng(11), []
    for _ in range(axes // 3):
        result = analyse_log(ImuLog(rng.standard_normal((samples, 3)) * 0.1, None, 100.0))
        rows += [axis.coefficients["random_walk"] for axis in result.axes]
    return np.array([(walk.value, walk.low, walk.high) for walk in rows]) / 0.01 - 1


def test_white_noise_alone_gives_no_other_term_a_share():
    """Of axes in which chance gives quantization something, N is the root mean square of the samples all the same."""
    samples = 4096
    signal = np.random.default_rng(4).standard_normal((samples, 6)) * 0.1
    axes = [axis for part in (signal[:, :3], signal[:, 3:]) for axis in analyse_log(ImuLog(part, None, 100.0)).axes]
    for axis, column in zip(axes, signal.T, strict=True):
        walk = axis.coefficients["random_walk"]
        shown = {term for term in TERMS if axis.coefficients[term] is not None}
        assert shown == {"random_walk"}
        # The ramp and the mean take a degree of freedom each.
        assert walk.value == pytest.approx(column.std(ddof=2) * 0.1, rel=1e-3)
        assert walk.low < walk.value / (1 + 1.96 / np.sqrt(2 * samples)) < walk.value < walk.high


@pytest.mark.slow
def test_white_noise_has_no_bias_and_is_missed_no_more_often_on_one_side():
    """252 axes. Without bias their mean lies within 2.6 of its standard errors in 99 % of such tests; 2.5 % of
    intervals may miss on either side, and more than 14 of them once in five hundred such tests."""
    walks = walks_of_white_noise(252, 36_000)
    mean, spread = walks[:, 0].mean(), walks[:, 0].std(ddof=1) / np.sqrt(len(walks))
    assert abs(mean) < 2.6 * spread
    assert spread < 3e-4
    assert np.count_nonzero(walks[:, 1] > 0) <= 14
    assert np.count_nonzero(walks[:, 2] < 0) <= 14


RUNS = {
    2: ([2.43, 2.59, 2.30], [0.38, 0.25, 0.34]),
    6: ([2.46, 2.61, 2.33], [0.38, 0.28, 0.35]),
}


@pytest.mark.parametrize("run", [2, pytest.param(6, marks=pytest.mark.slow)])
def test_adis16405_random_walks(shared_data: Path, run: int):
    log = read_log(shared_data / f"static_adis16405_run{run}_100hz_10000s.npz")
    axes = to_json(analyse_log(log))["axes"]
    expected = [*RUNS[run][0], *RUNS[run][1]]
    assert [axis["name"] for axis in axes[:4]] == ["gyro_x", "gyro_y", "gyro_z", "accelerometer_x"]
    np.testing.assert_allclose([axis["random_walk"]["value"] for axis in axes], expected, rtol=0.05)
    for axis in axes:
        assert axis["random_walk"]["low"] <= axis["random_walk"]["value"] <= axis["random_walk"]["high"]
        assert axis["random_walk"]["unit"] == ("°/√h" if axis["name"].startswith("gyro") else "m/s/√h")
    # A line near 0.6 Hz, of unknown cause, is in every accelerometer axis and must be named.
    for axis in axes[3:]:
        assert any(0.5 < line < 0.7 for line in axis["lines_hz"])
        assert any("vibration" in warning for warning in axis["warnings"])


def test_disturbed_ring_laser_log_gives_no_angle_random_walk(shared_data: Path):
    result = to_json(analyse_log(read_log(shared_data / "static_psins_lasergyro_100hz_1847s.npz")))
    for axis in result["axes"][:3]:
        assert axis["random_walk"] is None
        assert "disturb" in axis["not_resolved"]["random_walk"]
        assert any(warning.startswith("disturbed") for warning in axis["warnings"])


@pytest.mark.slow
def test_whole_size_log_fits_in_memory(shared_data: Path):
    """The 1,000,000 x 6 log read and analysed in a fresh process: peak resident size under 500 MB."""
    program = """
        import sys
        from pathlib import Path
        from nav_model.allan.log_file import read_log
        from nav_model.allan.static_log import analyse_log
        assert "scipy" not in sys.modules
        seen = []
        analyse_log(read_log(sys.argv[1]), progress=lambda fraction, what: seen.append(fraction))
        assert seen == sorted(seen) and seen[0] == 0.0 and seen[-1] == 1.0 and len(seen) == 7
        # VmHWM, not getrusage: that one also counts what the parent held when it forked.
        status = Path("/proc/self/status").read_text()
        print(int(status.split("VmHWM:")[1].split()[0]) / 1e3)
    """
    path = shared_data / "static_adis16405_run2_100hz_10000s.npz"
    run = subprocess.run(
        [sys.executable, "-c", textwrap.dedent(program), str(path)],
        capture_output=True,
        text=True,
        check=True,
        cwd=Path(__file__).resolve().parents[3],
    )
    assert float(run.stdout) < 500.0


def white(samples: int = 20_000, seed: int = 5) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal((samples, 3)) * 1e-3


def test_anti_alias_filter_hides_quantization_but_not_the_random_walk():
    """A two-point average (filtered sensor): the white level below is kept, the top of the band set aside."""
    noise = np.random.default_rng(1).standard_normal((100_003, 3))
    filtered = (noise[:-3] + noise[1:-2] + noise[2:-1] + noise[3:]) / 4.0
    axis = analyse_log(ImuLog(filtered, None, 100.0)).axes[0]
    walk = axis.coefficients["random_walk"]
    assert walk.value == pytest.approx(0.1, rel=0.05)
    assert axis.band_hz < 50.0
    assert "filter" in axis.not_resolved["quantization"]


@pytest.mark.parametrize("amplitude", [1e-3, 8e-5])
def test_vibration_line_is_named_and_left_out(amplitude: float):
    """The weaker one adds 8 % to the power of its bin and is known by its single coefficient only."""
    signal = white(100_000)
    time = np.arange(100_000) / 100.0
    signal[:, 0] += amplitude * np.sin(2 * np.pi * 17.3 * time)
    axis = analyse_log(ImuLog(signal, None, 100.0)).axes[0]
    assert axis.lines_hz == pytest.approx((17.3,), abs=0.01)
    walk = axis.coefficients["random_walk"]
    assert walk.low <= 1e-4 <= walk.high


def test_movement_at_low_frequency_refuses_the_random_walk():
    """A body swaying far above its own noise, as the ring-laser log: no random walk, with the reason."""
    from scipy.signal import butter, sosfilt

    rng = np.random.default_rng(8)
    sway = sosfilt(butter(6, 3.0, fs=100.0, output="sos"), rng.standard_normal((100_000, 3)), axis=0)
    axis = analyse_log(ImuLog(sway * 0.1 + white(100_000), None, 100.0)).axes[0]
    assert axis.coefficients["random_walk"] is None
    assert "disturb" in axis.not_resolved["random_walk"]


def test_burst_is_located():
    signal = white()
    signal[5000:5600] *= 3.0
    warnings = analyse_log(ImuLog(signal, None, 100.0)).axes[1].warnings
    assert any("disturbed: between 50 s" in warning or "disturbed: between 53 s" in warning for warning in warnings)
    assert not any("disturbed" in w for w in analyse_log(ImuLog(white(), None, 100.0)).axes[1].warnings)


def test_temperature_and_drift_are_warned_of():
    signal = white()
    temperature = np.linspace(20.0, 31.0, len(signal))
    signal[:, 2] += 1e-3 * temperature
    axes = analyse_log(ImuLog(signal, None, 100.0, temperature_c=temperature)).axes
    assert any(w.startswith("temperature (10.8") for w in axes[2].warnings)
    assert any("drifts steadily" in w for w in axes[2].warnings)
    assert not any("temperature" in w for w in axes[0].warnings)
    ramp = axes[2].coefficients["ramp"]
    assert ramp.low <= 1e-3 * 11.0 / 200.0 <= ramp.high


def test_falling_drift_keeps_its_sign():
    signal = white() - 1e-5 * np.arange(20_000)[:, None] / 100.0
    ramp = analyse_log(ImuLog(signal, None, 100.0)).axes[0].coefficients["ramp"]
    assert ramp.low <= -1e-5 <= ramp.high < 0.0


def test_wrong_unit_shows_in_the_means():
    force = white() + np.array([0.0, 0.0, 1.0])
    assert "not gravity" in analyse_log(ImuLog(None, force, 100.0)).warnings[0]
    still = white() + np.array([0.0, 0.0, 9.79])
    assert analyse_log(ImuLog(None, still, 100.0)).warnings == ()
    assert "turning" in analyse_log(ImuLog(white() + 0.2, None, 100.0)).warnings[0]


def test_constant_axis_is_unresolved_with_its_reason():
    signal = white()
    signal[:, 1] = 0.25
    result = analyse_log(ImuLog(signal, None, 100.0))
    stuck = to_json(result)["axes"][1]
    assert all(stuck[term] is None and "every sample is 0.25" in stuck["not_resolved"][term] for term in TERMS)
    assert result.axes[0].coefficients["random_walk"] is not None


@pytest.mark.parametrize("period", [2, 200, 10_000])
def test_a_log_that_repeats_itself_is_no_noise(period: int):
    """Its spectrum is empty between lines, which no likelihood of noise can be asked about."""
    signal = np.tile(np.round(white(period) * 1e5), (20_000 // period, 1))
    for axis in to_json(analyse_log(ImuLog(signal, None, 100.0)))["axes"]:
        assert all(axis[term] is None and "repeats itself" in axis["not_resolved"][term] for term in TERMS)
        assert "copied" in axis["would_resolve"]["random_walk"]
        assert axis["warnings"] == ["repeats itself exactly: a stretch copied behind itself, or a made-up signal"]


def test_samples_held_by_a_logger_are_still_noise():
    """A sensor slower than its logger: every value twice, white below the sensor's own band."""
    axis = analyse_log(ImuLog(np.repeat(white(10_000), 2, axis=0), None, 100.0)).axes[0]
    walk = axis.coefficients["random_walk"]
    assert walk.low <= 1e-3 * np.sqrt(2 / 100.0) <= walk.high
    coarse = analyse_log(ImuLog(np.repeat(white(100), 200, axis=0), None, 100.0)).axes[0]
    assert not any("repeats itself" in warning for warning in coarse.warnings)


def test_short_and_empty_logs_are_refused():
    with pytest.raises(ValueError, match="at least 512"):
        analyse_log(ImuLog(white(300), None, 100.0))
    with pytest.raises(ValueError, match="neither gyro nor accelerometer"):
        analyse_log(ImuLog(None, None, 100.0))


def test_fitted_lines_pass_through_the_measured_curve(simulate: Simulator):
    """Where the five terms rule, their sum lies within the curve's own 95 % limits, nearly everywhere."""
    signal = np.stack([simulate(s, 100_000, 0.01, 1e-6, 1e-4, 5e-5, 3e-5) for s in range(3)], axis=1)
    axis = analyse_log(ImuLog(signal, None, 100.0)).axes[0]
    lines = fitted_lines(axis, axis.deviation.tau_s)
    assert set(lines) >= {"random_walk", "total"}
    inside = (axis.deviation.low <= lines["total"]) & (lines["total"] <= axis.deviation.high)
    assert inside.mean() > 0.8


def test_triad_offers_one_value_to_the_design():
    gyro = white() * np.array([1.0, 2.0, 2.0])
    result = analyse_log(ImuLog(gyro, None, 100.0))
    offered = triad_coefficient(result, "gyro")
    assert offered.value == pytest.approx(1e-4 * np.sqrt(3.0), rel=0.01)
    assert offered.low < offered.value < offered.high
    assert triad_coefficient(result, "accelerometer") is None
