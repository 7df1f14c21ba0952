"""A small picture of the radar's geometry, with the values in force: aperture, line of sight, slant range, angle."""

import math
from html import escape

from app.document.numbers import number, show
from nav_model.budget import Budget

_WIDTH, _GROUND, _TARGET = 264, 118, 236  # pixels: width, height of the ground line, place of the target
_REACH, _HEIGHT = 176.0, 84.0  # the most a line of sight takes


def geometry_sketch(budget: Budget) -> str:
    """The geometry as SVG in HTML. Angles are true, lengths are not: the line of sight always fills the picture, and
    the aperture is drawn to its scale within a twentieth and a half of it.
    """
    radar, sar = budget.design.radar, budget.sar
    angle = float(radar.grazing_angle)
    length = min(_REACH / max(math.cos(angle), 1e-9), _HEIGHT / max(math.sin(angle), 1e-9))
    x, y = _TARGET - length * math.cos(angle), _GROUND - length * math.sin(angle)
    half = 0.5 * length * min(max(float(sar.aperture_length) / float(radar.slant_range), 0.05), 0.5)
    dx, dy = 0.94 * half, 0.34 * half  # the track goes into the picture
    degrees = f"{number(math.degrees(angle), given=True)}°"
    slant, aperture = show(float(radar.slant_range), "length", given=True), show(float(sar.aperture_length), "length")
    time = show(float(sar.aperture_time), "time")
    text = (
        f"Geometry: an aperture of {aperture}, flown in {time}; a line of sight of {slant} slant range to the scene; "
        f"grazing angle {degrees}."
    )
    arc = 26.0
    ax, ay = _TARGET - arc * math.cos(angle), _GROUND - arc * math.sin(angle)
    anchor, at = ("start", x + dx + 6) if x < _WIDTH / 2 else ("end", x - dx - 6)
    return f"""<svg viewBox="0 0 {_WIDTH} 134" width="100%" role="img" aria-label="{escape(text)}"
 font-size="11" fill="currentColor" stroke="currentColor" stroke-width="0">
<line x1="8" y1="{_GROUND}" x2="{_WIDTH - 8}" y2="{_GROUND}" stroke-width="1"/>
<line x1="{x:.1f}" y1="{y:.1f}" x2="{x:.1f}" y2="{_GROUND}" stroke-width="1" stroke-dasharray="2 3" opacity=".6"/>
<line x1="{x:.1f}" y1="{y:.1f}" x2="{_TARGET}" y2="{_GROUND}" stroke-width="1.5"/>
<line x1="{x - dx:.1f}" y1="{y + dy:.1f}" x2="{x + dx:.1f}" y2="{y - dy:.1f}" stroke-width="4" stroke="#1f72b0"/>
<path d="M {_TARGET - arc} {_GROUND} A {arc} {arc} 0 0 1 {ax:.1f} {ay:.1f}" fill="none" stroke-width="1"/>
<circle cx="{_TARGET}" cy="{_GROUND}" r="3"/>
<text x="{at:.1f}" y="{max(y - dy, 10):.1f}" text-anchor="{anchor}">aperture {aperture}, {time}</text>
<text x="{_TARGET - 34}" y="{_GROUND - 5}" text-anchor="end">{degrees}</text>
<text x="{_WIDTH / 2}" y="131" text-anchor="middle">line of sight, slant range {slant}</text>
</svg>"""
