"""What feeding a figure sends to the browser, and that every line stays on its column."""

from dataclasses import replace
from typing import Any

import numpy as np
from bokeh.document import Document
from bokeh.document.events import ColumnDataChangedEvent
from bokeh.models import HoverTool

from app.charts.kinds import Chart, LimitLine, Line, Points
from app.charts.screen.figures import DrawnChart, to_bokeh
from app.charts.screen.timelines import Timelines
from app.examples import example
from app.subjects.sar.charts import winner_chart
from nav_model.budget import analyse

_X = np.arange(5.0)


def _chart(first: float = 1.0, run: int = 7) -> Chart:
    return Chart(
        key="test",
        title="Test",
        x_label="time [s]",
        y_label="length [m]",
        lines=(
            Line("a", "steady", _X, np.full(5, first), "horizontal", "[T-3]"),
            Line("b", "worst", _X, _X**2, "vertical", f"run {run}"),
        ),
        knowledge="none",
    )


def _events(figure: DrawnChart) -> list[Any]:
    """Every change of the figure, and that no line is without its column while it is made."""
    document, events = Document(), []
    document.add_root(figure.plot)

    def hear(event: Any) -> None:
        events.append(event)
        assert all(_drawn(figure))

    document.on_change(hear)
    return events


def _drawn(figure: DrawnChart) -> list[Any]:
    """Columns that each line's glyph reads from its source."""
    return [line.data_source.data.get(line.glyph.y.field) is not None for line in figure._lines]


def test_only_what_changed_is_sent():
    figure = to_bokeh(_chart(), 300)
    events = _events(figure)
    figure.feed(_chart(first=2.0))
    (event,) = events
    assert isinstance(event, ColumnDataChangedEvent)
    assert event.cols == ["y of a"]
    events.clear()
    figure.feed(_chart(first=2.0))
    assert not events


def test_a_line_follows_its_name():
    figure = to_bokeh(_chart(), 300)
    events = _events(figure)
    chart = _chart(run=12)
    figure.feed(chart)
    assert events
    assert [line.name for line in figure._lines] == ["steady: [T-3]", "worst: run 12"]


def test_two_lines_of_one_name_have_their_own_values():
    """Such as the parts of a curve where a formula holds and where it does not."""
    chart = _chart()
    figure = to_bokeh(replace(chart, lines=tuple(replace(x, label="one", source="") for x in chart.lines)), 300)
    for renderer, line in zip(figure._lines, chart.lines, strict=True):
        assert np.array_equal(renderer.data_source.data[renderer.glyph.y.field], line.y)


def test_two_lines_that_change_their_names_keep_their_values():
    """Each takes the other's name: the columns must not be mixed up on the way."""
    chart = _chart()
    figure = to_bokeh(chart, 300)
    first, second = chart.lines
    swapped = replace(
        chart,
        lines=(
            replace(first, label=second.label, source=second.source),
            replace(second, label=first.label, source=first.source),
        ),
    )
    figure.feed(swapped)
    for renderer, line in zip(figure._lines, swapped.lines, strict=True):
        assert np.array_equal(renderer.data_source.data[renderer.glyph.y.field], line.y)


def test_a_map_that_changes_in_its_middle_is_sent():
    """The printed form of a large array leaves its middle out."""
    chart = winner_chart(analyse(example("mems_x_band")))
    figure, winner = to_bokeh(chart), chart.winner.copy()
    middle = (slice(20, 40),) * 2
    winner[middle] = (winner[middle] + 1) % len(chart.names)
    figure.feed(replace(chart, winner=winner))
    assert np.array_equal(figure._sources["map"].data["image"][0], winner)


def test_what_points_come_from_is_text_in_their_hover():
    """A hover's template is HTML, in figures and on grids."""
    named = Points("p", "points", np.array([5.0]), np.array([0.5]), ("here",), "reference", source="<img src=x>")
    plots = [to_bokeh(replace(_chart(), points=(named,)), 300).plot]
    winners = winner_chart(analyse(example("mems_x_band")))
    plots.append(to_bokeh(replace(winners, points=(replace(winners.points[0], source="<img src=x>"),)), 300).plot)
    for plot in plots:
        tooltips = [tool.tooltips for tool in plot.select(type=HoverTool) if "img" in str(tool.tooltips)]
        assert len(tooltips) == 1
        assert "&lt;img src=x&gt;" in tooltips[0]


def test_a_name_that_has_no_room_above_its_curve_is_below_it():
    under_the_frame = replace(_chart(), y_range=(0.0, 17.0))  # one curve ends at 16
    names = Timelines([under_the_frame])._sources["test labels"].data
    assert dict(zip(names["text"], (offset > 0 for offset in names["offset"]), strict=True)) == {
        "worst": True,
        "steady": False,
    }
    limited = replace(_chart(), y_range=(0.0, 30.0), limits=(LimitLine("limit", "limit", 0.0, 1e9, 17.0),))
    names = Timelines([limited])._sources["test labels"].data
    assert names["offset"][names["text"].index("worst")] > 0  # the limit is as near
    lines = under_the_frame.lines
    near = Timelines([replace(under_the_frame, lines=(*lines, replace(lines[1], key="c", y=lines[1].y - 0.1)))])
    worst, second = sorted(offset for offset in near._sources["test labels"].data["offset"] if offset > 0)
    assert second - worst > 12  # one below the other, where both ends are under the frame
