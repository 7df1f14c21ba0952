"""One requirement, one answer: value, limit, margin and verdict are the same wherever they are told."""

import io
import math
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl
import pytest

from app.document.display import ONE_SIGMA
from app.document.numbers import margin_in_sentence, show_in
from app.document.verdict import check_words, verdict_strip, verdicts_in_short
from app.library.reviews import open_review
from app.library.store import Library
from app.report.comparison import difference_tables
from app.report.spreadsheet import workbook_bytes
from app.subjects.budget.command import check_lines
from app.subjects.budget.key_figures import key_figures
from app.subjects.budget.tables import requirement_table
from app.subjects.review.report import status_table
from app.subjects.review.rows import figure_of
from app.subjects.sar.tables import answer
from nav_model.base.errors import InputError
from nav_model.budget import analyse
from nav_model.budget.json import to_json
from nav_model.budget.verdict import limit_on
from nav_model.design import Design
from nav_model.design.figures import FIGURES, OF_BUDGET, REQUIRED
from nav_model.design.parts import INPUTS
from nav_model.design.user_entries import UserEntries, read_entries
from nav_model.explore.margins import ratios
from nav_model.explore.supplier import required
from nav_model.sar.design_case import conditions, judged
from nav_model.sar.design_study import closed_forms
from nav_model.sar.strategies import NAMES
from nav_model.sar.winners import map_of_winners

REVIEWED = 6  # of the designs that are in a library too


def some_design(random: np.random.Generator) -> Design:
    """A design with every requirement, near the limits of some."""

    def spread(low: float, high: float) -> float:
        return float(np.exp(random.uniform(np.log(low), np.log(high))))

    def sometimes(changes: dict[str, Any], chance: float = 0.3) -> dict[str, Any]:
        return changes if random.random() < chance else {}

    keys: dict[str, Any] = {
        "imu.velocity_random_walk": spread(0.003, 0.2) / 60,
        "imu.angle_random_walk": math.radians(spread(0.003, 0.5)) / 60,
        "gnss.position_noise": spread(0.01, 3),
        "gnss.interval": float(random.choice([0.1, 0.5, 1.0])),
        "flight.speed": spread(40, 250),
        "radar.slant_range": spread(2e3, 4e4),
        "radar.aperture_time": spread(1, 20),
        "radar.autofocus_order": int(random.integers(1, 4)),
        "processing.mode": str(random.choice(["real time", "post-processed"])),
        "requirements.confidence": float(random.choice([1.0, 2.0])),
        **sometimes(
            {"imu.accelerometer_bias": spread(1e-5, 1e-3), "imu.gyro_bias": math.radians(spread(0.01, 1)) / 3600}
        ),
        **sometimes({"gnss.velocity_noise": spread(0.01, 0.1)}),
        **sometimes({"gnss.correlated": True, "gnss.correlated_noise": 0.3, "gnss.correlation_time": 300.0}, 0.2),
        **sometimes({"coast.before_aperture": spread(1, 60)}),
        **sometimes({"radar.squint_angle": float(random.uniform(-0.5, 0.5))}),
        **sometimes({"motion.unsensed_lines": ((float(spread(1, 20)), 1e-4, "length"),)}),
    }
    limits: dict[str, Any] = {
        "quadratic_phase": spread(0.1, 10), "cubic_phase": spread(0.05, 3), "detrended_phase": spread(0.05, 3),
        "azimuth_shift": 1.0, "range_shift": 0.5, "ce90": 2.0, "le90": 2.0, "horizontal_position": 0.5,
        "vertical_position": 0.5, "horizontal_velocity": 0.02, "vertical_velocity": 0.02, "tilt": 2e-4,
        "coast_horizontal_position": 20.0, "coast_vertical_position": 20.0,
    }  # fmt: skip
    assert set(limits) <= set(INPUTS["requirements"])
    return Design(
        keys | {f"requirements.{name}": limit for name, limit in limits.items()}, entries=some_entries(random)
    )


_SIZES = {"angle": "2°", "length": "0.2 m", "speed": "5 mm/s", "level": "-25 dB", "loss": "0.1 dB"}
_LIMITS = {"angle": "9°", "length": "1 m", "speed": "1 cm/s", "level": "-15 dB", "loss": "1 dB"}


def some_entries(random: np.random.Generator) -> UserEntries:
    """Contributors to some figures, and limits of the user's own on others."""
    entering, limited = (random.choice(list(OF_BUDGET), count, replace=False) for count in random.integers(0, 5, 2))
    contributors = [
        {
            "name": f"error {n}",
            "enters": str(name),
            "value": _SIZES[FIGURES[name].dimension],
            "kind": str(random.choice(["random", "systematic"])),
            "allowance": "20 %",
            "processing": str(random.choice(["both", "real time", "post-processed"]))
            if FIGURES[name].smoothed_mark
            else "both",
        }
        for n, name in enumerate(entering)
    ]
    limits = [
        {"name": f"limit {n}", "on": str(name), "limit": _LIMITS[FIGURES[name].dimension]}
        | ({"confidence": 3} if FIGURES[name].scaled and n % 2 else {})
        | ({"at": "7 s"} if FIGURES[name].kind == "outage" and n % 2 else {})
        for n, name in enumerate(limited)
    ]
    return read_entries({"contributors": contributors, "limits": limits})


@pytest.mark.parametrize(
    "count", [pytest.param(25, marks=pytest.mark.long), pytest.param(100, marks=pytest.mark.slow)]
)
def test_pages_report_and_command_give_one_verdict(count: int) -> None:
    random = np.random.default_rng(28)
    seen = {True: 0, False: 0}
    for _ in range(count):
        design = some_design(random)
        budget = analyse(design)
        verdict, lines = budget.verdict, check_lines("d", budget)
        document = to_json(budget)["verdict"]
        table = requirement_table(budget)
        assert document["closes"] is verdict.closes is all(check.met for check in verdict.checks)
        assert f"d: {'closes' if verdict.closes else 'DOES NOT CLOSE'} at" in lines[-1]
        assert verdict_strip(budget).word == ("✓ Closes" if verdict.closes else "✗ Does not close")
        short = next(text for text, mode in verdicts_in_short(budget).items() if mode == verdict.processing)
        assert ("✓" in short) is verdict.closes
        tiles = {tile.label: tile for tile in key_figures(budget).items}
        assert {label for label, tile in tiles.items() if tile.met is not None} <= {c.label for c in verdict.checks}
        explored = ratios(design)
        for check, entry, row, line in zip(verdict.checks, document["requirements"], table.rows, lines, strict=False):
            words = check_words(design, check)
            assert check.met is (check.value <= check.limit)
            seen[check.met] += 1
            assert (entry["name"], entry["met"], entry["margin"]) == (check.name, check.met, check.margin)
            texts = [cell.text for cell in row]
            assert texts[1:5] == [words.value, words.limit, words.margin, "✓ met" if check.met else "✗ not met"]
            assert line.startswith(f"  {'met    ' if check.met else 'NOT MET'} {check.label} ")
            plain = [text.replace("−", "-") for text in (words.value, words.limit, margin_in_sentence(check.margin))]
            assert "{} (limit {}, {};".format(*plain) in line.replace("−", "-")
            assert 1 - float(explored[check.name]) == pytest.approx(check.margin, rel=1e-9, abs=1e-9)
            tile = tiles[check.label]  # none hides another
            assert (tile.met, tile.used) == (check.met, 1 - check.margin)
        # A limit of one's own on the detrended phase may decide there.
        phases = [check for check in verdict.checks if check.on == "detrended_phase"]
        check = min(phases, key=lambda check: check.margin)
        closed = closed_forms(budget)
        block, strip, words = answer(budget, closed, None), verdict_strip(budget), check_words(design, check)
        assert (block.word, block.tone) == (strip.word, strip.tone)
        assert f" {words.value}, limit {words.limit}" in " ".join(block.sentences[:-1])
        assert (f"{NAMES[judged(design)]} meets " in block.sentences[-1]) is check.met
        phase = 4 * math.pi / budget.sar.wavelength * check.confidence
        assert phase * closed.detrended[judged(design)] == pytest.approx(check.value, rel=1e-9)
        drawn = map_of_winners(conditions(budget))
        assert phase * drawn.sigma[drawn.strategies.index(judged(design))] == pytest.approx(check.value, rel=1e-9)
        assert closed.advice.sentence.startswith(f"{NAMES[judged(design)]} meets ") is check.met
    assert min(seen.values()) > count


@pytest.mark.parametrize("count", [pytest.param(3, marks=pytest.mark.long), pytest.param(25, marks=pytest.mark.slow)])
def test_workbook_comparison_sheets_and_review_give_the_same_verdict(tmp_path: Path, count: int) -> None:
    """With the values of the budget, and a value of every sheet at once within every limit that one of them keeps."""
    random = np.random.default_rng(281)
    library, keys, reviewed = Library(tmp_path / "library.db"), [], []
    for number in range(count):
        design = some_design(random)
        budget = analyse(design)
        if number < REVIEWED:
            keys.append(library.save(budget, "Ann").key)
            reviewed += [(budget, check) for check in budget.verdict.checks]
        checks = {check.name: check for check in budget.verdict.checks}
        book = openpyxl.load_workbook(io.BytesIO(workbook_bytes(budget)), data_only=True)
        for verdict, sheet in (
            (budget.judged("real time"), "Budget"),
            (budget.judged("post-processed"), "Post-processed"),
        ):
            rows = {row[0].value: row for row in book[sheet].iter_rows(min_row=6)}
            for check in verdict.checks:
                assert rows[check.label][6].value == pytest.approx(check.margin, rel=1e-9, abs=1e-9), (
                    number,
                    check.name,
                )
                assert rows[check.label][7].value == ("met" if check.met else "not met")
        _, figures, _ = difference_tables([budget, analyse(design.replace({"name": "B"}))], ["A", "B"], ONE_SIGMA)
        values = {row[0].text: row[1].text for row in figures.rows}
        prior = analyse(design.replace({"requirements.steady_state": "prior"}))
        for name in REQUIRED:
            sigma, unit = prior.figure(name).sigma, limit_on(name).unit
            assert values[FIGURES[name].label] == show_in(sigma, unit, FIGURES[name].dimension)
        try:
            lines = [line for unit in ("imu", "gnss") for line in required(design, unit)]
        except InputError:
            continue
        delivered = analyse(design.replace({line.key: line.value for line in lines})).verdict
        assert all(check.margin > -1e-9 for check in delivered.checks if checks[check.name].margin < 1)
    review = open_review(library, "All", "Ann", keys)
    rows = [row for row in status_table(review).rows if len(row) > 1]
    places = [place for place, item in enumerate(review.revisions, 1) for _ in item.budget().verdict.checks]
    for (budget, check), row, place in zip(reviewed, rows, places, strict=True):
        words = check_words(budget.design, check)
        texts = [cell.text for cell in row]
        assert texts[1:4] == [words.value, words.limit, "✓ met" if check.met else "✗ not met"]
        assert figure_of(review, place, check.name).startswith(f"{words.value} against {words.limit} ")
    library.close()
