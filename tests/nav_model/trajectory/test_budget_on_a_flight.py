"""One requirement, one answer: a long straight line against the budget, every figure and every verdict.

What may differ is in `REASONS`, with its bound; docs/trajectory.md says why.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from nav_model.budget import analyse
from nav_model.budget.inputs import inputs_of
from nav_model.budget.real_time import RealTime
from nav_model.design import Design
from nav_model.design.figures import FIGURES, IN_FLIGHT, of_kind
from nav_model.design.file import read_design
from nav_model.design.processing import POST_PROCESSED, REAL_TIME
from nav_model.design.user_entries import read_entries
from nav_model.simulation.design_study import specification
from nav_model.simulation.single_run import POSTERIOR, fly_without_errors
from nav_model.trajectory.covariance import covariance
from nav_model.trajectory.design_study import covariance_specification
from nav_model.trajectory.result import beside_budget, larger_start

pytestmark = pytest.mark.long

BASES = [read_design(f"examples/{name}_x_band.toml") for name in ("mems", "tactical")]
LEG = 600.0  # s, so that the smoother has what the budget's has
REASONS = {
    "the aperture begins just after a fix, in the budget with the average between fixes": (
        REAL_TIME,
        ("phase", "place"),
        0.03,
    ),
    "the fix interval's worst moment is that of its end": (REAL_TIME, ("steady",), 0.04),
    "the aperture has no fix in its middle": (POST_PROCESSED, ("steady",), 0.04),
    "curves between steps": (POST_PROCESSED, ("phase", "place"), 0.01),
}
"""Reason -> processing, kinds of figures, and largest part by which the two may differ."""


def drawn(seed: int) -> Design:
    draw = np.random.default_rng(seed)

    def between(low: float, high: float) -> float:
        return float(np.exp(draw.uniform(np.log(low), np.log(high))))

    base = BASES[seed % 2]
    names = [name for name in IN_FLIGHT if name in of_kind("phase", "place", "steady")]
    changes = {
        "gnss.position_noise": between(0.02, 3.0),
        "gnss.interval": float(draw.choice([0.5, 1.0, 5.0])),
        "gnss.vertical_position_noise": None,
        "radar.aperture_time": between(1.0, 15.0),
        "radar.autofocus_order": int(draw.integers(1, 4)),
        "imu.angle_random_walk": base.imu.angle_random_walk * between(0.3, 3.0),
        "imu.velocity_random_walk": base.imu.velocity_random_walk * between(0.3, 3.0),
        "imu.accelerometer_bias": float(draw.choice([0.0, 1.0])) * between(1e-5, 1e-2),
        "imu.gyro_bias": float(draw.choice([0.0, 1.0])) * between(1e-8, 1e-4),
        "coast.before_aperture": 0.0,
        "requirements.confidence": float(draw.choice([1.0, 2.0])),
        "processing.mode": str(draw.choice([REAL_TIME, POST_PROCESSED])),
        "processing.leg_after": LEG / 2,  # the smoother of a flight has all fixes that follow
    }
    if draw.random() < 0.4:
        slow = {"correlated": True, "correlated_noise": between(0.05, 2.0), "correlation_time": between(20.0, 300.0)}
        changes |= {f"gnss.{key}": value for key, value in slow.items()}
    design = base.replace(changes)
    # Requirements about the figures, met or missed by up to three times; contributors; a limit of one's own.
    budget = analyse(design)
    limits = {
        f"requirements.{name}": budget.figure(name).sigma * between(1 / 3, 3.0)
        for name in names
        if FIGURES[name].requirement
    }
    entries = {
        "contributors": [
            {"name": "mount", "value": "0.1 mm", "enters": "quadratic_phase"},
            {"name": "datum", "value": "1 cm", "enters": "horizontal_position", "kind": "systematic"},
        ],
        "limits": [{"name": "half", "on": "detrended_phase", "limit": "9°", "confidence": 1}],
    }
    return design.replace(limits, entries=read_entries(entries))


@pytest.mark.parametrize("seed", [*range(6), *(pytest.param(n, marks=pytest.mark.slow) for n in range(6, 100))])
def test_a_straight_line_has_the_figures_and_verdicts_of_the_budget(seed: int) -> None:
    design = drawn(seed)
    budget = analyse(design)
    study = specification(design, trajectory="straight", duration=LEG, every=LEG / 2)
    # Its middle has as long to its end as the budget's smoother: no fixes beyond the end.
    result = covariance(replace(covariance_specification(design, study), flown_further=0.0))
    bounds = {(processing, kind): bound for processing, kinds, bound in REASONS.values() for kind in kinds}
    judged = set()
    for name in (name for name in IN_FLIGHT if name in of_kind("phase", "place", "steady")):
        bound = bounds[design.processing.mode, FIGURES[name].kind]
        if design.processing.mode == REAL_TIME and name in of_kind("phase", "place"):
            bound += 1.0 - 1.0 / larger_start(inputs_of(design))
        along = result.chosen.figures[name][1]
        assert along == pytest.approx(budget.figure(name).sigma, rel=bound), name
        limit = dict(result.spec.most).get(name, math.nan)
        checks = [check for check in budget.verdict.checks if check.on == name]
        met = all(check.met for check in checks)
        if checks and not abs(along / limit - 1) < bound:  # a value at its limit may be on either side
            assert met is bool(along <= limit), name
        judged.update(check.name for check in checks)
    others = {check.name for check in budget.verdict.checks if check.on not in IN_FLIGHT}
    assert judged | others == {check.name for check in budget.verdict.checks}


PARTED = {"tilt": 0.2, "vertical_position": 0.06}
"""Part of a figure that a filter on the flight tells from a bias in ten minutes: the budget takes an instability of
the tilt in full, and that of a height, under fixes of a metre, as of a filter that has run for ever."""


def filled(seed: int) -> Design:
    """A random design with every error of a data sheet.

    The gyros' turn-on bias is at most 5 °/h: a vertical gyro's turns the heading, and the heading the Earth's rate
    into a drift of the tilt, of which the budget has nothing.
    """
    draw = np.random.default_rng(1000 + seed)

    def between(low: float, high: float) -> float:
        return float(np.exp(draw.uniform(np.log(low), np.log(high))))

    hour = math.radians(1.0) / 3600.0
    walks = draw.random() < 0.5
    return drawn(seed).replace(
        {
            "accelerometer.bias_instability": between(3e-5, 1e-2),
            "accelerometer.correlation_time": between(100.0, 5000.0),
            "accelerometer.turn_on_bias": between(1e-4, 1e-2),
            "accelerometer.misalignment": between(1e-5, 1e-3),
            "accelerometer.scale_factor": between(1e-5, 1e-3),
            "accelerometer.rate_random_walk": walks * between(1e-8, 1e-6),
            "gyro.bias_instability": between(0.02, 5.0) * hour,
            "gyro.correlation_time": between(100.0, 5000.0),
            "gyro.turn_on_bias": between(0.1, 5.0) * hour,
            "gyro.misalignment": between(1e-5, 1e-3),
            "gyro.scale_factor": between(1e-5, 1e-3),
            "gyro.rate_random_walk": walks * between(1e-11, 1e-9),
            "gyro.g_sensitivity": between(0.01, 1.0) * hour / 9.80665,
            "coast.duration": LEG,  # from which rate random walk counts in tilt
        }
    )


@pytest.mark.parametrize("seed", [*range(4), *(pytest.param(n, marks=pytest.mark.slow) for n in range(4, 60))])
def test_so_it_is_with_all_that_a_data_sheet_prints(seed: int) -> None:
    design = filled(seed)
    budget, mode = analyse(design), design.processing.mode
    study = specification(design, trajectory="straight", duration=LEG, every=LEG / 2)
    result = covariance(covariance_specification(design, study))
    bounds = {(processing, kind): bound for processing, kinds, bound in REASONS.values() for kind in kinds}
    for name in (name for name in IN_FLIGHT if name in of_kind("phase", "place", "steady")):
        bound = bounds[mode, FIGURES[name].kind]
        if mode == REAL_TIME and name in of_kind("phase", "place"):
            bound += 1.0 - 1.0 / larger_start(inputs_of(design))
        sigma, along = budget.figure(name).sigma, result.chosen.figures[name][1]
        below = PARTED.get(name, bound)
        assert (1.0 - below) * sigma <= along <= (1.0 + bound) * sigma or sigma == along == 0.0, name


@pytest.mark.parametrize("seed", [*range(2), *(pytest.param(n, marks=pytest.mark.slow) for n in range(2, 60))])
def test_simulated_runs_that_have_settled_have_its_positions(seed: int) -> None:
    """Runs begin with independent errors: after 50 minutes positions are within 1 % and velocities within 3 %."""
    design = filled(seed)
    after = analyse(design).steady_state.posterior
    study = specification(design, trajectory="straight", duration=3000.0, every=3000.0)
    north, east, down, *velocity = fly_without_errors(study).filter_sigma[POSTERIOR, -1, :6]
    for part, bound, (first, second, third) in (
        ("position", 0.01, (north, east, down)), ("velocity", 0.03, velocity),
    ):  # fmt: skip
        assert [first, second] == pytest.approx([after[f"horizontal_{part}"]] * 2, rel=bound)
        assert third == pytest.approx(after[f"vertical_{part}"], rel=bound)


CONSIDERED = {
    "trajectory.lever_arm_error": 0.5,
    "trajectory.time_offset": 0.02,
    "trajectory.radar_time_offset": 0.02,
    **{f"accelerometer.{name}": 1e-3 for name in ("scale_factor", "misalignment")},
    **{f"gyro.{name}": 1e-3 for name in ("scale_factor", "misalignment")},
    "gyro.g_sensitivity": 1e-6,
    "accelerometer.turn_on_bias": 0.01,
    "gyro.turn_on_bias": 1e-5,
    "accelerometer.bias_instability": 0.01,
    "gyro.bias_instability": 1e-5,
    "processing.scene_height_error": 10.0,
}
"""Errors that a filter of 9 states ignores, and sizes [SI] of which a random part is added."""


@pytest.mark.parametrize("seed", [*range(3), *(pytest.param(n, marks=pytest.mark.slow) for n in range(3, 300))])
def test_an_error_that_the_filter_ignores_improves_no_figure(seed: int) -> None:
    """More of any, at the same gains and fixes: no state and no figure is less, in real time or smoothed."""
    draw = np.random.default_rng(5000 + seed)
    key = str(draw.choice(list(CONSIDERED)))
    design = drawn(seed).replace(
        {"filter.states": 9, **{each: CONSIDERED[each] * draw.uniform() * draw.integers(2) for each in CONSIDERED}}
    )
    worse = design.replace({key: design[key] + CONSIDERED[key] * 10.0 ** draw.uniform(-2, 0)})
    flight = str(draw.choice(["straight", "turns", "climb", "wandering"]))
    first, second = (
        covariance_specification(each, specification(each, trajectory=flight, duration=180.0, every=30.0))
        for each in (design, worse)
    )
    before, after = covariance(first), covariance(replace(second, flown_further=first.flown_further))
    for plain, more in ((before.real_time, after.real_time), (before.post_processed, after.post_processed)):
        for name in ("position", "velocity", "attitude"):
            assert np.all(getattr(more, name) >= getattr(plain, name) * (1 - 1e-6)), (key, name)
        for name, values in plain.figures.items():
            seen = np.isfinite(values)
            assert np.all(more.figures[name][seen] >= values[seen] * (1 - 1e-6)), (key, name)


SLOW_ERRORS = [(0.5, 300.0), (2.0, 60.0), (1.0, 20.0)]  # m, s


@pytest.mark.slow
@pytest.mark.parametrize("fix", [0.02, 0.5])
@pytest.mark.parametrize(("sigma", "time"), SLOW_ERRORS)
def test_budget_flight_and_simulation_know_one_slow_error(sigma: float, time: float, fix: float) -> None:
    """24 verdicts with limits 5 % above the budget's figures, which all are met, and the states of all three.

    A filter that did not know the slow error had figures up to 13 times as large and missed 19 of these limits.
    """
    changes = {"gnss.position_noise": fix, "gnss.vertical_position_noise": None, "processing.mode": POST_PROCESSED}
    slow = {"correlated": True, "correlated_noise": sigma, "correlation_time": time}
    plain = BASES[0].replace(changes | {f"gnss.{key}": value for key, value in slow.items()})
    names = ("quadratic_phase", "detrended_phase", "azimuth_shift", "horizontal_position")
    figures = analyse(plain)
    design = plain.replace({f"requirements.{name}": 1.05 * figures.figure(name).sigma for name in names})
    assert analyse(design).verdict.closes
    study = specification(design, trajectory="straight", duration=LEG, every=LEG / 2)
    flight = covariance(covariance_specification(design, study))
    for name in names:
        limit = dict(flight.spec.most)[name]
        assert flight.chosen.figures[name][1] <= limit
        assert flight.chosen.figures[name][1] == pytest.approx(figures.figure(name).sigma, rel=0.005), name
    # Just after a fix the filters are the same: the budget's, that along the flight and that of the simulated runs.
    after = RealTime(inputs_of(design)).cycle.posterior.horizontal
    budget = np.sqrt([float(after.p11), float(after.p22), float(after.p33)])
    real = flight.real_time
    for sigmas in (
        np.hstack([real.position, real.velocity, real.attitude]),
        fly_without_errors(study).filter_sigma[POSTERIOR],
    ):
        np.testing.assert_allclose(sigmas[1, [1, 4, 6]], budget, rtol=0.005)


def test_what_makes_a_straight_line_differ_is_said_beside_it() -> None:
    """Each reason by itself, and that without it the figures are the budget's; measured here for the heading."""
    plain = BASES[1].replace({"requirements.tilt": 1.0})

    def flown(changes: dict[str, float | bool], states: int = 0, yaw: float = 0.1) -> tuple[float, str]:
        design = plain.replace({**changes, "filter.initial_yaw": math.radians(yaw), "filter.states": states})
        study = specification(design, trajectory="straight", duration=LEG, every=LEG / 2)
        result = covariance(covariance_specification(design, study))
        ratio = float(result.chosen.figures["tilt"][1]) / analyse(design).figure("tilt").sigma
        return ratio, " ".join(beside_budget(result.spec))

    assert flown({})[1] == ""
    assert "begins just after a fix here" in flown({"gnss.interval": 5.0})[1]
    assert "10 s without fixes before the aperture" in flown({"coast.before_aperture": 10.0})[1]
    slow = {"gnss.correlated": True, "gnss.correlated_noise": 0.3, "gnss.vertical_correlated_noise": 0.3}
    slow["gnss.correlation_time"] = 100.0
    assert "this one does not" in flown(slow, states=9)[1]
    assert flown(slow)[1] == ""
    assert flown({"processing.mode": POST_PROCESSED})[1] == ""
    assert "has 20 s of fixes" in flown({"processing.mode": POST_PROCESSED, "processing.leg_after": 20.0})[1]
    # The noise of a navigation unit: 0.001 °/√h.
    precise = {"imu.angle_random_walk": 2.9e-7, "imu.velocity_random_walk": 5e-5, "imu.vibration_factor": 1.0}
    precise |= {"gnss.position_noise": 0.2, "gnss.interval": 0.5}
    (known, without), (unknown, heading) = flown(precise, yaw=1e-3), flown(precise)
    assert known == pytest.approx(1.0, abs=0.04)
    assert unknown > 1.1
    assert (without, "turns the Earth's rate into a drift" in heading) == ("", True)


@pytest.mark.parametrize("processing", [REAL_TIME, POST_PROCESSED])
def test_heights_of_a_navigation_unit_under_a_slow_error_are_the_budgets(processing: str) -> None:
    """Gravity that decreases with height makes 14 % of them in real time, and takes a third of them smoothed."""
    slow = {"gnss.correlated": True, "gnss.correlated_noise": 3.47, "gnss.correlation_time": 211.0}
    fixes = {"gnss.position_noise": 2.8, "gnss.interval": 0.5, "processing.leg_after": 1800.0}
    unit = {"imu.velocity_random_walk": 2e-4, "imu.vibration_factor": 1.0, "processing.mode": processing}
    design = BASES[1].replace(slow | fixes | unit)
    study = specification(design, trajectory="straight", duration=3600.0, every=1800.0)
    result, budget = covariance(covariance_specification(design, study)), analyse(design)
    for name in ("vertical_position", "vertical_velocity"):
        assert result.chosen.figures[name][1] == pytest.approx(budget.figure(name).sigma, rel=0.02), name


@pytest.mark.parametrize("method", ["map drift", "phase gradient"])
@pytest.mark.parametrize("seed", [1, 5])
def test_an_autofocus_leaves_along_a_line_what_it_leaves_in_the_budget(seed: int, method: str) -> None:
    design = drawn(seed).replace({"autofocus.method": method, "autofocus.scene": "urban", "autofocus.blocks": 8})
    budget, study = analyse(design), specification(design, trajectory="straight", duration=LEG, every=LEG / 2)
    result = covariance(covariance_specification(design, study)).chosen
    for name in (
        "phase_before_autofocus",
        "path_before_autofocus",
        "quadratic_phase",
        "cubic_phase",
        "detrended_phase",
    ):
        assert result.figures[name][1] == pytest.approx(budget.figure(name).sigma, rel=0.01), name
        shares = result.shares[name][:, 1]
        assert shares.sum() == pytest.approx(1.0, rel=1e-9), name
