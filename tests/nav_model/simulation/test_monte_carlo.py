"""Many runs: reproducible, right against closed forms, and with a correct consistency verdict."""

import math
import tracemalloc
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from nav_model.design import Design
from nav_model.simulation.departures import chain, departures
from nav_model.simulation.design_study import closed_form
from nav_model.simulation.monte_carlo import chunks, run_chunk, simulate
from nav_model.simulation.result import to_arrays
from nav_model.simulation.single_run import POSTERIOR, fly
from nav_model.simulation.specification import FilterModel, GnssModel, SimulationSpec, TrajectorySpec

pytestmark = pytest.mark.long

G = 9.80665
PAPER = Design({"flight.speed": 50.0})  # 0.05 m/s/√h, 0.5 °/√h, 1 m at 1 Hz are the defaults


@pytest.fixture
def short(paper_imu) -> SimulationSpec:
    """Small chunks of a quick study with an outage."""
    return SimulationSpec(paper_imu, runs=80, duration=60.0, outages=((40.0, 60.0),), every=2.0, keep_runs=True)


def test_the_sum_is_the_runs_one_by_one(short):
    result = simulate(short)
    records = [fly(short, run) for run in range(short.runs)]
    errors = np.stack([record.error for record in records])
    assert result.rms == pytest.approx(np.sqrt(np.mean(errors**2, axis=0)), rel=1e-12)
    assert result.mean == pytest.approx(np.mean(errors, axis=0), abs=1e-12)
    assert np.array_equal(result.run_errors, errors[:, POSTERIOR])
    sigma = np.stack([record.filter_sigma for record in records])
    assert result.filter_sigma == pytest.approx(np.sqrt(np.mean(sigma**2, axis=0)), rel=1e-12)
    assert result.nees.mean == pytest.approx(np.mean([record.nees for record in records]), rel=1e-12)
    assert result.nis.mean == pytest.approx(np.mean([record.nis for record in records]), rel=1e-12)
    furthest = np.max(np.hypot(errors[:, POSTERIOR, :, 0], errors[:, POSTERIOR, :, 1]), axis=1)
    assert result.worst.run == int(np.argmax(furthest))
    assert np.array_equal(result.worst.error, records[result.worst.run].error)


def test_percentiles_from_the_histogram_match_the_sorted_errors(short):
    result = simulate(replace(short, runs=400, duration=20.0, outages=()))
    for percent in (50.0, 90.0, 95.0):
        exact = np.percentile(np.abs(result.run_errors), percent, axis=0)
        assert result.percentiles[percent] == pytest.approx(exact, rel=0.05)


def test_the_result_is_the_same_bits_whatever_flies_the_runs(short):
    assert len(chunks(replace(short, runs=200))) > 2
    spec = replace(short, runs=200)
    reference = to_arrays(simulate(spec))
    with ThreadPoolExecutor(2) as pool:
        threads = to_arrays(simulate(spec, pool=pool, workers=2))
    processes = to_arrays(simulate(spec, workers=2))
    for name, values in reference.items():
        assert np.array_equal(values, threads[name]), name
        assert np.array_equal(values, processes[name]), name


def test_progress_counts_every_run(short):
    spec, seen = replace(short, runs=300, duration=20.0, outages=()), []
    simulate(spec, workers=1, progress=lambda done, total: seen.append((done, total)))
    assert seen[-1] == (300, 300)
    assert [done for done, _ in seen] == sorted({done for done, _ in seen})
    with pytest.raises(ValueError, match="workers"):
        simulate(spec, workers=0)


def test_memory_does_not_grow_with_the_runs(short):
    spec = replace(short, duration=10.0, outages=(), every=0.1, keep_runs=False)
    simulate(spec)
    peaks = []
    for runs in (64, 320):
        tracemalloc.start()
        simulate(replace(spec, runs=runs))
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 1.2 * peaks[0]


def check_against_closed_form(spec: SimulationSpec) -> float:
    """The largest deviation of a ratio from one that was seen."""
    result = simulate(spec, closed_form=closed_form(PAPER, spec))
    low, high = (1 - 4 / math.sqrt(2 * spec.runs), 1 + 4 / math.sqrt(2 * spec.runs))
    # Cycle rms just before the outage: four points a cycle over ten cycles, prior and posterior at the fix.
    cycle = (result.time_s > 390.0) & (result.time_s <= 400.0)
    simulated = np.sqrt(np.mean(result.rms[:, cycle] ** 2, axis=(0, 1)))
    ratio = simulated / result.closed_form_sigma[cycle][0]
    assert np.all((ratio[:8] > low) & (ratio[:8] < high))
    seen = [np.abs(ratio[:8] - 1).max()]
    # In the outage: horizontal position and velocity, and tilt, throughout; vertical up to 45 s [T-17].
    for after in (10.0, 20.0, 45.0, 100.0):
        row = int(np.argmin(np.abs(result.time_s - 400.0 - after)))
        ratio = result.rms[POSTERIOR, row] / result.closed_form_sigma[row]
        columns = [0, 1, 3, 4, 6, 7] + ([2, 5] if after <= 45.0 else [])
        assert np.all((ratio[columns] > low) & (ratio[columns] < high)), after
        seen.append(np.abs(ratio[columns] - 1).max())
    differences = departures(result, chain(PAPER, spec))
    assert not any(d.group == "position" and d.axis == "north" and d.start_s > 400.0 for d in differences)
    assert all(d.reason for d in differences)
    share = result.tilt_share_m[-1, 0] / result.closed_form_sigma[-1, 0]
    assert share == pytest.approx(0.5 * G * math.radians(0.0351388 * 0.986) * 100.0**2 / 48.014, rel=high - 1)
    return float(max(seen))


def test_a_few_runs_of_the_papers_case_agree_with_the_closed_form(paper_imu, compared):
    spec = SimulationSpec(paper_imu, runs=40, every=0.25, outages=((400.0, 500.0),), seed=11)
    compared(
        "Steady state and outage to 100 s by formula",
        "T-9",
        "our own derivation",
        "40 Monte Carlo runs of our own simulator",
        check_against_closed_form(spec),
        4 / math.sqrt(80),
        "largest ratio − 1; four standard errors allowed",
    )


@pytest.mark.slow
def test_two_hundred_runs_of_the_papers_case_agree_with_the_closed_form(paper_imu):
    check_against_closed_form(SimulationSpec(paper_imu, runs=200, every=0.25, outages=((400.0, 500.0),), seed=12))


FIVE_DESIGNS = {
    "paper": ((0.5, 0.05), GnssModel(), 9),
    "consumer MEMS": ((0.3, 0.1, 10.0, 0.05), GnssModel(), 15),
    "industrial MEMS": (
        (0.15, 0.06, 5.0, 0.02),
        GnssModel(position_noise=0.5, interval=0.5, lever_arm=(1, 0.5, -1)),
        15,
    ),
    "MEMS with RTK": (
        (0.06, 0.06, 25.0, 0.6, 1000.0, 14400.0),
        GnssModel(position_noise=0.02, velocity_noise=0.02, lever_arm=(1, 0.5, -1)),
        15,
    ),
    "tactical": ((0.02, 0.02, 0.0, 0.0, 1e3, 1e3, 1.0, 0.3), GnssModel(), 15),
}
TWO_KINDS = (0.15, 0.06, 5.0, 0.05, 100.0, 100.0, 10.0, 0.3)
"""A MEMS unit with a turn-on bias and a Gauss-Markov one on top."""


def study(make_imu, name: str, runs: int, duration: float, scale: float = 1.0) -> SimulationSpec:
    sensors, gnss, states = FIVE_DESIGNS[name]
    return SimulationSpec(
        make_imu(*sensors),
        gnss,
        TrajectorySpec("wandering"),
        FilterModel(states=states, process_noise_scale=scale),
        runs=runs,
        duration=duration,
        every=2.0,
        seed=20,
    )


PLAINEST_AND_FULLEST = [(name, 60, 200.0) for name in ("paper", "MEMS with RTK")]
ALL_WITH_MORE_RUNS = [pytest.param(name, 200, 400.0, marks=pytest.mark.slow) for name in FIVE_DESIGNS]


@pytest.mark.parametrize(("name", "runs", "duration"), [*PLAINEST_AND_FULLEST, *ALL_WITH_MORE_RUNS])
def test_the_filter_is_consistent_and_half_the_process_noise_is_caught(make_imu, name, runs, duration):
    matched = simulate(study(make_imu, name, runs, duration))
    assert matched.consistent, matched.verdict
    assert matched.verdict.startswith("consistent: NEES")
    assert matched.nis.inside
    assert simulate(study(make_imu, name, runs, duration, math.sqrt(0.5))).verdict.startswith("optimistic")


def two_kinds(make_imu, states: int, runs: int, duration: float) -> SimulationSpec:
    return replace(
        study(make_imu, "industrial MEMS", runs, duration),
        imu=make_imu(*TWO_KINDS),
        filter=FilterModel(states=states),
    )


def test_two_kinds_of_bias_are_consistent_in_a_state_each_and_pessimistic_in_one(make_imu):
    apart = simulate(two_kinds(make_imu, 21, 60, 300.0))
    assert apart.consistent, apart.verdict
    assert apart.nees.states == 21
    assert apart.nis.inside
    together = simulate(two_kinds(make_imu, 15, 60, 300.0))
    assert together.verdict.startswith("pessimistic"), together.verdict
    # Pessimistic, not wild: what one state cannot tell apart it holds for less known than it is.
    assert together.nees.mean > 12.0


@pytest.mark.slow
def test_two_hundred_runs_with_two_kinds_of_bias_are_consistent(make_imu):
    result = simulate(two_kinds(make_imu, 21, 200, 600.0))
    assert result.consistent, result.verdict


@pytest.mark.parametrize("states", [15, 21])
def test_states_of_biases_that_are_not_there_leave_the_verdict_alone(make_imu, states):
    """Known to be zero, they must count as known: neither optimistic nor pessimistic."""
    result = simulate(replace(study(make_imu, "paper", 60, 200.0), filter=FilterModel(states=states)))
    assert result.consistent, result.verdict


def test_the_nees_band_holds_its_probability():
    """The band of the mean over correlated times, for filters known to be consistent: 95 % of 400 studies inside."""
    from nav_model.simulation.result import nees_consistency

    generator, inside = np.random.default_rng(5), 0
    for _ in range(400):
        # Nine states, 60 runs, 50 times; errors a Gauss-Markov sequence of ten steps' correlation time.
        decay = math.exp(-0.1)
        error = generator.standard_normal((60, 9))
        nees = np.zeros((50, 60))
        for k in range(50):
            nees[k] = np.sum(error**2, axis=1)
            error = decay * error + math.sqrt(1 - decay**2) * generator.standard_normal((60, 9))
        means = nees.mean(axis=0)
        inside += nees_consistency(float(means.mean()), float(np.mean(means**2)), 60, 50, 9).inside
    assert 0.95 - 4 * math.sqrt(0.95 * 0.05 / 400) < inside / 400 < 0.95 + 4 * math.sqrt(0.95 * 0.05 / 400)


def test_a_run_that_arrives_twice_is_found(short):
    scale = np.ones((31, 9))
    statistics = run_chunk(short, scale, 0, 2)
    with pytest.raises(RuntimeError, match="arrived twice"):
        statistics.merge(run_chunk(short, scale, 1, 2))
