"""A chart's legend as HTML under the figure, which wraps on a phone and is read by screen readers."""

import math
from collections.abc import Callable, Iterable
from html import escape

import numpy as np

from app.charts.kinds import Chart, DotChart, MapChart, spread_of
from app.charts.region import region_names
from app.charts.styles import DASHES, STYLES, Style


def legend_html(chart: Chart | DotChart | MapChart) -> str:
    """One entry for each name; curves of one name, such as the two parts of one, share the first one's."""
    entries = {label: swatch for swatch, label in reversed(_ENTRIES[type(chart)](chart))}
    return _listed((swatch, label) for label, swatch in reversed(entries.items()))


def key_html(**names: str) -> str:
    """Legend of looks, whatever their colour: a dash of `DASHES`, "limit", "faint", or "span", a time."""
    looks = {dash: _line(Style("currentColor", dash)) for dash in DASHES}
    looks |= {
        "limit": _line(STYLES["limit"]),
        "faint": _line(Style("#9fb8ca")),
        "span": _box(Style("currentColor"), 0.2),
    }
    return _listed((looks[look], name) for look, name in names.items())


def _listed(entries: Iterable[tuple[str, str]]) -> str:
    items = "".join(f"<li>{swatch} {escape(label)}</li>" for swatch, label in entries)
    return f'<ul class="legend" aria-label="Legend">{items}</ul>'


def _dot_entries(chart: DotChart) -> list[tuple[str, str]]:
    entries = [
        (_svg(f'<path d="M15 0 L20 5.5 L15 11 L10 5.5 Z" fill="none" stroke-width="2" '
              f'stroke="{STYLES["vertical"].colour}"/>'), "formula"),
        (_box(STYLES["horizontal"], 0.55), "runs, rms"),
        (_line(Style("currentColor", "solid", 3.0)), "runs, 5 to 95 %"),
    ]  # fmt: skip
    if not math.isnan(chart.limit):
        entries.append((_line(STYLES["limit"]), "limit"))
    return entries


def _map_entries(chart: MapChart) -> list[tuple[str, str]]:
    """Regions that are too small for their name, then points and contour."""
    named = region_names(chart)
    entries = [
        (_box(STYLES[style], 0.55), name)
        for i, (style, name) in enumerate(zip(chart.styles, chart.names, strict=True))
        if (chart.winner == i).any() and i not in named
    ]
    entries.append((_line(STYLES[chart.contour.style]), chart.contour.label))
    return entries + [(_dot(STYLES[points.style], points.marker), points.label) for points in chart.points]


def _entries(chart: Chart) -> list[tuple[str, str]]:
    entries = [(_line(STYLES[line.style]), line.label) for line in chart.lines if not np.isnan(line.y).all()]
    entries += [(_box(STYLES[band.style], 0.3), band.label) for band in chart.bands]
    entries += [(_dot(STYLES[points.style], points.marker), points.label) for points in chart.points if points.names]
    if any(not math.isnan(limit.level) for limit in chart.limits):
        entries.append((_line(STYLES["limit"]), f"limit (scaled to {spread_of(chart.y_label)})"))
    return entries


_ENTRIES: dict[type, Callable[..., list[tuple[str, str]]]] = {
    Chart: _entries, DotChart: _dot_entries, MapChart: _map_entries,
}  # fmt: skip


def _svg(content: str) -> str:
    return f'<svg width="30" height="11" aria-hidden="true" focusable="false">{content}</svg>'


def _line(style: Style) -> str:
    return _svg(
        f'<line x1="1" y1="5.5" x2="29" y2="5.5" stroke="{style.colour}" stroke-width="{style.width}" '
        f'stroke-dasharray="{DASHES[style.dash]}"/>'
    )


def _box(style: Style, opacity: float) -> str:
    return _svg(f'<rect x="3" y="0.5" width="24" height="10" fill="{style.colour}" fill-opacity="{opacity}"/>')


def _dot(style: Style, marker: str) -> str:
    if marker == "diamond":
        return _svg(f'<path d="M15 0 L20 5.5 L15 11 L10 5.5 Z" fill="{style.colour}"/>')
    if marker == "x":
        return _svg(f'<path d="M11 1.5 L19 9.5 M19 1.5 L11 9.5" stroke="{style.colour}" stroke-width="1.8"/>')
    if marker == "cross":
        return _svg(f'<path d="M15 0 V11 M9.5 5.5 H20.5" stroke="{style.colour}" stroke-width="3"/>')
    return _svg(f'<circle cx="15" cy="5.5" r="4" fill="{style.colour}"/>')
