"""A design's verdict with its flight: met, not met, open or refused, on the line that decides."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from app.cli import main
from nav_model.base.errors import InputError
from nav_model.budget import Budget, analyse
from nav_model.budget.verdict import Check, check_names, flown_names
from nav_model.design import Design
from nav_model.design.figures import IN_FLIGHT
from nav_model.design.file import format_design
from nav_model.design.trajectory import LIMITED
from nav_model.design.user_entries import read_entries
from nav_model.trajectory import verdict as of_flight
from nav_model.trajectory.covariance import covariance, figures_on_lines
from nav_model.trajectory.design_study import along_flight, planned
from nav_model.trajectory.verdict import checks_of, with_flight

pytestmark = pytest.mark.long

LINES = {
    "imu.angle_random_walk": math.radians(0.1) / 60, "imu.velocity_random_walk": 0.03 / 60,
    "gnss.position_noise": 0.05, "flight.speed": 100.0, "radar.aperture_time": 5.0,
    "trajectory.flight": "lines", "trajectory.lines": 2.0, "trajectory.length": 3000.0,
    "trajectory.spacing": 1000.0,
}  # fmt: skip


def design(limits: dict[str, float], *rows: dict[str, Any], **others: Any) -> Design:
    """Two lines with requirements, and limits of single lines."""
    own = tuple((row["line"], *(row.get(name) for name in LIMITED)) for row in rows)
    keys = {f"requirements.{name}": limit for name, limit in limits.items()}
    return Design(
        LINES | keys | {"trajectory.limits": own} | {key.replace("__", "."): v for key, v in others.items()}
    )


def checks(budget: Budget) -> dict[str, Check]:
    return {check.name: check for check in budget.verdict.checks}


@pytest.fixture(scope="module")
def values() -> dict[str, float]:
    """Figures of both lines at worst."""
    case = design({"detrended_phase": 1e3, "tilt": 1.0, "ce90": 1e3})
    lines = covariance(along_flight(case, planned(case))).lines
    return {
        f"{name} {n}": line.worst[name] for n, line in enumerate(lines, 1) for name in ("detrended_phase", "tilt")
    }


def test_the_line_that_is_worst_beside_its_own_limit_decides(values: dict[str, float]) -> None:
    worst = max(values["detrended_phase 1"], values["detrended_phase 2"])
    case = design(
        {"detrended_phase": 1.2 * worst, "tilt": 1e-6, "le90": 1e3},
        {"line": "line 1", "detrended_phase": 0.5 * values["detrended_phase 1"], "ce90": 1e3},
        {"line": "line 2", "tilt": 1.0},
    )
    budget = with_flight(analyse(case))
    each = checks(budget)
    assert list(each) == [*check_names(case)] == ["detrended_phase", "le90", "tilt", "ce90"]
    phase, tilt, place = each["detrended_phase"], each["tilt"], each["ce90"]
    assert (phase.state, phase.judged) == ("not met", "line 1")
    assert (phase.value, phase.limit) == pytest.approx(
        (values["detrended_phase 1"], 0.5 * values["detrended_phase 1"])
    )
    assert phase.margin == pytest.approx(-1.0)
    assert phase.straight == checks_on_a_straight_leg(case)["detrended_phase"]
    assert (tilt.state, tilt.judged) == ("not met", "line 1")  # line 2 has a limit of its own
    # What a line limits beside the requirements is a check of its own, on that line alone.
    assert (place.state, place.judged, place.straight) == ("met", "line 1", None)
    assert each["le90"].judged == "straight leg"
    assert (budget.verdict.state, budget.verdict.failing) == ("fails", ("detrended_phase", "tilt"))
    assert sum(phase.shares.values()) == pytest.approx(1.0)
    # Each shares of the flight at the worst moment.
    result = covariance(along_flight(case, planned(case)))
    line = result.lines[0]
    output = int(np.searchsorted(result.time_s, line.worst_s["detrended_phase"]))
    assert result.chosen.figures["detrended_phase"][output] == line.worst["detrended_phase"] == phase.value
    assert phase.dominant_share == pytest.approx(result.chosen.shares["detrended_phase"][:, output].max())
    assert phase.dominant == result.sources[int(result.chosen.shares["detrended_phase"][:, output].argmax())]


def checks_on_a_straight_leg(case: Design) -> dict[str, float]:
    return {check.name: check.value for check in analyse(case).straight_leg().checks}


def test_a_line_without_an_aperture_is_refused_and_not_where_no_image_is_limited() -> None:
    short = design({"detrended_phase": 1e3, "tilt": 1.0, "le90": 1e3}, trajectory__length=300.0)
    each = checks(with_flight(analyse(short)))
    assert {name: check.state for name, check in each.items()} == {
        "detrended_phase": "refused", "le90": "met", "tilt": "met",
    }  # fmt: skip
    refused = each["detrended_phase"]
    assert (refused.reason, refused.judged) == ("line 1 is too short for an aperture of 5 s", "line 1")
    assert math.isnan(refused.value)
    verdict = with_flight(analyse(short)).verdict
    assert (verdict.state, verdict.open, verdict.closes) == ("open", ("detrended_phase",), False)
    assert verdict.tightest is not None
    alone = with_flight(analyse(short.replace({"requirements.detrended_phase": None}))).verdict
    assert alone.state == "closes"


def test_a_figure_that_the_flight_does_not_tell_is_refused_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    """Silent before: the limit was listed, had no value, and did not fail."""

    def without(*arguments: Any, **named: Any) -> Any:
        along = figures_on_lines(*arguments, **named)
        parts = {
            processing: replace(part, figures={k: v for k, v in part.figures.items() if k != "ce90"})
            for processing, part in along.figures.items()
        }
        return replace(along, figures=parts)

    monkeypatch.setattr(of_flight, "figures_on_lines", without)
    each = checks(with_flight(analyse(design({"ce90": 1e3, "tilt": 1.0}))))
    assert (each["ce90"].state, each["tilt"].state) == ("refused", "met")
    assert each["ce90"].reason == "line 1 has no CE90, which no flight tells"


def test_a_limit_of_ones_own_is_judged_on_the_flight_and_one_on_a_contributor_is_not() -> None:
    entries = read_entries(
        {
            "contributors": [{"name": "mast", "enters": "detrended_phase", "value": "1°"}],
            "limits": [
                {"name": "half", "on": "detrended_phase", "limit": "900°", "confidence": 3},
                {"name": "the mast", "on": "mast", "limit": "2°"},
                {"name": "later", "on": "coast_tilt", "limit": "9°", "at": "5 s"},
            ],
        }
    )
    budget = with_flight(analyse(design({}).replace({}, entries=entries)))
    each = checks(budget)
    assert {name: check.judged == "straight leg" for name, check in each.items()} == {
        "half": False, "the mast": True, "later": True,
    }  # fmt: skip
    assert each["half"].value == pytest.approx(3 * each["half"].sigma)
    assert budget.verdict.closes


def test_without_a_plan_only_what_a_straight_leg_does_not_tell_is_flown() -> None:
    plain = design({"tilt": 1.0, "detrended_phase": 1e3}, trajectory__flight="none")
    assert flown_names(plain) == ()
    budget = analyse(plain)
    assert with_flight(budget) is budget
    assert budget.verdict.closes
    heading = plain.replace({"requirements.heading": 0.01, "trajectory.duration": 60.0})
    assert flown_names(heading) == ("heading",)
    before = analyse(heading)
    assert (before.verdict.state, before.verdict.open) == ("open", ("heading",))
    after = with_flight(before).verdict
    assert [check.judged for check in after.checks] == ["straight leg", "straight leg", "flight"]
    named = plain.replace({"trajectory.flight": "straight", "trajectory.duration": 60.0})
    assert {check.judged for check in with_flight(analyse(named)).verdict.checks} == {"flight"}
    assert set(flown_names(named)) == {name for name in check_names(named) if name in IN_FLIGHT}
    # Limits of lines need lines.
    row = (("line 1", *(1.0 for _ in LIMITED)),)
    with pytest.raises(InputError, match=r"trajectory.limits\[1\].line: the flight has no line 'line 1'"):
        with_flight(analyse(plain.replace({"trajectory.limits": row})))


def test_both_processings_are_judged_by_a_result_that_exists_already_as_by_the_flight() -> None:
    case = design({"detrended_phase": 1.0, "tilt": 1e-3, "heading": 0.01})
    budget = analyse(case)
    result = covariance(along_flight(case, planned(case)))
    one, other = replace(budget, flight=checks_of(result, budget)), with_flight(budget)
    for processing in ("real time", "post-processed"):
        for check, same in zip(one.judged(processing).checks, other.judged(processing).checks, strict=True):
            assert (check.name, check.state, check.judged) == (same.name, same.state, same.judged)
            assert check.value == pytest.approx(same.value, rel=1e-9)
    assert one.other_verdict.processing == "post-processed"


@pytest.mark.parametrize(
    ("limit", "flag", "code", "words"),
    [
        (0.5, (), 0, "closes at 1σ in real time; tightest"),
        (1e-5, (), 1, "DOES NOT CLOSE at 1σ in real time; tightest heading along the flight"),
        (0.5, ("--no-flight",), 0, "; open: heading"),
        (1e-5, ("--no-flight",), 0, "; open: heading"),
    ],
)
def test_the_exit_of_check_is_that_of_its_last_line(
    limit: float, flag: tuple[str, ...], code: int, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "design.toml"
    limits = {"heading": limit, "tilt": 1.0}
    case = design(limits, trajectory__flight="none", trajectory__duration=60.0)
    path.write_text(format_design(case), encoding="utf-8")
    assert main(["check", str(path), *flag]) == code
    assert words in capsys.readouterr().out.splitlines()[-1]
    if flag:  # what fails by itself fails without the flight too
        tight = case.replace({"requirements.tilt": 1e-7})
        path.write_text(format_design(tight), encoding="utf-8")
        assert main(["check", str(path), *flag]) == 1
        last = capsys.readouterr().out.splitlines()[-1]
        assert "DOES NOT CLOSE" in last
        assert last.endswith("; open: heading")
