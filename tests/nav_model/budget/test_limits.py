"""Requirements of the user's own, against values written out here, and their allocation in the design."""

import math
import pickle
from pathlib import Path
from typing import Any

import pytest

from nav_model import Design, InputError, analyse
from nav_model.budget.allocation import allocate
from nav_model.budget.json import to_json
from nav_model.design.file import format_design, parse_design
from nav_model.design.link import from_query, to_query
from nav_model.design.user_entries import Allotment, read_entries
from nav_model.explore.margins import ratios
from nav_model.explore.solve import solve
from nav_model.explore.sweep import whole_sweep
from nav_model.explore.sweep_plan import read_plan

_SENSORS = {
    "imu.angle_random_walk": 1e-5, "imu.velocity_random_walk": 1e-3, "imu.gyro_bias": 1e-6,
    "imu.accelerometer_bias": 1e-4, "coast.duration": 100.0, "requirements.confidence": 2.0,
}  # fmt: skip
_HEADING = {"name": "heading", "on": "coast_heading", "limit": "0.1°", "at": "30 s", "confidence": 3}
_ARM = {"name": "lever arm", "value": "2 mm", "enters": "detrended_phase", "allowance": "50 %"}


def _design(*limits: dict[str, Any], **more: Any) -> Design:
    return Design(_SENSORS, entries=read_entries({"limits": list(limits), "contributors": [_ARM], **more}))


@pytest.mark.parametrize("mode", ["real time", "post-processed"])
def test_values_in_the_outage_agree_with_the_curves_at_that_time(mode: str) -> None:
    names = {
        "coast_horizontal_velocity": ("velocity_horizontal", "1 m/s"),
        "coast_vertical_velocity": ("velocity_vertical", "1 m/s"),
        "coast_tilt": ("tilt", "1°"), "coast_heading": ("yaw_growth", "1°"),
        "coast_horizontal_position": ("refined_horizontal", "10 m"),
        "coast_vertical_position": ("refined_vertical", "10 m"),
    }  # fmt: skip
    limits = [
        {"name": f"{name} {at}", "on": name, "limit": limit} | ({"at": at} if at != "end" else {})
        for name, (_, limit) in names.items() for at in ("0.1 s", "30 s", "end")
    ]  # fmt: skip
    budget = analyse(_design(*limits).replace({"processing.mode": mode}), times=[0.1, 30.0, 100.0])
    checks = {check.name: check for check in budget.verdict.checks}
    assert len(checks) == 18
    for name, (curve, _) in names.items():
        for at, value in zip(("0.1 s", "30 s", "end"), getattr(budget.coast, curve), strict=True):
            check = checks[f"{name} {at}"]
            assert check.sigma == pytest.approx(float(value), rel=1e-9, abs=1e-18)
            assert check.value == 2 * check.sigma
            assert math.fsum(check.shares.values()) == pytest.approx(1, rel=1e-12)
    assert checks["coast_heading 30 s"].sigma == pytest.approx(math.hypot(1e-5 * math.sqrt(30), 30e-6), rel=1e-12)
    across = ratios(budget.design)
    assert {name: float(value) for name, value in across.items()} == {
        name: pytest.approx(check.value / check.limit, rel=1e-9, abs=1e-15) for name, check in checks.items()
    }


def test_own_confidence_and_contributors_count_and_a_contributor_can_be_limited() -> None:
    contributors = [
        _ARM, {"name": "drift", "value": "1 mrad", "enters": "coast_heading", "kind": "systematic"},
        {"name": "mount", "value": "2 mrad", "enters": "coast_heading"},
    ]  # fmt: skip
    arm = {"name": "arm", "on": "lever arm", "limit": "5 mm"}
    budget = analyse(_design(_HEADING, arm, contributors=contributors))
    heading, held = budget.verdict.checks
    assert heading.sigma == pytest.approx(math.hypot(1e-5 * math.sqrt(30), 30e-6, 2e-3) + 1e-3, rel=1e-12)
    assert (heading.value, heading.confidence) == (3 * heading.sigma, 3)
    assert math.fsum(heading.shares.values()) == pytest.approx(1, rel=1e-12)
    assert heading.dominant == "mount"
    assert (held.sigma, held.value) == (pytest.approx(3e-3), pytest.approx(6e-3))
    assert not held.met
    assert dict(held.shares) == {"lever arm": 1.0}
    requirements = to_json(budget)["verdict"]["requirements"]
    assert [(row["name"], row["on"], row["confidence"]) for row in requirements] == [
        ("heading", "coast_heading", 3), ("arm", "lever arm", 2),
    ]  # fmt: skip
    assert [entry.source for entry in allocate(budget, "arm").entries] == ["lever arm"]
    sources = {entry.source for entry in allocate(budget, "heading").entries}
    assert sources == {"gyro noise", "gyro bias", "drift", "mount"}


_RESPONSE = [
    {"name": "width", "on": "response_width", "limit": "0.6 m"}, {"name": "peak", "on": "pslr", "limit": "-9 dB"},
    {"name": "side", "on": "response_islr", "limit": "-6 dB"}, {"name": "half", "on": "cep", "limit": "1 m"},
    {"name": "loss", "on": "peak_loss", "limit": "3 dB"},
]  # fmt: skip


@pytest.mark.parametrize("lines", [(), ((20.0, 2e-3, "length"),)])
@pytest.mark.parametrize("mode", ["real time", "post-processed"])
def test_measures_of_the_response_and_cep_are_those_that_are_printed(mode: str, lines: tuple[Any, ...]) -> None:
    changes = {"processing.mode": mode, "motion.unsensed_lines": lines}
    arm = {"name": "lever arm", "value": "2 mm", "enters": "quadratic_phase"}
    budget = analyse(_design(*_RESPONSE, contributors=[arm]).replace(changes))
    response, place = budget.response(mode), to_json(budget)["geolocation"]
    assert response is not None
    expected = {
        "width": response.half_power_extent_cells * budget.sar.cell_length,
        "peak": 10 ** (response.pslr_fixed_db / 20),
        "side": 10 ** (response.islr_fixed_db / 20),
        "half": place[mode.replace("-", "_").replace(" ", "_")]["cep_m"],
        "loss": -response.peak_loss_db,
    }
    checks = {check.name: check for check in budget.verdict.checks}
    assert {name: check.value for name, check in checks.items()} == {
        name: pytest.approx(float(value), rel=1e-12) for name, value in expected.items()
    }
    assert {check.confidence for check in checks.values()} == {None}
    for check in checks.values():
        assert math.fsum(check.shares.values()) == pytest.approx(1, rel=1e-12)
    across = ratios(budget.design, {"imu.angle_random_walk": [1e-5, 1e-3, 1.0]})
    for name, values in across.items():
        assert list(values[:1]) == [pytest.approx(checks[name].value / checks[name].limit, rel=1e-9)]
        assert values[0] < values[2] < math.inf
    with pytest.raises(InputError, match="'width' limits a measure of the impulse response"):
        allocate(budget, "width")
    assert allocate(budget).requirement == "half"


def test_a_contributor_to_the_width_or_to_cep_adds_to_it() -> None:
    contributors = [
        {"name": "pad", "value": "3 cm", "enters": "response_width", "kind": "systematic"},
        {"name": "datum", "value": "40 cm", "enters": "cep"},
        {"name": "taper", "value": "0.1 dB", "enters": "peak_loss", "kind": "systematic"},
    ]  # fmt: skip
    plain, more = (
        {check.name: check for check in analyse(_design(*_RESPONSE, contributors=each)).verdict.checks}
        for each in ([], contributors)
    )
    assert more["width"].value == pytest.approx(plain["width"].value + 0.03, rel=1e-12)
    assert more["half"].value == pytest.approx(math.hypot(plain["half"].value, 0.4), rel=1e-12)
    assert more["loss"].value == pytest.approx(plain["loss"].value + 0.1, rel=1e-12)
    assert more["width"].shares["pad"] == pytest.approx(0.03 / more["width"].value, rel=1e-9)


@pytest.mark.parametrize("order", [1, 2, 3])
@pytest.mark.parametrize("mode", ["real time", "post-processed"])
def test_a_phase_after_another_order_of_autofocus_is_that_of_a_design_of_this_order(mode: str, order: int) -> None:
    on = f"detrended_phase_{order}"
    arm = {"name": "mast", "value": "0.1 mm", "enters": on}
    changes = {"processing.mode": mode, "motion.unsensed_lines": ((20.0, 1e-5, "length"),)}
    design = _design({"name": "own", "on": on, "limit": "1°"}, contributors=[arm]).replace(changes)
    changes |= {"radar.autofocus_order": order, "requirements.detrended_phase": 1.0}
    of_order = _design(contributors=[]).replace(changes)
    (check,), (there,) = (analyse(each).verdict.checks for each in (design, of_order))
    size = 4 * math.pi / analyse(design).sar.wavelength * 1e-4
    assert check.sigma == pytest.approx(math.hypot(there.sigma, size), rel=1e-9)
    share_of_rest = there.sigma**2 / check.sigma**2
    assert check.shares == {"mast": pytest.approx(1 - share_of_rest, rel=1e-9)} | {
        source: pytest.approx(share * share_of_rest, rel=1e-9) for source, share in there.shares.items()
    }
    assert float(ratios(design)["own"]) == pytest.approx(check.value / check.limit, rel=1e-9)
    assert {entry.source for entry in allocate(analyse(design)).entries} >= {"mast", "gyro noise"}


@pytest.mark.parametrize("limit", ["30°", "0.5235987755982988 rad", "523.5987755982989 mrad"])
def test_a_limit_on_a_phase_takes_any_unit_of_an_angle(limit: str) -> None:
    (check,) = analyse(_design({"name": "phase", "on": "detrended_phase", "limit": limit})).verdict.checks
    assert check.limit == pytest.approx(math.pi / 6, rel=1e-12)


def test_what_would_close_it_solves_for_them() -> None:
    limit = {"name": "heading", "on": "coast_heading", "limit": "1e-5 rad", "at": "30 s"}
    solutions = solve(_design(limit).replace({"imu.gyro_bias": 0.0}))
    solved = next(solution for solution in solutions if solution.key == "imu.angle_random_walk")
    assert solved.together.value == pytest.approx(1e-5 / 2 / math.sqrt(30), rel=1e-6)


def test_file_link_pickle_and_hash_keep_them() -> None:
    plan = {
        "split": "equal",
        "reserve": "10 %",
        "locks": {"heading": {"gyro noise": "0.01°"}, "tilt": {"x": "1 mrad"}},
    }
    design = _design(_HEADING, allocation=plan)
    assert parse_design(format_design(design)) == design
    assert from_query(to_query(design)) == design
    assert pickle.loads(pickle.dumps(design)) == design
    variants = [
        _design(), _design(_HEADING), design, _design(_HEADING, allocation={}), _design(_HEADING | {"at": "20 s"}),
        _design(_HEADING | {"confidence": 2}), _design(_HEADING | {"limit": "1°"}),
        _design(_HEADING, allocation=plan | {"locks": {"heading": {"gyro noise": "0.02°"}}}),
    ]  # fmt: skip
    assert len({variant.content_hash for variant in variants}) == len({*variants}) == 8
    assert Design(_SENSORS, entries=read_entries({})).content_hash == Design(_SENSORS).content_hash


def test_an_allocation_is_that_of_the_design_unless_something_is_given() -> None:
    plan = {"split": "equal", "reserve": "10 %", "locks": {"detrended_phase": {"gyro noise": "0.1 mm"}}}
    design = _design(allocation=plan).replace({"requirements.detrended_phase": 3.0})
    budget = analyse(design)
    allocation = allocate(budget)
    locked = next(entry for entry in allocation.entries if entry.locked)
    assert (locked.source, allocation.reserve) == ("gyro noise", 0.1)
    assert locked.allocated == pytest.approx(4 * math.pi / budget.sar.wavelength * 1e-4, rel=1e-12)
    free = {entry.allocated for entry in allocation.entries if not entry.locked}
    assert max(free) == pytest.approx(min(free))
    assert math.sqrt(sum(entry.allocated**2 for entry in allocation.entries)) == pytest.approx(0.9 * 3.0)
    assert not any(entry.locked for entry in allocate(budget, plan=Allotment()).entries)
    plain = analyse(design.replace({}, entries=read_entries({"contributors": [_ARM]})))
    assert allocate(budget, plan=Allotment(reserve=0.5)) == allocate(plain, plan=Allotment(reserve=0.5))


@pytest.mark.parametrize(
    ("tables", "named"),
    [
        ({"limits": [_HEADING | {"on": "yaw"}]}, "limits[heading].on"),
        ({"limits": [_HEADING | {"on": "confidence"}]}, "limits[heading].on"),
        ({"limits": [_HEADING | {"limit": "1 m"}]}, "limits[heading].limit"),
        ({"limits": [{"name": "a", "on": "detrended_phase", "limit": "1 mm"}]}, "limits[a].limit"),
        ({"limits": [{"name": "a", "on": "pslr", "limit": "-9"}]}, "limits[a].limit"),
        (
            {"limits": [{"name": "a", "on": "response_width", "limit": "1 m", "confidence": 2}]},
            "limits[a].confidence",
        ),
        ({"limits": [_HEADING | {"limit": "0°"}]}, "limits[heading].limit"),
        ({"limits": [_HEADING | {"limit": "-1°"}]}, "limits[heading].limit"),
        ({"limits": [_HEADING | {"at": "30 m"}]}, "limits[heading].at"),
        ({"limits": [_HEADING | {"at": "-1 s"}]}, "limits[heading].at"),
        ({"limits": [_HEADING | {"on": "tilt"}]}, "limits[heading].at"),
        ({"limits": [_HEADING | {"confidence": 0}]}, "limits[heading].confidence"),
        ({"limits": [_HEADING | {"confidence": "nan"}]}, "limits[heading].confidence"),
        ({"limits": [_HEADING | {"confidence": "most"}]}, "limits[heading].confidence"),
        ({"limits": [{"name": "a", "on": "ce90", "limit": "1 m", "confidence": 2}]}, "limits[a].confidence"),
        ({"limits": [_HEADING | {"name": "tilt"}]}, "limits[tilt]"),
        ({"limits": [_HEADING | {"name": "a\nb"}]}, "limits[a\\nb].name"),
        ({"limits": [_HEADING | {"name": "=HYPERLINK(1)"}]}, "limits[=HYPERLINK(1)].name"),
        ({"limits": [_HEADING, _HEADING | {"name": "Heading"}]}, "limits[Heading]"),
        ({"limits": [_HEADING | {"name": f"n{n}"} for n in range(1000)]}, "limits"),
        ({"limits": [_HEADING | {"colour": "red"}]}, "limits[heading].colour"),
        ({"limits": [{"name": "a", "on": "lever arm", "limit": "1°"}], "contributors": [_ARM]}, "limits[a].limit"),
        ({"limits": {"name": "a"}}, "limits"),
        ({"allocation": {"split": "fair"}}, "allocation.split"),
        ({"allocation": {"reserve": "100 %"}}, "allocation.reserve"),
        ({"allocation": {"reserve": 0.2}}, "allocation.reserve"),
        ({"allocation": {"share": "1"}}, "allocation.share"),
        ({"allocation": {"locks": {"yaw": {"gyro noise": "1°"}}}}, "allocation.locks"),
        ({"allocation": {"locks": {"tilt": {"gyro noise": "1 m"}}}}, "allocation.locks.tilt.gyro noise"),
        ({"allocation": {"locks": {"tilt": {"gyro noise": "0°"}}}}, "allocation.locks.tilt.gyro noise"),
        ({"allocation": {"locks": {"tilt": "1°"}}}, "allocation.locks"),
        ({"allocation": "equal"}, "allocation"),
    ],
)
def test_what_is_wrong_is_refused_by_name(tables: dict[str, Any], named: str) -> None:
    with pytest.raises(InputError) as refused:
        read_entries(tables)
    assert refused.value.key == named


def test_what_is_still_used_is_not_removed_without_a_word() -> None:
    base = _design({"name": "arm", "on": "lever arm", "limit": "2 mm"}).entries.tables()
    locked = base | {"allocation": {"locks": {"arm": {"lever arm": "1 mm"}}}}
    renamed = {"contributors": [_ARM | {"name": "lever arms"}]}
    first = (
        "limits[arm].on: The requirement 'arm' limits 'lever arm', which is neither a contributor nor a figure of "
        "the budget. Remove that requirement first, or change what it limits."
    )
    then = (
        "allocation.locks: 'arm' is not a requirement, but some of its sources are locked. Remove these locks first."
    )
    for tables, message in (
        (base | {"contributors": []}, first), (base | renamed, first), (locked | {"limits": []}, then)
    ):  # fmt: skip
        with pytest.raises(InputError) as refused:
            read_entries(tables)
        assert str(refused.value) == message


def test_a_sweep_has_their_margins_and_closes_by_them(tmp_path: Path) -> None:
    design = _design(_HEADING)
    (tmp_path / "design.toml").write_text(format_design(design), encoding="utf-8")
    (tmp_path / "plan.toml").write_text(
        'design = "design.toml"\n[vary]\nimu.angle_random_walk = ["0.1 °/√h", "1 °/√h"]\n', encoding="utf-8"
    )
    columns = whole_sweep(read_plan(tmp_path / "plan.toml"))
    walks = (math.radians(walk / 60) * math.sqrt(30) for walk in (0.1, 1.0))
    margins = [1 - 3 * math.hypot(walk, 30e-6) / math.radians(0.1) for walk in walks]
    assert list(columns["heading_margin"]) == pytest.approx(margins)
    assert list(columns["closes"]) == [True, False]
