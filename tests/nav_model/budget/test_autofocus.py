"""A design with an autofocus: its verdict, its limits, and what stays without one."""

import math
from pathlib import Path

import numpy as np
import pytest

from nav_model import Design, analyse, read_design
from nav_model.budget.figures import figures
from nav_model.budget.inputs import inputs_of
from nav_model.budget.provenance import cautions, widest_swath
from nav_model.design.figures import FIGURES, OF_BUDGET
from nav_model.design.file import format_design
from nav_model.explore.margins import ratios
from tests.support.phase_gradient import lines_between, without_line

MEMS = read_design("examples/mems_x_band.toml")
BROUGHT = Path("/work/shared/data/brought/60_autofocus.toml")
OWN = ("phase_before_autofocus", "path_before_autofocus", "autofocus_estimation")


def focused(design: Design = MEMS, **more: object) -> Design:
    changes = {"autofocus.method": "phase gradient", "autofocus.scene": "urban"}
    return design.replace(changes | {key.replace("__", "."): value for key, value in more.items()})


@pytest.mark.parametrize("mode", ["real time", "post-processed"])
def test_a_town_closes_it_and_the_sea_does_not(mode: str) -> None:
    design = MEMS.replace({"processing.mode": mode})
    before, town, sea = (analyse(each) for each in (design, focused(design), focused(design, autofocus__scene="sea")))
    assert (before.verdict.state, town.verdict.state, sea.verdict.state) == ("fails", "closes", "fails")
    assert sea.verdict.checks == before.verdict.checks
    assert {check.name for check in town.verdict.checks} - {check.name for check in sea.verdict.checks} == set(OWN)
    first = town.figure("phase_before_autofocus").sigma
    assert first == pytest.approx(before.figure("quadratic_phase").sigma, rel=1e-12)
    for name in ("azimuth_shift", "range_shift", "ce90", "horizontal_position", "coast_horizontal_position"):
        assert town.figure(name).sigma == before.figure(name).sigma
    assert math.fsum(town.figure("detrended_phase").shares.values()) == pytest.approx(1, rel=1e-9)


def test_ten_milli_g_are_not_met_by_range_cells() -> None:
    biased = MEMS.replace({"imu.accelerometer_bias": 0.0980665, "radar.autofocus_order": 2})
    biased = biased.replace({"requirements.quadratic_phase": None})
    assert math.degrees(analyse(biased).figure("line_of_sight_detrended_phase").sigma) == pytest.approx(6.2, abs=0.05)
    checks = {check.name: check for check in analyse(focused(biased)).verdict.checks}
    path = checks["path_before_autofocus"]
    assert (path.state, path.dominant, path.limit) == ("not met", "accelerometer bias", pytest.approx(0.1))
    assert path.value == pytest.approx(0.355, abs=0.0005)
    assert checks["phase_before_autofocus"].state == "not met"
    corrected = focused(biased, autofocus__migration="corrected", autofocus__capture=1000.0)
    assert {"phase_before_autofocus", "path_before_autofocus"}.isdisjoint(analyse(corrected).verdict.failing)


@pytest.mark.skipif(not BROUGHT.exists(), reason="the designs that were brought are not here")
@pytest.mark.parametrize("method", ["map drift", "phase gradient"])
def test_the_design_that_was_brought(method: str) -> None:
    design = read_design(BROUGHT).replace({"imu.accelerometer_bias": 0.0980665})
    assert analyse(design).verdict.closes
    verdict = analyse(design.replace({"autofocus.method": method})).verdict
    assert {"phase_before_autofocus", "path_before_autofocus"} <= set(verdict.failing)


def test_the_capture_is_at_three_sigma_and_a_requirement_may_be_tighter() -> None:
    check = next(c for c in analyse(focused()).verdict.checks if c.name == "phase_before_autofocus")
    assert (check.confidence, check.limit) == (3.0, pytest.approx(8 * math.pi))
    tighter = focused(requirements__phase_before_autofocus=1.0)
    check = next(c for c in analyse(tighter).verdict.checks if c.name == "phase_before_autofocus")
    assert (check.confidence, check.limit, check.state) == (1.0, 1.0, "not met")


def test_it_fails_without_contrast() -> None:
    faint = focused(autofocus__range_bins=1.0, autofocus__signal_to_clutter=1.0)
    assert "autofocus_estimation" in analyse(faint).verdict.failing


@pytest.mark.parametrize("method", ["map drift", "phase gradient"])
@pytest.mark.parametrize("mode", ["real time", "post-processed"])
def test_arrays_have_the_figures_and_margins_of_the_budget(method: str, mode: str) -> None:
    design = focused(autofocus__method=method, processing__mode=mode)
    budget, known = analyse(design), [name for name in OF_BUDGET if FIGURES[name].kind != "response"]
    for name, value in figures(inputs_of(design), known).items():
        assert float(value) == pytest.approx(budget.figure(name).sigma, rel=1e-7, abs=1e-15), name
    coarser = ratios(design, {"radar.azimuth_resolution": 0.4})["path_before_autofocus"]
    check = next(
        c
        for c in analyse(design.replace({"radar.azimuth_resolution": 0.4})).verdict.checks
        if c.name == "path_before_autofocus"
    )
    assert 1 - float(coarser) == pytest.approx(check.margin, rel=1e-6)


def test_without_it_a_design_is_what_it_was() -> None:
    assert "autofocus" not in format_design(MEMS).replace("autofocus_order", "")
    assert MEMS.replace({"autofocus.method": "none"}).content_hash == MEMS.content_hash
    assert not set(OWN) & {check.name for check in analyse(MEMS).verdict.checks}


@pytest.mark.parametrize("mode", ["real time", "post-processed"])
def test_at_the_edges_of_the_widest_swath_a_sixteenth_of_a_wave_differs(mode: str) -> None:
    """Two points on flat ground, seen exactly, with the errors of a level and of an upright line of sight."""
    noisy = MEMS.replace({"processing.mode": mode, "imu.angle_random_walk": 1e-3, "imu.velocity_random_walk": 0.1})
    design = focused(noisy, requirements__confidence=2.0)
    level, upright = (
        analyse(noisy.replace({"radar.grazing_angle": angle})).figure("line_of_sight_quadratic_phase").sigma
        for angle in (0.0, math.pi / 2)
    )
    budget = analyse(design)
    width, slant, angle = widest_swath(budget), design.radar.slant_range, design.radar.grazing_angle
    height, ground = slant * math.sin(angle), slant * math.cos(angle)
    edge = math.hypot(height, ground + width / 2)
    turns = (ground + width / 2) / edge - ground / slant, height / edge - height / slant
    differs = 2.0 * math.hypot(turns[0] * level, turns[1] * upright)
    assert width < 0.1 * slant
    assert differs == pytest.approx(math.pi / 4, rel=width / slant)
    assert any(f"{width:.3g} m on the ground" in sentence for sentence in cautions(budget))


def test_the_error_of_estimation_scatters_what_a_transform_of_it_has() -> None:
    """Lines between independent phases of blocks, the mean over 200 draws of the energy outside the main lobe."""
    design = focused(autofocus__scene="farmland", radar__window="uniform")
    figure = analyse(design).figure("islr")
    assert figure.shares == {"autofocus estimation": 1.0}
    assert analyse(MEMS).figure("islr").sigma < 1e-10
    blocks, samples, rng = 32, 1024, np.random.default_rng(4)
    sigma = analyse(design).figure("autofocus_estimation").sigma / math.sqrt(1 - 2 / blocks)
    ratios = []
    for _ in range(200):
        phase = without_line(lines_between(sigma * rng.normal(size=blocks), samples))
        image = np.abs(np.fft.fft(np.exp(1j * phase)) / samples) ** 2  # a sample a cell: the window has no side lobes
        ratios.append(image[2:-1].sum() / image[[0, 1, -1]].sum())
    assert figure.sigma**2 == pytest.approx(np.mean(ratios), rel=0.15)
