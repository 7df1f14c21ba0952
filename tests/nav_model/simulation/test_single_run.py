"""One flight: the paper's case by covariance, fixes of every kind, and what makes a run reproducible."""

import math
from dataclasses import replace

import numpy as np
import pytest

from nav_model.simulation.monte_carlo import simulate
from nav_model.simulation.single_run import POSTERIOR, PRIOR, fly, fly_without_errors
from nav_model.simulation.specification import (
    Aids,
    FilterModel,
    GnssModel,
    InitialSigma,
    SimulationSpec,
    TrajectorySpec,
)


@pytest.fixture
def paper(paper_imu) -> SimulationSpec:
    """[A]'s flight at 50 m/s, 45 deg, 3 km, with its outage from 400 s to 500 s."""
    return SimulationSpec(paper_imu, duration=500.0, outages=((400.0, 500.0),))


def test_fixes_come_back_after_the_outage(paper):
    record = fly_without_errors(replace(paper, duration=510.0))
    assert record.filter_sigma[PRIOR, 500, 0] == record.filter_sigma[POSTERIOR, 500, 0]
    assert record.filter_sigma[PRIOR, 501, 0] > 40.0
    assert record.filter_sigma[POSTERIOR, 501, 0] < 1.0
    assert len(record.nis) == 510 - 100


def test_a_run_depends_on_seed_and_run_number_alone(paper):
    short = replace(paper, duration=50.0, outages=())
    first = fly(short, 7)
    fly(short, 3)
    fly(replace(short, seed=2), 7)
    again = fly(short, 7)
    assert np.array_equal(first.error, again.error)
    assert np.array_equal(first.nis, again.nis)
    assert not np.array_equal(first.error, fly(short, 8).error)
    assert not np.array_equal(first.error, fly(replace(short, seed=2), 7).error)


def test_receiver_settings_leave_the_imu_noise_as_it_was(paper):
    # Common random numbers: two designs compared on one seed differ by the design, not by the draw.
    short = replace(paper, duration=20.0, outages=((0.0, 20.0),))
    other = replace(short, gnss=GnssModel(position_noise=5.0, markov_noise=1.0, velocity_noise=0.1))
    assert np.array_equal(fly(short, 1).error, fly(other, 1).error)


def test_velocity_fixes_and_a_lever_arm_make_yaw_observable_in_turns(make_imu):
    imu = make_imu(0.1, 0.05, gyro=2.0, accelerometer=0.1)
    spec = SimulationSpec(
        imu,
        GnssModel(position_noise=0.5, velocity_noise=0.03, lever_arm=(1.0, -0.5, 0.8)),
        TrajectorySpec("turns", speed=80.0),
        FilterModel(states=15),
        duration=300.0,
    )
    record = fly(spec, 0)
    assert record.measured == 6 * 300
    assert record.filter_sigma[POSTERIOR, -1, 8] < 0.7 * record.filter_sigma[POSTERIOR, 0, 8]
    assert np.mean(record.nees) == pytest.approx(15.0, rel=0.4)
    assert np.mean(record.nis) == pytest.approx(6.0, abs=4 * math.sqrt(12 / 300))


def test_a_long_lever_arm_is_handled_consistently_through_turns(make_imu):
    # 20 m of arm and 0.5 deg of yaw are 17 cm against 2 cm fixes, and the gyro's noise alone swings the arm
    # by 6 mm/s: any slip in the arm's part shows.
    spec = SimulationSpec(
        make_imu(0.1, 0.05),
        GnssModel(position_noise=0.02, velocity_noise=0.02, lever_arm=(20.0, -5.0, 8.0)),
        TrajectorySpec("turns", speed=80.0),
        initial=InitialSigma(yaw=math.radians(0.5)),
        duration=180.0,
        runs=20,
    )
    result = simulate(spec)
    assert result.consistent, result.verdict
    assert result.nis.mean == pytest.approx(6.0, rel=0.03)
    assert np.degrees(result.filter_sigma[POSTERIOR, -1, 8]) < 0.2


def test_heading_and_height_come_with_the_fixes_and_height_alone_in_an_outage(make_imu):
    spec = SimulationSpec(
        make_imu(0.1, 0.05),
        aiding=Aids(heading_noise=math.radians(0.05), barometer_noise=0.5),
        trajectory=TrajectorySpec("turns", speed=80.0, heading=math.radians(175.0)),  # through 180°
        initial=InitialSigma(yaw=math.radians(1.0)),
        duration=240.0,
        outages=((180.0, 240.0),),
        runs=20,
    )
    result = simulate(spec)
    assert result.consistent, result.verdict
    assert result.nis.states == (5 * 180 + 60) / 240
    assert result.nis.mean == pytest.approx(result.nis.states, rel=0.03)
    assert np.degrees(result.rms[POSTERIOR, 180, 8]) < 0.05
    assert result.rms[POSTERIOR, -1, 2] < 0.3 < 3.0 < result.rms[POSTERIOR, -1, 0]


def test_gauss_markov_fix_noise_has_its_sigma_and_correlation_time(make_imu):
    # An INS this poor follows its 1 cm white fixes, so its error is the correlated noise they carry.
    gnss = GnssModel(position_noise=0.01, markov_noise=1.0, vertical_markov_noise=2.0, markov_time=10.0)
    spec = SimulationSpec(make_imu(5.0, 50.0), gnss, duration=4000.0)
    error = fly(spec, 0).error[POSTERIOR, 100:, :3] / [1.0, 1.0, 2.0]
    # 3900 s are 195 independent values (2 tau apart) per axis.
    assert np.var(error) == pytest.approx(1.0, rel=4 * math.sqrt(2 / 585))
    assert np.mean(error[10:] * error[:-10]) / np.var(error) == pytest.approx(math.exp(-1.0), abs=0.15)
