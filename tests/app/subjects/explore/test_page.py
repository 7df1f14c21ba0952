"""The Explore page without a browser: applying results, the user's sensors, refused input."""

import csv
import io
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import panel as pn
import pyarrow.parquet
import pytest
from bokeh.models import Line as LineGlyph
from pages import at_once, start_to_the_end, when_done
from waiting import soon

import app.subjects.explore.closing as closing_panel
import app.subjects.explore.search as search_panel
from app.charts.styles import STYLES
from app.document.numbers import margin_in_short
from app.document.wording import entered
from app.library.offers import library_files
from app.library.store import Library
from app.serving.server import first_design
from app.session import Session
from app.subjects.explore.charts import margin_chart
from app.subjects.explore.page import ExplorePage
from app.subjects.explore.ranking import ranked
from app.subjects.explore.search import EXAMPLE
from app.subjects.explore.sweep import SweepPanel
from app.subjects.explore.tables import uncertain_table
from app.subjects.explore.uncertainty import range_of, row_of
from app.work.run import Run
from nav_model import closing_sets, read_design
from nav_model.base.errors import InputError
from nav_model.budget import analyse
from nav_model.design.catalogue import catalogue
from nav_model.design.contributors import Contributor
from nav_model.design.file import format_design
from nav_model.design.link import split_link
from nav_model.design.parts import declaration_of
from nav_model.design.presets import preset_fill
from nav_model.design.user_entries import read_entries
from nav_model.explore.search import OWN_GNSS
from nav_model.explore.sweep import sweep_ratios, to_csv, to_parquet
from nav_model.explore.trade_map import trade_map
from nav_model.explore.uncertainty import read_uncertain, uncertain_verdict

pytestmark = pytest.mark.long

OWN = """
[[imu]]
name = "Our <b>unit</b>"
angle_random_walk = { value = "0.01 °/√h", status = "confirmed", source = "our bench" }
velocity_random_walk = { value = "0.005 m/s/√h", status = "assumed", source = "our bench" }

[[gnss]]
name = "Our receiver"
position_noise = { value = "3 cm", status = "confirmed", source = "our bench" }
interval = { value = "0.2 s", status = "confirmed", source = "our bench" }
"""

MOST_AT_ONCE = search_panel._MOST_AT_ONCE


@pytest.fixture(autouse=True)
def _here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Answers are worked out in this process, up to the end."""
    for panel in (search_panel, closing_panel):
        monkeypatch.setattr(panel, "run_in_pool", at_once)
    monkeypatch.setattr(Run, "start", start_to_the_end)


@pytest.fixture
def explore(monkeypatch: pytest.MonkeyPatch) -> ExplorePage:
    monkeypatch.setattr(search_panel, "_MOST_AT_ONCE", 250)  # so that an answer is there at once
    session = Session(first_design())
    made = ExplorePage(session)
    session.param.watch(lambda event: made.show(event.new), "budget")
    return made


def _ask(explore: ExplorePage, name: str) -> Any:
    explore.views.chosen = name
    return explore.question


def _search(explore: ExplorePage) -> Any:
    return _ask(explore, "Sensors that pass")


def _open(explore: ExplorePage, content: bytes) -> str:
    search = _search(explore)
    when_done(lambda: search._opened("own.toml", content), search.run)
    return str(search._message.object)


def test_only_the_question_in_view_is_made_and_worked_out(explore: ExplorePage) -> None:
    assert list(explore._asked) == ["What would close it"]
    solved = explore.question
    _search(explore)
    before = solved.answer
    explore.session.change({"imu.angle_random_walk": 1e-6})
    assert solved.answer is before
    assert "pass with your receiver" in explore._strip._text.object
    explore.views.chosen = "What would close it"
    assert solved.answer is not before


def test_an_address_names_a_question(explore: ExplorePage) -> None:
    explore.go_to("sensors")
    assert explore.views.chosen == "Sensors that pass"
    explore.go_to("nothing-of-the-kind")
    assert explore.views.chosen == "Sensors that pass"


def test_a_solved_value_is_taken_and_then_the_design_closes_at_its_limit(explore: ExplorePage) -> None:
    solved = explore.question
    assert not explore.session.budget.verdict.closes
    assert "Angle random walk: at most 0.0240 °/√h" in solved._values.html
    solved._values._handle_msg("Angle random walk: at most 0.0240 °/√h")
    verdict = explore.session.budget.verdict
    assert verdict.closes
    assert 0 <= verdict.tightest.margin < 0.01  # rounded down to three digits
    assert 'angle_random_walk = "0.024 °/√h"' in format_design(explore.session.design)
    explore.session.undo()
    assert "No value alone is enough: velocity random walk, vibration factor, position noise" in solved._values.html
    solved._values._handle_msg("Angle random walk: at most 0.0250 °/√h")  # of a table that is no longer there
    assert explore.session.design == first_design()


def test_a_set_of_levers_is_taken_whole_and_undone_whole(explore: ExplorePage) -> None:
    close = explore.question
    assert close.answer.word == "Closes with IMU Sagem Primus 200"
    close._groups.value = ["processing", "velocity", "receiver"]
    assert "IMU Sagem" not in close._sets.html
    assert explore.session.settings["close"] == "close.changes=processing%2Cvelocity%2Creceiver"
    close._sets._handle_msg("Process after the flight + velocity fixes of 3 cm/s, Doppler")
    design = explore.session.design
    assert (design.processing.mode, design.gnss.velocity_noise) == ("post-processed", 0.03)
    assert explore.session.budget.verdict.closes
    assert close.answer.tone == "good"
    assert close._sets.html == ""
    explore.session.undo()
    assert explore.session.design == first_design()
    close.reserve = "20"
    assert "receiver DGNSS" not in close._sets.html
    assert "receiver PPP" in close._sets.html
    close._groups.value = ["receiver"]
    assert close.answer.word == "✗ No set of these levers closes it"
    text = " ".join(close.answer.sentences)
    assert "Nearest: with receiver RTK; still over its limit: quadratic phase 1.09 ×, detrended phase 1.50 ×" in text
    assert "With processing allowed, process after the flight closes it." in text
    close._sets._handle_msg("IMU LN-100")  # of a table that is no longer there
    assert explore.session.design == first_design()


def test_offers_are_levers_too_and_no_presets(explore: ExplorePage) -> None:
    _open(explore, OWN.encode())
    close = _ask(explore, "What would close it")
    assert "IMU Our &lt;b&gt;unit&lt;/b&gt;" in close._sets.html
    close._sets._handle_msg("IMU Our <b>unit</b>")
    assert explore.session.design["imu.preset"] is None
    assert explore.session.budget.verdict.closes


def test_imus_with_the_designs_receiver_come_first_and_all_pairs_on_demand(explore: ExplorePage) -> None:
    search = _search(explore)
    assert {row.gnss for row in search._ranking.rows} == {OWN_GNSS}
    margins = [row.margin for row in search._ranking.rows]
    assert margins == sorted(margins, reverse=True)
    few = len(margins)
    search.own = False
    assert len(search._ranking.rows) == few * (1 + len(catalogue("gnss")))
    own_margins = [row.margin for row in search._ranking.rows if row.gnss == OWN_GNSS]
    assert own_margins == margins


def test_own_units_and_receivers_are_judged_and_adopted(explore: ExplorePage) -> None:
    search = _search(explore)
    search.own = False
    before = search._table.html.count("<tr>")
    assert "Added Our &lt;b&gt;unit&lt;/b&gt;, Our receiver" in _open(explore, OWN.encode())
    assert search._table.html.count("<tr>") > before
    assert "<b>unit" not in search._table.html
    search._table._handle_msg("Our <b>unit</b> with Our receiver")
    design = search.session.design
    assert design["imu.preset"] is None
    assert design.imu.angle_random_walk == pytest.approx(0.01 * 3.14159265 / 180 / 60)
    assert design.gnss.position_noise == 0.03
    assert design.gnss.interval == 0.2
    assert design.gnss.vertical_position_noise is None
    assert design.unit("gnss.position_noise") == "cm"
    assert "You can undo" in search._message.object
    search.session.undo()
    assert search.session.design == first_design()


def test_a_pair_that_is_no_longer_there_adopts_nothing(explore: ExplorePage) -> None:
    search = _search(explore)
    search._table._handle_msg("LN-200 with a kite")
    assert search.session.design == first_design()


def test_files_add_up_and_one_that_is_refused_changes_nothing_and_is_not_kept(explore: ExplorePage) -> None:
    assert "Added Our IMU, Our receiver." in _open(explore, EXAMPLE.encode())
    _open(explore, OWN.encode())
    search = _search(explore)
    added = search._table.html
    assert {"Our IMU", "Our <b>unit</b>"} <= {row.imu for row in search._ranking.rows}
    assert "others are in EUR" in _open(explore, EXAMPLE.replace("Our IMU", "New").replace("EUR", "USD").encode())
    assert search._keep.disabled
    search.own = False
    search.own = True
    assert search._table.html == added


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"\xff\xfe", "not UTF-8"),
        (b"[[imu]\n", "not a catalogue file"),
        (b"[[radars]]\nname = 'x'\n", "neither"),
        (b"[[imu]]\nname = 'x'\nangle_random_walk = '1 m'\n", "must be a table"),
        (b"a = " + b"[" * 5000, "nested more than 8 deep"),
        (b"imu = 3", "tables"),
    ],
)
def test_files_that_hold_no_sensors_are_refused_and_change_nothing(
    explore: ExplorePage, content: bytes, message: str
) -> None:
    before = _search(explore)._table.html
    answer = _open(explore, content)
    assert "Not opened" in answer
    assert message in answer
    assert _search(explore)._table.html == before


def _many(units: int, receivers: int) -> str:
    walks = ("angle_random_walk", "0.1 °/√h"), ("velocity_random_walk", "0.05 m/s/√h")
    imus = [("imu", f"Unit {n}", walks) for n in range(units)]
    others = [("gnss", f"Receiver {n}", (("position_noise", "3 cm"),)) for n in range(receivers)]
    return "\n".join(
        f'[[{kind}]]\nname = "{name}"\n'
        + "\n".join(f'{key} = {{ value = "{value}", status = "assumed", source = "s" }}' for key, value in values)
        for kind, name, values in imus + others
    )


def test_files_whose_units_and_receivers_are_too_many_pairs_are_refused_and_change_nothing(
    explore: ExplorePage,
) -> None:
    search = _search(explore)
    before = search._ranking.rows
    few = len(catalogue("imu")), len(catalogue("gnss"))
    message = _open(explore, _many(300, 280).encode())
    assert f"{few[0] + 300} units with each of {few[1] + 280} receivers" in message
    assert "at most 5000 are ranked at a time" in message
    assert search._ranking.rows == before
    assert "Added" in _open(explore, _many(300, 0).encode())
    assert "at most 5000" in _open(explore, _many(0, 100).encode())  # they add up
    assert len(search._ranking.rows) == len(before) + 300


def test_many_pairs_are_ranked_in_a_worker_and_the_first_rows_shown(
    explore: ExplorePage, monkeypatch: pytest.MonkeyPatch
) -> None:
    search = _search(explore)
    asked: list[Any] = []

    async def worker(function: Any, *arguments: Any) -> Any:
        asked.append(function)
        return await at_once(function, *arguments)

    monkeypatch.setattr(search_panel, "run_in_pool", worker)
    monkeypatch.setattr(search_panel, "_MOST_AT_ONCE", MOST_AT_ONCE)
    when_done(lambda: setattr(search, "own", False), search.run)  # of the catalogue alone, with slow errors
    assert asked.pop() == ranked
    monkeypatch.setattr(search_panel, "run_in_pool", at_once)
    _open(explore, _many(200, 0).encode())
    monkeypatch.setattr(search_panel, "run_in_pool", worker)

    def step() -> None:
        search.session.change({"imu.angle_random_walk": 1e-5})
        assert search.answer.sentences == ("Computing …",)
        assert not search._table.html  # nothing of the design before

    when_done(step, search.run)
    assert asked == [ranked]
    rows = search._ranking.rows
    assert len(rows) == (len(catalogue("gnss")) + 1) * (200 + len({r.imu for r in rows} & set(catalogue("imu"))))
    assert search._table.html.count('<button type="button" value=') == 200
    assert f"The first 200 of {len(rows)} rows" in search._notes.object
    assert len(list(csv.DictReader(io.StringIO(search._csv())))) == len(rows)
    last = rows[-1]
    search.words = f"{last.imu} {last.gnss}"
    assert f'value="{last.pair}"' in search._table.html
    when_done(lambda: setattr(search, "own", True), search.run)
    assert {row.gnss for row in search._ranking.rows} == {OWN_GNSS}


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("x" * 101, "not one line of at most 100 characters"),
        ("two\\nlines", "not one line of at most 100 characters"),
        ("Unit 1", "is the name of two entries"),
        ("unit 1", "is the name of two entries"),
    ],
)
def test_names_that_would_be_mistaken_are_refused(explore: ExplorePage, name: str, message: str) -> None:
    assert message in _open(explore, _many(2, 0).replace('"Unit 0"', f'"{name}"').encode())


def test_an_offer_with_a_name_of_the_catalogue_is_listed_beside_it_and_that_is_said(explore: ExplorePage) -> None:
    message = _open(explore, _many(2, 1).replace('"Unit 0"', '"ln-200"').replace('"Receiver 0"', '"RTK"').encode())
    assert "The product&#x27;s catalogue has ln-200, RTK; yours: ln-200 (offer), RTK (offer)." in message
    search = _search(explore)
    assert {"LN-200", "ln-200 (offer)"} <= {row.imu for row in search._ranking.rows}
    twice = _many(2, 0).replace('"Unit 0"', '"ln-200"').replace('"Unit 1"', '"ln-200 (offer)"')
    assert "is what another is called" in _open(explore, twice.encode())


def test_a_unit_that_is_opened_again_takes_the_place_of_the_one_before_and_that_is_said(explore: ExplorePage) -> None:
    _open(explore, _many(2, 0).encode())
    message = _open(explore, _many(1, 0).replace("0.1 °/√h", "0.2 °/√h").encode())
    assert "Replaced: Unit 0." in message


def test_the_librarys_files_are_ranked_kept_and_removed(
    explore: ExplorePage, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    place = Library(tmp_path / "library.db")
    monkeypatch.setattr(search_panel, "library", lambda: place)
    search = _search(explore)

    def press(what: Any) -> str:
        when_done(lambda: what(None), search.run)
        return str(search._message.object)

    assert "The library holds no offers yet" in press(search._load)
    for name, content in (("a.toml", _many(1, 0)), ("b.toml", _many(2, 0))):
        when_done(lambda name=name, content=content: search._opened(name, content.encode()), search.run)
        assert f"{name} is saved in the library" in press(search._keep_file)
    assert "In several files; the one saved last counts: Unit 0." in press(search._load)
    assert (search._of_library.options, search._of_library.value) == (["a.toml", "b.toml"], "b.toml")
    assert "b.toml was removed" in press(search._removed)
    assert library_files(place) == [("a.toml", _many(1, 0))]
    assert search._of_library.options == ["a.toml"]


def test_the_table_and_its_csv_say_the_same(explore: ExplorePage) -> None:
    search = _search(explore)
    rows = list(csv.DictReader(io.StringIO(search._csv())))
    pairs = re.findall(r'<button type="button" value="(.*?)"', search._table.html)
    assert [f"{row['imu']} with {row['gnss']}" for row in rows] == pairs
    passing = [row["imu"] for row in rows if row["closes"] == "True"]
    table_rows = re.findall(r"<tr>.*?</tr>", search._table.html, re.DOTALL)
    marked = [re.search('value="(.*?) with', row)[1] for row in table_rows if "<button" in row and "✓ " in row]
    assert marked == passing
    assert passing


def test_the_list_begins_with_the_designs_own_imu_as_the_budget_judges_it(explore: ExplorePage) -> None:
    """Its margin and tightest requirement are those of the verdict, also of edited values and with a contributor; and
    green and red are for that verdict alone."""
    search, session = _search(explore), explore.session
    arm = Contributor("lever arm", 2e-3, "detrended_phase", "length")
    for changes, entries, name in (
        ({}, None, "STIM300"),
        ({"imu.angle_random_walk": 1.1e-5}, None, "Custom, based on STIM300"),
        ({}, replace(session.design.entries, contributors=(arm,)), "Custom, based on STIM300"),
    ):
        assert session.change(changes, entries=entries) is None
        search.show(session.budget)
        first = re.search(r"<tbody><tr>(.*?)</tr>", search._table.html)[1]
        tightest = session.budget.verdict.tightest
        cells = re.sub("<[^>]+>", "|", first)
        assert f"Your IMU ({name})" in cells
        assert margin_in_short(tightest.margin) in cells
        assert tightest.label in cells
        assert search._ranking.in_design.margin == pytest.approx(tightest.margin, rel=1e-9)
        assert "button" not in first
        assert not re.search(r"tone (good|bad)", search._table.html)
        assert search.answer.tone == "open"


@pytest.mark.parametrize(
    ("cells", "text"),
    [
        (("uniform", "0.02", "0.06 °/√h"), "0.02 °/√h .. 0.06 °/√h"),
        (("log-uniform", "0.02", "0.06"), "0.02 °/√h .. 0.06 °/√h log"),
        (("typical", "0.15 °/√h", "1.3"), "0.15 °/√h */ 1.3"),
    ],
)
def test_a_range_is_what_the_command_takes(cells: tuple[str, str, str], text: str) -> None:
    row = dict(zip(("kind", "first", "second"), cells, strict=True))
    range_text = range_of(row, "°/√h")
    assert read_uncertain("imu.angle_random_walk", range_text) == read_uncertain("imu.angle_random_walk", text)
    assert range_of(row_of(text), "°/√h") == text
    assert not range_of({**row, "second": ""}, "°/√h")


def _vary(sure: Any, key: str, *cells: str) -> None:
    """Fill in the row of an input, as a person does."""
    label = str(declaration_of(key).label)
    row = next(row for row in sure.rows.rows if row["input"].startswith(f"{label}:"))
    row |= dict(zip(("kind", "first", "second"), cells, strict=True))
    sure.rows.put(sure.rows.rows)


async def test_a_range_that_cannot_be_is_refused_by_name_and_the_last_one_stays(explore: ExplorePage) -> None:
    sure = _ask(explore, "Probability")
    _vary(sure, "imu.angle_random_walk", "uniform", "0.02", "0.06")
    before = sure.ranges
    _vary(sure, "imu.angle_random_walk", "uniform", "0.06", "0.02")
    assert sure.rows.refused.startswith("Angle random walk: ")
    assert "below" in sure.rows.refused
    assert sure.ranges == before != ""
    sure.run.cancel()


def test_a_link_with_a_range_that_cannot_be_says_so(explore: ExplorePage) -> None:
    explore.session.settings = {"uncertainty": "uncertainty.ranges=imu.angle_random_walk%3D2"}
    sure = _ask(explore, "Probability")
    assert (sure.answer.word, sure.answer.tone) == ("No probability", "warn")


async def test_the_probability_shown_is_the_commands(explore: ExplorePage) -> None:
    sure = _ask(explore, "Probability")
    await soon(lambda: "An example" in " ".join(sure.answer.sentences), "the example of an empty page")
    _vary(sure, "imu.angle_random_walk", "uniform", "0.02", "0.06")
    texts = {  # the rows of the example that are still there
        "imu.angle_random_walk": "0.02 °/√h .. 0.06 °/√h", "imu.velocity_random_walk": "0.06 m/s/√h */ 1.3",
        "gnss.position_noise": "1 m */ 1.3",
    }  # fmt: skip
    exact = uncertain_verdict(first_design(), {key: read_uncertain(key, text) for key, text in texts.items()})
    await soon(lambda: sure.run.result.closes == exact.closes, "the probability")
    (bars,) = sure.__panel__().select(pn.pane.Bokeh)  # the bins right of zero hold the probability
    assert bars.object.yaxis[0].axis_label == "designs in a bin [%]"
    edges, shares = exact.histogram
    assert sum(share for edge, share in zip(edges, shares, strict=False) if edge >= -1e-9) == pytest.approx(
        exact.closes.value, abs=0.006
    )


async def test_question_ranges_and_choices_come_back_with_the_link(explore: ExplorePage) -> None:
    _search(explore).biases = "zero"
    _ask(explore, "Trade-off map").y = "gnss.interval"
    sure = _ask(explore, "Probability")
    _vary(sure, "imu.vibration_factor", "log-uniform", "1.0", "8.0")
    _vary(sure, "gnss.position_noise", "typical", "1 m", "1.5")
    sure.run.cancel()
    again = Session(first_design())
    again.take_studies(split_link(explore.session.link)[1])
    page = ExplorePage(again)
    assert page.views.chosen == "Probability"
    assert [list(row.values())[:3] for row in page.question.rows.rows if row.get("kind")] == [
        ["typical", "0.15 °/√h", "1.3"], ["typical", "0.06 m/s/√h", "1.3"], ["log-uniform", "1.0", "8.0"],
        ["typical", "1 m", "1.5"],
    ]  # fmt: skip
    page.question.run.cancel()
    assert _search(page).biases == "zero"
    assert _ask(page, "Trade-off map").y == "gnss.interval"


def test_the_strip_says_the_residual_biases_and_how_many_would_pass_without(explore: ExplorePage) -> None:
    search = _search(explore)
    assert "Residual biases 0 assumed, in real time." in explore._strip._text.object
    passing = {row.imu for row in search._ranking.rows if row.closes}
    explore.session.change({"imu.accelerometer_bias": 1e-3})
    text = explore._strip._text.object.replace("\xa0", " ")
    assert "None of 15" in text
    assert "Residual biases as in your design: 0.102 mg, in real time." in text
    assert f"With residual biases of zero, {len(passing)} would" in text
    search.biases = "zero"
    assert {row.imu for row in search._ranking.rows if row.closes} == passing
    search.biases = "in-run"
    assert "each data sheet" in explore._strip._text.object
    sheet = catalogue("imu")["HG4930"].extra
    row = next(row for row in search._ranking.rows if row.imu == "HG4930")
    search._table._handle_msg(row.pair)
    design = explore.session.design
    assert design.imu.gyro_bias == sheet["gyro_bias"].value
    assert design.imu.accelerometer_bias == sheet["accelerometer_bias"].value
    assert explore.session.budget.verdict.tightest.margin == pytest.approx(row.margin, rel=1e-9)


def _rows(sweep: SweepPanel, *specs: tuple[str, str, str, str]) -> None:
    keys = ("input", "from", "to", "points")
    sweep.inputs.put([{**dict(zip(keys, spec, strict=True)), "spacing": "log"} for spec in specs])


async def test_a_sweep_runs_and_says_what_the_budget_says(explore: ExplorePage) -> None:
    sweep: SweepPanel = _ask(explore, "Sweep")
    _rows(sweep, ("imu.angle_random_walk", "0.01 °/√h", "0.1 °/√h", "5"), ("gnss.position_noise", "0.1", "1", "3"))
    assert "15 designs" in sweep._count.object
    await sweep.start()
    columns = sweep.run.result.columns
    assert len(columns["row"]) == 15
    base = first_design()
    for row in (0, 7, 14):
        design = base.replace({key: columns[key][row] for key in ("imu.angle_random_walk", "gnss.position_noise")})
        verdict = analyse(design).verdict
        assert columns["closes"][row] == verdict.closes
        assert 1 - sweep_ratios(columns)[row] == pytest.approx(verdict.tightest.margin, rel=1e-9)
    assert f"{sum(columns['closes'])} of 15 designs meet all requirements" in sweep.answer.word
    margins = 1 - sweep_ratios(columns)[[int(row) for row in re.findall(r'value="(\d+)"', sweep._table.html)]]
    passing = margins[margins >= 0]
    assert len(passing) == sum(columns["closes"])
    assert margins.tolist() == [*sorted(passing), *sorted(margins[margins < 0], reverse=True)]
    sweep._table._handle_msg("7")
    taken = explore.session.design
    assert taken.imu.angle_random_walk == pytest.approx(columns["imu.angle_random_walk"][7], rel=5e-4)
    assert entered(taken, "imu.angle_random_walk") == "0.03162 °/√h"  # 10 to the power of -1.5
    assert "earlier sweep or design" in sweep.answer.sentences[0]  # its map has the mark where the design was
    parquet = pyarrow.parquet.read_table(io.BytesIO(to_parquet(columns)))
    table = list(csv.DictReader(io.StringIO(to_csv(columns).decode())))
    assert parquet.column_names == list(table[0])
    assert [float(row["gnss.position_noise"]) for row in table] == parquet["gnss.position_noise"].to_pylist()


async def test_a_sweep_too_large_for_the_page_is_not_started(explore: ExplorePage) -> None:
    sweep = _ask(explore, "Sweep")
    _rows(sweep, ("imu.angle_random_walk", "0.01", "1", "1000"), ("gnss.position_noise", "0.01", "1", "1000"))
    assert "1,000,000 designs; at most 200,000 on this page" in sweep._count.object
    assert sweep.bar.start.disabled
    assert sweep.start() is None
    _rows(sweep, ("imu.angle_random_walk", "5 kg", "1", "10"))
    assert "kg" in sweep._count.object
    assert sweep.bar.start.disabled


async def test_names_of_the_catalogue_are_swept_too(explore: ExplorePage) -> None:
    sweep: SweepPanel = _ask(explore, "Sweep")
    first, second = sweep.inputs.rows
    sweep.inputs.put([{**first, "input": "imu.preset"}, second])  # just chosen: all of them
    assert f"{20 * len(catalogue('imu'))} designs" in sweep._count.object
    sweep.inputs.put([{"input": "imu.preset", "from": "LN-200; STIM300"}])
    await sweep.start()
    columns = sweep.run.result.columns
    for name, ratio in zip(columns["imu.preset"], sweep_ratios(columns), strict=True):
        fill = preset_fill("imu", name)[0]
        assert 1 - ratio == pytest.approx(analyse(first_design().replace(fill)).verdict.tightest.margin, rel=1e-9)
    sweep._table._handle_msg("0")
    assert explore.session.design.imu.preset == "LN-200"


def test_what_only_a_flight_judges_is_named_and_hinders_no_advice() -> None:
    design = read_design("examples/tactical_x_band.toml")
    plain, explore = (ExplorePage(Session(each)) for each in (design, design.replace({"requirements.heading": 1e-4})))
    known, before = plain.question.answer, explore.question.answer
    assert known == replace(before, word=f"✓ {before.word}", tone="good")  # grey until it has been flown
    assert before.tone == "open"
    assert explore.question._ways == plain.question._ways != {}
    for name in ("What would close it", "Sensors that pass", "Trade-off map"):
        _ask(explore, name)
        assert "<h2>Before the flight: " in explore._strip._text.object, name
        assert "With the flight: Open. " in explore._strip._text.object, name


def test_what_is_below_a_strip_is_of_the_straight_leg_and_says_so_where_a_flight_decides() -> None:
    """Ranking, sensors, map, probability: the words, and no limit in red."""
    design, red = read_design("examples/tactical_x_band.toml"), STYLES["limit"].colour
    ranges = {"imu.angle_random_walk": read_uncertain("imu.angle_random_walk", "0.05 °/√h .. 0.1 °/√h")}
    for each, decides in ((design, False), (design.replace({"requirements.heading": 1e-4}), True)):
        explore, chance = ExplorePage(Session(each)), uncertain_verdict(each, ranges)
        histogram = margin_chart(each, chance)
        texts = {
            "ranking": explore.question._head.object,
            "sensors": _ask(explore, "Sensors that pass")._table.html,
            "map": _ask(explore, "Trade-off map")._head.object,
            "key of the map": explore.question._head.object.partition("✕ fails")[2],
            "probability": uncertain_table(each, chance).caption,
            "histogram": histogram.title,
        }
        assert {name: " before the flight" in text for name, text in texts.items()} == dict.fromkeys(texts, decides)
        looks = [each.glyph for each in explore.question._drawn.plot.renderers]
        lines = {look.line_color for look in looks if isinstance(look, LineGlyph)}
        assert (red in lines) is not decides
        assert not {STYLES[band.style].colour for band in histogram.bands} & {red, STYLES["closes"].colour}


def test_a_limit_that_a_flight_alone_judges_is_a_limit() -> None:
    keys = [
        key for key, value in first_design().items() if key.startswith("requirements.") and isinstance(value, float)
    ]
    changes = dict.fromkeys(key for key in keys if "conf" not in key)
    explore = ExplorePage(Session(first_design().replace({**changes, "requirements.heading": 1e-3})))
    for question in ("What would close it", "Sensors that pass", "Probability"):
        _ask(explore, question)
        said = explore._strip._text.object
        assert "Judged along the flight alone" in said
        assert "With the flight: Open" in said
        assert "No requirement" not in said
    assert "below the charts" in _ask(explore, "What would close it")._sets.html
    with pytest.raises(InputError, match=r"^requirements: a flight alone judges heading: ask `manoeuvre`"):
        closing_sets(explore.session.design)


def test_advice_is_tried_and_the_contributor_that_alone_exceeds_a_limit_is_named() -> None:
    arm = {"name": "Lever arm", "enters": "detrended_phase", "value": "2 mm"}
    design = read_design("examples/tactical_x_band.toml").replace({}, entries=read_entries({"contributors": [arm]}))
    explore = ExplorePage(Session(design))
    text = " ".join(explore.question.answer.sentences)
    assert "Lever arm alone: 46.1° of 20" in text
    assert "½ × lever arm" in explore.question._ranking.object
    lead = explore.question._head.object.replace("&quot;", '"').replace("\xa0", " ")
    assert re.search(r'Halving "Lever arm" cuts detrended phase by \d+ %\.', lead)
    assert "Plain: halved. Hatched: doubled." in lead


def test_the_map_of_each_figure_says_what_the_budget_says_at_its_confidence_and_lowest_limit() -> None:
    custom_limit = {"name": "own", "on": "detrended_phase", "limit": "9°", "confidence": 3}
    limits = {"ce90": 3.0, "detrended_phase": 1.0, "horizontal_position": 1.0, "le90": 1e-3}
    changes = {"requirements.confidence": 2.0} | {f"requirements.{name}": limit for name, limit in limits.items()}
    design = first_design().replace(changes, entries=read_entries({"limits": [custom_limit]}))
    explore, verdict = ExplorePage(Session(design)), analyse(design).verdict
    view = _ask(explore, "Trade-off map")
    for name in limits:
        check = min((check for check in verdict.checks if check.on == name), key=lambda check: check.margin)
        view.result = name
        assert view._value(analyse(design), view._now()) == pytest.approx(1 - check.margin, rel=1e-9), name
        assert f": {margin_in_short(check.margin)} in this design" in view.answer.word
        assert view.answer.tone == "open"
        trade = trade_map(design, view.x, view.y, name, 2)
        assert trade.limit == pytest.approx(check.limit, rel=1e-12)
