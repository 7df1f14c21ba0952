"""Errors that a data sheet prints beside noise, in every figure of a budget."""

import math
from dataclasses import replace

import numpy as np
import pytest
import varying_bias as oracle
from hypothesis import given, settings
from hypothesis import strategies as st

from app.report.workings import Traces
from nav_model.analytic.refined_coast import coupling
from nav_model.analytic.rise import gravity_gradient
from nav_model.aperture.geometry import line_of_sight_weights
from nav_model.base.constants import EARTH_RATE, MEAN_RADIUS
from nav_model.budget import analyse
from nav_model.budget.inputs import inputs_of
from nav_model.budget.real_time import RealTime
from nav_model.budget.smoothed import Smoothed, model_of
from nav_model.budget.varying import channels
from nav_model.design import Design
from nav_model.design.figures import FIGURES, OF_BUDGET, STEADY

DEGREE, HOUR = math.pi / 180, 3600.0
FILLED = {
    "accelerometer.bias_instability": 2e-3, "accelerometer.correlation_time": 400.0,
    "accelerometer.rate_random_walk": 1e-6, "gyro.bias_instability": 1 * DEGREE / HOUR,
    "gyro.correlation_time": 900.0, "gyro.rate_random_walk": 2e-9,
}  # fmt: skip
STATES = tuple(key for key in FILLED if "time" not in key)
BESIDE = {
    "accelerometer.turn_on_bias": 0.01, "accelerometer.misalignment": 5e-4, "gyro.turn_on_bias": 2 * DEGREE / HOUR,
    "gyro.scale_factor": 1e-3, "gyro.misalignment": 1e-3, "gyro.g_sensitivity": 1 * DEGREE / HOUR / 9.80665,
}  # fmt: skip


def sigmas(design: Design, names=OF_BUDGET) -> dict[str, float]:
    model = model_of(inputs_of(design))
    return {name: float(model.value(name)) for name in names}


@pytest.mark.long
def test_real_time_is_a_filter_of_all_states(closed_design, compared):
    """Steady state, outage and phase of a budget, against SciPy's filter of seven states."""
    off, closed = [], []
    for change in ({}, {"coast.before_aperture": 8.0}, {"gnss.velocity_noise": 0.02}, {"gnss.correlated": True}):
        design = closed_design.replace(FILLED | {"requirements.steady_state": "posterior"} | change)
        x = inputs_of(design)
        model, (level, upright) = RealTime(x), channels(x)
        if x.velocity is not None:
            level, upright = (replace(c, velocity_interval=x.interval) for c in (level, upright))
        of_level, of_upright = (oracle.after_a_fix(c)[1] for c in (level, upright))
        theirs = {
            "horizontal_position": of_level[0, 0], "vertical_position": of_upright[0, 0],
            "horizontal_velocity": of_level[1, 1], "vertical_velocity": of_upright[1, 1],
        }  # fmt: skip
        time, gradient = float(x.duration), float(gravity_gradient(x.g))
        ends = []
        for channel, start, rise in ((level, of_level, -gradient / 2), (upright, of_upright, gradient)):
            f, q = (np.pad(part, (0, 2)) for part in oracle.model(channel, rise))
            f[7, 8] = f[8, 1] = 1.0
            f[8, 7] = gradient
            ends.append(oracle.carried(f, q, np.pad(start, (0, 2)), time, 100.0))
        coupled = float(coupling(x.speed, x.latitude, x.altitude, x.heading)) * ends[0][7, 7]
        theirs |= {
            "coast_horizontal_position": ends[0][0, 0], "coast_vertical_position": ends[1][0, 0] + coupled,
            "coast_horizontal_velocity": ends[0][1, 1],
        }  # fmt: skip
        off += [float(model.value(name)) / math.sqrt(value) - 1 for name, value in theirs.items()]
        # The aperture begins with the average between fixes: what the biases add is that just after one.
        white = RealTime(replace(x, instability_a=None))
        weights = line_of_sight_weights(x.grazing_angle)
        for column in ("quadratic", "cubic", "left_1"):
            with_them, without = (
                sum(
                    float(weight) * oracle.along(channel, float(x.before_aperture), float(x.aperture))[column]
                    for weight, channel in zip(weights, pair, strict=True)
                )
                for pair in ((level, upright), channels(replace(white.x, velocity_interval=x.interval)))
            )
            ours = float(model.sight_variance(column) - white.sight_variance(column))
            closed.append(ours / (with_them - without) - 1)
    name = "SciPy's filter of seven states, written out in the test"
    compared("Steady state and outage of a budget with varying biases", "T-21", "solver written by others", name, off,
             1e-3)  # fmt: skip
    compared("What varying biases add to phase", "T-21", "solver written by others", name, closed, 1e-3,
             "largest ratio − 1 of what they add to the variance")  # fmt: skip


@pytest.mark.parametrize("mode", ["real time", "post-processed"])
def test_nothing_jumps_at_zero(mode, closed_design):
    """Nearly none of a bias gives the figure of none."""
    design = closed_design.replace({"processing.mode": mode, "gnss.correlated": True})
    before = sigmas(design)
    for key in STATES:
        for name, value in sigmas(design.replace({key: FILLED[key] * 1e-7})).items():
            assert value == pytest.approx(before[name], rel=1e-6), (key, name)


@pytest.mark.long
@pytest.mark.parametrize("mode", ["real time", "post-processed"])
@settings(max_examples=150)
@given(data=st.data())
def test_more_error_is_never_better(mode, data, designs):
    """Of 300 random designs, each with every error: one of them raised, or what it was nothing before."""
    scale = data.draw(st.floats(-2, 1).map(lambda x: 10.0**x))
    filled = {
        key: value * (scale if key not in BESIDE and "time" not in key else 1.0) for key, value in FILLED.items()
    }
    design = data.draw(designs).replace({**filled, **BESIDE, "processing.mode": mode})
    key = data.draw(st.sampled_from([*STATES, *BESIDE]))
    factor = data.draw(st.sampled_from([1.2, 5.0]))
    names = [name for name in OF_BUDGET if FIGURES[name].kind != "response"]  # side lobes may fall as the peak does
    before, after = sigmas(design, names), sigmas(design.replace({key: design[key] * factor}), names)
    for name, value in after.items():
        assert value >= before[name] * (1 - 1e-7), (name, key, factor)


@pytest.mark.long
@pytest.mark.parametrize("mode", ["real time", "post-processed"])
def test_shares_are_of_every_source(mode, closed_design):
    """Under names of their own, and those of a step of each size."""
    design = closed_design.replace({**FILLED, **BESIDE, "processing.mode": mode})
    budget, sources = analyse(design), {
        "accelerometer bias instability": "accelerometer.bias_instability",
        "gyro bias instability": "gyro.bias_instability",
        "gyro bias random walk": "gyro.rate_random_walk",
        "accelerometer turn-on bias": "accelerometer.turn_on_bias",
        "accelerometer misalignment": "accelerometer.misalignment",
        "gyro turn-on bias": "gyro.turn_on_bias",
        "gyro scale factor": "gyro.scale_factor",
        "gyro misalignment": "gyro.misalignment",
        "gyro g-sensitivity": "gyro.g_sensitivity",
    }  # fmt: skip
    for name in ("quadratic_phase", "tilt", "coast_horizontal_position", "coast_heading", "range_shift"):
        # Shares of the settled filter are of its average between fixes.
        average = design.replace({"requirements.steady_state": "closed"})
        for source, key in sources.items():
            more, less = (
                sigmas(average.replace({key: design[key] * (1 + step)}), [name])[name] for step in (1e-4, -1e-4)
            )
            share = math.log(more / less) / 2e-4
            assert budget[name, mode].shares[source] == pytest.approx(share, rel=1e-3, abs=1e-6), (name, source)


@pytest.mark.parametrize("mode", ["real time", "post-processed"])
def test_a_straight_leg_does_not_show_what_is_constant(mode, closed_design):
    """Turn-on biases, misalignment and scale factor: tilt and heading take them, and nothing else."""
    design = closed_design.replace({"processing.mode": mode})
    before, after = sigmas(design), sigmas(design.replace(BESIDE))
    changed = {name for name in OF_BUDGET if after[name] != pytest.approx(before[name], rel=1e-12)}
    assert changed == {"tilt", "coast_tilt", "coast_heading"}
    tilt = math.hypot(before["tilt"], 0.01 / design.flight.gravity, 5e-4)
    assert after["tilt"] == pytest.approx(tilt, rel=1e-9)
    f, t = design.flight, design.coast.duration
    around = EARTH_RATE * math.cos(f.latitude)
    ahead = f.speed / (MEAN_RADIUS + f.altitude)
    level = math.hypot(around + ahead * math.sin(f.heading), ahead * math.cos(f.heading))
    rates = (
        BESIDE["gyro.turn_on_bias"], 1e-3 * EARTH_RATE * math.sin(f.latitude), 1e-3 * level,
        BESIDE["gyro.g_sensitivity"] * f.gravity,
    )  # fmt: skip
    assert after["coast_heading"] == pytest.approx(math.hypot(before["coast_heading"], *(rate * t for rate in rates)))


def test_heading_of_an_instability():
    """0.012 °/√h, 0.05 °/h over 900 s, 600 s from 0.01°: 0.01343°."""
    design = Design(
        {"imu.angle_random_walk": 0.012 * DEGREE / 60, "coast.duration": 600.0, "imu.gyro_bias": 0.0,
         "gyro.bias_instability": 0.05 * DEGREE / HOUR, "gyro.correlation_time": 900.0}
    )  # fmt: skip
    growth = sigmas(design, ["coast_heading"])["coast_heading"] / DEGREE
    assert math.hypot(0.01, growth) == pytest.approx(0.01343, abs=5e-6)


def test_rate_random_walk_counts_from_the_start(closed_design):
    """K √t / g of tilt and K √(t³/3) of heading, beside the settled filter's own."""
    time, walk = closed_design.coast.duration, 1e-5
    design = closed_design.replace({"requirements.steady_state": "posterior"})
    x = inputs_of(design.replace({"accelerometer.rate_random_walk": walk}))
    settled = RealTime(x).started(RealTime(x).cycle.posterior).horizontal.p33
    tilt = math.sqrt(float(settled) + (walk / x.g) ** 2 * time + float(x.bias / x.g) ** 2)
    assert float(RealTime(x).tilt) == pytest.approx(tilt)
    before, after = (
        sigmas(design.replace({"gyro.rate_random_walk": k}), ["coast_heading"])["coast_heading"] for k in (0.0, 1e-8)
    )
    assert math.sqrt(after**2 - before**2) == pytest.approx(1e-8 * math.sqrt(time**3 / 3))


@pytest.mark.long
def test_arrays_are_designs_side_by_side(closed_design):
    """A sweep over an instability, zero among them, and its correlation time."""
    design = closed_design.replace(FILLED)
    sizes, times = np.array([0.0, 1e-4, 1e-2]), np.array([[30.0], [3000.0]])
    changes = {"gyro.bias_instability": sizes * DEGREE / HOUR, "gyro.correlation_time": times}
    for of in (RealTime, Smoothed):
        together = of(inputs_of(design, changes))
        for name in ("quadratic_phase", "coast_horizontal_position", "coast_tilt", "coast_heading", *STEADY):
            table = together.value(name)
            for i, n in np.ndindex(2, 3):
                one = {"gyro.bias_instability": sizes[n] * DEGREE / HOUR, "gyro.correlation_time": times[i, 0]}
                alone = of(inputs_of(design.replace(one))).value(name)
                table = np.broadcast_to(table, (2, 3))
                assert table[i, n] == pytest.approx(float(alone), rel=1e-7), (name, one)


@pytest.mark.long
@pytest.mark.parametrize("change", [{}, {"gnss.correlated": True}])
def test_the_workbook_has_them(change, closed_design):
    """Its formulas, and what no formula has, give the figures of the budget."""
    design = closed_design.replace(FILLED | BESIDE | change)
    model, named = RealTime(inputs_of(design)), Traces(design).workings.named
    cells = {name: named[f"real_time_{name}"].value for name in OF_BUDGET if f"real_time_{name}" in named}
    assert {"quadratic_phase", "coast_heading", "coast_horizontal_position", "range_shift"} <= cells.keys()
    for name, value in cells.items():
        assert value == pytest.approx(float(model.value(name)), rel=1e-9), name
    for state in ("prior", "posterior"):
        for name in STEADY:
            assert named[f"{state}_{name}"].value == pytest.approx(
                float(model.at(model.moment(state)).value(name)), rel=1e-9
            )
