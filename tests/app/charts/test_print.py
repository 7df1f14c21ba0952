"""Charts on paper: all is named in live text and told apart in grey, and the same bytes come out twice."""

import math
import re
import xml.etree.ElementTree as ET

import matplotlib
import numpy as np
import pytest

from app.charts.kinds import (
    CLOCK,
    Band,
    Bar,
    BarChart,
    Chart,
    Dot,
    DotChart,
    LimitLine,
    Line,
    MapChart,
    PictureChart,
    Points,
    Span,
)  # fmt: skip
from app.charts.print.look import plain_number, power_of_ten
from app.charts.print.svg import FONT, WIDTH, to_svg
from app.charts.styles import STYLES
from app.document.blocks import chart_block
from app.subjects.budget.charts import BUDGET_CHARTS

pytestmark = pytest.mark.long

SVG = "{http://www.w3.org/2000/svg}"


def texts(svg: str) -> list[str]:
    return ["".join(element.itertext()).strip() for element in ET.fromstring(svg).iter(f"{SVG}text")]


def dots(**changes) -> DotChart:
    rows = (
        Dot("one", 10.0, 11.0, 5.0, 20.0, "[T-15]"),
        Dot("two", math.nan, 300.0, 100.0, 900.0, "runs only"),
    )
    return DotChart(**{"key": "k", "title": "T", "x_label": "phase [°]", "dots": rows, "limit": 20.0,
                       "millimetres": 0.1, **changes})  # fmt: skip


def winners(**changes) -> MapChart:
    x, y = np.geomspace(1.0, 100.0, 30), np.geomspace(0.01, 1.0, 20)
    west = np.broadcast_to(x < 10.0, (20, 30))
    parts = {
        "key": "m", "title": "T", "x_label": "aperture time [s]", "y_label": "fix noise [m]",
        "value_label": "phase [°]",
        "x": x, "y": y, "winner": np.where(west, 0, 1), "values": np.ones((20, 30)), "names": ("2 INS", "5 fit"),
        "styles": ("strategy 2", "strategy 5"),
        "points": (
            Points("catalogue", "radars", np.array([2.0, 50.0]), np.array([0.1, 0.1]), ("near", "far"), "reference"),
            Points("design", "this design", np.array([5.0]), np.array([0.5]), ("here",), "limit", "cross"),
        ),
        "contour": Line("limit", "phase limit", np.array([3.0, 3.0]), np.array([0.01, 1.0]), "limit"),
    }  # fmt: skip
    return MapChart(**{**parts, **changes})


def pictures(count: int = 4) -> PictureChart:
    return PictureChart(
        key="p", title="T", x_label="azimuth [m]", y_label="range [m]", x=np.linspace(-2, 2, 21),
        y=np.linspace(-1, 1, 11), power_db=np.full((count, 11, 21), -20.0),
        names=tuple(f"strategy {i}" for i in range(count)), captions=tuple(f"brightest {i} dB" for i in range(count)),
        reference="over the error-free peak; the typical run",
    )  # fmt: skip


@pytest.mark.parametrize("chart", [*BUDGET_CHARTS, dots, winners, pictures], ids=lambda chart: chart.__name__)
def test_every_kind_prints_the_same_twice_in_the_report_face(chart, mems):
    def described():
        return chart(mems) if chart in BUDGET_CHARTS else chart()

    svg = to_svg(described())
    assert svg == to_svg(described())
    families = {name for names in re.findall(r"font-family: ([^;\"]*)", svg) for name in names.split(", ")}
    assert families == {f"'{FONT}'"}
    assert float(ET.fromstring(svg).get("width").removesuffix("pt")) == pytest.approx(WIDTH / 25.4 * 72)
    assert "http" not in re.sub(r'(xmlns(:\w+)?|rdf:\w+|rdf:resource)="[^"]*"|<!DOCTYPE[^>]*>', "", svg)


@pytest.mark.parametrize("chart", BUDGET_CHARTS, ids=lambda chart: chart.__name__)
def test_every_series_is_named_in_live_text(chart, mems):
    described = chart(mems)
    words = texts(to_svg(described))
    if isinstance(described, BarChart):
        expected = {described.first_label, described.second_label}
        expected |= {bar.label for bar in described.bars if bar.first > 0}
        assert not {bar.label for bar in described.bars if bar.first == 0} & set(words)  # nothing of that source
    else:
        expected = {x.label for group in (described.lines, described.bands, described.points, described.spans)
                    for x in group}  # fmt: skip
    assert expected <= set(words)


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
    limits = (LimitLine("a", "limit on a", 1.0, 10.0, math.nan),)
    svg = to_svg(plain_chart(limits=limits))
    assert not paths(svg, STYLES["limit"].colour)
    assert not any("limit" in text for text in texts(svg))
    given = to_svg(plain_chart(limits=(*limits, LimitLine("b", "limit on b", 10.0, 100.0, 5.0))))
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


def test_spans_with_a_verdict_and_numbered_places_are_named_where_they_are():
    x = np.array([1.0, 10.0])
    chart = plain_chart(
        spans=(Span("1", "first line", 1.0, 5.0, "closes"), Span("2", "second line", 50.0, 90.0, "does not close")),
        points=(Points("p", "place", x, x, ("I", "II"), "everything", "name"),),
    )
    words, bare = texts(to_svg(chart)), to_svg(plain_chart())
    assert [words.count(name) for name in ("first line", "second line", "I", "II")] == [1, 1, 1, 1]
    assert "place" not in words  # a number needs no mark and no entry in the legend
    assert to_svg(chart).count("<use") == bare.count("<use")


def test_an_empty_group_of_points_is_not_drawn():
    x = np.array([0.0, 1.0, 2.0])
    chart = Chart(key="k", title="T", x_label="x [m]", y_label="y [m]", square=True,
                  lines=(Line("a", "path", x, x, "horizontal"),),
                  points=(Points("p", "lines", x[:0], x[:0], (), "everything"),))  # fmt: skip
    assert not chart_block(chart, "k").chart.points


def test_log_axes_are_powers_of_ten():
    assert [power_of_ten(x) for x in (1e-12, 0.01, 1.0, 1e5)] == ["10⁻¹²", "10⁻²", "10⁰", "10⁵"]
    assert [power_of_ten(x) for x in (0.002, 5e-7, 2e5)] == ["2·10⁻³", "5·10⁻⁷", "2·10⁵"]
    assert [plain_number(x) for x in (0.0002, 0.05, 1.0, 50.0, 20000.0)] == ["0.0002", "0.05", "1", "50", "20000"]
    words = texts(to_svg(plain_chart(x_log=True, y_log=True)))
    assert {"1", "10", "100"} <= set(words)


_BARS = (Bar("one name " * 20, 3.0, 1.0, 0.3, 0.1, ""), Bar("two", 2.0, math.nan, 0.2, math.nan, ""))


def test_bars_of_the_second_kind_are_hatched_so_grey_tells_them_apart():
    svg = to_svg(BarChart("k", "T", "x [°]", "plain", "hatched", _BARS, 2.5, math.nan))
    assert "<pattern" in svg
    assert "limit on plain, at 1σ" in texts(svg)
    assert "limit on hatched, at 1σ" not in texts(svg)
    assert "one name one name one name …" in texts(svg)  # more would leave the bars no room


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


def test_dots_name_rows_and_all_they_show():
    legend = {"formula", "runs, rms", "runs, 5 to 95 %", "limit"}
    assert {"one", "two", "phase [°]", *legend} <= set(texts(to_svg(dots())))
    bare = dots(dots=(Dot("one", 10.0, math.nan, math.nan, math.nan, ""),), limit=math.nan)
    words = texts(to_svg(bare))
    assert not {"runs, rms", "limit"} & set(words)


def test_the_closed_form_is_another_mark_than_the_runs_not_only_another_colour():
    marks = [use.get("style") for use in ET.fromstring(to_svg(dots())).iter(f"{SVG}use") if use.get("style")]
    orange, blue = STYLES["vertical"].colour, STYLES["horizontal"].colour
    hollow = ["fill-opacity: 0" in style for style in marks if f"stroke: {orange}" in style]
    filled = [f"fill: {blue}" in style for style in marks if f"stroke: {blue}" in style]
    assert hollow == [True, True]  # the one closed form, and its entry in the legend
    assert filled == [True, True, True]


def test_regions_of_a_map_are_named_in_place_and_hatched():
    svg = to_svg(winners())
    words = texts(svg)
    assert words.count("2 INS") == words.count("5 fit") == 2  # in place and in the legend
    assert len(ET.fromstring(svg).findall(f".//{SVG}pattern")) >= 1
    assert {"phase limit", "radars", "this design", "near", "far", "here"} <= set(words)


def test_a_region_that_is_nowhere_is_neither_drawn_nor_named():
    words = texts(to_svg(winners(winner=np.zeros((20, 30), int))))
    assert "5 fit" not in words
    assert words.count("2 INS") == 2


def test_names_of_points_do_not_cover_one_another():
    crowd = Points("c", "crowd", np.full(12, 5.0), np.geomspace(0.1, 0.11, 12), tuple(f"unit {i}" for i in range(12)),
                   "reference")  # fmt: skip
    named = [word for word in texts(to_svg(winners(points=(crowd,)))) if word.startswith("unit")]
    assert 1 <= len(named) < 6


@pytest.mark.parametrize("count", [1, 3, 4, 9])
def test_pictures_have_name_caption_axes_and_one_scale(count):
    svg = to_svg(pictures(count))
    words = texts(svg)
    for i in range(count):
        assert f"strategy {i}" in words
        assert f"brightest {i} dB" in words
    assert words.count("power [dB] over the error-free peak") == 1
    assert {"azimuth [m]", "range [m]"} <= set(words)
    assert len(ET.fromstring(svg).findall(f".//{SVG}image")) >= count


def test_the_time_of_a_flight_is_in_minutes_and_seconds() -> None:
    time = np.linspace(0.0, 2500.0, 6)
    chart = Chart("k", "T", CLOCK, "y [m]", (Line("a", "a", time, time + 1.0, "horizontal", ""),))
    written = texts(to_svg(chart))
    assert "time [min:s]" in written
    assert {"0:00", "10:00", "40:00"} <= set(written)
    assert "2500" not in written
