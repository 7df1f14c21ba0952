"""Where a flight begins and ends: what is judged there, and flights without a fix."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from app.examples import example
from nav_model.budget import analyse
from nav_model.design import Design
from nav_model.design.processing import POST_PROCESSED, REAL_TIME
from nav_model.simulation.design_study import specification
from nav_model.simulation.trajectory import plan_trajectory
from nav_model.trajectory.covariance import covariance, lines_along
from nav_model.trajectory.design_study import along_flight, covariance_specification, planned
from nav_model.trajectory.lines import judge
from nav_model.trajectory.result import Processed, TrajectoryResult
from nav_model.trajectory.specification import CovarianceSpec

MEMS = example("mems_x_band").replace({"processing.mode": POST_PROCESSED})


def asked(design: Design, kind: str = "straight", **options: float) -> CovarianceSpec:
    return covariance_specification(design, specification(design, trajectory=kind, **options))


def flown(design: Design, kind: str = "straight", **options: float) -> TrajectoryResult:
    return covariance(asked(design, kind, **options))


def test_a_straight_flight_has_the_smoothed_figures_of_the_budget_to_its_end() -> None:
    """The last seconds had no fixes after them: 16° for the 9° of the budget. The start is settled."""
    result, budget = flown(MEMS, duration=200.0, every=2.0), analyse(MEMS)
    assert result.time_s[-1] == 200.0
    for name in ("quadratic_phase", "detrended_phase", "azimuth_shift"):
        along, value = result.post_processed.figures[name], budget.figure(name).sigma
        there = np.flatnonzero(np.isfinite(along))
        assert result.time_s[there[-1]] == pytest.approx(200.0 - float(result.spec.inputs.aperture) / 2, abs=2.0)
        assert along[there] == pytest.approx(value, rel=0.01), name
    for name in ("horizontal_position", "tilt"):
        assert result.post_processed.figures[name] == pytest.approx(budget.figure(name).sigma, rel=0.01), name
    (alone,) = lines_along(result.spec)
    assert alone.worst["detrended_phase"] == pytest.approx(result.lines[0].worst["detrended_phase"], rel=1e-12)


QUIET = {"imu.angle_random_walk": 1e-5, "imu.velocity_random_walk": 4e-4, "gnss.interval": 0.5}
SLOW = {"gnss.correlated": True, "gnss.correlated_noise": 1.2, "gnss.correlation_time": 20.0}


@pytest.mark.long
@pytest.mark.parametrize("changes", [{}, SLOW, QUIET, {**QUIET, **SLOW}], ids=["mems", "slow", "quiet", "both"])
@pytest.mark.parametrize("after", [200.0, 3600.0])
def test_a_straight_flight_goes_on_for_as_long_as_the_smoother_learns(changes: dict[str, Any], after: float) -> None:
    """Quiet units, and slow errors of the fixes, have the smoother remember minutes: up to 35 % were missing."""
    design = MEMS.replace({**changes, "processing.leg_after": after, "gnss.position_noise": 0.5})
    result, budget = flown(design, duration=60.0, every=10.0), analyse(design)
    for name in ("quadratic_phase", "detrended_phase", "horizontal_position", "vertical_velocity", "tilt"):
        along, value = result.post_processed.figures[name], budget.figure(name).sigma
        assert along[np.isfinite(along)][-1] == pytest.approx(value, rel=0.02), name


def test_fixes_that_the_smoother_does_not_wait_for_are_not_flown() -> None:
    assert asked(MEMS.replace({"processing.leg_after": 7.0}), duration=100.0).flown_further == 7.0
    assert asked(MEMS.replace({"processing.leg_after": 1e4}), duration=100.0).flown_further < 200.0


@pytest.mark.parametrize("kind", ["straight", "wandering", "turns", "climb"])
def test_a_named_flight_goes_on_as_it_was(kind: str) -> None:
    study = specification(MEMS, trajectory=kind, duration=250.0)
    times = np.arange(251.0)
    plain, longer = (plan_trajectory(study.trajectory, 250.0, further).evaluate(times) for further in (0.0, 90.0))
    np.testing.assert_allclose(longer[:, :2] * 6.4e6, plain[:, :2] * 6.4e6, atol=1e-6)  # m
    np.testing.assert_allclose(longer[:, 2:], plain[:, 2:], atol=1e-6)


@pytest.mark.parametrize("kind", ["straight", "wandering"])
def test_a_flight_without_a_fix_coasts_from_its_start(kind: str) -> None:
    """The fix interval is longer than the flight: positions are those of an outage from a settled filter."""
    design = MEMS.replace({"gnss.interval": 201.0})
    study = specification(design, trajectory=kind, duration=200.0, every=100.0)
    result = covariance(covariance_specification(design, study))
    out = analyse(design, np.array([100.0])).coast.refined_horizontal
    assert result.real_time.position[1, :2] == pytest.approx(float(out[0]), rel=0.05)
    assert np.isfinite(result.post_processed.figures["quadratic_phase"][1])


def test_a_line_at_the_end_of_a_plan_lacks_fixes_and_says_so() -> None:
    plan = {"trajectory.flight": "lines", "trajectory.lines": 2.0, "trajectory.length": 6000.0}
    design = MEMS.replace(plan | {"processing.leg_after": 30.0, "requirements.detrended_phase": 1.0})
    spec = along_flight(design, planned(design))
    first, last = lines_along(spec)
    assert (first.remark, last.remark) == ("", "no fixes for 30 s after it: fly on")
    assert last.worst["detrended_phase"] > 1.3 * first.worst["detrended_phase"]
    real_time = replace(spec, processing=REAL_TIME)
    assert [line.remark for line in lines_along(real_time)] == ["", ""]


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ([1, 1, 3, 4, 5], "tilt exceeds 2° (1σ) after 15 s; mainly from gyro noise"),
        ([3, 3, 4, 4, 5], "tilt exceeds 2° (1σ) from the start; mainly from gyro noise"),
        ([3, 1, 1, 1, 1], "tilt exceeds 2° (1σ) for 20 % of the line, first at its start; mainly from gyro noise"),
        ([1, 3, 1, 3, 1], "tilt exceeds 2° (1σ) for 40 % of the line, first after 5 s; mainly from gyro noise"),
    ],
)
def test_how_long_a_figure_is_beyond_its_limit_is_told_as_it_is(values: list[float], words: str) -> None:
    limit = np.deg2rad(2.0)
    spec = replace(asked(MEMS, duration=40.0), most=(("tilt", float(limit)),))
    figures, shares = {"tilt": np.deg2rad(np.array(values, float))}, {"tilt": np.ones((1, 5))}
    none = np.zeros((5, 3))
    (line,) = judge(spec, 10.0 * np.arange(5), Processed(none, none, none, figures, shares), ("gyro noise",))
    assert line.because == words
