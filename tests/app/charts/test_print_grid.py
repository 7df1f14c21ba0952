"""Dots, maps and pictures on paper: everything named in live text, regions told apart in grey."""

from __future__ import annotations

import math
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest

from app.charts.kinds import Dot, DotChart, Line, MapChart, PictureChart, Points
from app.charts.print.svg import FONT, WIDTH, to_svg
from app.charts.styles import STYLES

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
    left = np.broadcast_to(x < 10.0, (20, 30))
    parts = {
        "key": "m", "title": "T", "x_label": "aperture time [s]", "y_label": "fix noise [m]",
        "value_label": "phase [°]",
        "x": x, "y": y, "winner": np.where(left, 0, 1), "values": np.ones((20, 30)), "names": ("2 INS", "5 fit"),
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


@pytest.mark.parametrize("chart", [dots(), winners(), pictures()], ids=["dots", "map", "pictures"])
def test_every_kind_prints_the_same_twice_in_the_report_face(chart):
    svg = to_svg(chart)
    assert svg == to_svg(chart)
    families = {name for names in re.findall(r"font-family: ([^;\"]*)", svg) for name in names.split(", ")}
    assert families == {f"'{FONT}'"}
    assert float(ET.fromstring(svg).get("width").removesuffix("pt")) == pytest.approx(WIDTH / 25.4 * 72)


def test_dots_name_rows_and_all_they_show():
    legend = {"formula, 1σ", "runs, rms", "runs, 5 to 95 %", "limit (scaled to 1σ)"}
    assert {"one", "two", "phase [°]", *legend} <= set(texts(to_svg(dots())))
    bare = dots(dots=(Dot("one", 10.0, math.nan, math.nan, math.nan, ""),), limit=math.nan)
    words = texts(to_svg(bare))
    assert not {"runs, rms", "limit (scaled to 1σ)"} & set(words)


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
