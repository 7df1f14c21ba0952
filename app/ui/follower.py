"""Parts of a page that follow its result: made when they are first looked at, then shown every new one."""

from collections.abc import Callable
from typing import Any, Generic, TypeVar

import panel as pn

from app.charts.kinds import Plotted
from app.ui.chart_pane import ChartPane
from app.ui.grid import cell, grid
from app.ui.html_pane import html_pane
from app.upstream.rendering import TextPane

_T = TypeVar("_T")


class Follower(Generic[_T]):
    """A view that shows a result, and will show the next.

    Parameters
    ----------
    current : callable
        The page's result; None until there is one.
    coming : str
        What a part says until then, as HTML.

    Examples
    --------
    >>> runs = Follower(lambda: run.result, "<p>Appears with the first result.</p>")
    >>> page = pn.Column(runs.text(spread_html), runs.charts(path_chart, growth_chart, height=300))
    >>> runs.follow()  # when the result has changed
    """

    def __init__(self, current: Callable[[], _T | None], coming: str = "") -> None:
        self._current = current
        self._coming = coming
        self._shows: list[Callable[[_T], object]] = []

    def follow(self) -> None:
        """Show the current result in every part made so far."""
        result = self._current()
        if result is not None:
            for show in tuple(self._shows):  # a part may make others, which have the result already
                show(result)

    def add(self, show: Callable[[_T], object]) -> None:
        """Have ``show`` called with the result: now, if there is one, and whenever the page follows."""
        self._shows.append(show)
        result = self._current()
        if result is not None:
            show(result)

    def text(self, tell: Callable[[_T], str], margin: int | tuple[int, ...] = (4, 10)) -> TextPane:
        """HTML of the result; a text that stays the same is not sent."""
        pane = html_pane(self._coming, margin)
        self.add(lambda result: pane.say(tell(result)))
        return pane

    def later(self, make: Callable[[], Any], waiting: Any = None, **look: Any) -> pn.Column:
        """The place of what is made with the first result; until then it has what is ``waiting``."""
        waiting = waiting or html_pane(self._coming)
        place = pn.Column(waiting, **look)

        def show(_: _T) -> None:
            if place[0] is waiting:
                place.objects = [make()]

        self.add(show)
        return place

    def chart(self, draw: Callable[[_T], Plotted], height: int | None = None) -> pn.Column:
        """A chart of the result that there is."""
        pane: ChartPane[_T] = ChartPane(draw, self.known, height)
        self._shows.append(pane.show)
        return pane.view

    def charts(self, *draws: Callable[[_T], Plotted], height: int) -> pn.Column:
        """Charts beside each other, made with the first result."""
        return self.later(lambda: grid(*(cell(6, self.chart(draw, height)) for draw in draws)))

    def known(self) -> _T:
        """The result, for what appears with the first one."""
        result = self._current()
        assert result is not None
        return result
