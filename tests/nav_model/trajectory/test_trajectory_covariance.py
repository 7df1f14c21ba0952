"""The covariance along a flight against the simulator's filter, closed forms, simulated runs, and its own sums."""

import math
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
import pytest
from entered import entered

from nav_model.budget import analyse
from nav_model.budget.inputs import inputs_of
from nav_model.budget.real_time import RealTime
from nav_model.budget.smoothed import Smoothed
from nav_model.design import Design
from nav_model.design.figures import STEADY
from nav_model.design.file import parse_design, read_design
from nav_model.simulation.design_study import specification
from nav_model.simulation.single_run import POSTERIOR, fly, fly_without_errors
from nav_model.simulation.trajectory import plan_trajectory
from nav_model.trajectory.aperture import directions
from nav_model.trajectory.covariance import covariance
from nav_model.trajectory.design_study import covariance_specification
from nav_model.trajectory.errors import error_model
from nav_model.trajectory.passes import filtered
from nav_model.trajectory.result import Processed, TrajectoryResult
from nav_model.trajectory.specification import CovarianceSpec, FlightLine

MEMS = read_design("examples/mems_x_band.toml")
TACTICAL = read_design("examples/tactical_x_band.toml")
DENSE = parse_design(Path("examples/mems_x_band.toml").read_bytes(), changes=["gnss.interval=0.1 s"])
SHAKEN = parse_design(
    Path("examples/mems_x_band.toml").read_bytes(),
    changes=[
        "motion.lines=3 Hz 0.2 mm", "motion.delay=3 ms", "motion.unsensed_lines=2 Hz 0.5 mm",
        "oscillator.phase_noise=1 Hz 0 dBc/Hz; 1 kHz -60 dBc/Hz",
    ],
)  # fmt: skip
FAST = parse_design(Path("examples/mems_x_band.toml").read_bytes(), changes=["gnss.velocity_noise=3 cm/s"])
SLOW = MEMS.replace({"gnss.correlated": True, "gnss.correlated_noise": 0.5, "gnss.correlation_time": 100.0})
RICH = {
    "gyro.bias_instability": "20 °/h",
    "gyro.correlation_time": "100 s",
    "accelerometer.bias_instability": "0.3 mg",
    "accelerometer.correlation_time": "100 s",
    "gyro.scale_factor": "1000 ppm",
    "gyro.g_sensitivity": "30 °/h/g",
    "accelerometer.misalignment": "0.5 mrad",
    "gnss.velocity_noise": "3 cm/s",
    "gnss.lever_forward": "2 m",
}


def along(design: Design, **options: Any) -> TrajectoryResult:
    return covariance(planned(design, **options))


def planned(
    design: Design, more: Mapping[str, str] = MappingProxyType({}), states: int = 0, **options: Any
) -> CovarianceSpec:
    design = entered(design, {**more, "filter.states": str(states)})
    study = specification(design, **{"trajectory": "straight", "duration": 300.0, **options})
    return covariance_specification(design, study)


def as_simulated(design: Design, **options: Any) -> CovarianceSpec:
    """With the filter and the start of the simulator's runs."""
    return replace(planned(design, **options), settled=False)


def states(part: Processed) -> np.ndarray:
    return np.hstack([part.position, part.velocity, part.attitude])


@pytest.mark.parametrize(
    "options",
    [
        {"outages": [(150.0, 210.0)]},
        {"trajectory": "turns", "states": 15, "outages": [(170.0, 230.0)]},
        {"trajectory": "turns", "states": 21, "more": {"gnss.lever_forward": "2 m"}},
        {"trajectory": "climb", "more": {"gnss.velocity_noise": "5 cm/s"}},
        {"trajectory": "turns", "states": 18, "outages": [(170.0, 230.0)]},
    ],
)
def test_a_filter_that_knows_its_errors_is_that_of_the_simulator(options: dict[str, Any]) -> None:
    """The simulator steps ten times a second, this from fix to fix: the same to a thousandth through turns."""
    result = covariance(as_simulated(SLOW if options.get("states") == 18 else MEMS, **options))
    sigma = fly_without_errors(result.spec.study).filter_sigma[POSTERIOR][:, :9]
    np.testing.assert_allclose(states(result.real_time), sigma, rtol=2e-3)


@pytest.mark.long
def test_on_a_straight_leg_the_figures_are_the_closed_forms() -> None:
    """[S-5], [P-5] and their shares: to one part in a hundred, where a fix comes at the aperture's start."""
    for design in (MEMS, TACTICAL, FAST, SHAKEN):
        budget = analyse(design)
        result = along(design, duration=500.0)
        smooth, at = result.post_processed, 250
        post = {name: budget[name, "post-processed"] for name in (*PHASES, *PLACED, *STEADY)}
        for name in PHASES:
            assert smooth.figures[name][at] == pytest.approx(post[name].sigma, rel=0.01)
        x = inputs_of(design)
        free = RealTime(x)  # [P-7] from just after the fix with which the aperture begins
        free.at_last_fix = free.cycle.posterior
        for part, model in ((result.real_time, free), (smooth, Smoothed(x))):
            for name in PLACED:
                assert part.figures[name][at] == pytest.approx(float(model.value(name)), rel=0.005)
        assert smooth.position[at, 0] == pytest.approx(post["horizontal_position"].sigma, rel=0.01)
        assert smooth.position[at, 2] == pytest.approx(post["vertical_position"].sigma, rel=0.01)
        assert smooth.velocity[at, 1] == pytest.approx(post["horizontal_velocity"].sigma, rel=0.01)
        for name in (*PHASES, *PLACED[:2], *STEADY):
            same_shares(result.sources, smooth.shares[name][:, at], post[name].shares)


AXES = ("horizontal", "vertical")
PHASES = ("quadratic_phase", "cubic_phase", "detrended_phase")
PLACED = ("azimuth_shift", "range_shift", "ce90")


def same_shares(sources: tuple[str, ...], mine: np.ndarray, other: Mapping[str, float]) -> None:
    """True where shares along a flight are those of a budget, to 0.01."""
    np.testing.assert_allclose(mine, [other.get(source, 0.0) for source in sources], rtol=0, atol=0.01)


@pytest.mark.long
def test_on_a_straight_leg_real_time_is_the_closed_forms() -> None:
    """[T-8], and [S-5] where fixes are so dense that the filter is the continuous one of the closed form."""
    for design in (TACTICAL, DENSE):
        budget = analyse(design)
        state = budget.steady_state
        result = along(design, duration=500.0)
        real, at = result.real_time, 250
        after = state.posterior
        for mine, horizontal, vertical in (
            (real.position, after["horizontal_position"], after["vertical_position"]),
            (real.velocity, after["horizontal_velocity"], after["vertical_velocity"]),
        ):
            np.testing.assert_allclose(mine[at], [horizontal, horizontal, vertical], rtol=0.01)
        for name in PHASES:
            assert real.figures[name][at] == pytest.approx(budget[name, "real time"].sigma, rel=0.01)
            same_shares(result.sources, real.shares[name][:, at], budget[name, "real time"].shares)
        for quantity in ("position", "velocity"):
            for axis in AXES:
                shares = budget[f"{axis}_{quantity}", "real time"].shares
                same_shares(result.sources, real.shares[f"{axis}_{quantity}"][:, at], shares)


@pytest.mark.parametrize("every", [0.25, 1.0, 7.0])
@pytest.mark.parametrize(
    "changes",
    [
        ["gnss.position_noise=2 cm", "radar.aperture_time=3 s"],
        ["gnss.position_noise=1 cm", "gnss.interval=2 s", "requirements.steady_state=posterior"],
        ["gnss.velocity_noise=1 cm/s", "gnss.interval=0.5 s"],
    ],
)
def test_states_of_a_line_are_those_of_the_moment_that_the_budget_checks(changes: list[str], every: float) -> None:
    """Before a fix unless the design says otherwise, smoothed in the middle of an aperture; however many results."""
    design = parse_design(Path("examples/tactical_x_band.toml").read_bytes(), changes=changes)
    budget = analyse(design)
    result = covariance(
        replace(planned(design, duration=300.0, every=every), lines=(FlightLine("middle", 100.0, 200.0),))
    )
    on = (result.time_s >= 100.0) & (result.time_s <= 200.0)
    for part, processing in ((result.real_time, "real time"), (result.post_processed, "post-processed")):
        for name in STEADY:
            sigma = budget[name, processing].sigma
            np.testing.assert_allclose(part.figures[name][on], sigma, rtol=0.01, err_msg=f"{name}, {processing}")
            if design.processing.mode == processing and name in result.lines[0].worst:
                assert result.lines[0].worst[name] == pytest.approx(sigma, rel=0.01)
    after = {"prior": "just before a fix", "posterior": "just after a fix"}
    assert result.moment == after[design.requirements.steady_state]


@pytest.mark.parametrize("changes", [["gnss.interval=0.1 s"], ["gnss.interval=0.1 s", "radar.squint_angle=20°"]])
def test_phases_are_those_of_the_budget_the_whole_and_its_parts(changes: list[str]) -> None:
    """[S-8] and [P-5]; the whole is judged by the limit on quadratic phase of the design, and of a line."""
    limits = ["requirements.quadratic_phase=9°", "trajectory.limits=line 1, quadratic_phase=18°"]
    design = parse_design(Path("examples/tactical_x_band.toml").read_bytes(), changes=[*changes, *limits])
    study = specification(design, trajectory="straight", duration=200.0)
    spec = covariance_specification(
        design, study, (FlightLine("line 0", 50.0, 100.0), FlightLine("line 1", 100.0, 150.0))
    )
    result, budget = covariance(spec), analyse(design)
    for part, processing in ((result.real_time, "real time"), (result.post_processed, "post-processed")):
        for name in (f"{of}{name}" for of in ("", "line_of_sight_", "along_track_") for name in PHASES):
            assert part.figures[name][100] == pytest.approx(budget[name, processing].sigma, rel=0.01), name
    confidence = design.requirements.confidence
    for line, limit in zip(result.lines, (9.0, 18.0), strict=True):
        assert math.degrees(line.limits["quadratic_phase"]) == pytest.approx(limit / confidence)


def test_where_fixes_are_lost_states_are_judged_as_they_grow() -> None:
    """Before the fix that comes within an interval, else as they are: no result is as bad as the end of an outage."""
    result = along(TACTICAL, duration=200.0, outages=[(100.0, 130.0)])
    judged, now = result.real_time.figures["horizontal_position"], result.real_time.position[:, :2].max(axis=1)
    inside = (result.time_s > 100.0) & (result.time_s < 129.0)
    np.testing.assert_allclose(judged[inside], now[inside], rtol=1e-12)
    assert np.all(np.diff(judged[inside]) > 0.0)
    assert judged.max() > judged[inside].max()


def test_the_shares_of_all_sources_add_up_at_every_time() -> None:
    result = along(MEMS, trajectory="turns", states=15, outages=[(170.0, 200.0)], more=RICH, duration=260.0)
    for part in (result.real_time, result.post_processed):
        for name, shares in part.shares.items():
            whole = shares.sum(axis=0)
            np.testing.assert_allclose(whole[np.isfinite(whole)], 1.0, rtol=0, atol=1e-9, err_msg=name)
            assert np.nanmin(shares) > -1e-9


def test_the_sources_of_a_filter_that_knows_them_add_up_to_what_it_believes() -> None:
    result = covariance(as_simulated(MEMS, states=21, trajectory="turns", duration=200.0))
    model = error_model(result.spec)
    believed = filtered(model).covariance[model.outputs]
    variance = np.einsum("kii->ki", believed)[:, :6]
    np.testing.assert_allclose(states(result.real_time)[:, :6] ** 2, variance, rtol=1e-6)


def test_a_considered_error_improves_no_figure() -> None:
    plain = along(MEMS, trajectory="turns", duration=200.0)
    for change in ({"trajectory.lever_arm_error": 0.3}, {"trajectory.time_offset": 0.01}):
        worse = along(MEMS.replace(change), trajectory="turns", duration=200.0)
        for before, after in ((plain.real_time, worse.real_time), (plain.post_processed, worse.post_processed)):
            assert np.all(states(after) >= states(before) * (1 - 1e-9))
            for name, figure in before.figures.items():
                seen = np.isfinite(figure)
                assert np.all(after.figures[name][seen] >= figure[seen] * (1 - 1e-9))


def test_a_source_that_is_zero_has_no_share() -> None:
    assert "lever arm error" not in along(MEMS).sources
    assert "lever arm error" in along(MEMS.replace({"trajectory.lever_arm_error": 0.1})).sources


def test_a_radar_whose_time_is_wrong_sees_the_flight_of_another_time() -> None:
    """[P-16]: time by speed, also in the image; by acceleration in velocity, and in phase along the line of sight."""
    design = MEMS.replace({"processing.scene_height_error": 0.0})
    study = specification(design, trajectory="wandering", duration=100.0)
    plain, late = (
        covariance(covariance_specification(design, replace(study, radar_time_offset=offset)))
        for offset in (0.0, 1.0)
    )
    shape, at = late.spec.inputs, 50
    path = plan_trajectory(study.trajectory, study.duration)
    x = np.linspace(-1.0, 1.0, 2001)
    velocity = path.velocity(late.time_s[at] + 0.5 * shape.aperture * x)
    sight = directions(velocity[1000:1001], shape)[0][0]
    expected = np.polynomial.legendre.legfit(x, velocity @ sight, 7)
    speed = float(np.linalg.norm(velocity[1000]))
    shift = speed - 2.0 * shape.slant_range / (speed * shape.aperture) * expected[1]  # along the track, and by slope
    for before, after in ((plain.real_time, late.real_time), (plain.post_processed, late.post_processed)):
        # There is no acceleration northwards, so that what is added is rounding, of either sign.
        added = np.sqrt(np.maximum(states(after)[at] ** 2 - states(before)[at] ** 2, 0.0))
        np.testing.assert_allclose(added[:3], np.abs(velocity[1000]), rtol=1e-4)
        speeding = np.gradient(velocity, axis=0)[1000] * 2000 / shape.aperture
        np.testing.assert_allclose(added[3:6], np.abs(speeding), rtol=0.01, atol=1e-6)
        phase = np.sqrt(after.figures["quadratic_phase"][at] ** 2 - before.figures["quadratic_phase"][at] ** 2)
        assert phase == pytest.approx(abs(1.5 * expected[2] * 4 * np.pi / shape.wavelength), rel=0.02)
        assert after.figures["ce90"][at] == pytest.approx(1.645 * abs(shift), rel=0.01)  # in one direction


def test_beyond_the_bank_limit_no_fix_is_used() -> None:
    """The same covariance as with an outage from when the aircraft banks beyond the limit until it no longer does."""
    limit = math.radians(10.0)
    result = along(MEMS.replace({"trajectory.bank_limit": limit}), trajectory="turns", duration=200.0)
    beyond = np.abs(result.truth.euler[:, 0]) > limit
    edges = np.flatnonzero(np.diff(beyond.astype(int)))
    assert len(edges) == 6  # three turns
    outages = [(result.time_s[first] + 0.5, result.time_s[last] + 0.5) for first, last in edges.reshape(-1, 2)]
    other = along(MEMS, trajectory="turns", duration=200.0, outages=outages)
    for limited, with_outage in ((result.real_time, other.real_time), (result.post_processed, other.post_processed)):
        np.testing.assert_allclose(states(limited), states(with_outage), rtol=1e-9)
    assert result.real_time.position[beyond, 0].max() > 1.5 * along(MEMS).real_time.position[100, 0]


@pytest.mark.long
def test_after_a_loss_code_and_float_solutions_come_before_fixed_ones() -> None:
    """For as long as one solution lasts, the flight is that of a receiver with its noise; then it recovers."""

    def lossy(*solutions: tuple[float, float]) -> Design:
        return MEMS.replace({"trajectory.after_loss": solutions})

    code, floating = 8.0, 3.0
    result = along(lossy((1000.0, code)), duration=1500.0, outages=[(2.0, 4.0)])
    other = parse_design(Path("examples/mems_x_band.toml").read_bytes(), changes=[f"gnss.position_noise={code} m"])
    coarse = along(other, duration=1500.0).real_time.position
    np.testing.assert_allclose(result.real_time.position[900], coarse[900], rtol=1e-3)
    fine = along(MEMS, duration=1500.0).real_time.position
    np.testing.assert_allclose(result.real_time.position[1490], fine[1490], rtol=1e-3)
    both = along(lossy((20.0, code), (20.0, floating)), outages=[(100.0, 110.0)])
    noise = error_model(both.spec)
    fix = noise.noise[:, noise.measuring == noise.states.sources.index("GNSS noise"), 0][:, 0]
    at = np.searchsorted(noise.time_s, [99.0, 112.0, 129.0, 131.0, 149.0, 151.0])
    np.testing.assert_allclose(np.sqrt(fix[at]), [1.0, code, code, floating, floating, 1.0])


@pytest.mark.long
@pytest.mark.parametrize("runs", [60, pytest.param(1000, marks=pytest.mark.slow)])
@pytest.mark.parametrize(
    "receiver",
    [
        {},
        {"trajectory.lever_arm_error": 2.0, "trajectory.time_offset": 0.02, "trajectory.bank_limit": 0.3},
        {"trajectory.after_loss": ((4.0, 9.0), (10.0, 3.0)), "trajectory.bank_limit": 0.3},
        {
            "trajectory.heading_noise": 5e-4,
            "trajectory.barometer_noise": 0.5,
            "trajectory.time_offset": 0.02,
            "trajectory.radar_time_offset": 0.02,
            "trajectory.bank_limit": 0.3,
        },
        {
            "trajectory.heading_noise": 2e-4,
            "trajectory.heading_slow_noise": 3e-3,
            "trajectory.heading_correlation_time": 30.0,
            "trajectory.barometer_slow_noise": 3.0,
            "trajectory.barometer_correlation_time": 100.0,
        },
    ],
    ids=["", "receiver", "code and float", "heading and height, and the radar's time", "slow heading and height"],
)
def test_simulated_runs_with_errors_that_the_filter_ignores_lie_within_their_confidence(
    runs: int, receiver: dict[str, float]
) -> None:
    flight = {"trajectory": "turns", "duration": 220.0, "every": 10.0, "outages": [(170.0, 200.0)], "states": 9}
    result = covariance(as_simulated(MEMS.replace(receiver), more=RICH, **flight))
    squares = np.mean([fly(result.spec.study, run).error[POSTERIOR][:, :9] ** 2 for run in range(runs)], axis=0)
    ratio = squares[1:] / states(result.real_time)[1:] ** 2
    # The mean over times and axes of many correlated ratios, and each of them within five of its own sigmas.
    assert np.mean(ratio) == pytest.approx(1.0, abs=6.0 / np.sqrt(runs))
    assert np.all(np.abs(ratio - 1.0) < 5.0 * np.sqrt(2.0 / runs) + 0.01)
