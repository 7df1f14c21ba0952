"""Derivatives: against finite differences of `analyse`, against [T-18], and what a halving really does."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from nav_model.analytic.steady_state import horizontal
from nav_model.base.errors import InputError
from nav_model.budget import analyse
from nav_model.budget.figures import figures
from nav_model.budget.inputs import VARIABLES, inputs_of
from nav_model.design import Design
from nav_model.design.figures import REQUIRED
from nav_model.design.parts import declaration_of, quantity
from nav_model.design.processing import POST_PROCESSED, REAL_TIME
from nav_model.design.user_entries import read_entries
from nav_model.explore.margins import ratios
from nav_model.explore.rank import SENSORS, log_derivatives, rank, sentence, silent, stated


def _sigma(design, key, value, figure):
    checks = analyse(design.replace({key: value})).verdict.checks
    return next(check.sigma for check in checks if check.name == figure)


def _finite_difference(design, key, figure):
    h = 1e-4 if inputs_of(design).fast else 1e-3  # a line's phase turns many times over the aperture
    f = [np.log(_sigma(design, key, design[key] * (1 + k * h), figure)) for k in (-2, -1, 1, 2)]
    return (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * h)


@settings(max_examples=25)
@given(data=st.data())
def test_agrees_with_finite_differences_of_the_whole_analysis(data, designs):
    design = data.draw(designs)
    figure = data.draw(st.sampled_from(list(REQUIRED)))
    key = data.draw(st.sampled_from([key for key in stated(design) if design[key] != 0]))
    assume(abs(design[key]) > 1e-6 or key.startswith("imu"))  # an angle near zero leaves nothing to difference
    slope = float(log_derivatives(design, [key], [figure])[figure][0])
    assert slope == pytest.approx(_finite_difference(design, key, figure), rel=1e-6, abs=1e-6)


EVERYTHING = Design(
    {
        "imu.accelerometer_bias": 1e-3, "imu.gyro_bias": 1e-6,
        **{key: 1e-6 for key in VARIABLES if key.startswith(("gyro.", "accelerometer.")) and quantity(key).source},
        "gnss.vertical_position_noise": 2.0, "gnss.velocity_noise": 0.1, "gnss.vertical_velocity_noise": 0.2,
        "gnss.velocity_interval": 0.5, "gnss.correlated": True, "gnss.vertical_correlated_noise": 2.0,
        "coast.before_aperture": 2.0,
        "radar.squint_angle": 0.2, "processing.mode": POST_PROCESSED, "processing.scene_height_error": 5.0,
        "motion.lines": ((20.0, 1.0, "acceleration"),), "imu.bandwidth": 200.0, "motion.delay": 2e-3,
        "motion.rectification": 5e-7, "oscillator.frequency": 1e8,
        "oscillator.phase_noise": ((0.01, 1e-6, "phase noise"), (1e3, 1e-14, "phase noise")),
    }
)  # fmt: skip
CONDITIONAL = [key for key in VARIABLES if quantity(key).needs or quantity(key).unless]


def _moves(design, key):
    """True where any figure of either processing follows an input."""
    modes = (design.replace({"processing.mode": mode}) for mode in (REAL_TIME, POST_PROCESSED))
    slopes = [log_derivatives(each, [key], list(REQUIRED)) for each in modes]
    return any(np.any(np.nan_to_num(slope) != 0) for derivatives in slopes for slope in derivatives.values())


@pytest.mark.parametrize("key", CONDITIONAL)
def test_an_input_counts_where_its_declaration_says(key):
    section, declaration = key.partition(".")[0], quantity(key)
    absent = {f"{section}.{name}": declaration_of(f"{section}.{name}").default for name in declaration.needs}
    without = EVERYTHING.replace(absent | ({f"{section}.{declaration.unless}": 5.0} if declaration.unless else {}))
    assert EVERYTHING.uses(key)
    assert _moves(EVERYTHING, key)
    assert not without.uses(key)
    assert not _moves(without, key)


def test_sources_are_called_what_a_budget_calls_them():
    budget = analyse(EVERYTHING.replace({f"requirements.{name}": 1.0 for name in REQUIRED if name != "tilt"}))
    assert set(SENSORS.values()) <= {source for check in budget.verdict.checks for source in check.shares}


@pytest.mark.parametrize("figure", ["quadratic_phase", "horizontal_position", "coast_horizontal_position"])
def test_agrees_through_the_filter_with_a_slow_error(figure, open_design):
    """With a slow GNSS error the complex step passes through the augmented filter."""
    design = open_design.replace({"gnss.correlated": True, "coast.before_aperture": 3.0})
    keys = ["imu.angle_random_walk", "imu.velocity_random_walk", "gnss.position_noise", "gnss.interval",
            "gnss.correlated_noise", "gnss.correlation_time", "coast.before_aperture"]  # fmt: skip
    slopes = log_derivatives(design, keys, [figure])[figure]
    for key, slope in zip(keys, slopes, strict=True):
        now = float(figures(inputs_of(design), [figure])[figure])
        h = 1e-3
        values = np.array([design[key] * (1 + k * h) for k in (-2, -1, 1, 2)])
        f = np.log(np.broadcast_to(figures(inputs_of(design, {key: values}), [figure])[figure], 4) / now)
        assert slope == pytest.approx((f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * h), abs=1e-6)


def test_post_processed_slopes_are_the_shares(open_design):
    smoothed = open_design.replace({"processing.mode": "post-processed", "gnss.velocity_noise": 0.03})
    keys = ["imu.velocity_random_walk", "imu.angle_random_walk", "gnss.position_noise", "gnss.velocity_noise"]
    slopes = log_derivatives(smoothed, keys, ["quadratic_phase"])["quadratic_phase"]
    shares = analyse(smoothed)["quadratic_phase", "post-processed"].shares
    names = ("accelerometer noise", "gyro noise", "GNSS noise", "GNSS velocity noise")
    np.testing.assert_allclose(slopes, [shares[name] for name in names], rtol=1e-9)


def test_slopes_are_the_shares_of_the_closed_form(closed_design):
    """[T-18]: [T-3] differentiated by hand, where figures are that closed form."""
    design = closed_design.replace({"requirements.steady_state": "closed"})
    x = inputs_of(design)
    keys = ["imu.velocity_random_walk", "imu.angle_random_walk", "gnss.position_noise"]
    slopes_by_figure = log_derivatives(design, keys, ("horizontal_position", "tilt"))
    by_gyro = 2 * x.g * x.sigma_w * x.s**5 * horizontal(x.sigma_a, x.sigma_w, x.s, x.g).p11
    by_accelerometer = x.s**6 * x.sigma_a**2
    whole = 3 * by_gyro + 4 * by_accelerometer
    p11 = np.array([2 * by_accelerometer, by_gyro, 5 * by_gyro + 6 * by_accelerometer]) / whole
    np.testing.assert_allclose(slopes_by_figure["horizontal_position"], p11 / 2, rtol=1e-12)
    np.testing.assert_allclose(slopes_by_figure["tilt"], p11 + np.array([0, 1 / 2, -3 / 2]), rtol=1e-12)
    budget = analyse(design)
    for name, slopes in slopes_by_figure.items():
        assert list(budget[name, "real time"].shares.values()) == pytest.approx(list(slopes), rel=1e-12)


def test_sorted_and_halvings_are_exact(open_design):
    ranking = rank(open_design, "quadratic_phase")
    assert [abs(item.slope) for item in ranking] == sorted((abs(item.slope) for item in ranking), reverse=True)
    now = analyse(open_design)["quadratic_phase", "real time"].sigma
    for item in ranking:
        value = open_design[item.key]
        if not np.isnan(item.halved):
            half = analyse(open_design.replace({item.key: value / 2}))["quadratic_phase", "real time"].sigma
            assert item.halved == pytest.approx(half / now - 1, rel=1e-9, abs=1e-13)
    assert "imu.gyro_bias" in silent(open_design)
    assert "imu.gyro_bias" not in {item.key for item in ranking}


def test_unknown_figure(open_design):
    with pytest.raises(InputError, match="Choose "):
        rank(open_design, "weight")


def test_a_contributor_is_ranked_by_what_halving_it_really_does():
    """Against the design file with the halved value, through the whole analysis."""
    for kind in ("random", "systematic"):

        def given(value, kind=kind):
            table = {"name": "Lever arm", "enters": "detrended_phase", "value": value, "kind": kind}
            return Design(entries=read_entries({"contributors": [table]}))

        design = given("2 mm")
        item = next(item for item in rank(design, "detrended_phase") if item.label == "Lever arm")
        now, halved, doubled = (analyse(given(size)).figure("detrended_phase") for size in ("2 mm", "1 mm", "4 mm"))
        assert item.halved == pytest.approx(halved.sigma / now.sigma - 1, rel=1e-12)
        assert item.doubled == pytest.approx(doubled.sigma / now.sigma - 1, rel=1e-12)
        assert item.slope == pytest.approx(now.shares["Lever arm"], rel=1e-12)
        slopes = [each.slope for each in rank(design, "detrended_phase") if each.key in SENSORS]
        assert sum(slopes) + item.slope == pytest.approx(1)
        assert not [entry for entry in rank(design, "tilt") if entry.label == "Lever arm"]


def test_an_angle_that_cannot_be_flown_is_not_offered_and_a_coarser_image_is_named():
    nadir = {item.key: item for item in rank(Design({"radar.grazing_angle": np.pi / 4}), "detrended_phase")}
    assert np.isnan(nadir["radar.grazing_angle"].doubled)
    flown = {item.key: item for item in rank(Design({"radar.grazing_angle": np.pi / 6}), "detrended_phase")}
    assert np.isfinite(flown["radar.grazing_angle"].doubled)
    assert "which makes the image coarser" in sentence(flown["radar.azimuth_resolution"], "Detrended phase")
    assert not flown["radar.grazing_angle"].bought


def test_a_scene_nearer_than_the_ground_below_is_not_offered():
    """Half of 7 km is less than 4 km of height, but more than 3 km, be it over high ground."""
    for height, ground, possible in ((4000.0, 0.0, False), (3000.0, 0.0, True), (4000.0, 1000.0, True)):
        design = Design(
            {"radar.slant_range": 7000.0, "flight.altitude": height, "trajectory.ground": ground,
             "radar.grazing_angle": math.radians(30)}
        )  # fmt: skip
        halved = {item.key: item.halved for item in rank(design, "detrended_phase")}["radar.slant_range"]
        assert np.isfinite(halved) == possible


def test_a_change_that_leaves_no_line_of_sight_is_not_possible():
    """The design would be refused, and so are its figures on maps, in sweeps and backwards."""
    steep = Design({"radar.squint_angle": math.radians(22), "radar.grazing_angle": math.radians(55)})
    with pytest.raises(InputError, match="no line of sight"):
        analyse(steep.replace({"radar.squint_angle": math.radians(44)}))
    for name in ("azimuth_shift", "quadratic_phase"):
        by_key = {item.key: item for item in rank(steep, name)}
        assert np.isnan(by_key["radar.squint_angle"].doubled)
        assert math.isfinite(by_key["radar.squint_angle"].halved)
    limited = steep.replace({"requirements.tilt": 1.0})
    values = ratios(limited, {"radar.squint_angle": np.radians([22.0, 44.0])})["tilt"]
    assert np.isnan(values).tolist() == [False, True]
