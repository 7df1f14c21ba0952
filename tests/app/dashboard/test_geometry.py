"""The sketch of the radar's geometry follows the values."""

import math
import re

import pytest

from app.dashboard.geometry import geometry_sketch
from app.serving.server import first_design
from nav_model.budget import analyse


@pytest.mark.parametrize("degrees", [0, 5, 35, 62, 90])
def test_the_line_of_sight_is_drawn_at_the_grazing_angle_inside_the_picture(degrees: float) -> None:
    design = first_design().replace({"radar.grazing_angle": math.radians(degrees), "radar.slant_range": 12e3})
    drawn = geometry_sketch(analyse(design))
    x1, y1, x2, y2 = map(
        float, re.findall(r'x1="(.+?)" y1="(.+?)" x2="(.+?)" y2="(.+?)" stroke-width="1.5"', drawn)[0]
    )
    assert math.degrees(math.atan2(y2 - y1, x2 - x1)) == pytest.approx(degrees, abs=0.2)
    assert all(0 <= x <= 264 for x in (x1, x2))
    assert all(0 <= y <= 134 for y in (y1, y2))
    assert f"12 km slant range to the scene; grazing angle {degrees}°" in drawn


def test_a_finer_resolution_takes_a_longer_aperture() -> None:
    def description(resolution: float) -> str:
        return geometry_sketch(analyse(first_design().replace({"radar.azimuth_resolution": resolution})))

    # λR/(2ρ) times the width of a uniform aperture's -3 dB beam, 0.886
    length = 0.886 * 299792458 / 9.6e9 * 7000 / (2 * 0.2)
    assert f"an aperture of {length:.3g} m" in description(0.2)
    assert description(0.2) != description(0.4)
