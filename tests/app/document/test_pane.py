"""Blocks as HTML, read back by the standard library's XML parser."""

import math
import re
import xml.etree.ElementTree as ET

import pytest

from app.charts.kinds import Dot, DotChart
from app.document.blocks import Answer, Bullets, Cell, ChartBlock, Column, TableBlock, Text, table
from app.document.pane import html_of
from app.document.ranks_html import ranks_html
from nav_model.equations import ALL_EQUATIONS

HOSTILE = '</td><script>alert("1")</script>&amp;<img src=x onerror=alert(1)> [T-9]'


def parsed(html: str) -> ET.Element:
    """HTML as XML: the tags that HTML leaves open are closed."""
    closed = re.sub(r"<(input[^<>]*|br)>", r"<\1/>", html)
    return ET.fromstring(f"<page>{closed}</page>")


def text_of(element: ET.Element) -> str:
    return "".join(element.itertext()).replace("\N{NO-BREAK SPACE}", " ")


def test_what_people_write_is_text_in_every_field_of_every_block() -> None:
    cell = Cell(HOSTILE, mark=HOSTILE, sort=HOSTILE, value=HOSTILE)
    columns = (Column(HOSTILE, group=HOSTILE, sortable=True), Column(HOSTILE, group=HOSTILE))
    blocks = (
        Answer(HOSTILE, "good", (HOSTILE,), HOSTILE),
        TableBlock("key", HOSTILE, columns, ((cell, cell), (Cell(HOSTILE),)), HOSTILE, ticks=True),
        Text(HOSTILE),
        Bullets((HOSTILE,), HOSTILE),
    )
    for block in blocks:
        page = parsed(html_of(block))
        assert not [element for element in page.iter() if element.tag in ("script", "img")], block
        assert HOSTILE in text_of(page), block


def test_a_mark_leads_to_its_equation_and_an_unknown_one_nowhere() -> None:
    for equation in ALL_EQUATIONS:
        (link,) = parsed(html_of(Text(f"as in [{equation.mark}]"))).iter("a")
        assert (link.get("href"), link.get("title")) == (f"#theory-{equation.mark}", equation.title)
    page = parsed(html_of(Text("as in [T-999] and [X-1]")))
    assert text_of(page) == "as in [T-999] and [X-1]"
    assert not list(page.iter("a"))


def test_every_row_of_a_table_is_as_wide_as_its_heads() -> None:
    heads = ("Source", Column("a", group="Both"), Column("b", group="Both"), Column("c"))
    page = parsed(
        html_of(table("t", "Caption", heads, [("gyro", "1", "2", "3"), ("of the radar",), ("x", "", "", "")]))
    )
    for row in page.iter("tr"):
        assert sum(int(cell.get("colspan", 1)) for cell in row) == 4, ET.tostring(row)
    # A row of one cell heads the rows that follow, so it begins a body of its own.
    assert [len(body.findall("tr")) for body in page.iter("tbody")] == [1, 2]


def test_a_cell_with_a_value_is_pressed_or_ticked() -> None:
    rows = [(Cell("first", value="1"), Cell("apply", value="a")), (Cell("second"), Cell("none"))]
    for ticks in (False, True):
        page = parsed(html_of(table("t", "Caption", ("A", "B"), rows, ticks=ticks)))
        buttons = [(button.get("value"), text_of(button)) for button in page.iter("button")]
        boxes = [box.get("value") for box in page.iter("input")]
        assert (buttons, boxes) == (([("a", "apply")], ["1"]) if ticks else ([("1", "first"), ("a", "apply")], []))


def test_a_chart_is_drawn_elsewhere() -> None:
    with pytest.raises(KeyError):
        html_of(ChartBlock("key", DotChart("key", "Title", "x [°]", (), 1.0, 1.0), "alt"))


@pytest.mark.parametrize(("limit", "last"), [(20.0, 1000.0), (float("nan"), 1000.0), (900.0, 20_000.0)])
def test_what_is_far_beyond_the_limit_does_not_stretch_the_axis_of_a_ranking(limit: float, last: float) -> None:
    none = float("nan")
    dots = tuple(Dot(f"{value}", value, none, none, none, "[S-5]") for value in (22.8, 54.7, 12_000.0))
    page = parsed(ranks_html(DotChart("ranks", "Ranks", "rms [°]", dots, limit, 4.34)))
    assert [float(span.text.replace("\u2009", "")) for span in page.find(".//tfoot").iter("span")][-1] == last
    arrows = [
        text_of(row.find(".//em")) if row.find(".//em") is not None else "" for row in page.findall(".//tbody/tr")
    ]
    assert arrows == ["", "", "→" if last < 12_000.0 else ""]
    assert "12" in text_of(page.findall(".//tbody/tr")[2].findall("td")[-1])  # the value itself stands beside it


@pytest.mark.parametrize(("low", "high"), [(0.002, 0.7), (0.7, 0.9), (0.7, 40.0), (30.0, 1e3)])
def test_marks_of_a_ranking_stand_at_their_values_on_its_axis(low: float, high: float) -> None:
    """Read back through the marks of the axis, as a person does."""
    middle = (low * high) ** 0.5
    dots = (
        Dot("both", high, middle, low, high, "[S-5]"),
        Dot("runs <only>", float("nan"), low, low, middle, "[S-7]"),
    )
    page = parsed(ranks_html(DotChart("ranks", "Ranks", "rms [°]", dots, 0.8 * high, 4.34), best="both"))

    def place(element: ET.Element, name: str) -> float:
        styles = dict(part.split(":") for part in element.get("style", "").split(";") if part)
        return float(styles[name].rstrip("%"))

    axis = [(place(span, "left"), math.log10(float(span.text))) for span in page.find(".//tfoot").iter("span")]
    (first, start), *_, (last, end) = axis

    def value(at: float) -> float:
        return float(10 ** (start + (at - first) / (last - first) * (end - start)))

    both, runs = page.findall(".//tbody/tr")
    assert value(place(both.find(".//i"), "width")) == pytest.approx(middle, rel=2e-3)
    assert value(place(both.find(".//b"), "left")) == pytest.approx(high, rel=2e-3)
    assert value(place(both.find(".//u"), "left")) == pytest.approx(0.8 * high, rel=2e-3)
    band = both.find(".//s")
    assert band is not None
    ends = place(band, "left"), place(band, "left") + place(band, "width")
    assert [value(end) for end in ends] == pytest.approx([low, high], rel=2e-3)
    assert runs.find(".//b") is None  # no formula, no diamond
    assert [both.get("class"), runs.get("class")] == ["best", None]
    assert text_of(runs.find("th")) == "runs <only>"
