"""Vibration, unsensed motion and oscillator in a budget: phase by source, echoes, limits, image, refusals."""

import math

import numpy as np
import pytest

from nav_model.base.errors import InputError
from nav_model.budget import analyse
from nav_model.budget.figures import figures
from nav_model.budget.inputs import inputs_of
from nav_model.budget.json import to_json
from nav_model.design.processing import POST_PROCESSED
from nav_model.explore.margins import ratios
from nav_model.explore.rank import rank, silent
from nav_model.explore.solve import solve

G = 9.80665
UNSENSED = {"motion.unsensed_lines": ((12.0, 1e-4, "length"),)}
SOURCES = UNSENSED | {
    "motion.lines": ((20.0, G, "acceleration"),),
    "motion.spectrum": tuple(
        (f, d * G**2, "acceleration density") for f, d in ((5.0, 1e-3), (20.0, 0.04), (2e3, 1e-3))
    ),
    "motion.delay": 2e-4,
    "motion.rectification": 1e-6 / G,
    "oscillator.phase_noise": ((0.1, 1e-7, "phase noise"), (10.0, 1e-11, "phase noise"), (1e3, 1e-14, "phase noise")),
    "oscillator.bistatic": True,
}


@pytest.fixture(scope="module")
def full(open_design):
    return open_design.replace(SOURCES)


def test_shares_sum_to_one_with_every_source(full):
    budget = analyse(full)
    names = {"vibration", "unsensed motion", "oscillator", "vibration rectification"}
    assert names <= {line.source for line in budget.phase_lines("real time")}
    lines = budget.phase_lines("real time")
    for field in ("share", "detrended_share"):
        assert math.fsum(getattr(line, field) for line in lines) == pytest.approx(1, abs=1e-12)
    for figure in budget.values():
        assert math.fsum(figure.shares.values()) == pytest.approx(1, abs=1e-9)


@pytest.mark.parametrize("name", ["quadratic", "cubic", "detrended"])
def test_variances_add_up_post_processed(open_design, full, name):
    """What the sources add to the smoothed variance is what they are in real time, where nothing smooths them."""
    without, made = analyse(open_design), analyse(full)
    phases = (budget[f"{name}_phase", "post-processed"].sigma for budget in (made, without))
    added = next(phases) ** 2 - next(phases) ** 2
    lines = [
        line
        for line in made.phase_lines("real time")
        if line.source in ("vibration", "unsensed motion", "oscillator")
    ]
    alone = sum(getattr(line, name) ** 2 for line in lines)
    assert added == pytest.approx(alone, rel=1e-6)


def test_an_echo_is_where_the_doppler_of_its_line_is(open_design):
    budget = analyse(open_design.replace(UNSENSED))
    (echo,) = budget.spectral.echoes
    wavelength, radar = budget.sar.wavelength, open_design.radar
    assert echo.offset == pytest.approx(
        12.0 * wavelength * radar.slant_range / (2 * open_design.flight.speed), rel=1e-12
    )
    p = 4 * math.pi / wavelength * 1e-4
    assert 20 * math.log10(echo.level) == pytest.approx(20 * math.log10(p / 2 * (1 + p**2 / 8)), abs=1e-4)
    spectral = to_json(budget)["spectral"]
    assert spectral["echoes"][0]["level_db"] == pytest.approx(20 * math.log10(echo.level))
    assert budget.response("real time").pslr_fixed_db >= spectral["echoes"][0]["level_db"]


def test_vibration_is_what_the_delay_leaves(open_design):
    """20 Hz at 1 g is 0.62 mm, of which 5 ms leave 62 %; a delay or a bandwidth is needed for any to be left."""
    line = {"motion.lines": ((20.0, G, "acceleration"),)}
    (echo,) = analyse(open_design.replace(line | {"motion.delay": 5e-3})).spectral.echoes
    metres = echo.phase * 0.0312283810 / (4 * math.pi)
    assert metres == pytest.approx(0.6210e-3 * 0.6180, rel=1e-3)
    assert analyse(open_design.replace(line)).spectral.echoes == ()
    (slow,) = analyse(open_design.replace(line | {"imu.bandwidth": 20.0})).spectral.echoes
    assert slow.phase / echo.phase == pytest.approx(math.sqrt(0.5) / 0.6180, rel=1e-3)  # at its corner


def test_rectification_is_a_bias(open_design):
    """0.1 g rms of a line and 0.2 g rms of a band make 50 µg/g² a bias of 2.5 µg."""
    motion = {
        "motion.lines": ((20.0, 0.1 * math.sqrt(2) * G, "acceleration"),),
        "motion.spectrum": (
            (10.0, 0.04 / 90 * G**2, "acceleration density"),
            (100.0, 0.04 / 90 * G**2, "acceleration density"),
        ),
        "motion.rectification": 50e-6 / G,
    }
    stated = analyse(open_design.replace({"imu.accelerometer_bias": 2.5e-6 * G}))
    made = analyse(open_design.replace(motion))
    assert made["quadratic_phase", "real time"].sigma == pytest.approx(
        stated["quadratic_phase", "real time"].sigma, rel=1e-12
    )
    np.testing.assert_allclose(made.coast.position_horizontal, stated.coast.position_horizontal, rtol=1e-12)
    assert made["coast_horizontal_position", "real time"].shares["vibration rectification"] == pytest.approx(
        stated["coast_horizontal_position", "real time"].shares["accelerometer bias"], rel=1e-9
    )
    assert made["quadratic_phase", "post-processed"].sigma == pytest.approx(
        stated["quadratic_phase", "post-processed"].sigma, rel=1e-12
    )


def test_an_oscillator_of_one_radar_cancels_what_is_slow(open_design):
    noise = {key: value for key, value in SOURCES.items() if key == "oscillator.phase_noise"}
    mono, bi = (analyse(open_design.replace(noise | {"oscillator.bistatic": both})) for both in (False, True))

    def of(budget):
        return next(line for line in budget.phase_lines("real time") if line.source == "oscillator")

    assert of(bi).quadratic > 1000 * of(mono).quadratic > 0
    at_ten = analyse(open_design.replace(noise | {"oscillator.bistatic": True, "oscillator.frequency": 10e6}))
    assert of(at_ten).quadratic == pytest.approx(of(bi).quadratic * open_design.radar.frequency / 10e6, rel=1e-9)


def test_limits_in_decibels(open_design):
    design = open_design.replace(
        UNSENSED
        | {"requirements.paired_echo": 10 ** (-30 / 20), "requirements.islr": 0.1, "requirements.confidence": 2.0}
    )
    for mode in ("real time", POST_PROCESSED):
        checks = {
            check["name"]: check
            for check in to_json(analyse(design.replace({"processing.mode": mode})))["verdict"]["requirements"]
        }
        echo, islr = checks["paired_echo"], checks["islr"]
        assert echo["limit"] == pytest.approx(-30)
        assert echo["value"] == pytest.approx(-33.93, abs=0.01)  # the confidence does not multiply it
        assert echo["met"]
        assert echo["margin"] == pytest.approx(1 - 10 ** ((echo["value"] + 30) / 20))
        assert islr["value"] == pytest.approx(echo["value"] + 10 * math.log10(2), abs=0.01)  # an echo on each side
        result = ratios(design.replace({"processing.mode": mode}))
        assert 1 - float(result["paired_echo"]) == pytest.approx(echo["margin"], abs=1e-12)


def test_without_sources_nothing_is_thrown_out(open_design):
    design = open_design.replace({"requirements.paired_echo": 0.03, "requirements.islr": 0.03})
    budget = analyse(design)
    assert budget.spectral.echoes == ()
    assert not budget.has_fast_sources
    for check in budget.verdict.checks:
        if check.name in ("paired_echo", "islr"):
            assert check.met
            assert check.margin == pytest.approx(1)
    assert to_json(analyse(open_design))["sar"] == to_json(budget)["sar"]


def test_a_delay_longer_than_the_aperture_is_refused_by_name(full):
    with pytest.raises(InputError) as caught:
        analyse(full.replace({"motion.delay": 6.0}))
    assert caught.value.key == "motion.delay"
    assert "longer than the aperture" in caught.value.reason


def test_arrays_and_slopes(full):
    delays = np.geomspace(1e-4, 1e-2, 4)
    result = figures(inputs_of(full, {"motion.delay": delays}))
    for n, delay in enumerate(delays):
        values = figures(inputs_of(full.replace({"motion.delay": float(delay)})))
        for name, value in values.items():
            assert np.broadcast_to(result[name], 4)[n] == pytest.approx(float(value), rel=1e-12), name
    by_key = {item.key: item for item in rank(full, "islr")}
    scaled = figures(inputs_of(full, {"motion.delay": 2e-4 * np.array([0.999, 1.001])}), ("islr",))["islr"]
    assert by_key["motion.delay"].slope == pytest.approx(
        math.log(scaled[1] / scaled[0]) / math.log(1.001 / 0.999), rel=1e-4
    )


def test_inputs_that_nothing_uses_are_not_ranked(open_design):
    assert not [key for key in silent(open_design) if key.startswith(("motion.", "oscillator."))]


def test_both_sidebands_of_the_oscillator_count(open_design):
    """-60 dBc/Hz over 100 Hz is 2·10⁻⁴ rad² as everyone integrates L(f): an ISLR of -37 dB where nothing cancels."""
    flat = ((10.0, 1e-6, "phase noise"), (110.0, 1e-6, "phase noise"))
    made = analyse(open_design.replace({"oscillator.phase_noise": flat, "oscillator.bistatic": True}))
    assert 20 * math.log10(made["islr", "real time"].sigma) == pytest.approx(10 * math.log10(2e-4), abs=1e-3)


def test_an_aperture_that_hides_the_echo_in_the_main_lobe_is_found(open_design):
    """12 Hz over 1/12 s is one cell: up to there the line blurs and makes no echo."""
    design = open_design.replace(UNSENSED | {"requirements.paired_echo": 0.005, "radar.aperture_time": 0.05})
    solution = next(each for each in solve(design) if each.key == "radar.aperture_time")
    answer = next(each for each in solution.each if each.binding == "paired_echo")
    assert answer.value == pytest.approx(1 / 12, rel=1e-6)
    assert answer.margin >= 0


def test_sources_are_kept_while_the_design_changes_elsewhere(full):
    at_carrier = full.replace({"oscillator.bistatic": False, "imu.bandwidth": 200.0, "radar.aperture_time": 5.0})
    design = at_carrier.replace({"oscillator.frequency": 1e8})
    assert (
        inputs_of(design.replace({"imu.gyro_bias": 1e-6, "gnss.position_noise": 0.7})).fast is inputs_of(design).fast
    )
    changes = {
        "motion.delay": 3e-4, "imu.bandwidth": 100.0, "oscillator.frequency": 2e8, "radar.slant_range": 9e3,
        "radar.aperture_time": 3.0, "radar.window": "hamming", "oscillator.bistatic": True,
        "motion.lines": ((20.0, 2 * G, "acceleration"),),
    }  # fmt: skip
    for start, key, value in (
        *((design, *change) for change in changes.items()),
        (at_carrier, "radar.frequency", 5e9),
    ):
        before, after = (inputs_of(each).fast for each in (start, start.replace({key: value})))
        assert any(
            getattr(before[name], field) != getattr(after[name], field)
            for name in before
            for field in ("scattered", "quadratic")
        ), key
