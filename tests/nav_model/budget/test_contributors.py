"""Contributors of the user's own, against sums written out here."""

import json
import math
import pickle
import random
from typing import Any

import pytest

from nav_model import Design, InputError, analyse
from nav_model.base.constants import SPEED_OF_LIGHT
from nav_model.budget.figures import figures
from nav_model.budget.inputs import inputs_of
from nav_model.budget.json import to_json
from nav_model.design.catalogue import catalogue
from nav_model.design.contributors import Contributor, read_contributors
from nav_model.design.figures import FIGURES, OF_BUDGET, REQUIRED, of_kind
from nav_model.design.file import format_design, parse_design
from nav_model.design.link import from_query, to_query
from nav_model.design.user_entries import UserEntries, read_entries, read_limits
from nav_model.explore.search import search

_LIMITS = {
    f"requirements.{key}": {"angle": 1.0, "length": 10.0, "speed": 1.0, "level": 0.1}[FIGURES[key].dimension]
    for key in REQUIRED
}
# Values that have no requirement among the inputs get one of the user's own, under another name.
_OWN_LIMITS = read_limits(
    [{"name": f"own {name}", "on": name, "limit": "1 m/s" if figure.dimension == "speed" else "1 rad"}
     for name, figure in FIGURES.items() if name not in REQUIRED and figure.kind in ("outage", "phase")]
)  # fmt: skip
_NAMES = (*REQUIRED, *(limit.name for limit in _OWN_LIMITS))
DESIGN = Design(_LIMITS, entries=UserEntries(limits=_OWN_LIMITS))
_SIZES = {"angle": "1 mrad", "length": "1 cm", "speed": "1 mm/s", "level": "-40 dB", "loss": "0.1 dB"}
LEVER_ARM = {"name": "lever arm", "value": "1 mm", "enters": "detrended_phase", "owner": "mechanics"}
_ALONE = {mode: analyse(DESIGN.replace({"processing.mode": mode})) for mode in ("real time", "post-processed")}


def _with(*tables: dict[str, str], mode: str = "real time") -> Design:
    return DESIGN.replace(
        {"processing.mode": mode}, entries=UserEntries(read_contributors(list(tables)), _OWN_LIMITS)
    )


@pytest.mark.parametrize("mode", ["real time", "post-processed"])
def test_a_millimetre_enters_the_phase_by_four_pi_over_lambda(mode: str) -> None:
    design = _with(LEVER_ARM, mode=mode)
    size = 4 * math.pi / (SPEED_OF_LIGHT / design.radar.frequency) * 1e-3
    budget, alone = analyse(design), _ALONE[mode]
    for check, before in zip(budget.verdict.checks, alone.verdict.checks, strict=True):
        if check.on in ("detrended_phase", "line_of_sight_detrended_phase"):
            assert check.sigma == pytest.approx(math.hypot(before.sigma, size), rel=1e-14)
            assert check.shares["lever arm"] == pytest.approx(size**2 / check.sigma**2, rel=1e-14)
        else:
            assert check == before
    (entry,) = json.loads(json.dumps(to_json(budget)))["contributors"]
    expected = {"name": "lever arm", "enters": "detrended_phase", "unit": "rad", "owner": "mechanics"}
    assert entry == expected | {"sigma": pytest.approx(size, rel=1e-14)}
    before = alone.figure("detrended_phase").sigma
    assert budget.figure("detrended_phase").sigma == pytest.approx(math.hypot(before, size), rel=1e-14)


def test_the_lines_of_the_phase_budget_name_it_and_add_up() -> None:
    table = {**LEVER_ARM, "kind": "systematic", "enters": "cubic_phase"}
    budget, alone = analyse(_with(table, LEVER_ARM | {"name": "other"})), _ALONE["real time"]
    size = 4 * math.pi / alone.sar.wavelength * 1e-3
    lines, before = (each.phase_lines("real time") for each in (budget, alone))
    assert {line.source for line in lines} - {line.source for line in before} == {"lever arm", "other"}
    cubic = budget["cubic_phase", "real time"]
    assert cubic.sigma == pytest.approx(alone["cubic_phase", "real time"].sigma + size, rel=1e-14)
    for share in ("share", "detrended_share"):
        assert math.fsum(getattr(line, share) for line in lines) == pytest.approx(1, rel=1e-14)
    assert math.fsum(cubic.shares.values()) == pytest.approx(1, rel=1e-14)


@pytest.mark.parametrize("mode", ["real time", "post-processed"])
def test_one_of_zero_changes_nothing(mode: str) -> None:
    zeros = [{"name": name, "value": value, "enters": name, "kind": "systematic"} for name, value in (
        ("detrended_phase", "0 mm"), ("tilt", "0 rad"), ("ce90", "0 m"), ("coast_vertical_position", "0 m"),
        ("horizontal_velocity", "0 m/s"),
    )]  # fmt: skip
    left, right = to_json(analyse(_with(*zeros, mode=mode))), to_json(_ALONE[mode])
    for document in (left, right):
        del document["contributors"], document["design"]
    assert left == right


def _random_set(draw: random.Random) -> list[Contributor]:
    result = []
    for number in range(draw.randint(1, 8)):
        enters = draw.choice(list(OF_BUDGET))
        alike = enters.startswith("coast") or enters in ("paired_echo", "islr", "autofocus_estimation")
        lengthy = enters in of_kind("phase") and draw.random() < 0.5
        result.append(
            Contributor(
                f"c{number}", 10 ** draw.uniform(-4, -1), enters, "length" if lengthy else FIGURES[enters].dimension,
                kind=draw.choice(["random", "systematic"]),
                processing="both" if alike else draw.choice(["both", "real time", "post-processed"]),
                allowance=draw.choice([0.0, 0.2]),
            )
        )  # fmt: skip
    return result


@pytest.mark.long
def test_random_sets_agree_with_the_sum_written_out() -> None:
    draw = random.Random(29)
    for number in range(500):
        contributors = _random_set(draw)
        mode = ("real time", "post-processed")[number % 2]
        design = DESIGN.replace({"processing.mode": mode}, entries=UserEntries(tuple(contributors), _OWN_LIMITS))
        # The maps' way for all, the verdict's for some, since a budget takes longer.
        budget = analyse(design) if number % 25 < 2 else None
        result = {c.name: c.sigma for c in budget.verdict.checks} if budget else figures(inputs_of(design), _NAMES)
        for before in _ALONE[mode].verdict.checks:
            square, linear = before.sigma**2, 0.0
            for c in contributors:
                lasting = c.processing == "both" and f"coast_{c.enters}" == before.on and "position" in before.on
                # A part of a phase is in the image's, and what enters that is along the line of sight.
                whole = c.enters.removeprefix("along_track_").removeprefix("line_of_sight_")
                entered = {c.enters, whole, *([f"line_of_sight_{c.enters}"] if c.enters == whole else [])}
                if lasting or (before.on in entered and c.processing in ("both", mode)):
                    size = c.value * (1 + c.allowance)
                    if c.dimension == "length" and FIGURES[c.enters].dimension == "angle":
                        size *= 4 * math.pi / (SPEED_OF_LIGHT / design.radar.frequency)
                    square, linear = (square + size**2, linear) if c.kind == "random" else (square, linear + size)
            assert float(result[before.name]) == pytest.approx(math.sqrt(square) + linear, rel=1e-12), before.name
        for check in budget.verdict.checks if budget else ():
            assert math.fsum(check.shares.values()) == pytest.approx(1, rel=1e-12)


@pytest.mark.parametrize("mode", ["real time", "post-processed"])
@pytest.mark.parametrize("moment", ["prior", "closed", "posterior"])
def test_verdict_and_maps_have_the_same_figures(mode: str, moment: str) -> None:
    tables = [
        {"name": name, "value": _SIZES[figure.dimension],
         "enters": name, "kind": "systematic" if number % 2 else "random"}
        for number, (name, figure) in enumerate((name, FIGURES[name]) for name in OF_BUDGET)
    ]  # fmt: skip
    design = _with(*tables, mode=mode).replace({"requirements.steady_state": moment})
    result = figures(inputs_of(design), _NAMES)
    for check in analyse(design).verdict.checks:
        assert check.sigma == pytest.approx(float(result[check.name]), rel=1e-9), check.name
        assert math.fsum(check.shares.values()) == pytest.approx(1, rel=1e-12)
        assert check.on in check.shares


def test_file_link_pickle_and_replace_keep_them() -> None:
    design = _with(LEVER_ARM | {"allowance": "20 %", "source": "survey, 2026-03"}, {
        "name": "clock", "value": "2e-4 rad", "enters": "tilt", "kind": "systematic", "processing": "real time",
    })  # fmt: skip
    assert parse_design(format_design(design)) == design
    assert 'value = "1 mm"' in format_design(design)
    assert from_query(to_query(design)) == design
    assert pickle.loads(pickle.dumps(design)) == design
    assert design.replace({"gnss.interval": 0.5}).contributors == design.contributors
    assert design.replace({}, entries=UserEntries(limits=_OWN_LIMITS)) == DESIGN != design
    assert hash(design.replace({}, entries=UserEntries(limits=_OWN_LIMITS))) == hash(DESIGN)


def test_the_content_hash_counts_them() -> None:
    assert len({_with(LEVER_ARM | change).content_hash for change in (
        {}, {"value": "2 mm"}, {"value": "1 rad"}, {"kind": "systematic"}, {"allowance": "5 %"}, {"owner": "radar"},
        {"enters": "cubic_phase"}, {"processing": "real time"}, {"name": "lever"}, {"source": "survey"},
    )}) == 10  # fmt: skip
    assert _with(LEVER_ARM).content_hash == _with(LEVER_ARM | {"value": "0.001 m"}).content_hash


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"value": "1 m/s"}, "contributors[lever arm].value"),
        ({"value": "1"}, "contributors[lever arm].value"),
        ({"value": "-1 mm"}, "contributors[lever arm].value"),
        ({"value": 1}, "contributors[lever arm].value"),
        ({"value": "1 mm", "enters": "tilt"}, "contributors[lever arm].value"),
        ({"value": "1 mm", "enters": "islr"}, "contributors[lever arm].value"),
        ({"enters": "yaw"}, "contributors[lever arm].enters"),
        ({"enters": "confidence"}, "contributors[lever arm].enters"),
        ({"kind": "normal"}, "contributors[lever arm].kind"),
        ({"processing": "later"}, "contributors[lever arm].processing"),
        ({"value": "1 m", "enters": "coast_vertical_position", "processing": "real time"},
         "contributors[lever arm].processing"),
        ({"allowance": "20 mm"}, "contributors[lever arm].allowance"),
        ({"allowance": "-20 %"}, "contributors[lever arm].allowance"),
        ({"name": "Gyro noise"}, "contributors[Gyro noise]"),
        ({"name": "total"}, "contributors[total]"),  # a bar of this name would get the limits of the sum
        ({"name": " "}, "contributors[1].name"),
        ({"owner": "two\nlines"}, "contributors[lever arm].owner"),
        ({"colour": "red"}, "contributors[lever arm].colour"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_refused_by_name(change: dict[str, Any], named: str) -> None:
    with pytest.raises(InputError) as refused:
        read_contributors([LEVER_ARM | change])
    assert refused.value.key == named


@pytest.mark.parametrize(
    ("tables", "named"),
    [
        ([LEVER_ARM, LEVER_ARM | {"name": "Lever arm "}], "contributors[Lever arm]"),
        ([LEVER_ARM | {"name": f"c{n}"} for n in range(1000)], "contributors"),
        ([{"name": "lever arm", "enters": "tilt"}], "contributors[lever arm].value"),
        ({"name": "lever arm"}, "contributors"),
        (["lever arm"], "contributors"),
    ],
)
def test_a_list_that_is_wrong_is_refused_by_name(tables: Any, named: str) -> None:
    with pytest.raises(InputError) as refused:
        read_entries({"contributors": tables})
    assert refused.value.key == named
    if not isinstance(tables, dict):
        with pytest.raises(InputError):
            from_query("contributors=" + json.dumps(tables))


def test_a_search_judges_measures_of_the_response_by_the_quadratic_phase() -> None:
    arm = read_contributors([LEVER_ARM | {"enters": "quadratic_phase", "value": "1 mm"}])
    limits = [{"name": f"my {name}", "on": name, "limit": "1 dB"} for name in ("peak_loss", "pslr")]
    design = Design(entries=UserEntries(arm, read_limits(limits)))
    rows = search(design, catalogue("imu"), {})
    assert {"lever arm", "gyro noise"} <= {row.dominant for row in rows}
    for row in rows:
        check = analyse(design.replace(row.changes)).verdict.tightest
        assert (row.tightest, row.dominant) == (check.name, check.dominant)
        assert row.share == pytest.approx(check.dominant_share, rel=1e-6)


@pytest.mark.parametrize("kind", ["random", "systematic"])
def test_a_search_names_a_contributor_that_dominates_with_its_share(kind: str) -> None:
    arm = read_contributors([LEVER_ARM | {"kind": kind, "value": "5 mm"}])
    design = Design({"requirements.detrended_phase": 0.3, "requirements.tilt": 1.0}, entries=UserEntries(arm))
    rows = search(design, catalogue("imu"), catalogue("gnss"))
    dominated = [row for row in rows if row.dominant == "lever arm"]
    assert len(dominated) > 3
    for row in dominated[:3]:
        (check, _) = analyse(design.replace(row.changes)).verdict.checks
        assert row.share == pytest.approx(check.shares["lever arm"], rel=1e-9)
