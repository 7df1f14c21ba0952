"""The design report: what it says, how it is written, and that nothing hostile or missing breaks it."""

from __future__ import annotations

import io
import math
import os
import re
from datetime import UTC, datetime, timedelta, timezone
from html.parser import HTMLParser
from pathlib import Path

import pypdf
import pytest

from app import cli
from app.report import report_bytes, write_report
from app.report.content import report_of
from app.report.document import Bullets, Cell, Report, Table, Text
from app.report.equations import EQUATIONS, SYMBOLS
from nav_model.budget import Budget, analyse
from nav_model.design import Design
from nav_model.design_file import parse_design, read_design
from nav_model.inputs import DesignError
from nav_model.parts import INPUTS
from nav_model.units import format_quantity

EXAMPLES = Path(__file__).parents[2] / "examples"
NOW = datetime(2026, 11, 21, 9, 30, tzinfo=UTC)
HOSTILE = '<script>alert(1)</script> #strong[x] $x$ @ref \\ *b* _i_ [T-99] {{7*7}} // `c` ~ "q" <T-3>'

# For each chart: is there a canvas with more than eight colours on it? Bokeh keeps them in nested shadow roots.
DRAWN = """() => {
  const canvases = root => [...root.querySelectorAll("*")].flatMap(
    e => [...(e.tagName === "CANVAS" ? [e] : []), ...(e.shadowRoot ? canvases(e.shadowRoot) : [])])
  const colours = canvas => {
    if (!canvas.width || !canvas.height) return 0
    const {data} = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height)
    const seen = new Set()
    for (let i = 0; i < data.length; i += 4) seen.add(data[i] << 16 | data[i + 1] << 8 | data[i + 2])
    return seen.size
  }
  return [...document.querySelectorAll(".chart")].map(chart => canvases(chart).some(c => colours(c) > 8))
}"""


def budget_of(name: str) -> Budget:
    return analyse(read_design(EXAMPLES / f"{name}.toml"))


def changed(**changes: object) -> Budget:
    """The MEMS example with other values; ``imu__rate`` is imu.rate."""
    design = read_design(EXAMPLES / "mems_x_band.toml")
    return analyse(design.replace({key.replace("__", "."): value for key, value in changes.items()}))


@pytest.fixture(scope="module")
def mems() -> Budget:
    return budget_of("mems_x_band")


@pytest.fixture(scope="module")
def mems_pdf(mems) -> bytes:
    return report_bytes([mems], ".pdf", NOW)


@pytest.fixture(scope="module")
def mems_html(mems) -> str:
    return report_bytes([mems], ".html", NOW).decode()


@pytest.fixture(scope="module")
def three() -> list[Budget]:
    return [budget_of(path.stem) for path in sorted(EXAMPLES.glob("*.toml"))]


def pdf_text(data: bytes) -> str:
    """Words of a PDF, spaces and line breaks as one space."""
    return " ".join(" ".join(page.extract_text() for page in pypdf.PdfReader(io.BytesIO(data)).pages).split())


def squeezed(text: str) -> str:
    return re.sub(r"\s", "", text)


class Page(HTMLParser):
    """What an HTML file loads, links to and says."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.said: list[str] = []
        self._skip = 0
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        self._skip += tag in {"script", "style"}

    def handle_endtag(self, tag):
        self._skip -= tag in {"script", "style"}

    def handle_data(self, data):
        if not self._skip:
            self.said.append(data)

    @property
    def text(self) -> str:
        return " ".join("".join(self.said).split())


def cells(report: Report) -> list[Cell]:
    return [cell for block in report.blocks() if isinstance(block, Table) for row in block.rows for cell in row]


def sayings(report: Report) -> list[str]:
    """Every text of a report that may name an equation."""
    said = [cell.text for cell in cells(report)]
    for block in report.blocks():
        if isinstance(block, Table):
            said += [block.caption, block.note, *(column.title for column in block.columns)]
        elif isinstance(block, Text):
            said.append(block.text)
        elif isinstance(block, Bullets):
            said += block.items
    return said + [chart.chart.knowledge for chart in report.charts()]


def table(report: Report, key: str) -> Table:
    return next(block for block in report.blocks() if isinstance(block, Table) and block.key == key)


# what it says


def test_every_requirement_and_every_input_is_there(mems):
    report = report_of([mems], NOW)
    rows = table(report, "d-verdict").rows
    assert [row[0].text for row in rows] == [check.label for check in mems.verdict.checks]
    assert [row[4].text for row in rows] == ["✓ met" if check.met else "✗ not met" for check in mems.verdict.checks]
    named = [row[0].text for row in table(report, "d-inputs-table").rows if len(row) > 1]
    for names in INPUTS.values():
        for declaration in names.values():
            assert declaration.label in named


def test_the_verdict_sentence_stands_first_and_names_margin_and_sensor(mems, three):
    report = report_of([mems], NOW)
    verdict, tightest = report.chapters[0].verdict, mems.verdict.tightest
    assert verdict.word == "✗ Does not close"
    assert "2 of 5 requirements are not met" in verdict.sentence
    assert tightest.sensor in verdict.sentence
    assert f"{100 * tightest.margin:.1f} %".replace("-", "−") in verdict.sentence
    assert [report_of([b], NOW).chapters[0].verdict.tone for b in three] == ["good", "bad", "good"]


def test_a_design_without_requirements_is_said_to_be_unchecked():
    report = report_of([analyse(Design())], NOW)
    assert report.chapters[0].verdict.word == "Not checked"
    assert any("nothing was checked" in text for text in sayings(report))


def test_every_mark_that_is_cited_has_its_equation(three):
    cited = set(re.findall(r"\[([TS]-\d+)\]", " ".join(sayings(report_of(three, NOW)))))
    assert cited <= {equation.mark for equation in EQUATIONS}
    assert len(cited) > 15


def test_unconfirmed_and_assumed_values_carry_their_mark():
    report = report_of([budget_of("l_band_jet")], NOW)
    marked = {
        row[0].text: row[1].mark for row in table(report, "d-inputs-table").rows if len(row) > 1 and row[1].mark
    }
    assert marked["Frequency"] == "unconfirmed"
    assert marked["Slant range"] == "assumed"
    assert "Angle random walk" not in marked
    first = next(block.items[0] for block in report.chapters[0].sections[-1].blocks)
    assert "frequency (unconfirmed)" in first


def test_a_value_that_is_not_the_presets_is_marked_and_loses_the_presets_standing():
    report = report_of([budget_of("tactical_x_band")], NOW)
    rows = {row[0].text: row for row in table(report, "d-inputs-table").rows if len(row) > 1}
    assert (rows["Azimuth resolution"][1].text, rows["Azimuth resolution"][1].mark) == ("0.3 m", "changed")
    assert "0.2 m (confirmed)" in rows["Azimuth resolution"][2].text


def test_a_slow_gnss_error_brings_its_caution():
    report = report_of([changed(gnss__correlated=True)], NOW)
    assert any("slow GNSS error is switched on" in text for text in sayings(report))
    assert not any("slow GNSS error is switched on" in text for text in sayings(report_of([changed()], NOW)))


def test_steady_state_and_outage_stand_in_the_right_columns(mems):
    report = report_of([mems], NOW)
    steady = mems.steady_state
    for row, field in zip(
        table(report, "d-steady-table").rows, ("position_horizontal", "position_vertical"), strict=False
    ):
        moments = (steady.closed, steady.prior, steady.posterior)
        assert [cell.text for cell in row[1:4]] == [
            format_quantity(getattr(moment, field), "m", "length", 4) for moment in moments
        ]
    last = [float(cell.text) for cell in table(report, "d-coast").rows[-1]]
    coast = mems.coast
    curves = (coast.time, coast.position_horizontal, coast.refined_horizontal, coast.position_vertical,
              coast.refined_vertical, coast.velocity_horizontal, coast.velocity_vertical)  # fmt: skip
    angles = (coast.tilt, coast.yaw_growth)
    expected = [float(curve[-1]) for curve in curves] + [math.degrees(float(curve[-1])) for curve in angles]
    assert last == pytest.approx(expected, rel=1e-3)


def test_phase_shares_add_up_and_the_table_is_the_budgets(mems):
    rows = table(report_of([mems], NOW), "d-phase-table").rows
    assert [row[0].text for row in rows[:-2]] == [line.source for line in mems.sar.lines]
    shown = [float(row[1].text) for row in rows[:-2]]
    assert sum(x**2 for x in shown) == pytest.approx(float(rows[-2][1].text) ** 2, rel=2e-3)


def test_a_comparison_marks_the_smallest_figure_and_lists_what_differs(three):
    report = report_of(three, NOW)
    assert [chapter.key for chapter in report.chapters] == ["c", "d1", "d2", "d3"]
    quadratic = next(row for row in table(report, "c-figures-0").rows if row[0].text.startswith("Quadratic"))
    best = min(range(3), key=lambda i: three[i].sar.quadratic)
    assert [cell.mark for cell in quadratic[1:]] == ["best" if i == best else "" for i in range(3)]
    listed = {row[0].text for row in table(report, "c-inputs-0").rows}
    assert "Speed" in listed
    assert "Gravity" not in listed


def test_a_comparison_of_the_same_design_has_no_best_and_no_difference(mems):
    report = report_of([mems, mems], NOW)
    assert not any(cell.mark == "best" for cell in cells(report))
    assert "same inputs" in table(report, "c-inputs-0").note


def test_many_designs_are_split_over_tables_and_charts(mems):
    report = report_of([mems] * 9, NOW)
    widths = [len(block.columns) for block in report.blocks() if isinstance(block, Table) and "c-fig" in block.key]
    assert widths == [6, 5]
    lines = [len(block.chart.lines) for block in report.charts() if block.key.startswith("c-chart-position")]
    assert lines == [7, 2]


# as PDF


def test_the_numbers_of_the_pdf_are_the_budgets(mems, mems_pdf):
    text = squeezed(pdf_text(mems_pdf))
    degrees = [format_quantity(x, "°", "angle", 4) for x in (mems.sar.quadratic, mems.sar.detrended)]
    lengths = [
        format_quantity(x, "m", "length", 4)
        for moment in (mems.steady_state.closed, mems.steady_state.prior, mems.steady_state.posterior)
        for x in (moment.position_horizontal, moment.position_vertical)
    ]
    for quantity in (*degrees, *lengths, format_quantity(mems.coast.end_refined_horizontal, "m", "length", 4)):
        assert squeezed(quantity) in text, quantity
    for check in mems.verdict.checks:
        assert f"{100 * check.margin:+.1f}%".replace("-", "−") in text
    assert mems.design.content_hash in text
    assert "21November2026,09:30UTC" in text


def test_the_pdf_is_a_titled_tagged_a4_document_with_running_heads(mems, mems_pdf):
    reader = pypdf.PdfReader(io.BytesIO(mems_pdf))
    assert reader.metadata.title == "Navigation error budget: MEMS IMU at X band"
    assert reader.metadata.author.startswith("NavBudget ")
    assert reader.trailer["/Root"]["/MarkInfo"]["/Marked"]
    assert b"pdfuaid:part>1<" in reader.trailer["/Root"]["/Metadata"].get_data()
    count = len(reader.pages)
    for number, page in enumerate(reader.pages, start=1):
        assert [round(float(x) * 25.4 / 72) for x in page.mediabox[2:]] == [210, 297]
        text = page.extract_text()
        assert f"Page {number} of {count}" in text
        assert mems.design.content_hash[:12] in text
    fonts = {
        str(font.get_object()["/BaseFont"]).partition("+")[2]
        for page in reader.pages
        for font in page["/Resources"]["/Font"].values()
    }
    assert all(name.startswith(("LibertinusSerif", "NewCM", "DejaVuSansMono")) for name in fonts), fonts


def test_the_pdf_carries_the_design_file(mems, mems_pdf):
    reader = pypdf.PdfReader(io.BytesIO(mems_pdf))
    (attached,) = reader.attachments["d.toml"]
    assert parse_design(attached) == mems.design


def test_what_people_write_is_literal_in_the_pdf():
    budget = changed(name=HOSTILE, description=HOSTILE)
    text = squeezed(pdf_text(report_bytes([budget], ".pdf", NOW)))
    assert text.count(squeezed(HOSTILE)) >= 2
    compared = squeezed(pdf_text(report_bytes([budget, budget], ".pdf", NOW)))
    assert squeezed(f"D2: {HOSTILE}") in compared


def test_the_pdf_says_the_same_twice(mems, mems_pdf):
    assert pdf_text(report_bytes([mems], ".pdf", NOW)) == pdf_text(mems_pdf)


# as HTML


def test_the_html_loads_nothing(three):
    html = report_bytes(three, ".html", NOW).decode()
    page = Page(html)
    for tag, attributes in page.tags:
        for name in ("src", "srcset", "href", "action", "poster", "data", "xlink:href"):
            value = attributes.get(name) or ""
            assert not value or value.startswith(("#", "data:")), (tag, name, value[:80])
    styles = " ".join(re.findall(r"<style.*?</style>", html, re.DOTALL))
    assert not re.findall(r"@import|url\(\s*['\"]?(?!data:)", styles)


def test_the_html_is_well_headed_and_its_links_arrive(mems, mems_html):
    page = Page(mems_html)
    tags = [tag for tag, _ in page.tags]
    assert tags.count("h1") == 1
    assert dict(page.tags)["html"]["lang"] == "en"
    ids = [attributes["id"] for _, attributes in page.tags if attributes.get("id")]
    assert len(ids) == len(set(ids))
    links = {attributes["href"][1:] for tag, attributes in page.tags
             if tag == "a" and attributes["href"].startswith("#")}  # fmt: skip
    assert links
    assert links <= set(ids)
    assert all(attributes.get("scope") for tag, attributes in page.tags if tag == "th")
    assert tags.count("math") == len(EQUATIONS) + len(SYMBOLS)


def test_what_people_write_is_inert_in_the_html():
    budget = changed(name=HOSTILE, description=HOSTILE)
    html = report_bytes([budget, budget], ".html", NOW).decode()
    page = Page(html)
    assert "<script>alert" not in html
    assert page.text.count(" ".join(HOSTILE.split())) >= 5


def test_the_html_says_what_the_pdf_says(mems, mems_html):
    page = Page(mems_html).text
    for cell in cells(report_of([mems], NOW)):
        assert squeezed(cell.text) in squeezed(page), cell


def test_the_html_says_the_same_twice(mems, mems_html):
    assert Page(report_bytes([mems], ".html", NOW).decode()).text == Page(mems_html).text


def test_the_html_opens_from_disk_with_every_chart_drawn(three, tmp_path):
    sync_api = pytest.importorskip("playwright.sync_api")
    target = tmp_path / "r.html"
    write_report([*three[:2], changed(name=HOSTILE)], target, NOW)
    asked, wrong, dialogs = [], [], []
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=os.environ.get("CHROMIUM", "/usr/bin/chromium"),
            args=["--no-sandbox", "--disable-gpu", "--disable-quic", "--disable-background-networking"],
        )
        page = browser.new_page(viewport={"width": 390, "height": 844})
        page.on("request", lambda request: asked.append(request.url))
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.on(
            "console", lambda message: wrong.append(message.text) if message.type in ("error", "warning") else None
        )
        page.on("dialog", lambda dialog: (dialogs.append(dialog.message), dialog.dismiss()))
        page.goto(target.as_uri())
        page.wait_for_function(
            "() => window.Bokeh && Bokeh.documents.length && Bokeh.documents.every(d => d.is_idle)"
        )
        drawn = page.evaluate(DRAWN)
        width = page.evaluate("document.documentElement.scrollWidth")
        browser.close()
    assert [url for url in asked if not url.startswith("data:")] == [target.as_uri()]
    assert not wrong
    assert not dialogs
    assert drawn == [True] * (2 + 3 * 6)
    assert width == 390


# hard cases


def test_no_image_at_all_is_said_and_breaks_nothing():
    budget = changed(imu__angle_random_walk=0.05, radar__aperture_time=200.0)
    assert budget.sar.impulse_response is None
    report = report_of([budget], NOW)
    assert any("no image" in cell.text for cell in cells(report))
    assert pdf_text(report_bytes([budget], ".pdf", NOW))
    assert "no image" in Page(report_bytes([budget], ".html", NOW).decode()).text


@pytest.mark.parametrize("name", ["机载合成孔径雷达", "🚀", "رادار", "Ωмега", "bell\x07\x1b[31m\u200b\ufeff\nline"])
def test_a_name_in_any_script_is_written(name):
    budget = changed(name=name, description=name)
    assert budget.design.content_hash in squeezed(pdf_text(report_bytes([budget], ".pdf", NOW)))
    visible = "".join(sign if sign.isprintable() else " " for sign in name).split()
    for word in visible:
        assert word in Page(report_bytes([budget], ".html", NOW).decode()).text


def test_long_words_stay_on_the_page():
    budget = changed(name="n" * 300, description="m" * 900)
    reader = pypdf.PdfReader(io.BytesIO(report_bytes([budget, budget], ".pdf", NOW)))
    right = 0.0
    for page in reader.pages:
        edges: list[float] = []
        page.extract_text(
            visitor_text=lambda text, _cm, tm, _font, size, edges=edges: edges.append(tm[4]) if text.strip() else None
        )
        right = max(right, *edges)
    assert 0 < right < 210 / 25.4 * 72
    text = squeezed("".join(page.extract_text() for page in reader.pages)).replace("\u200b", "")
    assert text.count("n" * 300) >= 3
    assert text.count("m" * 900) == 2


@pytest.mark.parametrize("suffix", [".html", ".pdf"])
def test_extreme_and_empty_designs_are_written(suffix):
    budgets = [
        analyse(Design()),
        changed(name="", requirements__quadratic_phase=1e-7, coast__duration=7200.0),
        changed(gnss__position_noise=1e-6, imu__angle_random_walk=1e-12, radar__autofocus_order=3),
    ]
    assert report_bytes(budgets, suffix, NOW)


def test_the_date_is_told_in_utc(mems):
    summer = timezone(timedelta(hours=3))
    report = report_of([mems], datetime(2026, 7, 1, 1, 0, tzinfo=summer))
    assert ("Written", "30 June 2026, 22:00 UTC") in report.chapters[0].facts


# the file


@pytest.mark.parametrize("name", ["r.txt", "r", "r.html.gz", ".pdf"])
def test_another_suffix_is_refused(name, mems, tmp_path):
    with pytest.raises(DesignError, match=r"^-o: .*does not end in \.html or \.pdf"):
        write_report([mems], tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_a_missing_folder_and_a_folder_in_place_of_a_file_are_refused(mems, tmp_path):
    with pytest.raises(DesignError, match=r"^-o: .*is not a folder"):
        write_report([mems], tmp_path / "none" / "r.html")
    (tmp_path / "r.pdf").mkdir()
    with pytest.raises(DesignError, match=r"^-o: .*is a folder"):
        write_report([mems], tmp_path / "r.pdf")


def test_a_folder_that_refuses_gives_one_message(mems, tmp_path, monkeypatch):
    def refuse(*_args, **_options):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)  # root may write anywhere, so the refusal is acted
    with pytest.raises(DesignError, match=r"^-o: .*cannot be written: Permission denied$"):
        write_report([mems], tmp_path / "r.html")


def test_a_failure_leaves_the_old_file_and_no_litter(mems, tmp_path, monkeypatch):
    target = tmp_path / "r.html"
    target.write_text("old")

    def full(*_args):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(DesignError, match="No space left"):
        write_report([mems], target)
    assert [path.name for path in tmp_path.iterdir()] == ["r.html"]
    assert target.read_text() == "old"


def test_the_command_writes_both_kinds(tmp_path, capsys):
    design = str(EXAMPLES / "tactical_x_band.toml")
    for name in ("r.html", "R.PDF"):
        target = tmp_path / name
        assert cli.main(["report", design, "-o", str(target)]) == 0
        assert target.stat().st_size > 100_000
    assert sorted(path.name for path in tmp_path.iterdir()) == ["R.PDF", "r.html"]
    assert cli.main(["report", design, "-o", str(tmp_path / "r.doc")]) == 2
    assert len(capsys.readouterr().err.strip().splitlines()) == 3
