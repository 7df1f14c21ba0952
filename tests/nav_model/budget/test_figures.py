"""Arrays of designs give what `analyse` gives one at a time."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nav_model.base.errors import InputError
from nav_model.budget import analyse
from nav_model.budget.figures import figures
from nav_model.budget.inputs import VARIABLES, inputs_of
from nav_model.design.figures import REQUIRED
from nav_model.explore.margins import ratios, worst
from nav_model.explore.solve import SOLVED


@settings(max_examples=60)
@given(data=st.data())
def test_equal_to_analyse(data, designs):
    mode, leg = data.draw(st.sampled_from(["real time", "post-processed"])), data.draw(st.sampled_from([20.0, 300.0]))
    design = data.draw(designs).replace({"processing.mode": mode, "processing.leg_after": leg})
    verdict = analyse(design).verdict
    result, over = figures(inputs_of(design)), ratios(design)
    assert [check.name for check in verdict.checks] == list(REQUIRED)
    near = 1e-12 if mode == "real time" else 1e-7  # an outage or a least squares in complex numbers rounds otherwise
    for check in verdict.checks:
        assert float(result[check.name]) == pytest.approx(check.sigma, rel=near)
        assert 1 - float(over[check.name]) == pytest.approx(check.margin, abs=10 * near * (1 + abs(check.margin)))
    assert bool(worst(over) <= 1) == verdict.closes


def test_slow_error_too(closed_design):
    design = closed_design.replace({"gnss.correlated": True, "coast.before_aperture": 5.0})
    result = figures(inputs_of(design))
    for check in analyse(design).verdict.checks:
        assert float(result[check.name]) == pytest.approx(check.sigma, rel=1e-14)


def test_arrays_are_designs_side_by_side(closed_design):
    x, y = np.geomspace(1e-6, 1e-3, 5), np.geomspace(0.01, 5, 4)
    grid = figures(inputs_of(closed_design, {"imu.angle_random_walk": x[None, :], "gnss.position_noise": y[:, None]}))
    for j, noise in enumerate(y):
        for i, walk in enumerate(x):
            case = closed_design.replace({"imu.angle_random_walk": float(walk), "gnss.position_noise": float(noise)})
            for check in analyse(case).verdict.checks:
                value = np.broadcast_to(grid[check.name], (4, 5))[j, i]
                assert value == pytest.approx(check.sigma, rel=1e-13), check.name


@settings(max_examples=60)
@given(data=st.data())
def test_every_figure_grows_with_every_noise_interval_and_time(data, designs):
    """Monotone where theory says so: what makes solving backwards a single root."""
    design = data.draw(designs)
    key = data.draw(st.sampled_from(SOLVED))
    now = design[key] or {"radar.aperture_time": 2.0, "gnss.vertical_position_noise": 1.0}.get(key, 1.0)
    values = now * np.linspace(1.0, 1.5, 6)
    for name, value in figures(inputs_of(design, {key: values})).items():
        steps = np.diff(np.broadcast_to(value, values.shape))
        assert np.all(steps >= -1e-13 * value.max()), name


def test_an_aperture_beyond_the_bound_has_no_phase(closed_design):
    result = figures(inputs_of(closed_design, {"radar.azimuth_resolution": np.array([0.3, 1e-4])}))
    assert np.isnan(result["quadratic_phase"]).tolist() == [False, True]
    with pytest.raises(InputError, match="azimuth_resolution"):
        analyse(closed_design.replace({"radar.azimuth_resolution": 1e-3, "radar.slant_range": 1e6}))


def test_what_is_no_number_of_a_figure_is_refused(closed_design):
    for key in ("radar.window", "imu.rate", "requirements.tilt", "nothing.here"):
        with pytest.raises(InputError, match="no figure depends"):
            inputs_of(closed_design, {key: 1.0})
    assert "imu.angle_random_walk" in VARIABLES
