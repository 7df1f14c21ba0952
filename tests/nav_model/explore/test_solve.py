"""Solving backwards: put back, the margin is zero."""

import math
from functools import cache, partial

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nav_model.aperture.geometry import aperture_time
from nav_model.base.errors import InputError
from nav_model.budget import analyse
from nav_model.design import Design
from nav_model.design.parts import quantity
from nav_model.explore.margins import ALL, ratios
from nav_model.explore.solve import SOLVED, offer, remedies, resolution_for, rounded_offer, solve


def _margins(design, key, value):
    return {check.name: check.margin for check in analyse(design.replace({key: value})).verdict.checks}


@pytest.mark.long
@settings(max_examples=8)
@given(data=st.data())
def test_every_solved_value_of_a_figure_without_steps_is_at_its_limit(data, designs):
    """Without vibration and oscillator: an echo steps where its line leaves the main lobe (test_fast.py)."""
    keys = ("motion.lines", "motion.spectrum", "motion.unsensed_lines", "oscillator.phase_noise")
    design = data.draw(designs).replace(dict.fromkeys(keys, ()) | {"motion.delay": 0.0})
    exact = 1e-9 if design.gnss.velocity_noise is None else 1e-7
    for solution in solve(design):
        for answer in solution.each:
            if answer.value is not None:
                assert 0 <= answer.margin <= exact
                around = ratios(design, {answer.key: answer.value * np.array([0.98, 1.02])})[answer.requirement]
                assert around[0] <= 1 <= around[1]


@pytest.mark.long
@settings(max_examples=4)
@given(data=st.data(), leg=st.floats(2.0, 60.0), mode=st.sampled_from(["real time", "post-processed"]))
def test_every_solved_value_put_back_meets_its_limit_where_figures_step_too(data, designs, leg, mode):
    """With fixes that enter a short leg one by one, and echoes."""
    design = data.draw(designs).replace({"processing.mode": mode, "processing.leg_after": leg})
    for solution in solve(design):
        for answer in (*solution.each, solution.together):
            assert (answer.margin is None) == (answer.value is None)
            if answer.value is not None:
                assert answer.margin == _margins(design, answer.key, answer.value)[answer.binding] >= 0
        offered = offer(design, solution)
        assert offered is None or analyse(design.replace(offered.changes)).verdict.closes


@pytest.mark.parametrize("leg", [12.0, 15.0])
def test_where_the_number_of_fixes_steps_the_answer_is_on_the_side_that_meets_the_limit(open_design, leg):
    """Margins of -3.1 % (azimuth shift, 12 s), -2.4, -1.2 and -0.3 % had been found beyond the step."""
    design = open_design.replace(
        {"processing.mode": "post-processed", "processing.leg_after": leg,
         "requirements.ce90": 1.2, "requirements.azimuth_shift": 1.5}
    )  # fmt: skip
    interval = next(solution for solution in solve(design) if solution.key == "gnss.interval")
    limited = [answer for answer in interval.each if answer.value is not None]
    assert "azimuth_shift" in {answer.requirement for answer in limited}
    for answer in limited:
        assert _margins(design, answer.key, answer.value)[answer.requirement] >= 0


@pytest.mark.parametrize("interval", [0.02, 0.05, 0.2])
@pytest.mark.parametrize("limit", [0.3, 0.632, 2.0])
def test_positions_that_tell_nearly_nothing_beside_velocities(interval, limit):
    """Solved position noises of metres to kilometres beside velocities of 5 mm/s: an answer, and no fault of ours."""
    design = Design().replace(
        {"imu.velocity_random_walk": 1e-5, "imu.angle_random_walk": 3e-7, "gnss.position_noise": 0.005,
         "gnss.velocity_noise": 0.005, "gnss.interval": interval, "requirements.horizontal_position": limit}
    )  # fmt: skip
    answers = {solution.key: solution.each for solution in solve(design)}["gnss.position_noise"]
    [noise] = [answer for answer in answers if answer.requirement == "horizontal_position"]
    assert noise.value is None or noise.value > 1e3 * design.gnss.position_noise


@settings(max_examples=8)
@given(data=st.data())
def test_all_together_is_the_least_and_closes(data, designs):
    design = data.draw(designs)
    for solution in solve(design, verify=False):
        together = solution.together
        values = [answer.value for answer in solution.each if answer.value is not None]
        if together.outcome == "limited":
            assert together.value == min(values)
            closing = analyse(design.replace({solution.key: together.value * (1 - 1e-9)})).verdict
            assert closing.closes
        elif together.outcome == "no value":
            assert any(answer.outcome == "no value" for answer in solution.each)


@settings(max_examples=8)
@given(data=st.data())
def test_no_value_and_any_value_mean_it(data, designs):
    design = data.draw(designs)
    for solution in solve(design, verify=False):
        ends = _bounds(solution.key, solution.current)
        low, high = (cache(partial(_margins, design, solution.key, bound)) for bound in ends)
        for answer in solution.each:
            if answer.outcome == "no value":
                assert low()[answer.requirement] < 0
            elif answer.outcome == "any value" and answer.key != "radar.aperture_time":
                assert high()[answer.requirement] >= 0


def _bounds(key, now):
    """Inputs that can be bought or flown."""
    low, high = quantity(key).limits
    return max(min(quantity(key).softbounds[0], now), 1e-9 * high) if low else 1e-9 * high, high


def test_nothing_is_offered_below_what_can_be_bought(open_design):
    """A vibration factor below 1 is less than bench noise; it would have been 0.352."""
    solutions = {solution.key: solution for solution in solve(open_design)}
    assert solutions["imu.vibration_factor"].together.outcome == "no value"
    assert offer(open_design, solutions["imu.vibration_factor"]) is None
    shaken = {
        s.key: s for s in solve(open_design.replace({"imu.angle_random_walk": 1e-6, "imu.vibration_factor": 30}))
    }
    assert shaken["imu.vibration_factor"].together.value > 1
    quiet = open_design.replace({"imu.vibration_factor": 0.2})
    factor = next(s for s in solve(quiet) if s.key == "imu.vibration_factor")  # its owner has measured less
    assert 0.2 < factor.together.value < 1


@given(st.floats(-0.9, 0.9), st.floats(0.1, 2.0), st.sampled_from(["uniform", "hamming", "taylor"]))
def test_the_resolution_of_an_aperture_is_the_one_it_was_made_for(squint, resolution, window):
    design = Design({"radar.squint_angle": squint, "radar.azimuth_resolution": resolution, "radar.window": window})
    radar = design.radar
    wavelength = 299792458 / radar.frequency
    time = aperture_time(wavelength, radar.slant_range, design.flight.speed, resolution, window, squint)
    assert resolution_for(design, float(time)) == pytest.approx(resolution, rel=1e-12)


@pytest.mark.parametrize(("squint", "resolution"), [(0.0, 0.5), (30.0, 0.5773503)])
def test_a_squinted_aperture_resolves_less_by_the_cosine(squint, resolution):
    """By hand from [S-3]: 0.8858929 x 0.03 m x 10 km / (2 x 100 m/s x 2.6576788 s) is 0.5 m abeam; the track of 266 m
    looks shorter by cos 30° from the scene, so the cell is longer by 2/√3."""
    design = Design(
        {"radar.frequency": 299792458 / 0.03, "radar.slant_range": 10e3, "flight.speed": 100.0,
         "radar.window": "uniform", "radar.squint_angle": math.radians(squint)}
    )  # fmt: skip
    assert resolution_for(design, 2.6576788) == pytest.approx(resolution, rel=1e-7)


def test_no_value_helps_is_said_with_what_would(open_design):
    answers = solve(open_design)
    by_key = {solution.key: solution for solution in answers}
    assert by_key["gnss.position_noise"].together.outcome == "no value"
    assert by_key["coast.duration"].together.outcome == "no value"
    helps = {answer.key for answer in remedies(answers, ALL)}
    assert helps == {"imu.angle_random_walk", "radar.aperture_time"}
    most = by_key["imu.angle_random_walk"].together.value
    margins = [
        analyse(open_design.replace({"imu.angle_random_walk": k * most})).verdict.tightest.margin for k in (1, 2)
    ]
    assert margins[0] == pytest.approx(0, abs=1e-6)
    assert margins[1] < -0.1


def test_slow_error_and_missing_requirements(closed_design):
    slow = closed_design.replace({"gnss.correlated": True})
    assert {s.key for s in solve(slow)} <= set(SOLVED)
    keys = [k for k, v in slow.items() if k.startswith("requirements.") and isinstance(v, float) and "conf" not in k]
    with pytest.raises(InputError, match="at least one limit"):
        solve(slow.replace(dict.fromkeys(keys)))


@given(st.floats(1e-11, 0.09), st.sampled_from([1, 2, 3]), st.sampled_from(["°/√h", "°/h/√Hz", "rad/√s"]))
def test_a_typed_value_is_what_its_text_reads_as_and_not_above_the_value(value, digits, unit):
    design = Design({}, written={"imu.angle_random_walk": unit})
    rounded = rounded_offer(design, "imu.angle_random_walk", value, digits)
    text = quantity(rounded.key).write(rounded.value, rounded.unit)[1]
    number = text.split()[0]
    assert len(number.partition("e")[0].replace(".", "").strip("0")) <= digits
    assert quantity(rounded.key).read(text).value == rounded.value
    assert 0.5 * value < rounded.value <= value


def test_an_offer_is_typed_in_the_unit_of_the_design(open_design):
    """Not 0.024000000000000004."""
    solution = next(s for s in solve(open_design) if s.key == "imu.angle_random_walk")
    offered = offer(open_design, solution)
    assert offered.value == quantity(offered.key).read("0.024 °/√h").value
    assert offered.written == {"imu.angle_random_walk": "°/√h"}
