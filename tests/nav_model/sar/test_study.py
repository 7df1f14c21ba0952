"""The whole study against [S-1], [T-15] and its own parts."""

import numpy as np
import pytest

from nav_model.sar.axis_model import AxisModel, filter_drift, steady_covariance
from nav_model.sar.decomposition import decompose
from nav_model.sar.fast_engine import simulate_axis
from nav_model.sar.line_of_sight import ApertureGeometry
from nav_model.sar.strategies import STRATEGY_KEYS, Tuning
from nav_model.sar.study import choose_tuning, measure_runs, simulate_axes, typical_run

pytestmark = pytest.mark.long

WAVELENGTH = 0.031
GRAZING = 0.7
ARW, VRW = np.radians(0.15) / 60, 0.07 / 60
HORIZONTAL = AxisModel(VRW, ARW, 0.05, 1.0)
DOWN = AxisModel(VRW, ARW, 0.08, 1.0, horizontal=False)
GEOMETRY = ApertureGeometry(7000.0, 90.0, GRAZING)


def studied(models=(HORIZONTAL, HORIZONTAL, DOWN), span=6.0, window="uniform", order=1, runs=20, rate=25.0):
    axes = simulate_axes(models, span, 0.0, runs, np.random.SeedSequence(3), rate, Tuning())
    return measure_runs(axes, GEOMETRY, WAVELENGTH, models[1].fix_interval, window, order)


@pytest.fixture(scope="module")
def study():
    return studied(window="taylor", runs=800)


def test_measures_agree_with_the_histories(study):
    rms = np.sqrt(np.mean(study.residual**2, axis=-1))
    np.testing.assert_allclose(study.parts["residual_rms"], rms, rtol=1e-12)
    np.testing.assert_allclose(study.parts["detrended_rms"], rms, rtol=1e-9)
    assert study.parts["quadratic"].shape == (len(STRATEGY_KEYS), 800)
    assert study.fix_harmonics.shape == (len(STRATEGY_KEYS), 800, 3)
    assert study.responses["width_cells"][0] == pytest.approx(1.1875, abs=2e-4)
    assert study.responses["peak_loss_db"][0] == pytest.approx(0.0, abs=1e-6)
    typical = typical_run(study.parts["residual_rms"])
    assert abs(rms[1, typical] - np.median(rms[1])) < 0.02 * np.median(rms[1])


def test_the_raw_filter_saws_at_the_fix_rate_and_the_smoother_does_not(study):
    ripple = dict(zip(STRATEGY_KEYS, np.median(study.fix_harmonics[:, :, 0], axis=1), strict=True))
    assert ripple["4"] > 10 * ripple["8"]
    assert ripple["4"] > 10 * ripple["7"] or ripple["7"] < 0.5 * ripple["4"]
    assert np.median(study.jump_rms) > ripple["4"]


def test_jumps_are_those_of_the_filter_seen_along_the_line_of_sight(study):
    square = 0.0
    for model, weight in ((HORIZONTAL, np.cos(GRAZING)), (DOWN, np.sin(GRAZING))):
        phi, grown = filter_drift(model, model.fix_interval)
        prior = (phi @ steady_covariance(model) @ phi.T + grown)[0, 0]
        square += weight**2 * prior**2 / (prior + model.gnss_sigma**2)
    # The median of the rms of six jumps lies a few per cent below the rms itself.
    assert np.median(study.jump_rms) == pytest.approx(np.sqrt(square), rel=0.08)


def test_tuning_is_chosen_and_repeatable_and_better_than_a_bad_one():
    chosen = choose_tuning(HORIZONTAL, 6.0, seed=2)
    assert chosen == choose_tuning(HORIZONTAL, 6.0, seed=2)
    rms = {}
    for name, tuning in {
        "chosen": chosen,
        "stiff": Tuning(natural_frequency=8.0, proportional_gain=8.0, integral_gain=0.0),
        "slack": Tuning(natural_frequency=0.02, proportional_gain=0.02, integral_gain=0.0),
        "first": Tuning(natural_frequency=1 / 6, proportional_gain=1 / 12, integral_gain=0.0),
        "last": Tuning(natural_frequency=16 / 6, proportional_gain=16 / 6, integral_gain=0.0),
    }.items():
        result = simulate_axis(HORIZONTAL, 6.0, runs=300, seed=9, rate=50.0, tuning=tuning)
        rms[name] = [np.median(decompose(result.of(key)).detrended_rms) for key in ("6", "7")]
    for name, values in rms.items():
        assert np.all(np.array(rms["chosen"]) <= 1.03 * np.array(values)), name
    assert rms["stiff"][1] > 1.1 * rms["chosen"][1]


def test_fast_fixes_and_short_apertures_are_studied_too():
    fast = studied((AxisModel(VRW, ARW, 0.05, 0.04),) * 3, 0.8, runs=10, rate=50.0)
    assert fast.fix_harmonics.shape == (len(STRATEGY_KEYS), 10, 1)
    short = studied(span=0.7, runs=10, rate=50.0)
    assert short.fixes == 1
    assert np.isfinite(short.residual).all()
