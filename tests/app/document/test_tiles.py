"""Key figures as tiles, read as HTML."""

import re
import xml.etree.ElementTree as ET
from dataclasses import replace

from app.document.blocks import KeyFigure, KeyFigures
from app.document.tiles import tiles_html

MET = KeyFigure("CE90", "3.00 m", "of one point [T-8]", "4 m", state="met", used=0.75)
FAILED = KeyFigure("Quadratic phase", "163°", "in real time [S-5]", "90°", state="not met", used=163 / 90)
FREE = KeyFigure("Tilt", "5.00 arcsec", "after the last fix [T-9]")
FIGURES = KeyFigures("What decides", (FREE, MET, FAILED))


def names(html: str) -> list[str]:
    return [str(element.findtext("details/summary", element.text)) for element in ET.fromstring(html).iter("dt")]


def widths(html: str) -> list[float]:
    return [float(width) for width in re.findall(r"width:([\d.]+)%", html)]


def test_what_fails_comes_first_and_what_has_no_limit_last() -> None:
    assert names(tiles_html(FIGURES)) == ["Quadratic phase", "CE90", "Tilt"]


def test_nothing_is_green_beside_what_fails_or_is_open() -> None:
    opened = replace(MET, label="Heading", value="0.1°", state="open", used=None, last=True, beside="straight leg 2°")
    for figures, tones in (((MET,), ["good"]), ((MET, FAILED), ["bad", ""]), ((MET, opened), ["", ""])):
        html = tiles_html(KeyFigures("What decides", figures))
        assert [tone.strip() for tone in re.findall(r'class="card tile ?(\w*)"', html)] == tones
    assert names(html) == ["Heading", "CE90"]
    assert '<span class="big num last">0.1°</span> <span class="mark" title="margin">open</span>' in html
    assert "straight leg 2°" in html


def test_a_name_unfolds_what_the_figure_is() -> None:
    tiles = ET.fromstring(tiles_html(FIGURES)).iter("dt")
    assert ["".join(tile.find("details/div").itertext()) for tile in tiles] == [
        "In real time [S-5]", "Of one point [T-8]", "After the last fix [T-9]",
    ]  # fmt: skip
    (plain,) = ET.fromstring(tiles_html(KeyFigures("What decides", (replace(MET, detail=""),)))).iter("dt")
    assert (plain.text, list(plain)) == ("CE90", [])


def test_a_bar_is_the_part_of_the_limit_and_never_wider_than_all() -> None:
    assert widths(tiles_html(FIGURES)) == [100, 75]
    text = "".join(ET.fromstring(tiles_html(FIGURES)).itertext())
    assert "✓ +25 %" in text
    assert "✗ 1.81 ×" in text


def test_only_what_changed_says_what_it_was() -> None:
    before = KeyFigures("What decides", (FREE, replace(MET, value="3.60 m", used=0.9), FAILED))
    html = tiles_html(FIGURES, before)
    assert re.findall(r"was ([^<]*)<", html) == ["3.60 m"]
    assert widths(html) == [100, 100, 75, 90]


def test_what_people_write_is_text() -> None:
    hostile = '<script>alert("1")</script>&'
    figure = KeyFigure(hostile, hostile, hostile, hostile, state="met", used=0.5)
    html = tiles_html(KeyFigures(hostile, (figure,)))
    assert "<script" not in html
    assert names(html) == [hostile]
