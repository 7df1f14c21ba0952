"""One flight: the paper's case by covariance, fixes of every kind, and what makes a run reproducible."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from nav_model.simulation.single_run import POSTERIOR, PRIOR, fly, fly_without_errors
from nav_model.simulation.specification import FilterModel, GnssModel, SimulationSpec, TrajectorySpec


@pytest.fixture
def paper(paper_imu) -> SimulationSpec:
    """[A]'s flight at 50 m/s, 45 deg, 3 km, with its outage from 400 s to 500 s."""
    return SimulationSpec(paper_imu, duration=500.0, outages=((400.0, 500.0),))


def test_the_papers_outage_by_covariance(paper):
    sigma = fly_without_errors(paper).filter_sigma[POSTERIOR, -1]
    assert sigma[0] == pytest.approx(47.4, rel=0.01)
    assert sigma[1] == pytest.approx(47.4, rel=0.01)
    assert sigma[2] == pytest.approx(0.907, rel=0.02)


def test_fixes_come_back_after_the_outage(paper):
    record = fly_without_errors(replace(paper, duration=510.0))
    assert record.filter_sigma[PRIOR, 500, 0] == record.filter_sigma[POSTERIOR, 500, 0]
    assert record.filter_sigma[PRIOR, 501, 0] > 40.0
    assert record.filter_sigma[POSTERIOR, 501, 0] < 1.0
    assert len(record.nis) == 510 - 100


def test_without_errors_the_ins_stays_on_the_path(paper):
    error = fly_without_errors(paper).error
    assert np.max(np.abs(error[..., :3])) < 1e-3
    assert np.max(np.abs(error[..., 6:9])) < math.radians(1e-6)


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
    assert record.nis_states == 6
    assert record.filter_sigma[POSTERIOR, -1, 8] < 0.7 * record.filter_sigma[POSTERIOR, 0, 8]
    assert np.mean(record.nees) == pytest.approx(15.0, rel=0.4)
    assert np.mean(record.nis) == pytest.approx(6.0, abs=4 * math.sqrt(12 / 300))


def test_a_filter_that_ignores_the_lever_arm_would_be_caught(make_imu):
    # The same flight, the arm's 3 m moved into the receiver's errors: position must shift by the arm.
    imu = make_imu(0.01, 0.01)
    near = SimulationSpec(imu, GnssModel(position_noise=0.01), TrajectorySpec("straight"), duration=60.0)
    far = replace(near, gnss=GnssModel(position_noise=0.01, lever_arm=(3.0, 0.0, 0.0)))
    assert np.max(np.abs(fly(far, 0).error[POSTERIOR, -1, :3])) < 0.05


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"runs": 0}, "runs"),
        ({"seed": -1}, "seed"),
        ({"duration": math.nan}, "duration"),
        ({"outages": ((5.0, 2.0),)}, "outages"),
        ({"outages": ((5.0, 20.0), (10.0, 30.0))}, "outages"),
        ({"every": 1000.0}, "every"),
        ({"every": 0.001}, "every"),
        ({"gnss": GnssModel(interval=0.001)}, "interval"),
    ],
)
def test_studies_that_cannot_be_flown_are_refused(paper, change, named):
    with pytest.raises(ValueError, match=named):
        replace(paper, **change)
    with pytest.raises(ValueError, match="states"):
        FilterModel(states=12)
