"""Full flights under the strategies: against the per-axis model, SciPy's Riccati solver and themselves."""

from dataclasses import replace

import numpy as np
import pytest
import riccati

from nav_model.base.errors import InputError
from nav_model.budget import analyse
from nav_model.design import Design
from nav_model.sar.agreement import agreement, agreement_sentence
from nav_model.sar.decomposition import decompose
from nav_model.sar.design_case import design_case
from nav_model.sar.design_study import chunks, image_study, run_chunk
from nav_model.sar.flown_engine import flight_of, histories
from nav_model.sar.strategies import STRATEGY_KEYS, Tuning
from nav_model.sar.study_json import to_json

pytestmark = pytest.mark.long

DEG = np.pi / 180
X_BAND = {
    "imu.velocity_random_walk": 0.07 / 60,
    "imu.angle_random_walk": 0.15 * DEG / 60,
    "gnss.position_noise": 0.05,
    "gnss.vertical_position_noise": 0.1,
    "flight.speed": 90.0,
    "flight.heading": 1.0,
    "radar.slant_range": 7000.0,
    "radar.grazing_angle": 0.6,
    "radar.aperture_time": 6.3,
    "coast.before_aperture": 10.0,
}
RUNS = 80


@pytest.fixture(scope="module")
def case():
    return design_case(analyse(Design(X_BAND)), "simulator")


@pytest.fixture(scope="module")
def flown(case):
    return histories(case.flight, case.aperture_time, case.rate, 5, 0, RUNS)


def root(values):
    return np.sqrt(np.mean(values**2))


def test_the_filter_is_the_settled_one(case, flown):
    """At the fixes: SciPy's solution of the channel's Riccati equation; jumps, and errors of the fixes themselves."""
    channel = riccati.channel(0.07 / 60, 0.15 * DEG / 60, 9.80665)
    prior, posterior = riccati.settled(*riccati.van_loan(*channel, 1.0), np.eye(3)[:1], 0.05**2)
    innovation = prior[0, 0] + 0.05**2
    for axis in flown[:2]:
        assert len(axis.fix_time) == 7
        at = np.searchsorted(axis.time, axis.fix_time - 1e-9)
        assert root(axis.filter_position[:, at]) == pytest.approx(np.sqrt(posterior[0, 0]), rel=0.12)
        assert root(axis.filter_correction[:, 1:]) == pytest.approx(prior[0, 0] / np.sqrt(innovation), rel=0.12)
        assert root(axis.gnss_error) == pytest.approx(0.05, rel=0.12)
        assert not axis.filter_correction[:, 0].any()
    assert root(flown[2].gnss_error) == pytest.approx(0.1, rel=0.12)


def test_free_flights_leave_the_filter_at_their_last_fix(flown):
    for axis in flown:
        np.testing.assert_allclose(axis.ins_position[:, 0], axis.filter_position[:, 0], atol=1e-12)
        # The same instrument noise: until the first fix in the aperture nothing parts them.
        early = axis.time < 0.99
        np.testing.assert_allclose(axis.ins_position[:, early], axis.filter_position[:, early], atol=1e-9)
        late = axis.time > 1.05
        assert root((axis.ins_position - axis.filter_position)[:, late]) > 1e-3
        assert root(axis.coasted_position[:, 0]) > 3 * root(axis.ins_position[:, 0]) or axis is flown[2]


def test_the_smoother_is_better_everywhere_and_without_jumps(flown):
    for axis in flown:
        inside = axis.time < axis.fix_time[-1] - 1.0
        assert root(axis.smoothed_position[:, inside]) < 0.9 * root(axis.filter_position[:, inside])
        step = np.abs(np.diff(axis.smoothed_position[:, inside], axis=1))
        assert step.max() < 0.2 * np.abs(axis.filter_correction).max()
        at_end = np.searchsorted(axis.time, axis.fix_time[-1])
        np.testing.assert_allclose(axis.smoothed_position[:, at_end], axis.filter_position[:, at_end], atol=1e-9)


def test_the_smoother_smooths_what_its_equations_say(flown):
    """No correction of the smoother is left to find: its error is independent of what it took off the filter."""
    for axis in flown:
        middle = len(axis.time) // 2
        taken = (axis.filter_position - axis.smoothed_position)[:, middle]
        error = axis.smoothed_position[:, middle]
        assert abs(np.corrcoef(taken, error)[0, 1]) < 4 / np.sqrt(RUNS)


@pytest.mark.slow
def test_engines_agree_over_many_flights():
    """Six hundred flights: every strategy within three standard errors, which are 4 % or less."""
    design = Design(X_BAND)
    agreements = agreement(image_study(design, 600, 2, engine="simulator"), image_study(design, 2000, 2))
    assert all(each.agrees for each in agreements), agreements
    assert all(each.error < 0.045 for each in agreements)


def test_engines_agree_and_the_document_says_so(compared):
    design = Design(X_BAND | {"radar.aperture_time": 4.0})
    flown, fast = image_study(design, 60, 3, engine="simulator"), image_study(design, 400, 3)
    agreements = agreement(flown, fast)
    assert [each.key for each in agreements] == list(STRATEGY_KEYS[1:])
    compared(
        "Residuals of nine strategies, error model",
        "T-15",
        "our own derivation",
        "60 full flights of our own simulator",
        [(each.ratio - 1) / each.error for each in agreements],
        4.0,
        "largest difference, standard errors",
    )
    assert all(each.error < 0.15 for each in agreements)
    data = to_json(flown, fast)
    assert data["engine"] == "simulator"
    assert data["agreement"]["with"] == {"engine": "fast", "runs": 400, "seed": 3}
    assert data["agreement"]["strategies"][0]["ratio"] == agreements[0].ratio
    assert any("WGS 84" in sentence for sentence in data["cautions"])
    assert "agreement" not in to_json(fast)
    apart = (agreements[0]._replace(ratio=1.5, error=0.05), *agreements[1:])
    assert "differ by more than three standard errors" in agreement_sentence(apart)
    assert "INS from filter +50 % ± 5 %" in agreement_sentence(apart)


def test_a_chunk_is_the_same_whoever_flies_it(case):
    first, again, other = (run_chunk(case, Tuning(), 7, index, 2) for index in (1, 1, 2))
    np.testing.assert_array_equal(first.square, again.square)
    assert np.abs(first.square - other.square).max() > 0
    direct = histories(case.flight, case.aperture_time, case.rate, 7, 10, 2)
    assert decompose(direct[0].ins_position).detrended_rms.shape == (2,)
    assert chunks(25, "simulator") == [10, 10, 5]


def test_fixes_that_fall_between_the_instruments_samples():
    design = Design(X_BAND | {"gnss.interval": 0.37, "radar.aperture_time": 2.0, "coast.before_aperture": 0.0})
    flight = flight_of(design, 2.0, 0.0)
    assert flight.coasted is None
    axis = histories(flight, 2.0, 128.0, 1, 0, 3)[0]
    assert len(axis.fix_time) == 6
    assert np.abs(axis.fix_time - 0.37 * np.arange(6)).max() < 0.011
    assert len(axis.time) == 257
    np.testing.assert_array_equal(axis.coasted_position, axis.ins_position)


def test_a_slow_error_of_the_fixes_and_a_bias_are_flown():
    slow = {"gnss.correlated": True, "gnss.correlated_noise": 3.0, "gnss.correlation_time": 1e4}
    design = Design(X_BAND | slow | {"imu.accelerometer_bias": 1e-4})
    axis = histories(flight_of(design, 3.0, 0.0), 3.0, 100.0, 1, 0, 30)[0]
    assert 2.0 < root(axis.gnss_error) < 4.2
    assert np.abs(np.diff(axis.gnss_error, axis=1)).max() < 0.5


def test_too_long_a_flight_is_refused_by_key():
    slow = Design(X_BAND | {"imu.velocity_random_walk": 1e-7, "gnss.position_noise": 5.0, "imu.rate": 2000.0})
    with pytest.raises(InputError, match=r"imu\.rate.*settles"):
        flight_of(slow, 6.0, 0.0)
    case = design_case(analyse(Design(X_BAND)), "simulator")
    assert case.engine == "simulator"
    assert replace(case, flight=None) == design_case(analyse(Design(X_BAND)))
