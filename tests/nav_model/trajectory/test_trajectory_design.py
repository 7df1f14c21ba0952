"""The plan of a design: part of its file, link and hash; its flight, its limits by line and its aiding."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import nav_model
from app.cli import main
from nav_model.base.errors import InputError
from nav_model.budget import analyse
from nav_model.design import Design
from nav_model.design.figures import IN_FLIGHT
from nav_model.design.file import format_design, parse_design
from nav_model.design.link import from_query, to_query
from nav_model.design.parts import declaration_of
from nav_model.simulation.design_study import named_flight, specification
from nav_model.simulation.trajectory import plan_trajectory
from nav_model.trajectory.covariance import covariance
from nav_model.trajectory.design_study import covariance_specification, lines_of, planned
from nav_model.trajectory.result import STATE_AXES
from nav_model.trajectory.specification import FlightLine
from nav_model.trajectory.verdict import checks_of

EXAMPLE_FILE = Path(nav_model.__file__).parent.parent / "examples" / "mems_x_band.toml"
EXAMPLE = EXAMPLE_FILE.read_text()
PLAN = """
[trajectory]
flight = "waypoints"
bank = "20°"
waypoints = [
    {latitude = "47°", longitude = "8°", height = "3 km", line = "out & <b>in</b>"},
    {latitude = "47.1°", longitude = "8°", height = "3 km"},
    {latitude = "47.1°", longitude = "8.1°", height = "3.02 km", line = "line 2"},
    {latitude = "47°", longitude = "8.1°", height = "3.02 km"},
]
outages = [{start = "60 s", stop = "75 s"}]
limits = [{line = "line 2", quadratic_phase = "3000°", detrended_phase = "3000°"}]
"""
OWN = """
[[contributors]]
name = "lever arm"
value = "1 mm"
enters = "quadratic_phase"
[[contributors]]
name = "clock"
value = "0.02 rad"
enters = "quadratic_phase"
kind = "systematic"
processing = "real time"
[[contributors]]
name = "survey"
value = "0.5 m"
enters = "horizontal_position"
"""


def design(text: str = PLAN, **changes: str) -> Design:
    return parse_design(EXAMPLE + text, "design", [f"trajectory.{key}={value}" for key, value in changes.items()])


def read(key: str, text: str) -> object:
    return declaration_of(f"trajectory.{key}").read(text)


def test_a_plan_is_part_of_the_file_the_link_and_the_hash() -> None:
    plain, with_plan = parse_design(EXAMPLE), design()
    # What these were before designs had plans.
    assert Design().content_hash == "1ddf64c8a1ffdf37ffc6ef00d2802fa6027581b36bdf37cbda765da168b4f5fe"
    assert "[trajectory]" not in format_design(plain)
    assert plain.content_hash != with_plan.content_hash != design(bank="21°").content_hash
    for again in (parse_design(format_design(with_plan)), from_query(to_query(with_plan))):
        assert again == with_plan
        assert again.content_hash == with_plan.content_hash
    first, second = (plain.replace({"trajectory.outages": ((zero, 5.0),)}) for zero in (-0.0, 0.0))
    assert first == second
    assert first.content_hash == second.content_hash
    typed = "47\t8\t3000\tout & <b>in</b>\n47.1\t8\t3 km\n47.1, 8.1, 3020, line 2; 47°, 8.1°, 3.02 km"
    assert read("waypoints", typed) == with_plan.trajectory.waypoints


def test_the_flight_passes_the_waypoints_and_flies_the_lines_between_them() -> None:
    case = design()
    flight = planned(case)
    times = [time for line in flight.lines for time in (line.start, line.stop)]
    ends = plan_trajectory(flight.trajectory, flight.duration).evaluate(np.array(times))
    np.testing.assert_allclose(np.degrees(ends[:, :2]), [[47, 8], [47.1, 8], [47.1, 8.1], [47, 8.1]], atol=1e-5)
    assert [line.name for line in flight.lines] == ["out & <b>in</b>", "line 2"]
    length = math.radians(0.1) * 6.372e6  # whole: the turns come after its end, and before a run-in
    assert (flight.lines[0].stop - flight.lines[0].start) * case.flight.speed == pytest.approx(length, rel=0.003)


def test_parallel_lines_begin_at_the_first_waypoint_or_at_the_latitude_of_the_flight() -> None:
    plan = lines_of(design(flight="lines"))
    line = next(point for point in plan.waypoints if point.line == "line 1")
    np.testing.assert_allclose(np.degrees([line.latitude, line.longitude]), [47.0, 8.0], atol=1e-12)
    assert line.height == 3000.0
    case = design(flight="lines", waypoints="")
    line = next(point for point in lines_of(case).waypoints if point.line == "line 1")
    assert (line.latitude, line.longitude, line.height) == (case.flight.latitude, 0.0, case.flight.altitude)


def test_a_limit_of_a_line_takes_the_place_of_the_requirement_there() -> None:
    case = design().replace({"requirements.horizontal_position": None})
    flight = planned(case)
    study = specification(case, trajectory=flight.trajectory, runs=1, duration=flight.duration)
    lines = covariance(covariance_specification(case, study, flight.lines)).lines
    assert [line.closes for line in lines] == [False, True]
    assert math.degrees(lines[0].limits["quadratic_phase"]) == pytest.approx(90.0)
    assert math.degrees(lines[1].limits["quadratic_phase"]) == pytest.approx(3000.0)
    other = case.replace({"trajectory.limits": read("limits", "line 3, tilt=1°")})
    with pytest.raises(InputError, match=r"trajectory.limits\[1\].line: the flight has no line 'line 3'; its lines:"):
        covariance_specification(other, study, flight.lines)


REQUIRED = """
[[limits]]
name = "tilt after 30 s"
on = "coast_tilt"
limit = "0.001°"
at = "30 s"
[[limits]]
name = "half"
on = "quadratic_phase"
limit = "2°"
confidence = 2
"""


def test_a_requirement_that_no_flight_changes_is_judged_as_on_budget_and_none_is_left_out() -> None:
    """A flight is no better than its budget: what the budget does not meet outside the flight, it does not either."""
    case = design(PLAN + REQUIRED)
    flight = planned(case)
    study = specification(case, trajectory=flight.trajectory, runs=1, duration=flight.duration)
    spec = covariance_specification(case, study, flight.lines)
    budget = analyse(case)
    whole = replace(budget, flight=checks_of(covariance(spec), budget))
    legs = {check.name: check for check in budget.straight_leg().checks}
    after = whole.verdict
    assert after.open == ()
    by_name = {check.name: check for check in after.checks}
    assert list(by_name) == [*legs]
    assert {name for name, check in by_name.items() if check.judged == "straight leg"} == {
        name for name, check in legs.items() if check.on not in IN_FLIGHT
    }
    assert by_name["tilt after 30 s"] == legs["tilt after 30 s"]
    assert not by_name["tilt after 30 s"].met
    assert after.state == "fails"
    assert dict(spec.most)["quadratic_phase"] == pytest.approx(math.radians(1.0))  # the lower of two limits, at 1σ
    for name, check in by_name.items():
        assert check.straight == (None if check.judged == "straight leg" else legs[name].value)


def test_heading_is_required_of_a_flight_and_a_budget_alone_does_not_say_that_it_is_met() -> None:
    text = EXAMPLE.replace("[requirements]", '[requirements]\nheading = "0.5°"')
    case = parse_design(text + PLAN.replace("quadratic_phase = ", 'heading = "10°", quadratic_phase = '), "design")
    flight = planned(case)
    study = specification(case, trajectory=flight.trajectory, runs=1, duration=flight.duration)
    result = covariance(covariance_specification(case, study, flight.lines))
    first, second = result.lines
    assert first.worst["heading"] == pytest.approx(result.chosen.attitude[:, 2].max(), rel=0.2)
    assert (first.limits["heading"], second.limits["heading"]) == (math.radians(0.5), math.radians(10.0))
    relaxed = case.replace({key: None for key in case if key.startswith("requirements.") and "confidence" not in key
                           and "steady" not in key and "heading" not in key})  # fmt: skip
    verdict = analyse(relaxed).verdict
    assert {check.state for check in verdict.checks} == {"open"}
    assert "heading" in verdict.open
    assert verdict.state == "open"
    assert (verdict.closes, verdict.tightest) == (False, None)
    assert main(["check", str(EXAMPLE_FILE), "--set", "requirements.heading=1°"]) == 1


def test_a_limit_on_heading_leaves_the_hash_of_designs_that_have_none() -> None:
    """The hash that version 0.1.0 gave this design, which flew at 3 km."""
    assert (
        design().replace({"flight.altitude": 3000.0}).content_hash
        == "7c03deca22e8631dbba7e02467f238cc986ec2cde23113cbbd5c51769312cb9a"
    )


def test_a_line_between_two_results_is_judged_by_the_nearest_and_one_that_is_not_flown_is_told_so() -> None:
    case = design().replace({"trajectory.limits": (), "requirements.quadratic_phase": math.radians(3000.0)})
    case = case.replace({"requirements.detrended_phase": None})
    flight = planned(case)
    study = specification(case, trajectory=flight.trajectory, runs=1, duration=120.0, every=10.0)
    given = (("short", 43.0, 43.5), ("cut", 80.0, 150.0), ("later", 121.0, 122.0), ("not flown", 150.0, 190.0))
    spec = covariance_specification(case, study, tuple(FlightLine(*line) for line in given))
    result = covariance(spec)
    short, cut, *others = result.lines
    at = np.searchsorted(result.time_s, 40.0)
    for name in ("quadratic_phase", "horizontal_position"):
        assert short.worst[name] == result.chosen.figures[name][at]
    assert short.reason == f"is too short for an aperture of {float(spec.inputs.aperture):.3g} s"
    assert [short.closes, cut.closes, cut.reason, cut.stop_s] == [False, True, "", 120.0]
    for line, (_, start, stop) in zip(others, given[2:], strict=True):
        assert (line.start_s, line.stop_s, line.worst) == (start, stop, {})
        assert line.reason == "is not flown, as the flight ends at 120 s"
        assert not line.closes


@pytest.mark.parametrize(
    ("changes", "duration", "text"),
    [
        (["gnss.interval=0.1 s"], 20_001.0, r"duration: the flight takes 200\d{3} steps, at most 200000"),
        (["radar.aperture_time=3000 s"], 6000.0, "every: 3001 apertures of 3001 steps are too many"),
    ],
)
def test_a_flight_that_would_take_all_the_memory_is_refused(changes: list[str], duration: float, text: str) -> None:
    case = parse_design(EXAMPLE, "design", [*changes, "flight.latitude=0°", "flight.heading=90°"])
    study = specification(case, trajectory="straight", runs=1, duration=duration)
    with pytest.raises(InputError, match=text):
        covariance(covariance_specification(case, study))


def test_where_the_aircraft_stands_there_is_no_image() -> None:
    case = design().replace({"trajectory.limits": ()})
    study = specification(case, trajectory=replace(named_flight(case, "straight"), speed=0.0), runs=1, duration=60.0)
    result = covariance(covariance_specification(case, study))
    images = [values for name, values in result.chosen.figures.items() if name not in STATE_AXES]
    assert images
    assert np.isnan(images).all()
    assert result.lines[0].reason == "has no quadratic phase, as no aperture lies within it"
    assert not result.lines[0].closes


def test_a_heading_that_swings_is_no_turn() -> None:
    """The plan is told to turn, not to turn more sharply."""
    case = design().replace({"trajectory.limits": ()})
    texts = {}
    for kind in ("wandering", "turns"):
        flown = replace(named_flight(case, kind), attitude_wander=math.radians(3.0))
        study = specification(case, trajectory=flown, runs=1, duration=250.0, outages=[(0.0, 249.0)])
        texts[kind] = covariance(covariance_specification(case, study)).heading.in_words()
    assert "Add a turn of 90°" in texts["wandering"]
    assert "Add sharper turns" in texts["turns"]


def test_contributors_of_the_design_enter_the_figures_along_the_flight() -> None:
    """As the budget adds them: lengths by 4π/λ, the random in quadrature, the systematic linearly."""
    case = design()
    more = design(PLAN + OWN)
    flight = planned(case)
    study = specification(case, trajectory=flight.trajectory, runs=1, duration=flight.duration)
    plain, whole = (covariance(covariance_specification(each, study, flight.lines)) for each in (case, more))
    phase = 4 * math.pi / whole.spec.inputs.wavelength * 1e-3
    for before, after, systematic in (
        (plain.real_time, whole.real_time, 0.02),
        (plain.post_processed, whole.post_processed, 0.0),
    ):
        sigma, sigma_after = before.figures["quadratic_phase"], after.figures["quadratic_phase"]
        root = np.hypot(sigma, phase)
        np.testing.assert_allclose(sigma_after, root + systematic, rtol=1e-12)
        shares = dict(zip(whole.sources, after.shares["quadratic_phase"], strict=True))
        np.testing.assert_allclose(shares["clock"], systematic / sigma_after, rtol=1e-12)
        np.testing.assert_allclose(shares["lever arm"], phase**2 / root / sigma_after, rtol=1e-12)
        np.testing.assert_allclose(sum(shares.values()), np.where(np.isnan(sigma_after), np.nan, 1.0), rtol=1e-9)
        np.testing.assert_array_equal(after.figures["cubic_phase"], before.figures["cubic_phase"])
        np.testing.assert_allclose(
            after.figures["horizontal_position"], np.hypot(before.figures["horizontal_position"], 0.5), rtol=1e-12
        )


@pytest.mark.parametrize(
    ("key", "text", "message"),
    [
        ("waypoints", "47, 8", r"waypoints\[1\].height: Enter the height"),
        ("waypoints", "47, 8, 3000; 95, 8, 3000", r"waypoints\[2\].latitude: '95 °' is not allowed"),
        ("waypoints", "47, 8, 3000, a, b", r"waypoints\[1\]: .* too many cells"),
        ("limits", "line 1, wind=3 m", r"limits\[1\].wind: unknown key"),
        ("limits", "line 1, tilt=3 m", r"limits\[1\].tilt: 'm' is not a unit of angle"),
        ("limits", "line 1", r"limits\[1\]: has one cell only"),
        ("outages", "60", r"outages\[1\].stop: Enter the stop"),
    ],
)
def test_a_row_that_is_wrong_is_refused_by_its_number_and_cell(key: str, text: str, message: str) -> None:
    with pytest.raises(InputError, match=f"trajectory.{message}"):
        read(key, text)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        (
            {"bank": "2°", "waypoints": "47, 8, 3000, a; 47.1, 8, 3000, b; 47.1, 8.1, 3000"},
            "trajectory.waypoints: .*turns need .* at a bank of 2°; remove its name",
        ),
        ({"ground": "3010 m"}, "trajectory.waypoints: .*waypoint 1 .* is not above the ground"),
        ({"climb_rate": "0.1 m/s"}, "trajectory.waypoints: .*at most 0.1 m/s"),
        ({"flight": "lines", "lines": "2.5"}, "trajectory.lines: .*not a whole number"),
        ({"waypoints": "47, 8, 3000; 47, 8, 3000"}, "trajectory.waypoints: .*at one place"),
        ({"waypoints": ""}, "trajectory.waypoints: .*two waypoints or more"),
    ],
)
def test_a_plan_that_cannot_be_flown_is_refused_under_its_key(changes: dict[str, str], message: str) -> None:
    with pytest.raises(InputError, match=message):
        planned(design(**changes))


def test_the_commands_fly_the_plan_of_the_design(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "design.toml"
    path.write_text(EXAMPLE + PLAN)
    assert main(["trajectory", str(path), "--set", "trajectory.heading_noise=0.05°"]) == 1
    document = json.loads(capsys.readouterr().out)
    assert [line["name"] for line in document["lines"]] == ["out & <b>in</b>", "line 2"]
    first, second = document["lines"]
    assert (first["longest_s"], first["reserve_s"], second["reserve_s"]) == (0.0, 0.0, 1200.0)
    assert second["longest_s"] == pytest.approx(second["stop_s"] - second["start_s"] + 1200.0, abs=0.01)
    assert document["heading"]["text"].startswith("Heading is observed by two antennas")
    assert document["shares"]["position_horizontal"]["heading aiding"]
    assert document["time_s"][-1] == pytest.approx(planned(design()).duration, abs=1.0)
    assert main(["simulate", str(path), "--trajectory", "plan", "--runs", "2", "--workers", "1",
                 "--set", "trajectory.barometer_noise=3 m"]) == 0  # fmt: skip
    flown = json.loads(capsys.readouterr().out)
    assert main(["trajectory", str(path), "--set", "trajectory.outages=90, 60"]) == 2
    assert "navbudget: trajectory.outages: (90.0, 60.0) cannot be simulated" in capsys.readouterr().err
    assert flown["time_s"][-1] == document["time_s"][-1]
    assert any("the runs include barometer" in condition for condition in flown["conditions"])
    assert flown["nis"]["states"] > 3  # and more fixes: the height comes in the outage too
