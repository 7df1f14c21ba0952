"""The ranking on the Explore page: which input a figure depends on most."""

from __future__ import annotations

import io
from html import escape

import panel as pn
import panel_material_ui as pmui
import param

from app.charts.kinds import RankChart, to_csv
from app.charts.screen.maps import RankFigure
from app.declared import declared, held
from app.session import Session
from app.subjects.explore.charts import rank_chart
from app.ui.chart_pane import described, source_note
from app.ui.downloads import download
from app.ui.html_pane import html_pane
from app.ui.theme import FRAME
from nav_model.budget import Budget
from nav_model.budget.figures import FIGURES
from nav_model.explore.margins import label_of


class RankPanel(pn.viewable.Viewer):
    """The ranking, with the figure it is of."""

    session = held(Session)
    figure: str = declared(
        param.Selector(objects={label_of(name): name for name in FIGURES}, label="Figure to improve")
    )

    def __init__(self, session: Session) -> None:
        tightest = session.budget.verdict.tightest
        super().__init__(session=session, figure=tightest.name if tightest else "quadratic_phase")
        chart = rank_chart(session.design, self.figure)
        self._chart = RankFigure(chart)
        self._title = html_pane("", margin=(10, 14, 0, 14))
        self._know = html_pane("")
        self._tell(chart)

    def __panel__(self) -> pn.Column:
        return pn.Column(
            self._title,
            pmui.Select.from_param(self.param.figure, sizing_mode="stretch_width", margin=(10, 14, 0, 14)),
            pn.Column(pn.pane.Bokeh(self._chart.plot, sizing_mode="stretch_width")),
            self._know,
            download("Ranking: CSV", "ranking.csv", self._csv),
            styles=FRAME,
        )

    def show(self, budget: Budget) -> None:
        """Follow the budget in force."""
        self._rank()

    @param.depends("figure", watch=True)
    def _rank(self) -> None:
        chart = rank_chart(self.session.design, self.figure)
        self._chart.feed(chart)
        self._tell(chart)

    def _tell(self, chart: RankChart) -> None:
        lead = chart.bars[0].sentence if chart.bars else ""
        self._title.object = f"<h3>{escape(chart.title)}</h3>"
        self._know.object = (
            f"{described(chart)}<p>{escape(lead)} Hatched bars: the input doubled. Plain bars: the input halved.</p>"
            f"{source_note(chart.knowledge)}"
        )

    def _csv(self) -> io.BytesIO:
        return io.BytesIO(to_csv(rank_chart(self.session.design, self.figure)).encode())
