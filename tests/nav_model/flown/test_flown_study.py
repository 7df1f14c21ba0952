"""Made flights, whose errors are known, against the verdict, the lag, the noise and the relation that are named."""

import math
from dataclasses import replace
from datetime import UTC, datetime

import numpy as np
import pytest

from nav_model import flown_study
from nav_model.base.errors import InputError
from nav_model.design.file import parse_design
from nav_model.design.trajectory import LIMITED
from nav_model.flown.relation import compare
from nav_model.flown.result import ALL, to_json
from nav_model.flown.solution import Claims, Solution
from nav_model.flown.track import stretches_of
from tests.support import made_flights as made

DESIGN = parse_design("""
radar.wavelength = "3.1 cm"
imu.angle_random_walk = "0.1 °/√h"
imu.velocity_random_walk = "0.03 m/s/√h"
trajectory.flight = "lines"
trajectory.lines = 3
trajectory.length = "9 km"
trajectory.spacing = "2 km"
""")
LINES = ("line 1", "line 2", "line 3")
STATES = {"horizontal_position": slice(0, 2), "horizontal_velocity": slice(3, 5), "tilt": slice(6, 8)}


@pytest.fixture(scope="module")
def flights():
    return made.fly(DESIGN, 6, seed=11)


def pair(flights, run, rate=5.0):
    return (
        made.solution(flights, flights.after[:, :, run], 1.0, "real-time"),
        made.solution(flights, flights.smoothed[:, :, run], rate, "post-processed"),
    )


def truth(flights, run, axes):
    """Root mean square of the larger axis on the lines."""
    model = flights.model
    on = [(model.time_s >= line.start) & (model.time_s <= line.stop) for line in flights.spec.lines]
    return math.sqrt(np.mean([(flights.after[each, axes, run] ** 2).mean(axis=0).max() for each in on]))


def all_lines(result):
    return next(line for line in result.lines if line.name == ALL).figures


@pytest.mark.parametrize(("factor", "verdict"), [(2.0, "met"), (0.5, "not met")])
def test_the_verdict_is_that_of_the_errors(flights, factor, verdict) -> None:
    """Two flights against limits well above and well below what is known of their errors."""
    for run in (0, 1):
        size = np.mean([truth(flights, each, STATES["horizontal_position"]) for each in range(6)])
        confidence = DESIGN.requirements.confidence
        design = DESIGN.replace({"requirements.horizontal_position": float(factor * confidence * size)})
        result = flown_study(design, *pair(flights, run))
        assert (result.relation, result.verdict) == ("smoothed", verdict)
        assert not result.jumps
        assert to_json(result)["verdict"] == verdict


@pytest.mark.slow
def test_of_a_hundred_flights_nearly_all_get_the_right_verdict() -> None:
    """Each of its own noise, with IMU or receiver up to twice as noisy, and limits on both sides of truth."""
    rng, verdicts = np.random.default_rng(3), []
    for group in range(10):
        flights = made.fly(DESIGN, 10, seed=group, imu=rng.uniform(1.0, 2.0), gnss=rng.uniform(1.0, 2.0))
        sizes = {name: np.mean([truth(flights, run, axes) for run in range(10)]) for name, axes in STATES.items()}
        for run in range(10):
            name, met = rng.choice(list(STATES)), bool(rng.integers(2))
            limit = sizes[name] * (1.8 if met else 0.55) * DESIGN.requirements.confidence
            result = flown_study(DESIGN.replace({f"requirements.{name}": float(limit)}), *pair(flights, run))
            verdicts.append((met, result.verdict))
    assert sum(verdict == ("met" if met else "not met") for met, verdict in verdicts) >= 95
    assert all(verdict != ("not met" if met else "met") for met, verdict in verdicts)
    assert all(verdict != "cannot be told" for _, verdict in verdicts)


def test_an_image_is_held_against_an_independent_reference(flights) -> None:
    solution = made.solution(flights, flights.smoothed[:, :, 0], 20.0, "post-processed")
    reference = made.solution(flights, 0.0 * flights.smoothed[:, :, 0], 20.0, "")
    reference = replace(reference, place=reference.place + np.array([1e-6, 0.0, 2.0]))  # another datum: no phase
    result = flown_study(DESIGN, solution, reference)
    figures = all_lines(result)
    assert result.relation == "independent"
    for name in ("quadratic_phase", "detrended_phase"):
        assert figures[name].against_budget == "consistent"
        assert 0.6 < figures[name].ratio < 1.5
    assert result.compared.offset[2].value == pytest.approx(2.0, abs=0.5)


def test_white_noise_of_a_reference_is_no_phase_of_the_solution(flights) -> None:
    """Little is taken off; a centimetre at 20 Hz hides the phase, which then cannot be told."""
    solution = made.solution(flights, flights.smoothed[:, :, 1], 20.0, "post-processed")
    truth_of = made.solution(flights, 0.0 * flights.smoothed[:, :, 0], 20.0, "")
    design = DESIGN.replace({"requirements.quadratic_phase": math.radians(90.0)})
    noise = np.random.default_rng(0).standard_normal(truth_of.place.shape) / [6.4e6, 6.4e6, 1.0]
    phases = []
    for sigma in (0.0, 2e-4, 1e-2):
        reference = replace(truth_of, place=truth_of.place + sigma * noise, velocity=None)
        phases.append(all_lines(flown_study(design, solution, reference))["quadratic_phase"])
    assert phases[1].flown == pytest.approx(phases[0].flown, rel=0.1)
    assert "white noise of the reference" in phases[2].reason


def test_phases_of_a_filter_are_not_those_of_the_free_ins(flights) -> None:
    """Its fixes make steps: the phase is far beyond the image's, and cannot be told against it."""
    solution = made.solution(flights, flights.after[:, :, 0], 20.0, "real-time")
    reference = made.solution(flights, 0.0 * flights.after[:, :, 0], 20.0, "")
    design = DESIGN.replace({"requirements.detrended_phase": math.radians(60.0)})
    result = flown_study(design, solution, reference)
    phase = all_lines(result)["detrended_phase"]
    assert phase.verdict == "cannot be told"
    assert "the raw log tells" in phase.reason
    assert phase.budget > 5 * result.spec.inputs.aperture  # degrees of thousands, in radians above tens


def test_a_lag_is_found_in_turns(flights) -> None:
    solution, reference = pair(flights, 2)
    late = replace(solution, time_s=solution.time_s + 0.2)
    result = flown_study(DESIGN, late, reference)
    lag = result.compared.lag
    assert lag.removed
    assert lag.value == pytest.approx(0.2, abs=0.05)
    assert all_lines(result)["horizontal_position"].against_budget == "consistent"
    late_still = flown_study(DESIGN, late, reference, remove_lag=False)
    assert late_still.compared.lag.value == pytest.approx(0.2, abs=0.05)
    assert all_lines(late_still)["horizontal_position"].against_budget == "more"


def test_on_a_straight_line_a_lag_is_an_offset() -> None:
    design = DESIGN.replace({"trajectory.flight": "straight", "trajectory.duration": 200.0})
    flights = made.fly(design, 1, seed=5)
    solution, reference = pair(flights, 0)
    result = flown_study(design, replace(solution, time_s=solution.time_s + 0.2), reference)
    assert not result.compared.lag.removed
    assert "does not part a lag from an offset" in result.compared.remark


def test_utc_beside_gps_time_is_named(flights) -> None:
    solution, reference = pair(flights, 3)
    result = flown_study(DESIGN, replace(solution, time_s=solution.time_s - 18.0), reference)
    assert result.compared.lag.value == pytest.approx(-18.0, abs=0.05)
    assert any("is UTC beside GPS time" in note for note in result.notes)
    marked = replace(solution, time_s=solution.time_s - 18.0 + 315_964_800.0, clock="utc")
    assert flown_study(DESIGN, marked, reference).compared.lag.value == pytest.approx(0.0, abs=0.05)


@pytest.mark.parametrize("exchanged", [False, True])
def test_utc_and_seconds_of_a_gps_week_are_one_time(flights, exchanged: bool) -> None:
    solution, reference = pair(flights, 3)
    noon = datetime(2024, 5, 18, 12, tzinfo=UTC)
    gps = (noon - datetime(1980, 1, 6, tzinfo=UTC)).total_seconds() + 18.0
    dated = replace(solution, time_s=solution.time_s + noon.timestamp(), clock="utc")
    weekly = replace(reference, time_s=reference.time_s + gps % 604_800.0, clock="gps week seconds")
    pair_of = (weekly, dated) if exchanged else (dated, weekly)
    compared = compare(*pair_of)
    assert compared.lag.value == pytest.approx(0.0, abs=0.05)
    assert np.ptp(compared.time_s) == pytest.approx(solution.duration_s, abs=1.0)


def test_the_place_of_a_filters_output_has_the_steps_of_its_fixes(flights) -> None:
    measured = []
    for run in range(3):
        output = made.solution(flights, flights.after[:, :, run], 20.0, "real-time")
        measured.append(all_lines(flown_study(DESIGN, output, pair(flights, run, 20.0)[1]))["ce90"])
    assert np.mean([one.ratio for one in measured]) == pytest.approx(1.0, abs=0.1)
    assert {one.verdict for one in measured} == {""}


def test_an_imu_three_times_as_noisy_is_told() -> None:
    flights = made.fly(DESIGN, 4, seed=2, imu=3.0)
    values = [flown_study(DESIGN, *pair(flights, run)).noise["imu"] for run in range(3)]
    assert all(one.low_95 < 3.0 < one.high_95 for one in values)
    assert np.mean([one.value for one in values]) == pytest.approx(3.0, rel=0.25)


def test_a_real_time_reference_is_not_smoothed(flights) -> None:
    solution, _ = pair(flights, 0)
    other = replace(pair(flights, 1)[0], kind="real-time")
    result = flown_study(DESIGN, solution, other, relation="smoothed")
    assert any(note.startswith("the relation is denied") for note in result.notes)


def test_passes_in_both_directions_give_no_image(flights) -> None:
    solution, reference = pair(flights, 0, rate=20.0)
    result = flown_study(DESIGN, replace(solution, smoothing="forward"), replace(reference, smoothing="backward"))
    assert result.relation == "reverse"
    phase = all_lines(result).get("detrended_phase")
    assert phase is None or math.isnan(phase.flown) or "share noise" in phase.reason


def test_a_jump_is_listed_and_its_apertures_left_out(flights) -> None:
    solution = made.solution(flights, flights.smoothed[:, :, 0], 20.0, "post-processed")
    reference = made.solution(flights, 0.0 * flights.smoothed[:, :, 0], 20.0, "")
    line = flights.spec.lines[1]
    moved = reference.place + np.where(reference.time_s - 1000.0 > line.start + 30.0, 3.0, 0.0)[:, None] * [0, 0, 1]
    result = flown_study(DESIGN, solution, replace(reference, place=moved))
    assert [jump.cause for jump in result.jumps] == ["step"]
    assert result.jumps[0].size_m == pytest.approx(3.0, abs=0.1)
    assert result.jumps[0].time_s - 1000.0 == pytest.approx(line.start + 30.0, abs=0.1)
    assert [flown.apertures_left_out > 0 for flown in result.lines[:3]] == [False, True, False]


def test_claims_alone_are_no_error(flights) -> None:
    solution, _ = pair(flights, 0)
    claims = Claims("sigma", position=np.full((len(solution.time_s), 3), 0.5))
    design = DESIGN.replace({"requirements.horizontal_position": 4.0})
    result = flown_study(design, replace(solution, claims=claims))
    assert (result.verdict, result.reason) == ("cannot be told", "claimed to be met: a claim is no error")
    one = result.claims["line 1"]["horizontal_position"]
    assert one.claimed == pytest.approx(0.5 * design.requirements.confidence)
    assert not result.lines


def test_a_claim_is_held_against_the_limit_of_its_line(flights) -> None:
    solution, _ = pair(flights, 0)
    claims = Claims("sigma", position=np.full((len(solution.time_s), 3), 0.5))
    limits = {
        "requirements.horizontal_position": 4.0,
        "trajectory.limits": (("line 2", *(0.1 if name == "horizontal_position" else None for name in LIMITED)),),
    }
    result = flown_study(DESIGN.replace(limits), replace(solution, claims=claims))
    met = {name: figures["horizontal_position"].claimed_to_be_met for name, figures in result.claims.items()}
    assert met == {"line 1": True, "line 2": False, "line 3": True}
    assert result.reason == "claimed not to be met: a claim is no error"


def test_what_has_nothing_in_common_is_refused(flights) -> None:
    solution, reference = pair(flights, 0)
    with pytest.raises(InputError, match="in common"):
        flown_study(DESIGN, solution, replace(reference, time_s=reference.time_s + 50_000.0))
    with pytest.raises(InputError, match="another place"):
        flown_study(DESIGN, solution, replace(reference, place=reference.place + np.array([0.1, 0.0, 0.0])))
    with pytest.raises(InputError, match=r"^reference: has the places of the solution itself\. Give a second one\."):
        flown_study(DESIGN, solution, replace(solution, kind="post-processed"))
    with pytest.raises(InputError, match="needs a reference"):
        flown_study(DESIGN, solution, relation="smoothed")


def test_a_track_that_repeats_itself_has_no_lag_of_a_period() -> None:
    """Clocks without a name, and fixes of a metre: a period later is as good, and is not taken."""
    time = np.arange(0.0, 1200.0)
    turn = 2.0 * np.pi * time / 300.0
    place = np.column_stack([0.8 + 2e-4 * np.cos(turn), 0.1 + 3e-4 * np.sin(turn), 500.0 + 0.0 * time])
    noise = np.random.default_rng(1).standard_normal((2, len(time), 3)) * [1.5e-7, 2e-7, 1.0]
    x, y = (Solution("table", "", time, "", place + each) for each in noise)
    assert abs(compare(x, y).lag.value) < 0.5


@pytest.mark.parametrize(
    ("of_file", "given", "note"),
    [
        ("", "", "taken as real-time"),
        ("real-time", "", ""),
        ("", "real-time", ""),
        ("post-processed", "real-time", ""),
    ],
)
def test_a_kind_is_named_where_nobody_tells_it(flights, of_file, given, note) -> None:
    solution, reference = pair(flights, 0)
    result = flown_study(DESIGN, replace(solution, kind=of_file), reference, relation="smoothed", kind=given)
    assert result.solution.kind == (given or of_file or "real-time")
    assert [one for one in result.notes if one.startswith("taken as")] == [note] * bool(note)


def test_lines_of_the_plan_are_matched_whatever_turn_a_longitude_counts(flights) -> None:
    solution, _ = pair(flights, 0)
    begin, end = solution.time_s[[0, -1]].tolist()
    far = replace(solution, place=solution.place - np.array([0.0, 2.0 * np.pi, 0.0]))
    lines, remark = stretches_of(DESIGN, far, begin, end)
    assert [line.name for line in lines] == [*LINES], remark
    assert lines == stretches_of(DESIGN, solution, begin, end)[0]


def sampled(solution, mask):
    """A solution at some of its times."""
    parts = {name: getattr(solution, name)[mask] for name in ("time_s", "place", "velocity", "attitude")}
    return replace(solution, **parts)


def test_a_reference_within_a_gap_of_the_solution_has_nothing_in_common(flights) -> None:
    solution, reference = pair(flights, 0)
    x = sampled(solution, (solution.time_s < 1100.0) | (solution.time_s > 1500.0))
    y = sampled(reference, (reference.time_s > 1110.0) & (reference.time_s < 1490.0))
    with pytest.raises(InputError, match=r"^reference: has 0 s in common with the solution; a comparison needs 20\."):
        flown_study(DESIGN, x, y)


def test_apertures_over_a_gap_of_either_solution_are_left_out(flights) -> None:
    """Those too that begin within it, where enough samples of their end are known."""
    solution = made.solution(flights, flights.smoothed[:, :, 0], 50.0, "post-processed")
    reference = made.solution(flights, 0.0 * flights.smoothed[:, :, 0], 50.0, "")
    line, T = flights.spec.lines[1], float(flights.spec.inputs.aperture)
    begin, end = 1000.0 + line.start + 40.1, 1000.0 + line.start + 40.1 + 0.5 * T
    counts = []
    for gap in ("x", "y"):
        x, y = (
            sampled(one, (one.time_s <= begin) | (one.time_s >= end)) if gap == name else one
            for name, one in (("x", solution), ("y", reference))
        )
        (flown,) = [each for each in flown_study(DESIGN, x, y).lines if each.name == "line 2"]
        starts = np.arange(flown.start_s, flown.stop_s - T + 1e-9, 0.25 * T)
        counts.append(flown.apertures_left_out)
    times = solution.time_s
    last, first = times[times <= begin][-1], times[times >= end][0]
    assert counts == [np.sum((starts <= first) & (starts + T >= last))] * 2


def test_of_two_passes_the_forward_one_has_the_error_that_was_drawn(flights) -> None:
    """Processed after the flight, and an output of a filter all the same: its budget is that of real time."""
    backward, ratios = made.backward(flights, seed=7), []
    for run in range(6):
        x = made.solution(flights, flights.after[:, :, run], 1.0, "post-processed", smoothing="forward")
        y = made.solution(flights, backward[:, :, run], 1.0, "post-processed", smoothing="backward")
        result = flown_study(DESIGN, x, y)
        assert result.relation == "reverse"
        # Not the last line: there the other pass has not settled.
        ratios += [[line.figures[name].ratio for name in STATES] for line in result.lines[:2]]
    assert np.mean(ratios, axis=0) == pytest.approx(1.0, abs=0.15)


def test_changes_of_fix_outside_of_what_is_compared_are_no_jumps(flights) -> None:
    solution, reference = pair(flights, 0)
    fix = (np.arange(len(solution.time_s)) % 200 == 0).astype(np.int8)
    some = sampled(reference, (reference.time_s > 1090.0) & (reference.time_s < 1310.0))
    result = flown_study(DESIGN, replace(solution, fix=fix, fix_names=("fixed", "float")), some)
    assert [jump.time_s for jump in result.jumps] == [1200.0, 1201.0]


def test_limits_of_the_lines_that_were_flown_count(flights) -> None:
    solution, reference = pair(flights, 0)
    rows = [(name, *(4.0 if figure == "horizontal_position" else None for figure in LIMITED)) for name in LINES]
    end = 1000.0 + flights.spec.lines[1].stop + 5.0
    x, y = (sampled(one, one.time_s < end) for one in (solution, reference))
    result = flown_study(DESIGN.replace({"trajectory.limits": tuple(rows)}), x, y)
    limits = {line.name: line.figures["horizontal_position"].limit for line in result.lines if line.name != ALL}
    assert limits == {"line 1": pytest.approx(4.0), "line 2": pytest.approx(4.0)}
    assert "without the limits of line 3, not flown" in result.notes


def test_claimed_noise_of_a_reference_is_none_of_imu_and_receiver(flights) -> None:
    solution, _ = pair(flights, 0)
    exact = made.solution(flights, 0.0 * flights.after[:, :, 0], 1.0, "")
    noise = 0.15 * np.random.default_rng(3).standard_normal(exact.place.shape)
    claims = Claims("sigma", position=np.full_like(noise, 0.15))
    noisy = replace(exact, place=exact.place + noise / [6.37e6, 6.37e6, 1.0], claims=claims)
    expected, seen = (
        flown_study(DESIGN, solution, one, relation="independent").noise["gnss"].value for one in (exact, noisy)
    )
    assert seen == pytest.approx(expected, rel=0.05)
