"""Page, report and command show the same figures, those of the budget."""

import asyncio
import math
import re

import numpy as np
import pytest
from commanded import reply
from known_designs import MEMS, changed

from app.cli import main
from app.document.bars import bars_html
from app.document.blocks import Text
from app.document.closing import largest_values, ways_table
from app.document.display import Display
from app.document.numbers import NONE, show_in
from app.document.tiles import tiles_html
from app.document.verdict import check_words, verdict_of, verdict_strip
from app.examples import example
from app.report.cautions import caution_list
from app.report.content import report_of
from app.session import Session
from app.subjects.budget.charts import phase_chart, response_chart
from app.subjects.budget.command import check_lines
from app.subjects.budget.key_figures import key_figures
from app.subjects.budget.page import BudgetPage, requirements
from app.subjects.budget.report import sections
from app.subjects.budget.tables import image_table, processing_table, requirement_table, steady_table
from app.subjects.budget.timelines import all_timelines, attitude_chart, position_chart, velocity_chart
from app.subjects.budget.vendor import VendorPanel, vendor_block
from nav_model.budget import Budget, analyse
from nav_model.budget.provenance import cautions
from nav_model.design import Design
from nav_model.design.figures import FIGURES, REQUIRED, label_of, of_kind
from nav_model.design.other_filters import noise_for
from nav_model.design.processing import REAL_TIME
from nav_model.design.user_entries import read_entries
from nav_model.explore.vendor_table import read_row, vendor_table

_FACTOR = {"mm": 1e-3, "cm": 1e-2, "m": 1.0, "km": 1e3, "mm/s": 1e-3, "cm/s": 1e-2, "m/s": 1.0,
           "°": math.pi / 180, "arcsec": math.pi / 648000}  # fmt: skip


def si(text: str) -> float:
    """A quantity of a page in SI."""
    number, unit = re.fullmatch(r"(−?[\d.]+)\s?(\D+)", text).groups()
    return float(number.replace("−", "-")) * _FACTOR[unit]


def test_key_figures_are_the_budgets_to_three_digits(mems: Budget) -> None:
    kinds = ("steady", "outage", "phase", "place")
    names = [name for kind in kinds for name in of_kind(kind) if FIGURES[name].tile]
    expected = [mems[name, "real time"].sigma for name in names]
    *figures, width = key_figures(mems).items
    assert width.label == "Azimuth width"
    assert [si(figure.value) for figure in figures] == pytest.approx(expected, rel=5e-3)


def test_every_limited_figure_that_post_processing_changes_is_in_the_table_of_both(mems: Budget) -> None:
    _, *rows = processing_table(mems).rows
    both = {
        name: [mems[name, processing].sigma for processing in ("real time", "post-processed")] for name in REQUIRED
    }
    changed_ones = {FIGURES[name].label: sigmas for name, sigmas in both.items() if sigmas[0] != sigmas[1]}
    rows = [row for row in rows if row[0].tone != "quiet"]  # parts of a phase
    assert [row[0].text for row in rows] == list(changed_ones)
    for row, sigmas in zip(rows, changed_ones.values(), strict=True):
        assert [si(cell.text.partition(" [")[0]) for cell in row[1:]] == pytest.approx(sigmas, rel=5e-3)


def test_parts_of_a_phase_are_told_quietly_under_the_whole_and_need_not_add_up() -> None:
    budget = analyse(example("mems_x_band").replace({"flight.speed": 180.0}))
    rows = processing_table(budget).rows
    for name, parts in (("quadratic_phase", (41.4, 41.3)), ("cubic_phase", None), ("detrended_phase", None)):
        label = label_of(name)
        place = next(place for place, row in enumerate(rows) if row[0].text == label)
        under = rows[place + 1]
        assert under[0].text == "line of sight · along-track"
        assert {cell.tone for cell in under} == {"quiet"}
        known = [math.degrees(budget[f"{part}_{name}", REAL_TIME].sigma) for part in ("line_of_sight", "along_track")]
        assert [float(text.removesuffix("°")) for text in under[1].text.split(" · ")] == pytest.approx(
            known, rel=6e-3
        )
        if parts:
            assert known == pytest.approx(parts, abs=0.05)
            (tile,) = (item for item in key_figures(budget).items if item.label == label)
            assert tile.value == "56.9°"  # less than 58.4°, the sum of squares
            assert tile.detail.endswith("; along the line of sight 41.4°, along the track 41.3°")


def test_key_figures_say_their_limits_and_whether_they_keep_them(mems: Budget) -> None:
    rows = {figure.label: (figure.limit, figure.met) for figure in key_figures(mems).items if figure.met is not None}
    assert rows == {
        "Horizontal position": ("2 m", True),
        "Horizontal position after the outage": ("50 m", True),
        "Quadratic phase": ("90°", False),
        "Detrended phase": ("20°", False),
    }
    smoothed = changed(processing__mode="post-processed")
    limits = {figure.label: figure.limit for figure in key_figures(smoothed).items}
    assert limits["Horizontal position after the outage"] == "50 m, real time"


def test_every_check_can_be_seen_to_fail() -> None:
    """Every check has a tile; the limit is on the total, not on its parts."""
    html = bars_html(phase_chart(changed(imu__angle_random_walk=2.0 * math.pi / 180 / 60)))
    (limited,) = re.findall(r'<tr class="[^"]*limited"><th scope="row"[^>]*>([^<]+)</th>', html)
    assert limited == "total"
    tight = changed(requirements__ce90=0.1, requirements__le90=0.1, requirements__azimuth_shift=0.01)
    entries = {"limits": [{"name": "mine", "on": "coast_tilt", "limit": "0.001°"}]}
    tight = analyse(tight.design.replace({}, entries=read_entries(entries)))
    tiles = {tile.label: tile.met for tile in key_figures(tight).items if tile.met is not None}
    assert tiles == {check.label: check.met for check in tight.verdict.checks}
    assert not any(tiles[label] for label in ("LE90", "CE90", "Azimuth shift", "mine"))
    plain = changed(requirements__quadratic_phase=None)
    assert key_figures(plain).items[-1].label == "Azimuth width"


def test_a_contributor_shows_in_the_value_it_enters_and_what_enters_a_position_lasts_through_the_outage() -> None:
    """With a limit or without one; the curve of position has no other step at the last fix than the fix itself."""
    rows = [
        {"name": "time", "value": "90 mm", "enters": "horizontal_position", "kind": "systematic"},
        {"name": "air", "value": "9 mm", "enters": "range_shift", "kind": "systematic"},
    ]
    plain = changed()
    budget = analyse(plain.design.replace({}, entries=read_entries({"contributors": rows})))
    values, before = ({tile.label: tile.amount for tile in key_figures(each).items} for each in (budget, plain))
    assert values["Horizontal position"] == pytest.approx(before["Horizontal position"] + 0.09)
    assert values["Range shift"] == pytest.approx(plain["range_shift", "real time"].sigma + 0.009)
    assert "Range shift" not in before
    after = "Horizontal position after the outage"
    assert values[after] == pytest.approx(before[after] + 0.09)
    curves = [all_timelines(each)[0].lines[0].y for each in (budget, plain)]
    np.testing.assert_allclose(curves[0] - curves[1], 0.09)
    assert curves[0][-1] == pytest.approx(values[after])


def test_sources_add_up_to_the_total_and_its_parts_stand_under_it(mems: Budget) -> None:
    *sources, total, sight, track = phase_chart(mems).bars
    assert (total.label, sight.label, track.label) == ("total", "line of sight", "along-track")
    assert math.hypot(*(bar.first for bar in sources if bar.first > 0)) == pytest.approx(total.first, rel=1e-9)
    assert sight.parts[0][0] == "initial tilt"  # what the part along the line of sight is made of
    assert "initial tilt" in re.search(r"line of sight</th>.*?</tr>", bars_html(phase_chart(mems)))[0]
    assert verdict_strip(mems).sentences[0].endswith("% from gyro noise.")


def test_a_comparison_keeps_its_units(mems: Budget) -> None:
    better = changed(imu__angle_random_walk=0.001 * math.pi / 180 / 60)
    alone, beside = key_figures(better), key_figures(better, was=key_figures(mems))
    assert alone.items[3].value.endswith("arcsec")
    assert beside.items[3].value.endswith("°")
    assert si(beside.items[3].value) == pytest.approx(si(alone.items[3].value), rel=5e-3)


def test_a_limit_at_another_multiple_than_the_figure_beside_it_says_so() -> None:
    twice = changed(requirements__confidence=2.0)
    check = next(check for check in twice.verdict.checks if check.name == "horizontal_position")
    position = key_figures(twice).items[0]
    assert position.limit == "2 m at 2σ"
    assert position.value == show_in(check.value, "m", "length")
    assert (
        verdict_strip(twice)
        .sentences[0]
        .startswith(
            "{0.label} {1.value}, limit {1.limit} at 2σ".format(
                twice.verdict.tightest, check_words(twice.design, twice.verdict.tightest)
            )
        )
    )
    assert key_figures(twice, Display("1σ")).items[0].limit == "1 m"
    assert key_figures(changed(), Display("2σ")).items[0].limit == "4 m"
    in_si = key_figures(changed(), Display(units="SI"))
    assert in_si.items[5].limit == "1.57 rad"
    assert not [item for item in in_si.items if re.search(r"\d (cm|mm|km|µm|arcsec|min|ms)\b", item.value)]


@pytest.mark.parametrize("mode", ["real time", "post-processed"])
def test_figures_within_a_detail_are_as_wide_as_the_one_they_explain(mode: str) -> None:
    budget = changed(processing__mode=mode)
    for a, b in zip(key_figures(budget).items[:7], key_figures(budget, Display("2σ")).items[:7], strict=True):
        once, twice = (
            [si(amount) for amount in re.findall(r"[\d.]+ ?(?:[mc]?m(?:/s)?|°)(?!\w)", figure.detail)]
            for figure in (a, b)
        )
        assert twice == pytest.approx([2 * amount for amount in once], rel=6e-3), (a.detail, b.detail)
        assert "1σ" not in b.detail


def test_a_design_that_closes_is_told_how_far_each_input_may_go() -> None:
    budget = changed(imu__angle_random_walk=0.02 * math.pi / 180 / 60)
    assert budget.verdict.closes
    by_input = {way.what: way for way in largest_values(budget.design)}
    noise = by_input["Angle random walk"]
    assert "still close, one at a time" in ways_table(budget, tuple(by_input.values())).caption
    ((key, most),) = noise.changes.items()
    assert analyse(budget.design.replace({key: most})).verdict.closes
    assert not analyse(budget.design.replace({key: 1.02 * most})).verdict.closes


@pytest.mark.parametrize(
    ("chosen", "moment"), [("prior", "before a fix"), ("posterior", "after a fix"), ("closed", "average between")]
)
def test_key_figures_are_of_the_moment_the_design_is_held_against(chosen: str, moment: str) -> None:
    budget = changed(requirements__steady_state=chosen)
    position = key_figures(budget).items[0]
    assert moment in position.detail
    assert ("; average" in position.detail) == (chosen != "closed")
    expected = getattr(budget.steady_state, chosen)["horizontal_position"]
    assert si(position.value) == pytest.approx(expected, rel=5e-3)


def test_requirements_have_value_limit_margin_and_verdict(mems: Budget) -> None:
    table = requirement_table(mems)
    for row, check in zip(table.rows, mems.verdict.checks, strict=True):
        assert row[0].text == check.label
        assert [si(cell.text) for cell in row[1:3]] == pytest.approx([check.value, check.limit], rel=5e-3, abs=0.05)
        margin = row[3].text.replace("−", "-")
        if check.margin < 0:
            assert float(margin.removesuffix(" × the limit")) == pytest.approx(
                check.value / check.limit, rel=5e-3, abs=0.05
            )
        else:
            assert float(margin.removesuffix(" %")) == pytest.approx(100 * check.margin, rel=5e-3, abs=0.05)
        assert row[4].text.endswith("not met") != check.met
        assert row[6].text.startswith(f"{check.dominant}, ")


def test_check_prints_what_the_table_says_with_the_minus_of_scripts(mems: Budget) -> None:
    table = requirement_table(mems)
    *lines, other, verdict = check_lines("a.toml", mems)
    assert {f"  caution: {caution}" for caution in cautions(mems)} == {
        lines.pop() for _ in range(len(lines) - len(table.rows))
    }
    for line, row, check in zip(lines, table.rows, mems.verdict.checks, strict=True):
        value, limit, margin = (cell.text.replace("−", "-") for cell in row[1:4])
        met, margin = "met    " if check.met else "NOT MET", f"margin {margin}" if "%" in margin else margin
        assert line.startswith(f"  {met} {check.label} {value} (limit {limit}, {margin}; main ")
        assert line.endswith(f"error source {row[6].text}; {row[5].text})")
        assert not re.search("closed|prior|refined", line)
    word, closing = verdict.split("; closes ")
    assert word == "a.toml: DOES NOT CLOSE at 1σ in real time; tightest detrended phase, 2.73 × the limit"
    assert closing.startswith("with IMU Sagem Primus 200 (margin +51.4 %), or post-processed with velocity fixes of ")
    assert other == "  post-processed it would not close; tightest detrended phase, 1.14 × the limit"


def test_a_design_without_requirement_is_not_checked_anywhere() -> None:
    budget = analyse(Design())
    assert verdict_of(budget).word == "Not checked"
    assert "Main source of quadratic phase:" in " ".join(verdict_of(budget).sentences)
    assert isinstance(requirement_table(budget), Text)
    assert check_lines("-", budget) == ["-: closes (the design has no requirement, so nothing was checked)"]


def test_page_and_report_say_the_same(mems: Budget) -> None:
    page, strip = requirements(mems).replace("\xa0", " "), verdict_strip(mems)
    chapter = report_of([mems]).chapters[0]
    table, closing = chapter.sections[0].blocks
    assert table == requirement_table(mems)
    assert closing.rows[0][0].text == "IMU Sagem Primus 200"
    listed = [figure for figure in key_figures(mems).items if figure.met is not None]
    values = {row[0].text: row[1].text for row in table.rows}
    assert all(figure.value == values[figure.label] for figure in listed)
    assert chapter.verdict == verdict_of(mems)
    assert chapter.sections[-1].blocks[0] == caution_list(mems)
    assert (strip.word, strip.tone) == (chapter.verdict.word, chapter.verdict.tone)
    tightest = check_words(mems.design, mems.verdict.tightest)
    assert all(text in strip.sentences[0] for text in (tightest.value, tightest.limit, tightest.share))
    for text in (*(row[1].text for row in table.rows), *caution_list(mems).items[:1]):
        assert text in page


def test_what_is_doubtful_comes_first_and_goes_when_it_is_stated_otherwise(mems: Budget) -> None:
    assert caution_list(mems).items[0].startswith("Not confirmed at the source: velocity random walk (secondary)")
    walk = mems.design.imu.velocity_random_walk
    assert "velocity random walk" not in caution_list(changed(imu__velocity_random_walk=2 * walk)).items[0]


def test_the_page_follows_the_budget_it_is_shown(mems: Budget) -> None:
    session = Session(mems.design)
    page = BudgetPage(session)
    other = changed(imu__angle_random_walk=2 * mems.design.imu.angle_random_walk)
    page.show(other)
    assert key_figures(other).items[5].value in page._tiles.object
    assert key_figures(mems).items[5].value not in page._tiles.object
    assert [plot.x_range for plot in page._stack.plots] == [page._stack.plots[0].x_range] * 3


def test_a_receiver_class_is_one_press_where_an_accuracy_is_taken_for_white() -> None:
    session = Session(example("mems_x_band").replace({"gnss.position_noise": 0.5}))
    page = BudgetPage(session)
    text, take = page._requirements()
    assert (take.visible, take.label) == (True, "Take receiver class SBAS")
    take.clicks += 1
    assert (session.design.gnss.preset, session.design.gnss.correlated) == ("SBAS", True)
    page.show(session.budget)
    page._details.follow()
    assert not take.visible
    assert "counts as white" not in text.object
    session.undo()
    assert session.design.gnss.position_noise == 0.5


def test_a_new_comparison_comes_with_one_feed_of_the_curves(monkeypatch: pytest.MonkeyPatch) -> None:
    """With two, the browser was told of columns of different lengths."""
    session = Session(example("mems_x_band"))
    page = BudgetPage(session)
    session.change({"imu.angle_random_walk": 1e-6})
    page.show(session.budget)
    fed = []
    monkeypatch.setattr(page._stack, "feed", lambda charts: fed.append(len(charts[0].lines[0].x)))
    session.change({"processing.mode": "post-processed"})
    page.show(session.budget)
    assert page._compared is session.compared is not None
    assert fed == [len(all_timelines(session.budget)[0].lines[0].x)]


def test_page_and_report_cite_the_steady_state_that_was_computed() -> None:
    """[T-3] and [T-4] know position fixes only."""
    for noise, cited, absent in ((None, "[T-3]", "[P-6]"), (0.03, "[P-6]", "[T-3]")):
        budget = changed(**{"gnss.velocity_noise": noise, "requirements.steady_state": "closed"})
        charts = [make(budget) for make in (position_chart, velocity_chart, attitude_chart)]
        texts = [chart.knowledge for chart in charts]
        texts += [chart.lines[0].source for chart in charts]
        texts += [str(key_figures(budget)), str(steady_table(budget, "a"))]
        assert all(cited in text and absent not in text for text in texts)


def test_charts_of_formulas_say_real_time_where_the_design_is_post_processed(mems: Budget) -> None:
    smoothed = changed(processing__mode="post-processed", gnss__velocity_noise=0.03)
    for draw in (position_chart, velocity_chart, attitude_chart):
        assert "[P-6], [P-6]" not in draw(smoothed).knowledge
        assert not any("real time" in line.label for line in draw(mems).lines)
        assert any("real time" in line.label for line in draw(smoothed).lines)
    for draw in (velocity_chart, attitude_chart):
        assert draw(smoothed).knowledge.startswith("Smoothed [P-3], in real time by formula [P-6]")
    levels = {limit.key: limit.level for limit in position_chart(smoothed).limits}
    assert (levels["coast_horizontal_position"], levels["horizontal_position"]) == (50, 2)


def test_a_figure_that_holds_a_share_is_a_radius_and_sigmas_are_of_an_axis(mems: Budget) -> None:
    for spread, word in (("1σ", "per axis"), ("2σ", "per axis"), ("95 %", "radius"), ("CEP", "radius")):
        labels = [row[0].text for row in steady_table(mems, "d", Display(spread)).rows]
        assert [label.split(", ")[1] for label in labels if label.startswith("Horizontal")] == [word, word]


def test_a_design_that_fails_by_far_has_tiles_in_their_place_and_an_image_that_says_so(mems: Budget) -> None:
    """Margins in percent would reach into the next tile, and a chart without a finite number has no axes."""
    hopeless = changed(imu__vibration_factor=1000.0)
    assert hopeless.half_power_extent is None
    html = tiles_html(key_figures(hopeless), key_figures(mems))
    assert not re.search(r"−[\d.]+ %", html)
    detrended = next(check for check in hopeless.verdict.checks if check.name == "detrended_phase")
    assert f"✗ {float(f'{1 - detrended.margin:.3g}'):g} ×" in html
    chart = response_chart(hopeless)
    ideal, *spread = chart.lines
    assert chart.title == "Point target in azimuth, not focused"
    assert math.isfinite(ideal.x[0] + ideal.y.max())
    assert all(math.isnan(line.y.max()) for line in spread)


def test_what_the_image_comes_from_is_of_the_designs_processing(mems: Budget) -> None:
    """The response of a smoothed quadratic phase is not that of real time [S-8]."""
    smoothed = changed(processing__mode="post-processed")
    for budget, mode, mark in ((mems, "real time", "[S-8]"), (smoothed, "post-processed", "[P-5]")):
        assert response_chart(budget).knowledge.startswith(f"With 1σ quadratic error, {mode}: width")
        rows = {row[0].text: row[2].text for row in image_table(budget, "d").rows}
        assert rows["Response width"] == f"[S-3], {mark}"


def test_while_a_slider_moves_the_switch_does_not_contradict_the_strip() -> None:
    session = Session(example("mems_x_band"))
    page = BudgetPage(session)
    assert list(page._mode.options) == ["Real time ✗ 2.73 ×", "Post-processed ✗ 1.14 ×"]
    session.change({"imu.angle_random_walk": 0.001 * math.pi / 180 / 60})
    page._tell_soon = lambda: None  # the slider has not stopped
    page.show(session.budget)
    assert "✓ Closes" in page._strip._text.object
    assert list(page._mode.options) == ["Real time ✓ +26 %", "Post-processed …"]


def test_post_processed_curves_bridge_the_outage() -> None:
    """From both sides, far below the outage in real time, which has curves of its own."""
    budget = changed(processing__mode="post-processed")
    position, _, attitude = all_timelines(budget)
    smoothed, free = position.lines[:2]
    outage = smoothed.x > 0
    assert free.label == "horizontal, real time"
    np.testing.assert_array_equal(free.y[outage], budget.coast.refined_horizontal[1:])
    assert (smoothed.y[outage] <= free.y[outage]).all()
    # The fixes before and after the outage are alike, and far from it nothing of it is felt.
    assert smoothed.y[-1] == pytest.approx(smoothed.y[~outage][-1], rel=1e-4)
    assert smoothed.y[outage].max() == pytest.approx(np.interp(50.0, smoothed.x, smoothed.y), rel=0.01)
    (aperture,) = position.spans
    assert aperture.stop <= 0
    assert attitude.lines[0].y.max() < attitude.lines[1].y[outage].max()
    assert all(np.isnan(line.y).all() for line in all_timelines(changed())[0].lines if "real time" in line.label)


def test_vendor_table_on_page_report_and_console_is_one(capsys):
    design = example("mems_x_band")
    told_table = reply(capsys, "table", MEMS, "--imu", "ADIS16495-1")
    rows = told_table["rows"]
    assert "without the design's contributors" in told_table["of"]
    block = vendor_block(design, "d", "ADIS16495-1")
    assert [row[1].text for row in block.rows] == [row["processing"] for row in rows]
    assert block.rows[2][2].text == show_in(rows[2]["horizontal_position_sigma_m"], "cm", "length")
    assert rows[0]["heading_sigma_rad"] is None
    assert block.rows[0][6].text == NONE
    report = sections(analyse(design), "d")
    growth = next(section for section in report if section.key == "d-growth")
    assert vendor_block(design, "d") in growth.blocks
    assert main(["table", MEMS, "--imu", "none such"]) == 2
    assert "--imu" in capsys.readouterr().err


@pytest.mark.long
def test_panel_takes_the_implied_noise_into_the_design() -> None:
    session = Session(example("mems_x_band"))
    panel = VendorPanel(session)
    # A unit of 4.1 °/h and 1 mg.
    panel.rows.value = (
        "no outage: horizontal 0.4039 m, vertical 0.2140 m, velocity 0.03694 m/s, roll and pitch 0.05986°\n"
        "10 s: horizontal 0.9174 m, vertical 0.5641 m, velocity 0.1146 m/s, tilt 0.06141°, heading 0.01392°\n"
        "60 s: horizontal 20.43 m, vertical 18.01 m, velocity 0.7238 m/s, roll and pitch 0.09316°, heading 0.07143°"
    )
    asyncio.run(panel._invert(None))
    assert panel.take.visible, panel.answer.object
    panel._take(None)
    assert session.design.origins["imu.angle_random_walk"].startswith(
        "implied by the vendor's table: horizontal 0.4039 m"
    )
    panel.rows.value = "60 s: horizontal 6.59 m, vertical 0.63 m, velocity 0.2 m/s, roll and pitch 0.0233°"
    asyncio.run(panel._invert(None))
    assert "any up to" in panel.answer.object
    assert not panel.take.visible
    panel.rows.value = "60 s: horizontal 6.59 m, vertical 0.63 m, velocity 0.2 m/s, roll and pitch 0.233°"
    asyncio.run(panel._invert(None))
    answer = re.sub("<.*?>", "", panel.answer.object).replace("\N{NO-BREAK SPACE}", " ")
    assert re.search(
        r"roll and pitch 0.233° after 60 s is a factor of (9|10)\.\d+ above what the others imply", answer
    )
    assert "not determined by these rows" in answer
    assert "0.0000100" not in answer
    panel.rows.value = "60 s: horizontal 3.0 m, heading 0.02°"  # two numbers for four unknowns
    asyncio.run(panel._invert(None))
    assert not panel.take.visible
    panel.rows.value = "no outage: horizontal 9 m\n60 s: horizontal 0.01 m, velocity 2 m/s"
    asyncio.run(panel._invert(None))
    assert "several at once" in panel.answer.object
    assert "what the closest noise gives" in panel.answer.object
    panel.rows.value = "60 s: depth 3 m"
    asyncio.run(panel._invert(None))
    assert "Not solved." in panel.answer.object
    assert not panel.take.visible


def test_noise_for_other_filters_is_written_or_refused(capsys) -> None:
    assert main(["export", MEMS, "--for", "kf-gins"]) == 0
    assert capsys.readouterr().out == noise_for(example("mems_x_band"), "kf-gins")
    assert main(["export", MEMS, "--for", "kalibr", "--set", "imu.gyro_bias=0 °/h"]) == 2
    assert "imu.gyro_bias" in capsys.readouterr().err


def test_a_row_of_the_vendors_table_is_read_as_it_is_printed_and_a_column_has_one_unit() -> None:
    block = vendor_block(example("mems_x_band"), "d")
    for printed, row in zip(block.rows, vendor_table(example("mems_x_band")), strict=True):
        texts = [cell if isinstance(cell, str) else cell.text for cell in printed]
        if row.processing != "real time":
            continue
        for separator in ("\t", " "):
            entries = {entry.column: entry for entry in read_row(separator.join(texts))}
            assert {name: entry.value for name, entry in entries.items()} == pytest.approx(
                {name: value for name, value in row.values.items() if value is not None}, rel=0.006
            )
            assert {entry.outage for entry in entries.values()} == {row.outage}
    for column in zip(*(list(row)[2:] for row in block.rows), strict=True):
        texts = [cell if isinstance(cell, str) else cell.text for cell in column]
        assert len({text.lstrip("0123456789.") for text in texts if text != "–"}) == 1, texts
