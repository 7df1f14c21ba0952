"""Requirements: figure, confidence, margin and responsible sensor."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nav_model.budget import analyse
from nav_model.design import Design

FIGURES = {  # requirement -> the figure it is held against, written independently of the code
    "quadratic_phase": lambda b: b["quadratic_phase", "real time"].sigma,
    "detrended_phase": lambda b: b["detrended_phase", "real time"].sigma,
    "horizontal_position": lambda b: b.steady_state.prior["horizontal_position"],
    "vertical_position": lambda b: b.steady_state.prior["vertical_position"],
    "horizontal_velocity": lambda b: b.steady_state.prior["horizontal_velocity"],
    "vertical_velocity": lambda b: b.steady_state.prior["vertical_velocity"],
    "tilt": lambda b: b.steady_state.prior["tilt"],
    "coast_horizontal_position": lambda b: b.coast.refined_horizontal[-1],
    "coast_vertical_position": lambda b: b.coast.refined_vertical[-1],
}
BASE = Design({"radar.aperture_time": 2.0, "imu.gyro_bias": 1e-7, "coast.before_aperture": 1.0})


def _check(budget, name):
    return next(check for check in budget.verdict.checks if check.name == name)


def test_nothing_asked_nothing_checked():
    verdict = analyse(BASE).verdict
    assert verdict.closes
    assert verdict.checks == ()
    assert verdict.tightest is None


@pytest.mark.parametrize("name", FIGURES)
def test_each_requirement_alone(name):
    sigma = float(FIGURES[name](analyse(BASE)))
    for confidence in (1.0, 2.5):
        for factor, met in ((1.001, True), (0.999, False)):
            limit = sigma * confidence * factor
            budget = analyse(BASE.replace({f"requirements.{name}": limit, "requirements.confidence": confidence}))
            check = _check(budget, name)
            assert check.sigma == pytest.approx(sigma, rel=1e-12)
            assert check.value == pytest.approx(confidence * sigma, rel=1e-12)
            assert check.limit == limit
            assert check.margin == pytest.approx(1 - 1 / factor, rel=1e-9)
            assert check.met is met
            assert check.equation
            assert check.label
            assert [c.name for c in budget.verdict.checks] == [name]
            assert budget.verdict.closes is met


@pytest.mark.parametrize("moment", ["prior", "closed", "posterior"])
def test_the_user_chooses_the_moment_of_the_cycle(moment):
    budget = analyse(
        BASE.replace(
            {"requirements.steady_state": moment, "requirements.tilt": 0.1, "requirements.vertical_position": 1.0}
        )
    )
    sigmas = getattr(budget.steady_state, moment)
    assert _check(budget, "tilt").sigma == sigmas["tilt"]
    assert _check(budget, "vertical_position").sigma == sigmas["vertical_position"]
    assert _check(budget, "tilt").equation == ("[T-3]" if moment == "closed" else "[T-8]")


LIMITS = st.dictionaries(st.sampled_from(sorted(FIGURES)), st.floats(1e-4, 3.0), min_size=1)


@settings(max_examples=40)
@given(LIMITS, st.floats(0.2, 6.0))
def test_closes_if_and_only_if_every_check_is_met(limits, confidence):
    budget = analyse(
        BASE.replace({"requirements.confidence": confidence, **{f"requirements.{k}": v for k, v in limits.items()}}),
        [0.0],
    )
    verdict = budget.verdict
    assert verdict.closes == all(check.met for check in verdict.checks)
    assert verdict.confidence == confidence
    assert {check.name for check in verdict.checks} == set(limits)
    for check in verdict.checks:
        assert check.met == (check.value <= check.limit) == (check.margin >= 0)
        assert verdict.tightest.margin <= check.margin
        assert 0 < check.dominant_share <= 1


@pytest.mark.parametrize(
    ("changes", "name", "dominant"),
    [
        # A poor gyro: the tilt at the last fix is its doing (5/6 in the gyro-dominated limit).
        ({"imu.angle_random_walk": 1e-4, "coast.before_aperture": 0.0},
         "quadratic_phase", "gyro noise"),
        # [T-18] in the gyro-dominated limit: position is the receiver's.
        ({"imu.angle_random_walk": 1e-3}, "horizontal_position", "GNSS noise"),
        ({"imu.angle_random_walk": 1e-3}, "tilt", "gyro noise"),
        ({"imu.accelerometer_bias": 0.1}, "quadratic_phase", "accelerometer bias"),
        ({"imu.gyro_bias": 1e-2}, "coast_horizontal_position", "gyro bias"),
        ({"coast.before_aperture": 3000.0, "imu.gyro_bias": 0.0},
         "quadratic_phase", "gyro noise"),
        ({"imu.velocity_random_walk": 1e-2, "imu.angle_random_walk": 1e-9, "radar.grazing_angle": 1.57},
         "quadratic_phase", "accelerometer noise"),
        ({"gnss.correlated": True, "gnss.correlated_noise": 20.0, "coast.duration": 1.0},
         "coast_horizontal_position", "slow GNSS error"),
    ],
)  # fmt: skip
def test_the_dominant_source_is_the_one_that_was_made_to_dominate(changes, name, dominant):
    check = _check(analyse(BASE.replace({**changes, f"requirements.{name}": 1.0})), name)
    assert check.dominant == dominant
