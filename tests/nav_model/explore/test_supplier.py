"""Required values of a supplier's sheet, and the risk that its acceptance leaves to both sides."""

import numpy as np
import pytest
from scipy.stats import chi2

from app.report.supplier import supplier_bytes
from nav_model import analyse, read_design
from nav_model.allan.deviation import overlapping_allan_deviation
from nav_model.allan.imu_log import ImuLog
from nav_model.allan.static_log import analyse_log
from nav_model.base.errors import InputError
from nav_model.budget.allocation import allocate
from nav_model.design.figures import REQUIRED
from nav_model.design.file import format_design, parse_design
from nav_model.design.user_entries import Allotment, UserEntries, read_entries
from nav_model.explore.supplier import (
    AVERAGING,
    accepted_share,
    degrees_of,
    exceeding,
    frozen,
    judge_log,
    released,
    required,
)

DESIGN = read_design("examples/tactical_x_band.toml")
_NO_LIMITS = {f"requirements.{key}": None for key in REQUIRED}


def test_with_all_required_values_of_all_sheets_at_once_every_limit_is_met_and_one_percent_more_misses_one() -> None:
    lines = [line for unit in ("imu", "gnss") for line in required(DESIGN, unit)]
    at = {line.key: line.value for line in lines}
    assert analyse(DESIGN.replace(at)).verdict.closes
    assert not analyse(DESIGN.replace({key: 1.011 * value for key, value in at.items()})).verdict.closes
    ratios = [line.value / line.current for line in lines]
    assert max(ratios) == pytest.approx(min(ratios), rel=0.01)


def test_frozen_values_do_not_move_with_the_design_and_go_through_its_file() -> None:
    before = {unit: required(DESIGN, unit) for unit in ("imu", "gnss")}
    design = DESIGN.replace({}, entries=frozen(DESIGN))
    assert design.allocation.frozen == DESIGN.content_hash[:12]
    better = design.replace({"imu.velocity_random_walk": 0.2 * DESIGN.imu.velocity_random_walk})
    again = parse_design(format_design(better).encode(), "design")
    assert again == better
    assert again.content_hash == better.content_hash != better.replace({}, entries=UserEntries()).content_hash
    for unit, lines in before.items():
        assert [line.value for line in required(again, unit)] == [line.value for line in lines]
    assert required(better.replace({}, entries=UserEntries()), "imu")[1].value != before["imu"][1].value
    assert frozen(better) == better.entries  # once
    assert frozen(DESIGN, "2026-11-26").allocation.frozen == f"{DESIGN.content_hash[:12]}, 2026-11-26"
    assert DESIGN.replace({}, entries=released(design)) == DESIGN
    planned = DESIGN.replace({}, entries=UserEntries(allocation=Allotment("equal")))
    assert released(planned.replace({}, entries=frozen(planned))) == planned.entries
    with pytest.raises(InputError, match=r"allocation.required.radar.slant_range"):
        read_entries({"allocation": {"required": {"radar.slant_range": "7 km"}}})


@pytest.mark.parametrize("name", ["tactical_x_band", "l_band_jet", "mems_x_band"])
@pytest.mark.parametrize("mode", ["real time", "post-processed"])
@pytest.mark.parametrize("split", ["equal", "shares", "cheapest"])
def test_values_from_the_allocation_meet_each_limit_less_its_reserve(name: str, mode: str, split: str) -> None:
    plan = read_entries({"allocation": {"split": split, "reserve": "20 %"}})
    design = read_design(f"examples/{name}.toml").replace({"processing.mode": mode}, entries=plan)
    lines = {line.key: line for unit in ("imu", "gnss") for line in required(design, unit)}
    new = analyse(design.replace({key: line.value for key, line in lines.items()}))
    assert all(check.value <= 0.8 * check.limit * (1 + 1e-9) for check in new.verdict.checks), [
        (check.name, check.value / check.limit) for check in new.verdict.checks
    ]
    # The noise that limits one entry is at its part: written out for gyro noise in the tightest.
    gyro = lines["imu.angle_random_walk"]
    ratios = [
        entry.allocated / entry.estimated
        for check in analyse(design).verdict.checks
        for entry in allocate(analyse(design), check.name).entries
        if entry.source in ("gyro noise", "initial tilt", "coast before aperture")
    ]
    assert min(ratios) * 0.99 < gyro.value / gyro.current <= min(ratios)


def test_sources_beyond_their_part_of_the_allocation_are_named_beside_the_values() -> None:
    """With values of all sheets every limit is met less its reserve, unless a source without a sheet takes more."""
    arm = {"name": "lever <arm>", "value": "9 cm", "enters": "horizontal_position"}
    small, large = (
        DESIGN.replace({}, entries=read_entries({"allocation": {}, "contributors": [arm | {"value": value}]}))
        for value in ("1 mm", "9 cm")
    )
    for design, over in ((small, ()), (large, ("lever <arm>",))):
        assert exceeding(design) == over
        at = {line.key: line.value for unit in ("imu", "gnss") for line in required(design, unit)}
        checks = analyse(design.replace(at)).verdict.checks
        assert all(check.value <= 0.8 * check.limit * (1 + 1e-9) for check in checks) is not bool(over)
        sheet = supplier_bytes(design, "imu").decode()
        assert ("Over their part in this design: lever &lt;arm&gt;." in sheet) is bool(over)
    assert exceeding(DESIGN) == ()


def test_an_allocation_that_does_not_close_has_no_sheet() -> None:
    plan = read_entries({"allocation": {"locks": {"detrended_phase": {"gyro noise": "1000°"}}}})
    with pytest.raises(InputError, match="gyro noise locked too high"):
        required(DESIGN.replace({}, entries=plan), "imu")


def test_a_limit_on_the_impulse_response_is_left_out_of_values_from_the_allocation() -> None:
    width = {"name": "width", "on": "response_width", "limit": "0.3 m"}
    plain, limited, alone = (
        DESIGN.replace(changes, entries=read_entries({"allocation": {}, "limits": limits}))
        for changes, limits in (({}, []), ({}, [width]), (_NO_LIMITS, [width]))
    )
    assert required(limited, "imu") == required(plain, "imu")
    with pytest.raises(InputError, match="no allocated limit depends on its noise"):
        required(alone, "imu")


def test_what_no_unit_meets_and_a_design_without_limits_are_refused() -> None:
    with pytest.raises(InputError, match="whatever its noise"):
        required(DESIGN.replace({"imu.accelerometer_bias": 1.0}), "gnss")
    with pytest.raises(InputError, match="none is given"):
        required(DESIGN.replace(_NO_LIMITS), "imu")


def test_no_sheet_asks_for_what_a_design_may_not_have() -> None:
    loose = {"gnss.velocity_noise": 20.0, "gnss.position_noise": 1.0, "requirements.horizontal_position": 300.0}
    lines = {line.key: line for line in required(DESIGN.replace(_NO_LIMITS | loose), "gnss")}
    new = DESIGN.replace(_NO_LIMITS | loose | {key: line.value for key, line in lines.items()})
    assert analyse(new).verdict.closes
    assert lines["gnss.velocity_noise"].bounded
    assert not lines["gnss.position_noise"].bounded
    strict = {"gnss.velocity_noise": 1e-3, "gnss.position_noise": 1e-3, "requirements.horizontal_position": 2e-6}
    with pytest.raises(InputError, match=r"velocity_noise: .* would be required"):
        required(DESIGN.replace(_NO_LIMITS | strict), "gnss")


def test_the_accepted_share_is_the_quantile_of_chi_square() -> None:
    for degrees in (10.0, 100.0, 5400.0):
        assert accepted_share(degrees) == pytest.approx(np.sqrt(chi2.ppf(0.05, degrees) / degrees), rel=1e-9)
    # An hour at 1 s has 1.5 degrees of freedom for each second: Greenhall and Riley, table 2, white noise.
    assert degrees_of(3600, 100) == pytest.approx(1.5 * 3600, rel=2e-3)


def log(factor: float, axes: int = 3) -> ImuLog:
    """Ten minutes of white noise, so many times what is required."""
    rate, rng = 100.0, np.random.default_rng(7)
    walks = {line.key: factor * np.sqrt(rate) * line.value for line in required(DESIGN, "imu")}
    gyro, accelerometer = (
        walks[f"imu.{name}_random_walk"] * rng.standard_normal((60_000, axes)) for name in ("angle", "velocity")
    )
    return ImuLog(gyro, accelerometer, rate)


@pytest.mark.long
def test_a_log_well_below_passes_and_one_above_fails_on_every_axis() -> None:
    lines = required(DESIGN, "imu")
    quiet, loud = (judge_log(lines, analyse_log(log(factor))) for factor in (0.85, 1.1))
    assert [row.name for row in quiet] == [f"{kind}_{axis}" for kind in ("gyro", "accelerometer") for axis in "xyz"]
    assert all(row.passes for row in quiet)
    assert not any(row.passes for row in loud)
    assert quiet[0].reading == pytest.approx(0.85 * quiet[0].required, rel=0.1)


def test_a_log_without_accelerometers_is_refused() -> None:
    analysed = analyse_log(ImuLog(log(0.5).gyro, None, 100.0, file_name="gyro.csv"))
    with pytest.raises(InputError, match=r"gyro\.csv: has no accelerometer"):
        judge_log(required(DESIGN, "imu"), analysed)


def test_a_unit_at_its_required_value_passes_in_one_case_of_twenty() -> None:
    rng, rate, seconds, runs = np.random.default_rng(3), 10.0, 300, 2000
    share = accepted_share(degrees_of(seconds, rate))
    passed = 0
    for _ in range(runs):
        allan = overlapping_allan_deviation(rng.standard_normal(int(rate * seconds)), 1 / rate, np.array([AVERAGING]))
        passed += allan.deviation[0] * np.sqrt(rate) <= share
    assert passed / runs == pytest.approx(0.05, abs=4 * np.sqrt(0.05 * 0.95 / runs))
