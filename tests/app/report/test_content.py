"""The design report: what it says."""

import math
import re
from datetime import UTC, datetime

import numpy as np
import pytest
from scipy import stats

from app.document.blocks import Bullets, Equations, Report, TableBlock, Text
from app.document.display import Display
from app.report.content import report_of
from nav_model.base.units import format_quantity
from nav_model.budget import analyse
from nav_model.design.parts import INPUTS, declaration_of
from nav_model.equations import ALL_EQUATIONS, EQUATIONS
from nav_model.equations.literature import references_of

NOW = datetime(2026, 11, 21, 9, 30, tzinfo=UTC)


def sayings(report: Report) -> list[str]:
    """Every text of a report that may name an equation."""
    texts: list[str] = []
    for block in report.blocks():
        if isinstance(block, TableBlock):
            texts += [cell.text for row in block.rows for cell in row]
            texts += [block.caption, block.note, *(column.title for column in block.columns)]
        elif isinstance(block, Text):
            texts.append(block.text)
        elif isinstance(block, Bullets):
            texts += block.items
    return texts + [chart.chart.knowledge for chart in report.charts()]


def table(report: Report, key: str) -> TableBlock:
    return next(block for block in report.blocks() if isinstance(block, TableBlock) and block.key == key)


def test_every_requirement_and_every_input_is_there(mems):
    report = report_of([mems], NOW)
    rows = table(report, "d-verdict").rows
    assert [row[0].text for row in rows] == [check.label for check in mems.verdict.checks]
    assert [row[4].text for row in rows] == ["✓ met" if check.met else "✗ not met" for check in mems.verdict.checks]
    named = [row[0].text for row in table(report, "d-inputs-table").rows if len(row) > 1]
    planned = mems.design.replace(
        {"trajectory.heading_noise": math.radians(0.25), "trajectory.outages": ((20.0, 30.0),)}
    )
    entries = table(report_of([analyse(planned)], NOW), "d-inputs-table").rows
    for section, names in INPUTS.items():
        part = getattr(mems.design, section)
        for declaration in names.values():
            assert declaration.label in named or (part.optional and not part.given())
    entries = [[cell.text for cell in row[:2]] for row in entries]
    assert entries[entries.index(["Flight plan"]) + 1 :][:3] == [
        ["Outages", "20 s, 30 s"], ["Heading of two antennas", "0.25°"], ["Requirements"],
    ]  # fmt: skip


def test_figures_of_the_budget_follow_the_display_and_the_verdict_does_not(mems):
    """A percentage of a horizontal pair against SciPy's Rayleigh distribution, of one axis against the normal one."""
    plain, converted = report_of([mems], NOW), report_of([mems], NOW, display=Display("95 %", "SI"))
    pair, axis = stats.rayleigh.ppf(0.95), stats.norm.ppf(0.975)
    before, after = ({block.chart.key: block.chart for block in each.charts()} for each in (plain, converted))
    for key in ("position", "velocity"):
        for was, now in zip(before[key].lines, after[key].lines, strict=True):
            np.testing.assert_allclose(now.y, was.y * (pair if "horizontal" in was.label else axis), rtol=1e-12)
        assert after[key].y_label.startswith(f"{key}, 95 % [")
    assert after["phase"].first_limit == pytest.approx(math.radians(axis * before["phase"].first_limit))
    assert converted.chapters[0].verdict == plain.chapters[0].verdict
    assert table(converted, "d-verdict") == table(plain, "d-verdict")
    assert ("Values of the budget", "95 %, SI units; all others 1σ") in converted.chapters[0].facts


def test_a_comparison_follows_the_display(mems, three):
    """Against the same two distributions, for the table and both charts; which design is best does not change."""
    plain, converted = (report_of([mems, three[0]], NOW, display=each) for each in (Display(), Display("95 %", "SI")))
    pair, axis = stats.rayleigh.ppf(0.95), stats.norm.ppf(0.975)
    rows = {row[0].text: row[1:] for row in table(converted, "c-figures-0").rows}
    was = {row[0].text: row[1:] for row in table(plain, "c-figures-0").rows}
    assert [[cell.mark for cell in row] for row in rows.values()] == [[c.mark for c in row] for row in was.values()]
    horizontal, phase = rows["Horizontal position, 95 %"][0].text, rows["Quadratic phase, 95 %"][0].text
    assert horizontal == f"{pair * mems.steady_state.prior['horizontal_position']:.3g} m"
    assert phase == f"{axis * mems['quadratic_phase', 'real time'].sigma:.3g} rad"
    before, after = ({block.key: block.chart for block in each.charts()} for each in (plain, converted))
    now, then = (charts["c-0-chart-position"] for charts in (after, before))
    np.testing.assert_allclose(now.lines[0].y, pair * then.lines[0].y, rtol=1e-12)
    assert now.y_label == "horizontal position, 95 % [m]"
    in_degrees = before["c-0-chart-phase"].bars[0].first
    assert after["c-0-chart-phase"].bars[0].first == pytest.approx(math.radians(axis * in_degrees))


def test_the_verdict_sentence_stands_first_and_names_margin_and_sensor(mems, three):
    report = report_of([mems], NOW)
    verdict, tightest = report.chapters[0].verdict, mems.verdict.tightest
    assert verdict.word == "✗ Does not close"
    sentence = " ".join(verdict.sentences)
    assert "2 of 4 requirements met; " in sentence
    assert tightest.dominant in sentence
    assert f" {tightest.value / tightest.limit:.2f} × the limit." in sentence
    assert [report_of([b], NOW).chapters[0].verdict.tone for b in three] == ["good", "bad", "good"]


def test_every_mark_that_is_cited_has_its_equation(three):
    cited = set(re.findall(r"\[([TS]-\d+)\]", " ".join(sayings(report_of(three, NOW)))))
    assert cited <= {equation.mark for equation in EQUATIONS}
    assert len(cited) > 15


def test_unconfirmed_and_assumed_values_carry_their_mark(budget_of):
    report = report_of([budget_of("l_band_jet")], NOW)
    marked = {
        row[0].text: row[1].mark for row in table(report, "d-inputs-table").rows if len(row) > 1 and row[1].mark
    }
    assert marked["Frequency"] == "unconfirmed"
    assert marked["Slant range"] == "assumed"
    assert "Angle random walk" not in marked
    first = next(block.items[0] for block in report.chapters[0].sections[-1].blocks)
    assert "frequency (unconfirmed)" in first


def test_a_value_that_is_not_the_presets_is_marked_and_loses_the_presets_standing(budget_of):
    report = report_of([budget_of("tactical_x_band")], NOW)
    rows = {row[0].text: row for row in table(report, "d-inputs-table").rows if len(row) > 1}
    assert (rows["Azimuth resolution"][1].text, rows["Azimuth resolution"][1].mark) == ("0.3 m", "changed")
    assert "0.2 m (confirmed)" in rows["Azimuth resolution"][2].text


def test_steady_state_and_outage_stand_in_the_right_columns(mems):
    report = report_of([mems], NOW)
    steady = mems.steady_state
    for row, field in zip(
        table(report, "d-steady-table").rows, ("horizontal_position", "vertical_position"), strict=False
    ):
        moments = (steady.closed, steady.prior, steady.posterior)
        assert [cell.text for cell in row[1:4]] == [
            format_quantity(moment[field], "m", "length", 3) for moment in moments
        ]
    last = [float(cell.text) for cell in table(report, "d-coast").rows[-1]]
    coast = mems.coast
    curves = (coast.time, coast.position_horizontal, coast.refined_horizontal, coast.position_vertical,
              coast.refined_vertical, coast.velocity_horizontal, coast.velocity_vertical)  # fmt: skip
    angles = (coast.tilt, coast.yaw_growth)
    expected = [float(curve[-1]) for curve in curves] + [math.degrees(float(curve[-1])) for curve in angles]
    assert last == pytest.approx(expected, rel=5e-3)


def test_phase_shares_add_up_and_the_table_is_the_budgets(mems):
    rows = table(report_of([mems], NOW), "d-phase-table").rows
    assert [row[0].text for row in rows[:-3]] == [
        line.source for line in mems.phase_lines("real time") if line.quadratic > 0
    ]
    shares = [float(row[1].text) for row in rows[:-3]]
    assert sum(x**2 for x in shares) == pytest.approx(
        float(rows[-3][1].text) ** 2, rel=1e-2
    )  # squares of three digits


def test_a_report_of_a_design_processed_afterwards_has_its_phases_everywhere(mems):
    """processing.md prints 70.63° and 21.94° along the line of sight, and along the track 18.29°."""
    smoothed = analyse(mems.design.replace({"processing.mode": "post-processed"}))
    report = report_of([smoothed], NOW)
    *sources, total, sight, along = table(report, "d-phase-table").rows
    assert [sight[1].text, sight[4].text, along[1].text] == ["70.6", "21.9", "18.3"]
    assert [total[1].text, total[4].text] == ["73.8", "22.8"]
    assert sum(float(row[1].text) ** 2 for row in sources) == pytest.approx(73.79**2, rel=1e-2)
    assert "post-processed" in table(report, "d-phase-table").caption
    values = {row[0].text: row[1].text for row in table(report, "d-image").rows}
    both = {row[0].text: row[2].text for row in table(report, "d-both-processings").rows}
    assert [both[f"{name} phase"].split()[0] for name in ("Quadratic", "Cubic", "Detrended")] == [
        "73.8°",
        "33.4°",
        "22.8°",
    ]
    assert values["Response width"] == "20.8 cm"  # the tile's


def test_a_comparison_marks_the_smallest_figure_and_lists_what_differs(three):
    report = report_of(three, NOW)
    assert [chapter.key for chapter in report.chapters] == ["c", "d1", "d2", "d3"]
    quadratic = next(row for row in table(report, "c-figures-0").rows if row[0].text.startswith("Quadratic"))
    best = min(range(3), key=lambda i: three[i]["quadratic_phase", "real time"].sigma)
    assert [cell.mark for cell in quadratic[1:]] == ["best" if i == best else "" for i in range(3)]
    listed = {row[0].text for row in table(report, "c-inputs-0").rows}
    assert "Speed" in listed
    assert "Gravity" not in listed


def test_a_comparison_has_the_figures_of_each_designs_processing(mems):
    """The worked example as processing.md prints it: 0.1591 m and 8.660 mm/s smoothed."""
    smoothed = analyse(mems.design.replace({"processing.mode": "post-processed"}))
    report = report_of([mems, smoothed], NOW)
    rows = {
        row[0].text.partition(" [")[0]: [cell.text for cell in row[1:]] for row in table(report, "c-figures-0").rows
    }
    assert rows["Quadratic phase"] == ["182°", "73.8°"]
    assert rows["Detrended phase"] == ["54.7°", "22.8°"]
    assert rows["Horizontal position"][1] == "0.159 m"
    assert rows["Horizontal velocity"][1] == "0.00866 m/s"
    (phases,) = (block.chart for block in report.charts() if block.key == "c-0-chart-phase")
    assert phases.bars[1].first == pytest.approx(73.79, rel=1e-3)
    assert [row[3].text for row in table(report, "c-verdicts-table").rows] == ["real time", "post-processed"]


def test_a_comparison_of_the_same_design_has_no_best_and_no_difference(mems, cells):
    report = report_of([mems, mems], NOW)
    assert not any(cell.mark == "best" for cell in cells(report))
    assert "same inputs" in table(report, "c-inputs-0").note


def test_many_designs_are_split_over_tables_and_charts(mems):
    report = report_of([mems] * 9, NOW)
    widths = [
        len(block.columns) for block in report.blocks() if isinstance(block, TableBlock) and "c-fig" in block.key
    ]
    assert widths == [6, 5]
    lines = [len(block.chart.lines) for block in report.charts() if re.match(r"c-\d+-chart-position", block.key)]
    assert lines == [7, 2]


def test_a_report_without_studies_is_what_it_was(mems):
    sections = [section.key for section in report_of([mems], NOW).chapters[0].sections]
    assert sections == [
        f"d-{x}" for x in ("requirements", "processing", "steady", "growth", "phase", "regime", "inputs", "cautions")
    ]


def test_a_noted_origin_stands_in_the_table_of_inputs(mems):
    origin = "rms of gyro x, y, z, from static log bench.csv (sha256 0123)"
    walk = declaration_of("imu.angle_random_walk").read("0.12 °/√h").value
    key = "imu.angle_random_walk"
    noted = mems.design.replace({key: walk}, {key: "°/√h"}, {key: origin})
    report = report_of([analyse(noted)], NOW)
    row = next(row for row in table(report, "d-inputs-table").rows if row[0].text == "Angle random walk")
    assert (row[1].mark, row[2].text) == ("noted", origin)
    report = report_of([analyse(noted.replace({key: 2 * walk}))], NOW)
    row = next(row for row in table(report, "d-inputs-table").rows if row[0].text == "Angle random walk")
    assert row[1].mark != "noted"


def test_references_have_the_source_of_every_equation(mems):
    report = report_of([mems], NOW)
    (cited,) = (block for block in report.blocks() if isinstance(block, Equations))
    (block,) = (section.blocks[0] for section in report.sections if section.key == "references")
    for equations, references in ((cited.items, block.items), (ALL_EQUATIONS, references_of(ALL_EQUATIONS))):
        authors = r"Anderson|Squire|Harris|Taylor|Chu\b|JCGM|Prats|Bryson|\[B\]|\[C\]"
        for e in equations:
            assert any(f"[{e.mark}]" in reference for reference in references)
            for author in re.findall(authors, e.source) or {"A": ["[A]"], "C": ["[C]"]}.get(e.source, ()):
                assert any(author in reference and f"[{e.mark}]" in reference for reference in references)
