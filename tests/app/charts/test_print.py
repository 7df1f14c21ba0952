"""Charts on paper: live text, the right number of things drawn, the same bytes twice."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET
from pathlib import Path

import matplotlib
import numpy as np
import pytest

from app.charts.kinds import Band, Bar, BarChart, Chart, Limit, Line, Points, Span
from app.charts.print.look import plain_number, power_of_ten
from app.charts.print.svg import FONT, to_svg
from app.charts.styles import STYLES
from app.subjects.budget.charts import BUDGET_CHARTS
from nav_model.budget import Budget, analyse
from nav_model.design.file import read_design

pytestmark = pytest.mark.long

EXAMPLES = Path(__file__).parents[3] / "examples"
SVG = "{http://www.w3.org/2000/svg}"


@pytest.fixture(scope="module")
def budget() -> Budget:
    return analyse(read_design(EXAMPLES / "mems_x_band.toml"))


def texts(svg: str) -> list[str]:
    return ["".join(element.itertext()).strip() for element in ET.fromstring(svg).iter(f"{SVG}text")]


@pytest.mark.parametrize("chart", BUDGET_CHARTS, ids=lambda chart: chart.__name__)
def test_the_same_chart_gives_the_same_bytes(chart, budget):
    assert to_svg(chart(budget)) == to_svg(chart(budget))


@pytest.mark.parametrize("chart", BUDGET_CHARTS, ids=lambda chart: chart.__name__)
def test_every_series_is_named_in_live_text_in_the_report_face(chart, budget):
    described = chart(budget)
    svg = to_svg(described)
    words = texts(svg)
    if isinstance(described, BarChart):
        expected = {
            described.first_label,
            described.second_label,
            *(bar.label for bar in described.bars if bar.first > 0),
        }
        assert not {bar.label for bar in described.bars if bar.first == 0} & set(words)  # nothing of that source
    else:
        expected = {x.label for group in (described.lines, described.bands, described.points, described.spans)
                    for x in group}  # fmt: skip
    assert expected <= set(words)
    families = {name for names in re.findall(r"font-family: ([^;\"]*)", svg) for name in names.split(", ")}
    assert families == {f"'{FONT}'"}
    assert "http" not in re.sub(r'(xmlns(:\w+)?|rdf:\w+|rdf:resource)="[^"]*"|<!DOCTYPE[^>]*>', "", svg)


def plain_chart(**changes) -> Chart:
    x = np.array([1.0, 10.0, 100.0])
    parts = {
        "key": "k", "title": "T", "x_label": "x [s]", "y_label": "y [m]",
        "lines": (Line("a", "first", x, x, "horizontal"), Line("b", "second", x, 2 * x, "vertical refined")),
    }  # fmt: skip
    return Chart(**{**parts, **changes})


def paths(svg: str, colour: str) -> list[str]:
    """Outlines drawn in a colour, legend entries included."""
    styles = [path.get("style", "") for path in ET.fromstring(svg).iter(f"{SVG}path")]
    return [style for style in styles if f"stroke: {colour}" in style]


def test_a_line_has_the_colour_and_dash_of_its_style():
    svg = to_svg(plain_chart())
    solid, dashed = (paths(svg, STYLES[name].colour) for name in ("horizontal", "vertical refined"))
    assert len(solid) == len(dashed) == 2  # the curve and its entry in the legend
    assert not any("stroke-dasharray" in style for style in solid)
    assert all("stroke-dasharray" in style for style in dashed)


def test_a_limit_that_is_not_given_is_neither_drawn_nor_named():
    limits = (Limit("a", "limit on a", 1.0, 10.0, math.nan),)
    svg = to_svg(plain_chart(limits=limits))
    assert not paths(svg, STYLES["limit"].colour)
    assert not any("limit" in text for text in texts(svg))
    given = to_svg(plain_chart(limits=(*limits, Limit("b", "limit on b", 10.0, 100.0, 5.0))))
    assert len(paths(given, STYLES["limit"].colour)) == 2
    assert "limit (scaled to 1σ)" in texts(given)


def test_bands_spans_and_points_are_drawn():
    x = np.array([1.0, 10.0])
    chart = plain_chart(
        bands=(Band("b", "band", x, x, 2 * x, "horizontal"),),
        spans=(Span("s", "aperture", 2.0, 5.0),),
        points=(Points("p", "points", x, x, ("one", "two"), "reference"),),
    )
    bare, full = to_svg(plain_chart()), to_svg(chart)
    assert {"band", "aperture", "points"} <= set(texts(full)) - set(texts(bare))
    assert full.count("<use") > bare.count("<use")


def test_log_axes_are_powers_of_ten():
    assert [power_of_ten(x) for x in (1e-12, 0.01, 1.0, 1e5)] == ["10⁻¹²", "10⁻²", "10⁰", "10⁵"]
    assert [power_of_ten(x) for x in (0.002, 5e-7, 2e5)] == ["2·10⁻³", "5·10⁻⁷", "2·10⁵"]
    assert [plain_number(x) for x in (0.0002, 0.05, 1.0, 50.0, 20000.0)] == ["0.0002", "0.05", "1", "50", "20000"]
    words = texts(to_svg(plain_chart(x_log=True, y_log=True)))
    assert {"1", "10", "100"} <= set(words)


def test_bars_of_the_second_kind_are_hatched_so_grey_tells_them_apart():
    bars = (Bar("one", 3.0, 1.0, 0.3, 0.1, ""), Bar("two", 2.0, math.nan, 0.2, math.nan, ""))
    svg = to_svg(BarChart("k", "T", "x [°]", "plain", "hatched", bars, 2.5, math.nan))
    assert "<pattern" in svg
    assert "limit on plain, at 1σ" in texts(svg)
    assert "limit on hatched, at 1σ" not in texts(svg)


def test_a_persons_matplotlib_settings_change_nothing_and_are_left_alone():
    before = to_svg(plain_chart())
    with matplotlib.rc_context({"font.size": 30, "svg.fonttype": "path", "lines.linewidth": 9}):
        assert to_svg(plain_chart()) == before
        assert matplotlib.rcParams["font.size"] == 30


def test_no_curve_at_all_still_makes_a_chart():
    x = np.array([0.0])
    nothing = (Line("a", "first", x, np.array([math.nan]), "horizontal"),)
    assert "first" in texts(to_svg(plain_chart(lines=nothing)))
    assert "first" in texts(to_svg(plain_chart(lines=nothing, y_log=True)))


def test_a_last_row_with_one_bar_alone_stays_inside_the_frame():
    bars = (Bar("one", 3.0, 1.0, 0.3, 0.1, ""), Bar("two", 2.0, math.nan, 0.2, math.nan, ""))
    svg = ET.fromstring(to_svg(BarChart("k", "T", "x [°]", "plain", "hatched", bars, math.nan, math.nan)))

    bottom = max(float(y) for y in re.findall(r"[ML] [\d.]+ ([\d.]+)", svg.find(".//*[@id='patch_2']/*").get("d")))
    text = next(t for t in svg.iter(f"{SVG}text") if "".join(t.itertext()).strip() == "two")
    place = text.get("y") or re.findall(r"[\d.]+", text.get("transform"))[1]
    assert float(place) + 5 < bottom  # the label's line, and half a row of the bar under it
