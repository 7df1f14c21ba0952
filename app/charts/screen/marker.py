"""One marker that moves along a flight, on its time charts and its map alike."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from bokeh.events import MouseLeave, MouseMove
from bokeh.models import ColumnDataSource, CustomJS, Scatter, Span
from bokeh.plotting import figure

from app.charts.kinds import Array
from app.charts.screen.figures import add_glyph
from app.charts.styles import GREY, STYLES

_CODE = Path(__file__).with_suffix(".js").read_text("utf-8")


class PathMarker:
    """Moves a dot on the map with the pointer on the time charts, and a rule on the charts with that on the map.

    Examples
    --------
    >>> marker = PathMarker(stack.plots)  # before they are on a page
    >>> marker.join(map_figure.plot)
    >>> marker.feed(time_s, east_km, north_km)
    """

    def __init__(self, charts: Sequence[figure]) -> None:
        self._charts = charts
        self._way = ColumnDataSource({"t": [], "x": [], "y": []}, name="flight")
        self._here = ColumnDataSource({"x": [np.nan], "y": [np.nan]}, name="flight marker")
        self._rules = [Span(dimension="height", line_color=GREY, line_dash="dotted", visible=False) for _ in charts]
        for chart, rule in zip(charts, self._rules, strict=True):
            chart.add_layout(rule)

    def join(self, above: figure) -> None:
        """Join the flight's map to the charts."""
        look = {"fill_color": STYLES["mark"].colour, "line_color": "white", "line_width": 2}
        add_glyph(above, self._here, Scatter(x="x", y="y", size=13, **look))
        for plot in (*self._charts, above):
            arguments = {"way": self._way, "here": self._here, "rules": self._rules, "map": plot is above}
            for event in (MouseMove, MouseLeave):
                plot.js_on_event(event, CustomJS(args=arguments, code=_CODE))

    def feed(self, time_s: Array, x: Array, y: Array) -> None:
        """Take another flight: its times and its places on the map's axes."""
        self._way.data = {"t": time_s, "x": x, "y": y}
