"""One verdict and one value of each requirement, with the design's flight, wherever they are told."""

import io
import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl
import pytest

from app.cli import main
from app.document.verdict import check_words, met_cell, verdict_of
from app.library.reviews import MAX_ITEMS, open_review
from app.library.store import Library
from app.report.content import report_of
from app.report.spreadsheet import workbook_bytes
from app.session import Session
from app.subjects.budget.tables import requirement_table
from app.subjects.review.report import status_table
from app.subjects.review.rows import decision_row
from app.work.flight import follow
from nav_model.base.errors import InputError
from nav_model.budget import Budget, analyse
from nav_model.budget.allocation import allocate
from nav_model.budget.verdict import Check, flies
from nav_model.design import Design
from nav_model.design.figures import IN_FLIGHT
from nav_model.design.file import format_design
from nav_model.design.trajectory import LIMITED, row_of
from nav_model.trajectory.verdict import with_flight

_FLIGHTS = ("lines", "waypoints", "wandering", "straight", "turns", "climb")


def some_design(random: np.random.Generator, *, planned: bool) -> Design:
    """A design near its limits, `planned`: with a flight, with or without lines and limits of their own."""

    def spread(low: float, high: float) -> float:
        return float(np.exp(random.uniform(np.log(low), np.log(high))))

    def sometimes(changes: dict[str, Any], chance: float = 0.4) -> dict[str, Any]:
        return changes if random.random() < chance else {}

    keys: dict[str, Any] = {
        "imu.velocity_random_walk": spread(0.003, 0.2) / 60,
        "imu.angle_random_walk": math.radians(spread(0.003, 0.5)) / 60,
        "imu.vibration_factor": spread(1, 5),
        "gnss.position_noise": spread(0.01, 3),
        "gnss.interval": float(random.choice([0.5, 1.0])),
        "flight.speed": spread(60, 200),
        "flight.latitude": float(random.uniform(-1.2, 1.2)),
        "flight.heading": float(random.uniform(0, 6)),
        "flight.altitude": spread(500, 8000),
        "radar.slant_range": spread(2e3, 3e4),
        "radar.aperture_time": spread(1, 8),
        "radar.autofocus_order": int(random.integers(1, 4)),
        "processing.mode": str(random.choice(["real time", "post-processed"])),
        "requirements.confidence": float(random.choice([1.0, 2.0])),
        "requirements.steady_state": str(random.choice(["prior", "posterior", "closed"])),
        **sometimes({"gnss.velocity_noise": spread(0.01, 0.1)}),
        **sometimes({"gnss.vertical_position_noise": spread(0.02, 5)}),
        **sometimes({"imu.accelerometer_bias": spread(1e-5, 1e-3), "imu.gyro_bias": spread(1e-8, 1e-6)}),
        **sometimes({"radar.squint_angle": float(random.uniform(-0.4, 0.4))}),
    }
    limits = {
        "quadratic_phase": spread(0.1, 10), "cubic_phase": spread(0.05, 3), "detrended_phase": spread(0.05, 3),
        "azimuth_shift": spread(0.1, 5), "range_shift": spread(0.1, 5), "ce90": spread(0.2, 10), "le90": 2.0,
        "horizontal_position": spread(0.1, 2), "vertical_position": spread(0.1, 2), "tilt": spread(1e-4, 1e-3),
        "horizontal_velocity": spread(0.01, 0.2), "vertical_velocity": spread(0.005, 0.1),
        "coast_horizontal_position": spread(5, 50), "heading": math.radians(spread(0.01, 1)),
    }  # fmt: skip
    keys |= {f"requirements.{name}": limit for name, limit in limits.items() if random.random() < 0.5}
    if not planned:
        return Design(keys | {"trajectory.duration": 60.0})
    kind = str(random.choice(_FLIGHTS))
    length = keys["flight.speed"] * float(random.uniform(4, 40))  # some are too short for an aperture
    keys |= {
        "trajectory.flight": kind, "trajectory.lines": float(random.integers(1, 3)), "trajectory.length": length,
        "trajectory.spacing": spread(500, 2000), "trajectory.duration": float(random.uniform(60, 150)),
    }  # fmt: skip
    names = {"lines": ["line 1"], "waypoints": ["first leg"]}.get(kind, [])
    if kind == "waypoints":
        step = length / 6.4e6
        places = [(keys["flight.latitude"] + n * step, 0.1, 3000.0) for n in range(3)]
        keys["trajectory.waypoints"] = tuple(
            row_of(*place, name) for place, name in zip(places, ("first leg", "", ""), strict=True)
        )
    known = {figure: 0.7 * limit for figure, limit in limits.items()}
    own = [(name, *(known.get(figure) if random.random() < 0.3 else None for figure in LIMITED)) for name in names]
    keys["trajectory.limits"] = tuple(row for row in own if any(row[1:]) and random.random() < 0.7)
    return Design(keys)


def said(check: Check) -> tuple[str, str, str, float | None, float | None]:
    """The part of an answer that must be the same everywhere."""
    return (check.name, check.state, check.judged, _none(check.value), _none(check.margin))


def _none(value: float | None) -> float | None:
    return None if value is None or math.isnan(value) else value


def alike(one: list[Any], other: list[Any]) -> None:
    assert [row[:3] for row in one] == [row[:3] for row in other]
    for row, same in zip(one, other, strict=True):
        numbers, others = ([math.nan if value is None else value for value in each[3:]] for each in (row, same))
        assert numbers == pytest.approx(others, rel=1e-9, abs=1e-12, nan_ok=True), row[0]


@pytest.mark.parametrize(
    "count", [pytest.param(6, marks=pytest.mark.long), pytest.param(100, marks=pytest.mark.slow)]
)
def test_a_design_and_its_flight_have_one_verdict(
    count: int, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for solver in ("line_length.with_lengths", "swath.with_swath"):  # flights that no verdict is of
        monkeypatch.setattr(f"nav_model.trajectory.{solver}", lambda result, *_: result)
    random = np.random.default_rng(48)
    library, saved, kept = Library(tmp_path / "library.db"), [], list[Budget]()
    states = dict.fromkeys(("met", "not met", "refused"), 0)
    for number in range(count):
        design = some_design(random, planned=number % 3 == 0)
        path = tmp_path / f"{number}.toml"
        path.write_text(format_design(design), encoding="utf-8")
        try:
            budget, refused = with_flight(analyse(design)), ""
        except InputError as error:
            budget, refused = analyse(design), error.key
        if refused:
            for command in ("evaluate", "check", "trajectory"):
                assert main([command, str(path)]) == 2
                assert refused in capsys.readouterr().err, command
            continue
        verdict = budget.verdict
        whole = [said(check) for check in verdict.checks]
        for check in verdict.checks:
            states[check.state] += 1
            assert (check.judged == "straight leg") is (
                check.on not in IN_FLIGHT or not (design.trajectory.planned or check.on == "heading")
            )
        closes = {"closes": True, "fails": False, "open": False}[verdict.state]
        # Commands.
        assert main(["evaluate", str(path)]) == 0
        document = json.loads(capsys.readouterr().out)["verdict"]
        assert (document["state"], document["closes"]) == (verdict.state, closes)
        keys = ("name", "state", "judged", "value", "margin")
        alike([tuple(row[key] for key in keys) for row in document["requirements"] if row["name"] != "islr"], whole)
        assert main(["check", str(path)]) == (0 if closes else 1)
        *lines, last = capsys.readouterr().out.splitlines()
        word = {"closes": "closes", "fails": "DOES NOT CLOSE", "open": "OPEN"}[verdict.state]
        assert f"{path}: {word}" in last
        for check, line in zip(verdict.checks, lines, strict=False):
            state = {"met": "met    ", "not met": "NOT MET", "refused": "REFUSED"}[check.state]
            assert line.startswith(f"  {state} {check.label} ")
        if flies(design):
            assert main(["trajectory", str(path)]) == (0 if closes else 1)
            document = json.loads(capsys.readouterr().out)
            assert document["closes"] is closes
            alike([tuple(row[key] for key in keys) for row in document["verdict"]["requirements"]], whole)
        # The page: the budget of the session with the checks of the flight that the page Flight follows.
        session = Session(design)
        if flies(design):
            assert session.budget.verdict.state in ("open", "fails")
            followed = follow(design)
            session.budget = replace(session.budget, flight=followed.checks)
        alike([said(check) for check in session.budget.verdict.checks], whole)
        rows = requirement_table(budget).rows if verdict.checks else ()
        for check, row in zip(verdict.checks, rows, strict=True):
            words = check_words(design, check)
            assert [cell.text for cell in row][1:5] == [
                words.value,
                words.limit,
                words.margin,
                met_cell(check, verdict).text,
            ]
        # Report, library, workbook, allocation.
        (chapter,) = report_of([budget]).chapters
        assert chapter.verdict == verdict_of(budget)
        assert ("✓" in chapter.verdict.word) is (closes and bool(verdict.checks))
        if number % 5 == 0 and len(saved) < MAX_ITEMS:
            revision = library.save(analyse(design), "Ann")
            assert revision.closes is (None if verdict.state == "open" or not verdict.checks else closes)
            saved.append(revision.key)
            kept.append(budget)
            alike([said(check) for check in revision.budget().verdict.checks], whole)
        if number % 4 == 0:
            in_workbook(budget)
        for leg in budget.straight_leg().checks:
            split = allocate(budget, leg.name)
            squares = sum(entry.estimated**2 for entry in split.entries)
            assert math.sqrt(squares) == pytest.approx(leg.value, rel=1e-6)
            beside = next(check for check in verdict.checks if check.name == leg.name)
            assert beside.straight in (None, leg.value)
    review = open_review(library, "All", "Ann", saved)
    rows = [row for row in status_table(review).rows if len(row) > 1]
    flat = [(place, budget, check) for place, budget in enumerate(kept, 1) for check in budget.verdict.checks]
    assert review.points() == [(place, check.name) for place, _, check in flat]
    for (place, budget, check), row in zip(flat, rows, strict=True):
        words = check_words(budget.design, check)
        assert [cell.text for cell in row][1:4] == [words.value, words.limit, met_cell(check, budget.verdict).text]
        assert review.met(place, check.name) is check.met
        assert decision_row(review, place, check.name)["verdict"] == met_cell(check, budget.verdict).text
    library.close()
    assert states["met"] > count
    assert states["not met"] > count / 2


def in_workbook(budget: Budget) -> None:
    """The straight leg's values, and beside them the flight's, which decide."""
    book = openpyxl.load_workbook(io.BytesIO(workbook_bytes(budget)), data_only=True)
    for processing, sheet in (("real time", "Budget"), ("post-processed", "Post-processed")):
        verdict = budget.judged(processing)
        legs = {check.name: check for check in budget.straight_leg(processing).checks}
        words = {"closes": "Closes" if verdict.checks else "Not checked", "fails": "Does not close", "open": "Open"}
        assert book[sheet]["A2"].value == words[verdict.state]
        head = next(row for row in book[sheet].iter_rows(values_only=True) if row[0] == "Requirement")
        rows = {row[0]: row for row in book[sheet].iter_rows(values_only=True)}
        for check in verdict.checks:
            row = rows[check.label]
            assert row[head.index("Met")] == check.state
            if check.known:
                assert row[head.index("Margin")] == pytest.approx(check.margin, rel=1e-9, abs=1e-9)
            if check.name in legs:
                leg, limit = (
                    legs[check.name],
                    check.limit if check.judged != "straight leg" else legs[check.name].limit,
                )
                checked, allowed = row[head.index("Value checked")], row[head.index("Limit")]
                assert checked / allowed == pytest.approx(leg.value / limit, rel=1e-6)
            if check.judged != "straight leg" and check.known:
                ratio = row[head.index("Along the flight")] / row[head.index("Limit")]
                assert ratio == pytest.approx(check.value / check.limit, rel=1e-9)
