"""Contributors of the user's own in the report and on the command line."""

import re

import pytest

from app.document.blocks import TableBlock
from app.document.html import to_html
from app.examples import example
from app.report.comparison import difference_tables
from app.report.content import report_of
from app.subjects.budget.key_figures import key_figures
from nav_model import analyse
from nav_model.design.contributors import read_contributors
from nav_model.design.user_entries import Allotment, UserEntries

_BASE = example("mems_x_band")
_LEVER_ARM = {
    "name": "lever <arm>", "value": "1 mm", "enters": "detrended_phase", "allowance": "20 %", "owner": "mechanics",
    "source": "survey, 2026-03",
}  # fmt: skip
_POSITIONS = ("horizontal_position", "coast_horizontal_position", "coast_vertical_position")
_OMITTED = "Lever arm, timing, atmosphere"


@pytest.mark.parametrize("mode", ["real time", "post-processed"])
def test_the_report_lists_them_and_no_longer_says_that_they_are_left_out(mode: str) -> None:
    alone = _BASE.replace({"processing.mode": mode})
    design = alone.replace({}, entries=UserEntries(read_contributors([_LEVER_ARM]), allocation=Allotment()))
    report, without = (report_of([analyse(variant)]) for variant in (design, alone))
    tables = [each for part in report.chapters[0].sections for each in part.blocks if isinstance(each, TableBlock)]
    written = [column for each in tables for column in each.columns if column.title in ("Owner", "Source")]
    assert written
    assert all(column.width for column in written)  # else a long text leaves the others no room on paper
    html, before = map(to_html, (report, without))
    assert _OMITTED in before
    assert _OMITTED not in html
    row = re.search(r"<tr>(?:(?!</tr>).)*lever &lt;arm&gt;(?:(?!</tr>).)*mechanics.*?</tr>", html, re.DOTALL)
    for text in ("Detrended phase", "1\xa0mm", "20\xa0%", "random", "both", "survey, 2026-03"):
        assert text in row[0]
    assert "Contributors given in the design" not in before


@pytest.mark.parametrize("mode", ["real time", "post-processed"])
def test_a_comparison_has_them_in_errors_while_fixes_come_in(mode: str) -> None:
    alone = _BASE.replace({"processing.mode": mode})
    monument = {"name": "monument", "value": "3 m", "enters": "horizontal_position", "kind": "systematic"}
    budgets = [analyse(alone), analyse(alone.replace({}, entries=UserEntries(read_contributors([monument]))))]
    _, figures, _ = difference_tables(budgets, ("D1", "D2"))
    (row,) = (row for row in figures.rows if row[0].text == "Horizontal position")
    assert [cell.mark for cell in row[1:]] == ["best", ""]
    before, after = (float(cell.text.removesuffix(" m")) for cell in row[1:])
    assert after == pytest.approx(before + 3, abs=0.006)


def test_a_tile_has_them_in_both_moments() -> None:
    rows = [{"name": name, "value": "3 m", "enters": name, "kind": "systematic"} for name in _POSITIONS]
    alone = analyse(_BASE.replace({"requirements.steady_state": "prior"}))
    with_own = analyse(alone.design.replace({}, entries=UserEntries(read_contributors(rows))))
    sigmas = []
    for budget in (alone, with_own):
        (tile,) = (item for item in key_figures(budget).items if item.label == "Horizontal position")
        result = re.search(r"average ([\d.]+) (c?)m", tile.detail)
        sigmas.append(float(result[1]) / (100 if result[2] else 1))
    assert sigmas[1] == pytest.approx(sigmas[0] + 3, abs=0.006)
