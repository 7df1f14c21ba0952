"""When a line fails, why, and how long it may be: against the closed form of heading, and lines flown again."""

import math
from dataclasses import replace

import numpy as np
import pytest
from entered import entered

from nav_model.base.constants import DEGREE, DEGREE_PER_HOUR
from nav_model.budget import analyse
from nav_model.design import Design
from nav_model.design.trajectory import LIMITED, Rows
from nav_model.earth.wgs84 import metres_per_radian
from nav_model.simulation.design_study import specification
from nav_model.trajectory.covariance import covariance
from nav_model.trajectory.design_study import along_flight, covariance_specification, planned
from nav_model.trajectory.line_length import with_lengths
from nav_model.trajectory.lines import MOST_RESERVE, length_in_words
from nav_model.trajectory.result import TrajectoryResult, to_json
from nav_model.trajectory.specification import FlightLine

START, WALK, BIAS, TIME = 0.005 * DEGREE, 0.05 * DEGREE / 60, 0.5 * DEGREE_PER_HOUR, 200.0
TACTICAL = Design({"imu.angle_random_walk": WALK, "flight.speed": 60.0, "gnss.position_noise": 0.05})


@pytest.mark.parametrize("states", [9, 15])
def test_heading_grows_along_a_straight_line_as_its_closed_form(states: int) -> None:
    """Variance sigma0² + N² t + 2 B² tau (t - tau (1 - exp(-t/tau))) to 1 %, and a limit is passed when it says."""
    noise = {"gyro.bias_instability": "0.5 °/h", "gyro.correlation_time": "200 s", "filter.initial_yaw": "0.005 °"}
    design = entered(TACTICAL, {**noise, "filter.states": str(states)})
    study = specification(design, trajectory="straight", duration=900.0)
    limit = 0.02 * DEGREE
    spec = covariance_specification(design, study, (FlightLine("line 1", 0.0, 900.0),))
    flown = covariance(replace(spec, most=(("heading", limit),)))
    t = np.arange(901.0)
    drift = 2 * BIAS**2 * TIME * (t - TIME * (1 - np.exp(-t / TIME)))
    variance = START**2 + WALK**2 * t + drift
    np.testing.assert_allclose(flown.real_time.attitude[:, 2] ** 2, variance, rtol=0.01)
    (line,) = flown.lines
    passes = float(np.interp(limit**2, variance, t))
    assert line.fails_at_s == pytest.approx(passes, abs=0.01 * passes + 1)  # judged just before the next fix
    minutes, seconds = divmod(round(line.fails_at_s), 60)
    mostly = "gyro noise" if WALK**2 * passes > np.interp(passes, t, drift) else "gyro bias instability"
    assert line.because == f"heading exceeds 0.02° (1σ) after {minutes} min {seconds} s; mainly from {mostly}"
    (entry,) = to_json(flown, analyse(TACTICAL).verdict)["lines"]
    assert (entry["because"], entry["limits"]) == (line.because, {"heading": limit})
    heading = entry["figures"]["heading"]
    assert heading["start"] == pytest.approx(math.sqrt(variance[1]), rel=0.01)
    assert heading["worst"] == pytest.approx(math.sqrt(variance[-1]), rel=0.01)
    assert heading["mean"] == pytest.approx(math.sqrt(np.mean(variance)), rel=0.01)
    assert entry["figures"].keys() >= {"horizontal_position", "vertical_velocity", "tilt", "detrended_phase"}


def test_a_line_within_its_limits_fails_at_no_time_and_one_beyond_from_the_start_says_so() -> None:
    study = specification(TACTICAL, trajectory="straight", duration=60.0)
    spec = covariance_specification(TACTICAL, study, (FlightLine("line 1", 10.0, 60.0),))
    within, beyond = (
        covariance(replace(spec, most=(("heading", limit * DEGREE),))).lines[0] for limit in (1.0, 0.05)
    )
    assert (within.fails_at_s, within.fails_by, within.because, length_in_words(within)) == (None, "", "", "")
    assert (beyond.fails_at_s, beyond.fails_by) == (0.0, "heading")
    assert beyond.because == "heading exceeds 0.05° (1σ) from the start; mainly from initial heading"
    solved = [(within, 90.0), (within, MOST_RESERVE), (beyond, -20.0), (beyond, -50.0)]
    lines = [replace(line, longest_s=50.0 + longer, reserve_s=max(longer, 0.0)) for line, longer in solved]
    assert [length_in_words(line) for line in lines] == [
        "may be 1 min 30 s longer", "may be more than 20 min longer", "up to 30 s", "no line is short enough",
    ]  # fmt: skip


@pytest.mark.long
def test_a_post_processed_line_with_which_the_flight_ends_has_no_length_that_holds_its_end() -> None:
    """Nothing later is known there, so a shorter one fails as well; the turn after the first lets it hold."""
    rows = _waypoints(0.8, 60.0 * np.array([200.0, 70.0j, -200.0]))
    design = TACTICAL.replace({"trajectory.flight": "waypoints", "trajectory.waypoints": rows})
    design = design.replace({"processing.mode": "post-processed"})
    first, last = (line.worst["ce90"] for line in _flown(design).lines)
    assert last > 1.5 * first
    design = design.replace({"requirements.ce90": 0.5 * (first + last)})
    before, after = with_lengths(_flown(design), design).lines
    assert before.reserve_s == MOST_RESERVE
    assert 0.9 * after.duration < after.fails_at_s < after.duration
    assert (after.longest_s, length_in_words(after)) == (0.0, "no line is short enough")


def _flown(design: Design) -> TrajectoryResult:
    return covariance(along_flight(design, planned(design)))


def _waypoints(latitude: float, legs: np.ndarray) -> Rows:
    """The ends of legs [m], north and east as the imaginary part; lines begin with the first and the third."""
    place, rows = np.array([latitude, 0.1]), [(latitude, 0.1, 1500.0, "line 1", None)]
    for leg, name in zip(legs, ("", "line 2", ""), strict=True):
        north = 0.0
        for _ in range(3):  # with the metres of a degree half way
            scale = metres_per_radian(place[0] + north / 2, 1500.0)
            north = leg.real / scale[0]
        place = place + np.array([north, leg.imag / scale[1]])
        rows.append((*place.tolist(), 1500.0, name, None))
    return tuple(rows)


@pytest.mark.parametrize(
    "seed", [pytest.param(n, marks=pytest.mark.long if n < 2 else pytest.mark.slow) for n in range(20)]
)
def test_the_longest_line_flown_again_meets_its_limit_and_a_longer_one_fails(seed: int) -> None:
    random = np.random.default_rng([42, seed])
    speed, latitude, sense = random.uniform(40, 90), random.uniform(-1, 1), random.choice([-1, 1])
    course = random.uniform(-math.pi, math.pi) + sense * random.uniform(1.2, 2) * np.arange(3)
    legs = speed * random.uniform([120, 60, 120], [300, 90, 300]) * np.exp(1j * course)
    design = Design(
        {
            "imu.angle_random_walk": 10 ** random.uniform(-1.5, -0.7) * DEGREE / 60,
            "imu.gyro_bias": random.choice([0, 0.5]) * DEGREE_PER_HOUR, "flight.speed": speed,
            "gnss.position_noise": 10 ** random.uniform(-1.7, -0.5),
            "processing.mode": ("real time", "post-processed")[seed % 2],
            "trajectory.flight": "waypoints", "trajectory.waypoints": _waypoints(latitude, legs),
        }
    )  # fmt: skip
    limits = [line.worst["heading"] * random.uniform(0.8, 1.5) for line in _flown(design).lines]
    rows = (tuple(limit if name == "heading" else None for name in LIMITED) for limit in limits)
    design = design.replace({"trajectory.limits": tuple((f"line {n}", *row) for n, row in enumerate(rows, 1))})
    result = _flown(design)
    for number, line in enumerate(with_lengths(result, design).lines):
        assert line.longest_s is not None
        trials = {1.02 * line.longest_s: False, 0.999 * line.longest_s: True}
        if line.longest_s == 0.0:
            trials = {float(result.spec.inputs.aperture) + 1.0: False, line.duration / 2: False}
        elif line.reserve_s == MOST_RESERVE:
            trials = {line.longest_s: True}
        for length, holds in trials.items():
            other = legs.copy()
            other[2 * number] *= 1 + (length - line.duration) * speed / abs(other[2 * number])
            lines = _flown(design.replace({"trajectory.waypoints": _waypoints(latitude, other)})).lines
            again = next(each for each in lines if each.name == line.name)
            assert again.duration == pytest.approx(length, rel=5e-4)
            assert again.closes == holds
