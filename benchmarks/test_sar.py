"""Costs of the SAR model, against the targets of its issue and beside named ways of doing the same.

Times are of the processor (all threads), so a busy machine does not blur them; nothing here fails on a clock. Each
``times_over`` is how many times as long the alternative takes for the same work.
"""

import time

import numpy as np
import pytest
from made_history import simulate_phase_history
from scipy.linalg import solve_discrete_are

from nav_model.analytic.discrete import SlowError, cycle
from nav_model.aperture.impulse_response import aperture_positions, impulse_response
from nav_model.aperture.polynomial_response import quadratic_response
from nav_model.base.constants import SPEED_OF_LIGHT
from nav_model.budget import analyse
from nav_model.design import Design
from nav_model.sar.axis_model import AxisModel, inertial_drift
from nav_model.sar.decomposition import decompose, run_responses
from nav_model.sar.design_case import design_case
from nav_model.sar.design_study import image_study, run_chunk
from nav_model.sar.fast_engine import simulate_axis
from nav_model.sar.image import back_project
from nav_model.sar.line_of_sight import ApertureGeometry, range_error
from nav_model.sar.strategies import Tuning
from nav_model.sar.winners import Conditions, map_of_winners

SIGMA_A, SIGMA_W, G = 0.05 / 60, np.radians(0.5) / 60, 9.80665
HORIZONTAL = AxisModel(SIGMA_A, SIGMA_W, 1.0, 1.0)
VERTICAL = AxisModel(SIGMA_A, SIGMA_W, 1.0, 1.0, horizontal=False)


def cpu(call, repeats=3):
    """Seconds of processor, the best of a few."""
    best = np.inf
    for _ in range(repeats):
        start = time.process_time()
        call()
        best = min(best, time.process_time() - start)
    return best


@pytest.mark.parametrize("window", ["uniform", "taylor"])
def test_impulse_response(benchmark, window):
    """Beside the zero-padded transform (x64) of 1024 samples."""
    aperture = np.exp(1j * np.pi / 2 * aperture_positions(1024) ** 2)
    quadratic_response(1.5, window)
    benchmark(quadratic_response, np.pi / 2, window)
    fast = cpu(lambda: [quadratic_response(np.pi / 2, window) for _ in range(50)]) / 50
    full = cpu(lambda: impulse_response(aperture, window))
    benchmark.extra_info.update(cpu_s=fast, beside="zero-padded FFT", times_over=full / fast)


def by_textbook(runs, time_s=20.0, rate=100.0):
    """A Kalman filter and a free INS of one axis as a textbook writes them: run by run, a prediction a sample."""
    random = np.random.default_rng(1)
    phi, noise = inertial_drift(HORIZONTAL, 1 / rate)
    root = np.linalg.cholesky(noise + 1e-24 * np.eye(3))
    row = np.array([[1.0, 0.0, 0.0]])
    for _ in range(runs):
        truth, state, ins, covariance = np.zeros(3), np.zeros(3), np.zeros(3), np.eye(3) * 1e-2
        for sample in range(round(time_s * rate)):
            truth = phi @ truth + root @ random.standard_normal(3)
            state, ins = phi @ state, phi @ ins
            covariance = phi @ covariance @ phi.T + noise
            if sample % round(rate) == 0:
                innovation = truth[0] + random.standard_normal() - state[0]
                gain = covariance @ row.T / (row @ covariance @ row.T + 1.0)
                state = state + gain[:, 0] * innovation
                covariance = (np.eye(3) - gain @ row) @ covariance


def test_nine_strategies_500_seeds_line_of_sight_with_decomposition(benchmark):
    """Three axes, 20 s at 100 Hz; beside the filter and the INS alone, in NumPy, run by run."""
    geometry = ApertureGeometry(10e3, 100.0, 0.6)

    def whole():
        along, across, down = (
            simulate_axis(model, 20.0, 100.0, 500, seed)
            for seed, model in enumerate((HORIZONTAL, HORIZONTAL, VERTICAL))
        )
        error = range_error(geometry, along.time, along.error, across.error, down.error)
        return decompose(error, 2)

    benchmark.pedantic(whole, rounds=2, warmup_rounds=1)
    cost = cpu(whole)
    one_axis = cpu(lambda: simulate_axis(HORIZONTAL, 20.0, 100.0, 500))
    textbook = cpu(lambda: by_textbook(2), 2) * 250 * 3
    benchmark.extra_info.update(
        target_s=2.0, cpu_s=cost, one_axis_cpu_s=one_axis, beside="NumPy, run by run, strategies 2 and 4 only",
        times_over=textbook / cost,
    )  # fmt: skip


def test_impulse_responses_of_nine_strategies_500_seeds(benchmark):
    """Beside the responses of full precision (x64)."""
    phase = 4 * np.pi / 0.031 * simulate_axis(HORIZONTAL, 20.0, 100.0, 500).error
    benchmark.pedantic(run_responses, args=(phase, "taylor"), rounds=1)
    cost = cpu(lambda: run_responses(phase, "taylor"), 1)
    apertures = np.exp(1j * phase[1, :20, :1024])
    full = cpu(lambda: impulse_response(apertures, "taylor"), 1) * 9 * 25
    benchmark.extra_info.update(responses=9 * 500, cpu_s=cost, beside="zero-padded FFT x64", times_over=full / cost)


@pytest.mark.parametrize("slow", [None, SlowError(1.0, 1.0, 300.0)], ids=["white", "slow"])
@pytest.mark.parametrize("squint", [0.0, 0.5])
def test_map_of_winners_100_by_100(benchmark, slow, squint):
    """With the settled filter of every fix noise; beside SciPy's Riccati solver for those alone, point by point."""
    spans, noise = np.geomspace(2.5, 60, 100)[None], np.geomspace(0.005, 5, 100)[:, None]

    def whole():
        settled = cycle(SIGMA_A, SIGMA_W, G, 1.0, noise, noise, slow)
        return map_of_winners(
            Conditions(
                spans, noise, 1.0, SIGMA_A, SIGMA_W, settled.posterior.horizontal, grazing_angle=0.6,
                start_vertical=settled.posterior.vertical, slow=slow, slow_with_tilt=settled.slow_with_tilt,
                turn_rate=0.01, squint_angle=squint, coast_time=30.0,
            )
        )  # fmt: skip

    phi, q = inertial_drift(HORIZONTAL, 1.0)
    benchmark(whole)
    cost = cpu(whole)
    riccati = cpu(lambda: [solve_discrete_are(phi.T, np.eye(3)[:, :1], q, np.eye(1)) for _ in range(100)])
    benchmark.extra_info.update(
        target_s=0.1, cpu_s=cost, beside="SciPy solve_discrete_are, 100 fix noises", times_over=riccati / cost
    )


def by_numpy(history, axis):
    """Back-projection as in Gorham and Moore (2010): pulse by pulse, range profile interpolated at every pixel."""
    samples, pulses = history.samples.shape
    bins = 4096
    x, y = np.meshgrid(axis, axis)
    step = history.unambiguous_range / bins
    place = (np.arange(bins) - bins // 2) * step
    image = np.zeros(x.shape, complex)
    for p in range(pulses):
        profile = np.fft.fftshift(np.fft.ifft(history.samples[:, p], bins))
        px, py, pz = history.position[p]
        beyond = np.sqrt((x - px) ** 2 + (y - py) ** 2 + pz**2) - history.reference_range[p]
        value = np.interp(beyond, place, profile.real) + 1j * np.interp(beyond, place, profile.imag)
        image += value * np.exp(4j * np.pi * history.frequency[0] / SPEED_OF_LIGHT * beyond)
    return image / pulses * bins / samples


def test_image_256_by_256(benchmark):
    """512 pulses; beside back-projection in NumPy after Gorham and Moore (2010), which must give the same image."""
    history = simulate_phase_history(
        ApertureGeometry(6000.0, 100.0, 0.6),
        np.linspace(-1, 1, 512),
        9.6e9 + np.linspace(-75e6, 75e6, 256),
        [[0.0, 0.0, 0.0], [10.0, 5.0, 0.0]],
    )
    axis = np.linspace(-40, 40, 256)
    back_project(history, axis[:2], axis[:2])
    benchmark.pedantic(back_project, args=(history, axis, axis), rounds=2)
    cost = cpu(lambda: back_project(history, axis, axis), 2)
    other = cpu(lambda: by_numpy(history, axis), 1)
    np.testing.assert_allclose(np.abs(by_numpy(history, axis)), np.abs(back_project(history, axis, axis)), atol=0.03)
    benchmark.extra_info.update(
        target_s=2.0, cpu_s=cost, beside="NumPy, Gorham and Moore 2010", times_over=other / cost
    )


def test_whole_study_500_runs_with_impulse_responses(benchmark):
    design = Design({"radar.aperture_time": 20.0, "coast.before_aperture": 100.0, "radar.window": "taylor"})
    benchmark.pedantic(image_study, args=(design, 500), rounds=1)
    benchmark.extra_info["cpu_s"] = cpu(lambda: image_study(design, 500), 1)


def test_flights_of_the_simulator(benchmark):
    """Ten flights under every strategy, of 20 s aperture at 100 Hz, beside ten runs of the error model."""
    budget = analyse(Design({"radar.aperture_time": 20.0}))
    flown, fast = (design_case(budget, engine) for engine in ("simulator", "fast"))
    run_chunk(flown, Tuning(), 1, 0, 1)  # compiles
    benchmark.pedantic(run_chunk, args=(flown, Tuning(), 1, 1, 10), rounds=1)
    cost = cpu(lambda: run_chunk(flown, Tuning(), 1, 2, 10), 1)
    other = cpu(lambda: run_chunk(fast, Tuning(), 1, 2, 10), 1)
    benchmark.extra_info.update(
        cpu_s_a_flight=cost / 10, settles_s=flown.flight.start, beside="the error model", times_over=other / cost
    )
