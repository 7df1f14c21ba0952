"""Maps of regions as Bokeh figures; `figures` feeds them, `legend` explains them."""

from html import escape
from typing import Any

import numpy as np
from bokeh.models import HoverTool, LinearColorMapper
from bokeh.plotting import figure

from app.charts.kinds import MapChart
from app.charts.region import region_names
from app.charts.screen.axes import TOOLS, empty_figure, line_look
from app.charts.screen.sources import Sources
from app.charts.styles import STYLES


def columns_of(chart: MapChart) -> dict[str, dict[str, Any]]:
    """Source name -> columns."""
    left, right = _edges(chart.x)
    bottom, top = _edges(chart.y)
    places = list(region_names(chart).values())
    return {
        "map": {
            "image": [chart.winner.astype(np.uint8)],
            "x": [left],
            "y": [bottom],
            "dw": [right - left],
            "dh": [top - bottom],
        },
        "regions": {
            "x": [x for x, _, _ in places],
            "y": [y for _, y, _ in places],
            "name": [name for *_, name in places],
        },
        "contour": {"x": chart.contour.x, "y": chart.contour.y},
        **{f"points {p.key}": {"x": p.x, "y": p.y, "name": list(p.names)} for p in chart.points},
    }


def _edges(values: np.ndarray) -> tuple[float, float]:
    half = np.sqrt(values[1] / values[0])
    return float(values[0] / half), float(values[-1] * half)


def draw(chart: MapChart, sources: Sources, height: int) -> figure:
    """The figure."""
    plot = empty_figure(
        chart, x_log=True, y_log=True, height=height, sizing_mode="stretch_width", tools=TOOLS,
        toolbar_location="right", active_drag=None,
    )  # fmt: skip
    plot.x_range.range_padding = plot.y_range.range_padding = 0
    plot.grid.visible = False
    colours = [STYLES[style].colour for style in chart.styles]
    mapper = LinearColorMapper(palette=colours, low=-0.5, high=len(colours) - 0.5)
    plot.image("image", x="x", y="y", dw="dw", dh="dh", source=sources["map"], color_mapper=mapper, global_alpha=0.55)
    plot.text(
        "x", "y", text="name", source=sources["regions"], text_align="center", text_baseline="middle",
        text_font_size="12px", text_color="#1b2329", background_fill_color="#ffffff", background_fill_alpha=0.8,
        padding=4, border_radius=4,
    )  # fmt: skip
    look = line_look(STYLES[chart.contour.style]) | {"line_width": 2.2}
    plot.line("x", "y", source=sources["contour"], **look)
    for points in chart.points:
        style = STYLES[points.style]
        look = {"size": 7, "line_width": 0.8, "line_color": "#ffffff"}
        if points.marker == "cross":
            look = {"size": 16, "line_width": 3, "line_color": style.colour}
        marks = plot.scatter(
            "x", "y", source=sources[f"points {points.key}"], marker=points.marker, fill_color=style.colour, **look
        )
        plot.add_tools(HoverTool(renderers=[marks], tooltips=f"<b>@name</b>: {escape(points.source)}", visible=False))
    return plot
