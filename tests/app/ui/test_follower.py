"""Parts of a page that follow its result."""

import numpy as np
import panel as pn
from bokeh.models import ColumnDataSource

from app.charts.kinds import Chart, Line
from app.ui.follower import Follower

_COMING = "<p>Appears with the first result.</p>"


class Page:
    """A result, and its follower."""

    def __init__(self, result: int | None = None) -> None:
        self.result = result
        self.parts = Follower(lambda: self.result, _COMING)

    def take(self, result: int) -> None:
        self.result = result
        self.parts.follow()


def chart(result: int) -> Chart:
    curve = Line("a", "a", np.arange(3.0), np.full(3, float(result)), "horizontal", "a test")
    return Chart("test", f"Chart of {result}", "x", "y", (curve,))


def test_a_text_says_what_is_coming_then_each_result() -> None:
    page = Page()
    pane = page.parts.text("<p>{}</p>".format)
    assert pane.object == _COMING
    page.take(1)
    assert pane.object == "<p>1</p>"
    page.take(2)
    assert pane.object == "<p>2</p>"
    assert page.parts.text("{} too".format).object == "2 too"


def test_a_part_is_made_once_with_the_first_result_and_may_make_others() -> None:
    page, made, results = Page(), [], []

    def make() -> pn.pane.HTML:
        made.append(page.result)
        page.parts.add(results.append)
        return page.parts.text("{}".format)

    place = page.parts.later(make)
    page.parts.follow()
    assert place[0].object == _COMING
    assert not made
    for result in (3, 4):
        page.take(result)
        assert place[0].object == str(result)
    assert made == [3]
    assert results == [3, 4]


def test_charts_keep_their_figures() -> None:
    page = Page()
    place = page.parts.charts(chart, chart, height=300)
    assert not place.select(pn.pane.Bokeh)
    page.take(5)
    plots = [pane.object for pane in place.select(pn.pane.Bokeh)]
    assert len(plots) == 2
    page.take(6)
    assert [pane.object for pane in place.select(pn.pane.Bokeh)] == plots
    for plot in plots:
        (curve,) = plot.select({"type": ColumnDataSource})
        assert any(np.array_equal(column, np.full(3, 6.0)) for column in curve.data.values())
