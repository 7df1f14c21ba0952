"""The whole-leg smoother in the study: error model and flights against the formulas, and where it may win."""

import math

import numpy as np
import pytest
from scipy.stats import chi2

from nav_model.budget import analyse
from nav_model.design.user_entries import read_entries
from nav_model.sar.decomposition import autofocus, decompose
from nav_model.sar.design_case import design_case, judged, study_cautions
from nav_model.sar.design_map import arw_map, gnss_map
from nav_model.sar.design_study import closed_forms, image_study
from nav_model.sar.flown_engine import fly_axes
from nav_model.sar.line_of_sight import range_error
from nav_model.sar.strategies import STRATEGY_KEYS, Tuning
from nav_model.sar.study import simulate_axes
from nav_model.sar.study_json import to_json

LEG = STRATEGY_KEYS.index("9")
POST = {"processing.mode": "post-processed"}
VELOCITY = {"gnss.velocity_noise": 0.03}
SHORT = {"processing.leg_after": 10.0}
SLOW = {"gnss.correlated": True, "gnss.correlated_noise": 0.3, "gnss.correlation_time": 60.0}
BIASED = {"imu.accelerometer_bias": 5e-3, "imu.gyro_bias": 1e-5, "radar.squint_angle": 0.4}


def measured(case, axes):
    error = range_error(case.geometry, axes[0].time, *(axis.error[LEG] for axis in axes))
    parts = decompose(error)
    return {
        "quadratic": parts.quadratic,
        "detrended": parts.detrended_rms,
        "after order 2": np.sqrt(np.mean(autofocus(error, 2) ** 2, axis=-1)),
    }


def agree(design, results, runs, slack=0.0):
    """Rms of the runs over the formula lies where that of so many normal errors would, but for once in ten thousand.

    ``slack`` is for what a mean over samples is more than one over time.
    """
    budget, second = analyse(design), analyse(design.replace({"radar.autofocus_order": 2}))
    closed = closed_forms(budget)
    expected = (closed.quadratic["9"], closed.detrended["9"], closed_forms(second).detrended["9"])
    low, high = (math.sqrt(chi2.ppf(share, runs) / runs) for share in (5e-5, 1 - 5e-5))
    for (name, values), sigma in zip(results.items(), expected, strict=True):
        ratio = math.sqrt(np.mean(values**2)) / sigma
        assert low - slack < ratio < high + slack, (name, ratio)


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("MEMS", {}), ("MEMS", VELOCITY | SHORT), ("MEMS", SHORT | SLOW | VELOCITY), ("tactical", SHORT),
        ("tactical", BIASED),
    ],
)  # fmt: skip
def test_the_error_model_confirms_the_formulas(open_design, closed_design, name, changes):
    """A thousand runs of each: within 9 % and 1 % more."""
    design = (closed_design if name == "tactical" else open_design).replace(changes)
    case = design_case(analyse(design))
    axes = simulate_axes(
        case.models, case.aperture_time, 0.0, 1000, np.random.SeedSequence(3), 300 / case.aperture_time, Tuning()
    )
    agree(design, measured(case, axes), 1000, 0.01)


def flown(design, runs):
    case = design_case(analyse(design), "simulator")
    return measured(case, fly_axes(case.flight, case.models, case.aperture_time, case.rate, 5, 0, runs, Tuning()))


def test_a_few_flights_in_a_short_leg(open_design):
    """Twenty flights whose smoother ends 10 s after the aperture: within 60 %."""
    design = open_design.replace(SHORT | {"imu.rate": 20.0})
    agree(design, flown(design, 20), 20)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "changes"), [("MEMS", {}), ("MEMS", SHORT), ("MEMS", VELOCITY | SHORT), ("tactical", VELOCITY)]
)
def test_three_hundred_flights(open_design, closed_design, name, changes):
    """Within 16 %, which 300 normal errors leave but once in ten thousand."""
    design = (closed_design if name == "tactical" else open_design).replace({"imu.rate": 25.0} | changes)
    agree(design, flown(design, 300), 300)


def test_a_leg_that_ends_with_the_aperture_leaves_the_rts_smoother(closed_design):
    """No fix after the aperture and a long leg before it: both smoothers have the same fixes, run by run."""
    case = design_case(analyse(closed_design.replace({"processing.leg_after": 0.0})))
    axes = simulate_axes(case.models, case.aperture_time, 0.0, 50, np.random.SeedSequence(1), 50.0, Tuning())
    for axis in axes:
        apart = autofocus(axis.of("9") - axis.of("8"))
        assert math.sqrt(np.mean(apart**2)) < 0.03 * math.sqrt(np.mean(autofocus(axis.of("8")) ** 2))


def test_it_wins_only_where_the_processing_allows(open_design):
    now, later = (image_study(design, 40, 1) for design in (open_design, open_design.replace(POST)))
    np.testing.assert_array_equal(now.rms, later.rms)
    assert now.best().key != "9"
    assert now.closed.advice.strategy != "9"
    assert "Post-processed, Whole-leg smoother leaves" in now.sentence
    assert "needs post-processing, so it cannot be chosen" in now.closed.advice.because
    assert later.best().key == later.closed.advice.strategy == "9"
    assert "It needs post-processing." in later.sentence
    assert later.closed.advice.sentence.endswith(
        "Whole-leg smoother: smooth the trajectory after the flight, with the "
        "fixes before, in and after the aperture."
    )
    assert later.best(causal=True).key == now.best(causal=True).key
    assert now.closed.detrended == later.closed.detrended
    for drawn, allowed in ((gnss_map(now.budget, 20), False), (arw_map(later.budget, 20), True)):
        assert ("9" in drawn.strategies) == allowed
    result = gnss_map(later.budget, 20)
    assert np.any(result.winner == result.strategies.index("9"))
    plain = gnss_map(now.budget, 20)
    assert np.all(result.phase <= plain.phase * 1.05)
    assert any("it is shown for reference" in caution for caution in study_cautions(now.budget))
    assert any("so it can be the best" in caution for caution in study_cautions(later.budget))
    data = to_json(later)
    assert data["processing"] == {"mode": "post-processed", "leg_after_s": 200.0}
    assert data["strategies"][-1]["timing"] == "post-processed"
    assert not data["strategies"][-1]["causal"]
    assert data["strategies"][-1]["closed_form"]["residual_rms_m"] == later.closed.detrended["9"]


def test_the_formula_is_the_budgets_post_processed_figure(open_design, closed_design):
    for design in (open_design, closed_design.replace(VELOCITY | SHORT)):
        budget = analyse(design)
        closed = closed_forms(budget)
        to_phase = 4 * math.pi / budget.sar.wavelength
        assert to_phase * closed.quadratic["9"] == pytest.approx(
            budget["quadratic_phase", "post-processed"].sigma, rel=1e-12
        )
        assert to_phase * closed.detrended["9"] == pytest.approx(
            budget["detrended_phase", "post-processed"].sigma, rel=1e-12
        )


@pytest.mark.parametrize("processing", ["real time", "post-processed"])
def test_contributors_count_in_the_strategy_that_is_judged_as_on_budget(open_design, processing):
    entries = read_entries(
        {
            "contributors": [
                {"name": "lever arm", "value": "2 mm", "enters": "detrended_phase"},
                {"name": "clock", "value": "3°", "enters": "quadratic_phase", "kind": "systematic"},
                {"name": "before", "value": "5°", "enters": "detrended_phase", "processing": "real time"},
            ]
        }
    )
    for coast in (0.0, 4.0):
        changes = {"processing.mode": processing, "coast.before_aperture": coast}
        budget = analyse(open_design.replace(changes, entries=entries))
        closed, to_phase = closed_forms(budget), 4 * math.pi / budget.sar.wavelength
        key = judged(budget.design)
        assert to_phase * closed.detrended[key] == pytest.approx(budget.figure("detrended_phase").sigma, rel=1e-9)
        assert to_phase * closed.quadratic[key] == pytest.approx(budget.figure("quadratic_phase").sigma, rel=1e-9)
        bare = closed_forms(analyse(open_design.replace(changes)))
        assert all(value > bare.detrended[name] for name, value in closed.detrended.items() if value is not None)
