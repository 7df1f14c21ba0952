"""Where closed form and simulation differ: each cause alone must be found, named and measured."""

import math
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
import riccati
from entered import entered
from scipy.linalg import block_diag

from nav_model.design import Design
from nav_model.simulation.departures import CAUSES, Departure, chain
from nav_model.simulation.design_study import SimulationStudy, closed_form, specification, study_of
from nav_model.simulation.monte_carlo import simulate
from nav_model.simulation.single_run import POSTERIOR

pytestmark = pytest.mark.long

PAPER = Design({"flight.speed": 50.0})
G, SIGMA_A, SIGMA_W = 9.80665, 0.05 / 60, math.radians(0.5) / 60
CHANNEL = riccati.channel(SIGMA_A, SIGMA_W, G)
SETTLED = 150.0


def study(design: Design = PAPER, added: dict[str, str] | None = None, **options: object) -> SimulationStudy:
    asked = {"runs": 30, "duration": 300.0, "outages": [(200, 300)], "trajectory": "straight", **options}
    design = entered(design, {"filter.states": str(asked.pop("states", 0)), **(added or {})})
    spec = specification(design, **asked)
    return study_of(design, simulate(spec, closed_form=closed_form(design, spec)))


@cache
def plain() -> SimulationStudy:
    """The paper's study with nothing put in."""
    return study()


def causes(result: SimulationStudy, after: float = SETTLED) -> set[str]:
    """Every cause named once the filter has settled."""
    return {cause for d in result.departures if d.stop_s > after for cause, _ in d.steps}


def of(result: SimulationStudy, group: str, axis: str, at: float) -> Departure | None:
    for departure in result.departures:
        if (departure.group, departure.axis) == (group, axis) and departure.start_s <= at <= departure.stop_s:
            return departure
    return None


def channel_after(seconds: float, start: np.ndarray) -> np.ndarray:
    """Covariance of position, velocity, tilt of one flat channel."""
    phi, added = riccati.van_loan(*CHANNEL, seconds)
    return phi @ start @ phi.T + added


def after_fix(prior: np.ndarray) -> np.ndarray:
    """Covariance just after a position fix of 1 m."""
    return prior - np.outer(prior[:, 0], prior[0]) / (prior[0, 0] + 1.0)


def settled_channel(states: int = 3) -> np.ndarray:
    """Covariance just after a fix of the settled filter; two states are a channel without tilt."""
    each_second = riccati.van_loan(*(part[:states, :states] for part in CHANNEL), 1.0)
    return riccati.settled(*each_second, np.eye(states)[:1], 1.0)[1]


def test_the_flat_links_of_the_chain_match_solvers_of_others() -> None:
    spec = specification(PAPER, duration=250.0, outages=[(200, 250)], trajectory="straight")
    links, posterior = chain(PAPER, spec), settled_channel()
    for row, seconds in ((200, 0.0), (220, 20.0), (250, 50.0)):
        sigma = np.sqrt(np.diag(channel_after(seconds, posterior)))
        assert links.fixes[row, [0, 3, 6]] == pytest.approx(sigma, rel=1e-8)
        assert links.fixes[row, [1, 4, 7]] == pytest.approx(sigma, rel=1e-8)
    # theory.md section 2: closed form at the last fix; in an outage the formula starts as the filter does.
    assert links.bare[200, 0] == pytest.approx(0.474565, abs=6e-7)
    assert links.bare[200, 2] == pytest.approx(0.202052, rel=1.5e-3)  # gravity by height takes 0.09 %
    assert links.bare[201:] == pytest.approx(links.fixes[201:], rel=1e-12)


def test_the_steps_multiply_to_the_whole_way_from_closed_form_to_filter() -> None:
    simulated = study(trajectory="turns", states=15, added={"accelerometer.bias_instability": "1 mg"})
    links, result = chain(simulated.design, simulated.result.spec), simulated.result
    stations = [result.closed_form_sigma, links.bare, links.fixes, links.settling, links.earth, links.flight]
    stations.append(result.filter_sigma[POSTERIOR, :, :9])
    product = np.prod([after / before for before, after in pairwise(stations)], axis=0)
    assert product == pytest.approx(stations[-1] / stations[0], rel=1e-12)
    for departure in simulated.departures:
        named = math.prod(factor for _, factor in departure.steps)
        # Steps left out are below a quarter of the largest each.
        largest = max((abs(math.log(factor)) for _, factor in departure.steps), default=0.03)
        assert abs(math.log(departure.simulated / named)) < 5 * max(0.25 * largest, 0.03)


def test_a_plain_study_parts_only_where_the_earth_makes_it() -> None:
    result = plain()
    assert causes(result) == {"earth"}
    # [T-17]: the vertical channel alone, after about 45 s; full filters and polynomial part by 2.7 % in position.
    assert {(d.group, d.axis) for d in result.departures if d.stop_s > SETTLED} == {("velocity", "down")}
    assert of(result, "position", "down", 299.0) is None


@pytest.mark.parametrize(
    ("changes", "options", "added", "cause", "words"),
    [
        ({"imu.accelerometer_bias": 5e-3}, {}, {}, "biases", "the residual accelerometer bias"),
        ({"gnss.interval": 5.0, "gnss.position_noise": 5**-0.5}, {}, {}, "fixes", "sawtooth"),
        ({}, {"outages": [(100, 160), (200, 300)]}, {}, "settling", "settling; the formula holds for steady state"),
        ({}, {"trajectory": "turns"}, {}, "flight", "turns, climbs or wander"),
        ({}, {}, {"filter.gnss_noise_scale": "2"}, "filter", "fix noise setting ×2"),
        ({}, {"states": 15}, {"gyro.bias_instability": "60 °/h"}, "filter", "6 of them biases"),
        ({}, {"states": 9}, {"gyro.bias_instability": "60 °/h"}, "errors", "biases, which 9 states do not include"),
        ({}, {}, {"filter.process_noise_scale": "0.5"}, "errors", "mismatched tuning"),
    ],
)
def test_what_a_cause_explains_goes_when_the_cause_is_taken_away(changes, options, added, cause, words) -> None:
    """The plain study is each of these without its cause; its only departure is that of the Earth."""
    result = study(PAPER.replace(changes), added=added, **options)
    explained = [d for d in result.departures if d.stop_s > SETTLED and cause in dict(d.steps)]
    assert explained
    assert any(words in d.reason and CAUSES[cause] in d.reason for d in explained)
    remaining = {(d.group, d.axis, d.phase): d for d in plain().departures if d.stop_s > SETTLED}
    assert all(cause not in dict(d.steps) for d in remaining.values())
    for departure in explained:
        still = remaining.get((departure.group, departure.axis, departure.phase))
        assert still is None or set(dict(still.steps)) == {"earth"}


def test_after_an_outage_the_filter_settles_by_as_much_as_a_flat_filter_of_others() -> None:
    """Schuler and Coriolis terms over 60 s are below 1 %: none of them may be named for the way back."""
    result = study(outages=[(100, 160), (200, 300)])
    back = of(result, "position", "north", 161.0)
    settled = settled_channel()
    carried, ratios = channel_after(60.0, settled), []
    for _ in range(20):
        carried = after_fix(channel_after(1.0, carried))
        ratios.append(math.sqrt(carried[0, 0] / settled[0, 0]))
    assert dict(back.steps) == {"settling": pytest.approx(max(ratios), rel=0.01)}
    assert 161.0 <= back.start_s <= back.stop_s <= 200.0  # one finding for each outage


def test_the_step_of_the_earth_is_what_schuler_gravity_and_coriolis_make_of_a_flat_outage() -> None:
    """North, east and down together over the outage, by [T-17]'s system in SciPy, with those terms and without.

    Beside [T-17]: the level force that holds the flight straight against Coriolis's acts on a tilt.
    """
    # North, east: position, velocity, tilt; down: position, velocity.
    start = block_diag(settled_channel(), settled_channel(), settled_channel(2))
    radius, speed, turn = 6_374_000.0, 50.0, 2 * 7.292115e-5 * math.sqrt(0.5)
    flat = np.zeros((8, 8))
    for position in (0, 3, 6):
        flat[position, position + 1] = 1.0
    flat[1, 2] = flat[4, 5] = G
    earth = flat.copy()
    earth[1, 0] = earth[4, 3] = -G / radius
    earth[7, 6] = 2 * G / radius
    earth[7, 1], earth[7, 4], earth[7, 5] = -2 * speed / radius, -turn, -turn * speed
    noise = np.diag([*[0.0, SIGMA_A**2, SIGMA_W**2] * 2, 0.0, SIGMA_A**2])
    down = []
    for f in (flat, earth):
        phi, added = riccati.van_loan(f, noise, 100.0)
        down.append(math.sqrt((phi @ start @ phi.T + added)[7, 7]))
    departure = of(plain(), "velocity", "down", 299.0)
    assert dict(departure.steps) == {"earth": pytest.approx(down[1] / down[0], rel=0.01)}


def test_velocity_fixes_of_the_design_part_nothing() -> None:
    with_velocity = PAPER.replace({"gnss.velocity_noise": 0.02})
    result = study(with_velocity)
    assert "filter" not in causes(result)
    assert not [d.reason for d in result.departures if d.phase == "aided"]


def test_errors_the_filter_does_not_expect_are_found_though_the_filter_agrees_with_the_closed_form() -> None:
    """The slow GNSS error passes straight into position: 1 m on 0.47 m, and the filter knows nothing of it."""
    slow = PAPER.replace({"gnss.correlated": True, "gnss.correlated_noise": 1.0})
    result = study(slow, states=9)
    north = of(result, "position", "north", 190.0)
    # The filter has the white posterior of [T-8]; the formula about 1 m more of slow error, which it includes.
    assert north.ratio == pytest.approx(0.449 / math.hypot(0.475, 1.0), rel=0.02)
    assert north.steps[0][0] == "filter"
    assert "9 states without the slow GNSS error, which the formula includes" in north.reason
    (cause, factor) = north.steps[-1]
    assert cause == "errors"
    assert factor == pytest.approx(math.hypot(1.0, 0.449) / 0.449, rel=0.35)  # 90 values of 300 s: a few independent
    assert "the slow GNSS error" in north.reason
    assert north.simulated == pytest.approx(north.ratio * factor)
    known = study(slow)  # the filter expects them, as the formula does
    assert of(known, "position", "north", 190.0) is None
    assert causes(known) == {"earth"}


def test_velocity_fixes_with_a_vertical_noise_of_their_own_part_nothing() -> None:
    result = study(PAPER.replace({"gnss.velocity_noise": 0.02, "gnss.vertical_velocity_noise": 0.2}))
    assert causes(result) <= {"earth", "settling"}
    assert not [d for d in result.departures if d.phase == "aided"]


def test_chance_is_no_departure() -> None:
    """Twelve consistent studies of eight runs, whose rms scatters by a quarter: none is said to have errors."""
    for seed in range(12):
        assert "errors" not in causes(study(runs=8, seed=seed)), seed
