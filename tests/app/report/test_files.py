"""The report as PDF and as HTML: complete, inert, and readable whatever stands in it."""

import io
import os
import re
from datetime import UTC, datetime
from html.parser import HTMLParser
from urllib.parse import unquote

import pypdf
import pytest
from known_designs import changed

from app.charts.kinds import to_csv
from app.document.blocks import Equations, Symbols
from app.report import report_bytes
from app.report.content import report_of
from nav_model.base.units import format_quantity
from nav_model.budget import analyse
from nav_model.design import Design
from nav_model.design.file import parse_design
from nav_model.equations import EQUATIONS, SYMBOLS

pytestmark = [pytest.mark.usefixtures("charts_drawn_once"), pytest.mark.long]
NOW = datetime(2026, 11, 21, 9, 30, tzinfo=UTC)
HOSTILE = '<script>alert(1)</script> #strong[x] $x$ @ref \\ *b* _i_ [T-99] {{7*7}} // `c` ~ "q" <T-3>'

# For each chart: has it bars, or is there a canvas with more than eight colours on it? Bokeh keeps them in nested
# shadow roots.
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
  const bars = chart => [...chart.querySelectorAll(".bars tbody i")]
  return [...document.querySelectorAll(".chart")].map(
    chart => bars(chart).filter(bar => bar.offsetWidth > 20 && bar.offsetHeight > 8).length > 1
      || canvases(chart).some(c => colours(c) > 8))
}"""


@pytest.fixture(scope="module")
def mems_pdf(mems) -> bytes:
    return report_bytes([mems], ".pdf", NOW)


@pytest.fixture(scope="module")
def mems_html(mems) -> str:
    return report_bytes([mems], ".html", NOW).decode()


@pytest.fixture(scope="module")
def hostile_html(budget_of) -> bytes:
    """Three designs, two of which are called what nobody should be called."""
    hostile = changed(name=HOSTILE, description=HOSTILE)
    return report_bytes([budget_of("tactical_x_band"), hostile, hostile], ".html", NOW)


def pdf_text(data: bytes) -> str:
    """Words of a PDF, spaces and line breaks as one space; without the charts', whose curves take long to read."""
    pages = pypdf.PdfReader(io.BytesIO(data)).pages
    for page in pages:
        page["/Resources"].pop("/XObject", None)
    return " ".join(" ".join(page.extract_text() for page in pages).split())


def squeezed(text: str) -> str:
    return re.sub(r"\s", "", text)


class Page(HTMLParser):
    """Everything that an HTML file loads, links to and says."""

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


def test_the_numbers_of_the_pdf_are_the_budgets(mems, mems_pdf):
    text = squeezed(pdf_text(mems_pdf))
    degrees = [
        format_quantity(x, "°", "angle", 3)
        for x in (mems["quadratic_phase", "real time"].sigma, mems["detrended_phase", "real time"].sigma)
    ]
    lengths = [
        format_quantity(x, "m", "length", 3)
        for moment in (mems.steady_state.closed, mems.steady_state.prior, mems.steady_state.posterior)
        for x in (moment["horizontal_position"], moment["vertical_position"])
    ]
    for quantity in (
        *degrees,
        *lengths,
        format_quantity(mems["coast_horizontal_position", "real time"].sigma, "m", "length", 3),
    ):
        assert squeezed(quantity) in text, quantity
    for check in mems.verdict.checks:
        margin, ratio = 100 * check.margin, check.value / check.limit
        margin_text = f"{ratio:.3g}×" if margin < 0 else f"{margin:+.{1 if abs(margin) < 99.95 else 0}f}%"
        assert margin_text.replace("-", "−") in text
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


def test_what_people_write_is_literal_in_the_pdf_and_inert_in_the_html(hostile_html):
    budget = changed(name=HOSTILE, description=HOSTILE)
    compared = squeezed(pdf_text(report_bytes([budget, budget], ".pdf", NOW)))
    assert compared.count(squeezed(HOSTILE)) >= 5  # each one's name and description, and the comparison
    assert squeezed(f"D2: {HOSTILE}") in compared
    html = hostile_html.decode()
    assert "<script>alert" not in html
    assert Page(html).text.count(" ".join(HOSTILE.split())) >= 5


def test_the_html_loads_nothing(hostile_html):
    html = hostile_html.decode()
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
    blocks = [block for block in report_of([mems], NOW).blocks() if isinstance(block, Equations | Symbols)]
    assert tags.count("math") == sum(len(block.items) for block in blocks) >= len(EQUATIONS) + len(SYMBOLS)


def test_the_html_carries_every_number_of_every_chart_and_the_design_file(mems, mems_html):
    files = {attributes["download"]: attributes["href"] for tag, attributes in Page(mems_html).tags
             if tag == "a" and "download" in attributes}  # fmt: skip
    charts = report_of([mems], NOW).charts()
    assert len(files) == len(charts) + 1
    for block in charts:
        kind, _, content = files[f"{block.key}.csv"].partition(",")
        assert kind == "data:text/csv;charset=utf-8"
        assert unquote(content) == to_csv(block.chart)
    assert parse_design(unquote(files["d.toml"].partition(",")[2])) == mems.design


def test_the_html_says_what_the_pdf_says(mems, mems_html, cells):
    page = Page(mems_html).text
    for cell in cells(report_of([mems], NOW)):
        assert squeezed(cell.text) in squeezed(page), cell


def test_the_html_opens_from_disk_with_every_chart_drawn(hostile_html, tmp_path):
    sync_api = pytest.importorskip("playwright.sync_api")
    target = tmp_path / "r.html"
    target.write_bytes(hostile_html)
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


def test_a_name_in_any_script_is_written():
    name = "机载合成孔径雷达 🚀 رادار Ωмега bell\x07\x1b[31m\u200b\ufeff\nline"
    budget = changed(name=name, description=name)
    assert budget.design.content_hash in squeezed(pdf_text(report_bytes([budget], ".pdf", NOW)))
    text = Page(report_bytes([budget], ".html", NOW).decode()).text
    for word in "".join(sign if sign.isprintable() else " " for sign in name).split():
        assert word in text


@pytest.mark.slow
def test_long_words_stay_on_the_page(placed):
    budget = changed(name="n" * 300, description="m" * 900)
    pages = placed(report_bytes([budget, budget], ".pdf", NOW))
    assert all(0 < right < 210 / 25.4 * 72 for _, right in pages)
    text = squeezed("".join(text for text, _ in pages)).replace("\u200b", "")
    assert text.count("n" * 300) >= 3
    assert text.count("m" * 900) == 2


def test_extreme_and_empty_designs_are_written(cells):
    without_image = changed(imu__angle_random_walk=0.05, radar__aperture_time=200.0)
    assert without_image.response("real time") is None
    assert any("no image" in cell.text for cell in cells(report_of([without_image], NOW)))
    budgets = [
        analyse(Design()),
        changed(name="", requirements__quadratic_phase=1e-7, coast__duration=7200.0),
        without_image,
    ]
    assert "no image" in Page(report_bytes(budgets, ".html", NOW).decode()).text
    assert report_bytes(budgets, ".pdf", NOW)
