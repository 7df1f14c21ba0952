"""Studies in the report: its numbers are those of the study's JSON, and studies of other designs are omitted."""

import math
import pickle
import re
from dataclasses import replace
from datetime import UTC, datetime
from typing import Any

import pytest

from app.document.blocks import Answer, Bullets, Cell, ChartBlock, Equations, Section, Symbols, TableBlock, Text
from app.examples import example
from app.report import report_bytes
from app.report.content import report_of
from app.report.studies import belonging, study_sections
from app.session import Session
from app.subjects.sar.run import SarResult
from app.subjects.suborbital.charts.content import Content
from nav_model.budget import analyse
from nav_model.design import Design
from nav_model.equations import SYMBOLS
from nav_model.sar.design_case import design_case
from nav_model.sar.design_study import image_study
from nav_model.sar.pictures import point_pictures
from nav_model.sar.study_json import to_json as sar_json
from nav_model.simulation.design_study import closed_form, specification, study_of, to_document
from nav_model.simulation.monte_carlo import simulate
from nav_model.suborbital.settings import DEFAULTS, from_design
from nav_model.suborbital.survey import run_survey
from nav_model.suborbital.survey_json import survey_json

pytestmark = [pytest.mark.usefixtures("charts_drawn_once"), pytest.mark.long]
NOW = datetime(2026, 11, 21, 9, 30, tzinfo=UTC)
MOST_BYTES = 3_000_000  # of the sections on their way to a worker


@pytest.fixture(scope="module")
def design() -> Design:
    return example("mems_x_band")


@pytest.fixture(scope="module")
def findings(design) -> dict[str, Any]:
    spec = specification(design, runs=20, duration=140.0, outages=((100.0, 140.0),))
    simulation = study_of(design, simulate(spec, workers=1, closed_form=closed_form(design, spec)))
    study = image_study(design, 40, 3)
    points = point_pictures(study.budget, study.typical.residual)
    settings = from_design(DEFAULTS, design)
    survey = run_survey(settings)
    return {
        "simulation": simulation,
        "sar": SarResult(design_case(study.budget), study, points),
        "suborbital": Content(survey, survey.study, settings, "all"),
    }


@pytest.fixture(scope="module")
def sections(findings, design) -> tuple[Section, ...]:
    return study_sections(findings, design, "d")


@pytest.fixture(scope="module")
def html(sections, design) -> str:
    return report_bytes([analyse(design)], ".html", NOW, studies=[sections]).decode()


@pytest.fixture(scope="module")
def pages(sections, design, placed) -> list[tuple[str, float]]:
    texts: list[tuple[str, float]] = placed(report_bytes([analyse(design)], ".pdf", NOW, studies=[sections]))
    return texts


def table(sections: tuple[Section, ...], key: str) -> TableBlock:
    return next(
        b for section in sections for b in section.blocks if isinstance(b, TableBlock) and b.key == f"d-{key}"
    )


def verdict(sections: tuple[Section, ...], key: str) -> Answer:
    section = next(section for section in sections if section.key == f"d-{key}")
    return next(block for block in section.blocks if isinstance(block, Answer))


def value(cell: Cell) -> float:
    """The number a cell begins with; 0 for less than the smallest one told."""
    if cell.text.startswith("<"):
        return 0.0
    return float(cell.text.split(" (")[0].replace("\u202f", "").replace("−", "-"))


def squeezed(text: str) -> str:
    return re.sub(r"\s", "", text)


# the numbers are those of the JSON


def test_simulated_sigmas_are_those_of_the_studys_json(sections, findings):
    document = to_document(findings["simulation"])
    rows = table(sections, "simulation-sigmas").rows
    times = [float(re.search(r"([\d.]+) s$", row[0].text)[1]) for row in rows if len(row) == 1]
    assert times == [100.0, 140.0]
    states = [row for row in rows if len(row) > 1]
    assert len(states) == 2 * 9
    for number, row in enumerate(states):
        at = document["time_s"].index(times[number // 9])
        group, axis, unit = re.match(r"(\w+), (\w+) \[(.+)\]", row[0].text).groups()
        suffix, scale = {"m": ("m", 1.0), "m/s": ("m_s", 1.0), "°": ("rad", 180 / math.pi)}[unit]
        sigmas = document[group.lower()][axis]
        kinds = ("rms", "filter_sigma", "closed_form_sigma")
        expected = [scale * sigmas[f"{kind}_{suffix}"][at] for kind in kinds]
        assert [value(cell) for cell in row[1:4]] == pytest.approx(expected, rel=5e-3), row[0].text
        refined = sigmas.get("refined_sigma_m", [None] * (at + 1))[at]
        assert row[4].text == "–" if refined is None else value(row[4]) == pytest.approx(refined, rel=5e-3)
        assert value(row[5]) == pytest.approx(expected[0] / expected[2], rel=5e-3)


def test_the_simulations_verdict_says_nees_nis_and_their_bands(sections, findings):
    document, answer = to_document(findings["simulation"]), verdict(sections, "simulation")
    assert (answer.word == "Consistent") == document["consistent"]
    for name, sentence in zip(("nees", "nis"), answer.sentences, strict=True):
        figures = [
            float(text)
            for text in re.findall(rf"{name.upper()} ([\d.]+),? .* band ([\d.]+) to ([\d.]+)[,:)]", sentence)[0]
        ]
        assert figures == pytest.approx([document[name][part] for part in ("mean", "low", "high")], rel=5e-3)
    rows = table(sections, "simulation-departures").rows
    assert sum(row[0].text.count(",") for row in rows) == len(document["departures"])  # alike ones share a row
    reasons = {re.sub(r" \(×[^)]*\)", "", departure["reason"].lower()) for departure in document["departures"]}
    assert {re.sub(r" \(×[^)]*\)", "", row[4].text.lower()) for row in rows} == reasons
    factors = sorted(step["factor"] for departure in document["departures"] for step in departure["steps"])
    told_factors = [float(text) for row in rows for text in re.findall(r"[×(]?([\d.]+)(?: to|\))", row[4].text)]
    assert min(told_factors) == pytest.approx(factors[0], rel=5e-3)
    assert max(told_factors) == pytest.approx(factors[-1], rel=5e-3)
    bullets = next(b for s in sections if s.key == "d-simulation" for b in s.blocks if isinstance(b, Bullets))
    assert list(bullets.items) == document["conditions"]


def listed(document: dict[str, Any], rows: tuple[tuple[Cell, ...], ...]) -> list[dict[str, Any]]:
    """The strategies of a document that a table has; without an outage one of them is another's twin."""
    names = [row[0].text for row in rows]
    strategies = [strategy for strategy in document["strategies"] if strategy["name"] in names]
    assert len(strategies) == len(names) >= len(document["strategies"]) - 1
    return strategies


def test_the_strategies_numbers_are_those_of_the_studys_json_in_millimetres_and_degrees(sections, findings):
    document = sar_json(findings["sar"].study)
    degrees = math.degrees(4 * math.pi / document["wavelength_m"])
    rows = table(sections, "sar-errors").rows
    for row, strategy in zip(rows, listed(document, rows), strict=True):
        rms, band = strategy["residual_rms_over_runs_m"], strategy["parts_m"]["residual_rms"]
        page = [None if cell.text == "–" else value(cell) for cell in row[4:]]
        expected = [1e3 * rms, degrees * rms, degrees * band["median"]]
        for number, other in zip(page, expected, strict=True):
            assert number == (None if other is None else pytest.approx(other, rel=6e-3, abs=1e-9)), row[0].text
        form = strategy["closed_form"]["residual_rms_m"]
        assert row[2].text == "–" if form is None else value(row[2]) == pytest.approx(1e3 * form, rel=6e-3)
        assert strategy["reconstruction"] == ("reconstruction" in row[1].text)


def test_the_responses_are_those_of_the_studys_json_both_ways(sections, findings):
    document = sar_json(findings["sar"].study)
    lobe, integrated = table(sections, "sar-lobe").rows, table(sections, "sar-islr").rows
    seen = 0
    for row, other, strategy in zip(lobe, integrated, listed(document, lobe), strict=True):
        response = strategy["impulse_response"]
        if response["width_cells"]["median"] is None:
            assert row[1].text == "not focused"
            continue
        seen += 1
        names = ("width_cells", "width_cells", "pslr_fixed_db", "pslr_null_db", "peak_loss_db")
        expected = [response[name]["median"] for name in names]
        expected[1] *= document["cell_length_m"]
        assert [value(cell) for cell in row[1:]] == pytest.approx(expected, rel=6e-3, abs=6e-3), row[0].text
        names = ("islr_fixed_db", "islr_null_db", "islr_fixed_ten_db", "shift_cells")
        expected = [response[name]["median"] for name in names]
        assert [value(cell) for cell in other[1:]] == pytest.approx(expected, abs=6e-3), other[0].text
    assert seen >= 6


def test_the_sar_answer_says_which_why_and_what_would_change_it(sections, findings):
    advice = sar_json(findings["sar"].study)["advice"]
    study = findings["sar"].study
    texts = [b.text for s in sections if s.key == "d-sar" for b in s.blocks if isinstance(b, Text)]
    assert texts[0].startswith("No strategy meets 20° in real time. Closest: RTS smoother")
    blocks = [block for section in sections if section.key.startswith("d-sar") for block in section.blocks]
    assert not any(isinstance(block, Answer) for block in blocks)  # page 1 has the verdict, with the flight in it
    assert any(advice["sentence"] in text for text in texts)
    assert any(study.sentence in text for text in texts)
    assert any(advice["because"] in text for text in texts)
    assert any(advice["would_change"] in text for text in texts)


def test_the_four_suborbital_tables_are_the_studys_json_beside_the_paper(sections, findings):
    document = survey_json(findings["suborbital"].survey)
    seen = 0
    for key in ("accelerometers", "gyros", "initial"):
        for row in table(sections, f"suborbital-{key}").rows:
            for part, cells in (("final_m", row[1:4]), ("aided_final_m", row[4:7])):
                entry = document[part][row[0].text]
                expected = [entry[axis] for axis in ("north", "east", "up")]
                assert [value(cell) for cell in cells] == pytest.approx(expected, rel=5e-3, abs=1e-3), row[0].text
            seen += 1
    assert seen == 8
    gyro_total = next(row for row in table(sections, "suborbital-gyros").rows if row[0].text == "gyro total")
    assert [value(cell) for cell in gyro_total[7:]] == [11100, 7500, 20500]  # the paper's readings, [B]
    texts = [b.text for s in sections if s.key == "d-suborbital" for b in s.blocks if isinstance(b, Text)]
    assert document["summary"] in texts
    rows = [row for row in table(sections, "suborbital-inputs-table").rows if len(row) > 1]
    for row, entry in zip(rows, document["inputs"].values(), strict=True):
        assert row[2].text == entry["from"]
        assert row[1].text.split()[-1] == (entry["value"] or "none").split()[-1]
    assert sum(row[2].text == "design MEMS IMU at X band" for row in rows) == 4


# what is in the report, and that both faces have it


def test_every_chart_of_the_three_studies_is_there_once(sections):
    keys = [block.key for section in sections for block in section.blocks if isinstance(block, ChartBlock)]
    assert len(keys) == len(set(keys))
    kinds = [type(block.chart).__name__ for s in sections for block in s.blocks if isinstance(block, ChartBlock)]
    assert {kind: kinds.count(kind) for kind in set(kinds)} == {
        "Chart": 9 + 4 + 9 + 6, "DotChart": 2, "MapChart": 1, "PictureChart": 1,
    }  # fmt: skip


def test_equations_symbols_and_references_are_those_the_studies_use(sections, design):
    def shared(studies: tuple[Section, ...]) -> tuple[set[str], int, str]:
        report = report_of([analyse(design)], NOW, studies=[studies])
        (equations,) = (block for block in report.blocks() if isinstance(block, Equations))
        (symbols,) = (block for block in report.blocks() if isinstance(block, Symbols))
        references = next(section for section in report.sections if section.key == "references").blocks[0]
        return {e.mark for e in equations.items}, len(symbols.items), " ".join(references.items)

    bare, full = shared(()), shared(sections)
    assert full[0] - bare[0] >= {"T-14", "T-16", "S-7", *(f"B-{i}" for i in range(1, 10))}
    assert bare[1] == len(SYMBOLS) + 1  # of smoothing, whose marks every report cites
    assert full[1] == bare[1] + 11
    for name in ("Savage", "Rauch", "Hipparcos", "[B] Moghtadaei"):
        assert name in full[2]
        assert name not in bare[2]


def test_every_mark_in_the_html_leads_to_its_equation(html):
    ids = set(re.findall(r'id="([^"]+)"', html))
    marks = set(re.findall(r'href="#([TSBP]-\d+)"', html))
    assert {"B-3", "T-16", "T-17"} <= marks
    assert marks <= ids
    # Not links are only an equation's own number, marks within an equation, and tables of a chart's numbers.
    assert not re.findall(r'(?<!class="num")(?<!<td)(?<!<mtext)>\[[TSBP]-\d+\]<(?!/a)', html)


def test_html_and_pdf_say_every_number_of_every_table(sections, html, pages):
    page = squeezed(re.sub(r"<[^>]+>", " ", html).replace("&#39;", "'").replace("&lt;", "<"))
    printed = squeezed(" ".join(text for text, _ in pages)).replace("\u200b", "")
    tables = [block for section in sections for block in section.blocks if isinstance(block, TableBlock)]
    texts = {cell.text for table in tables for row in table.rows for cell in row}
    assert len(texts) > 100
    assert not {text for text in texts if squeezed(text) not in page}
    # Longer ones break over lines, which words of a PDF do not tell.
    assert not {text for text in texts if len(text) < 12 and squeezed(text) not in printed}


def test_nothing_in_the_pdf_runs_off_the_page(pages):
    for number, (_, right) in enumerate(pages, start=1):
        assert 0 < right < 210 / 25.4 * 72, number


def test_the_sections_are_small_enough_to_travel_to_a_worker(sections):
    assert len(pickle.dumps(sections)) < MOST_BYTES


# whose studies


def test_a_study_of_another_design_is_left_out_and_that_is_said(findings, design):
    other = design.replace({"imu.angle_random_walk": 2.0 * design.imu.angle_random_walk})
    (section,) = study_sections(findings, other, "d")
    assert section.key == "d-left-out"
    text = " ".join(section.blocks[0].items)
    for word in ("Simulation", "SAR", "Suborbital", design.content_hash[:12], "another design"):
        assert word in text
    assert belonging(findings, other) == {"simulation": False, "sar": False, "suborbital": False}
    assert all(belonging(findings, design).values())


def test_a_suborbital_study_with_inputs_of_its_own_goes_with_any_design_and_says_so(findings, design):
    survey = replace(findings["suborbital"], settings=DEFAULTS)
    for any_design in (design, Design()):
        sections = study_sections({"suborbital": survey}, any_design, "d")
        texts = [b.text for b in sections[0].blocks if isinstance(b, Text)]
        assert any("not this design's IMU" in text for text in texts)


def test_studies_of_several_designs_stand_in_their_own_chapters(findings, design):
    both = [study_sections({"sar": findings["sar"]}, design, key) for key in ("d1", "d2")]
    budget = analyse(design)
    report = report_of([budget, budget], NOW, studies=both)
    assert [c.key for c in report.chapters if any(s.key == f"{c.key}-sar" for s in c.sections)] == ["d1", "d2"]
    keys = [block.key for block in report.charts()]
    assert len(keys) == len(set(keys))


# from the page


def test_a_session_keeps_the_last_finding_of_each_kind_and_the_choice_follows(findings, design):
    from app.dashboard.report_choice import ReportChoice

    session = Session(design)
    choice = ReportChoice(session)
    assert (choice.offered(), choice.lacking()) == ([], "")
    for kind, finding in findings.items():
        session.keep(kind, finding)

    def ticked() -> list[str]:
        return [offer["kind"] for offer in choice.offered() if offer["ticked"]]

    assert ticked() == ["simulation", "sar", "suborbital"]
    choice.tick("simulation", False)
    choice.tick("suborbital", False)
    assert ticked() == list(choice.chosen()) == ["sar"]
    session.change({"imu.angle_random_walk": 2.0 * design.imu.angle_random_walk})
    assert choice.offered() == []
    assert "SAR" in choice.lacking()
    session.undo()
    assert ticked() == ["sar"]
    assert choice.lacking() == ""
    session.running = True
    assert "still running" in choice.lacking()
