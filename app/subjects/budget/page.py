"""The Budget page: answer, key figures and the charts that explain them on one screen; details folded below."""

from collections.abc import Mapping
from functools import partial
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui
import param
from bokeh.core.property.validation import validate

from app.charts.kinds import BarChart, Chart
from app.charts.legend import key_html
from app.charts.screen.timelines import Timelines
from app.declared import required
from app.document.bars import bars_html
from app.document.blocks import Answer, Block, KeyFigures, Text
from app.document.closing import (
    ON_FLIGHT,
    Way,
    closing_block,
    closing_options,
    largest_values,
    set_name,
    ways_table,
)
from app.document.display import Display, display_of
from app.document.pane import html_of
from app.document.sicd import sicd_xml
from app.document.tiles import tiles_html
from app.document.verdict import verdict_strip, verdicts_in_short
from app.report.cautions import caution_list
from app.session import Session
from app.subjects.budget import charts, timelines
from app.subjects.budget.key_figures import key_figures
from app.subjects.budget.tables import echo_table, processing_table, requirement_table
from app.subjects.budget.vendor import VendorPanel
from app.ui.answer_strip import AnswerStrip
from app.ui.chart_pane import ChartPane, described, head_html
from app.ui.downloads import download
from app.ui.first_screen import first_screen
from app.ui.folded import Folded
from app.ui.follower import Follower
from app.ui.html_pane import html_pane
from app.ui.sortable_table import SortableTable
from app.ui.theme import FRAME, NARROW, PRINT_NOTHING, STACK_ON_A_PHONE
from app.ui.turns import debounce, once_loaded
from app.ui.verdict_switch import VerdictSwitch
from app.ui.view import View
from app.work.pool import run_in_pool
from nav_model.base.errors import InputError
from nav_model.budget import Budget
from nav_model.budget.provenance import class_for_white_noise
from nav_model.budget.sicd import error_statistics
from nav_model.budget.verdict import flown_names
from nav_model.design import Design
from nav_model.design.presets import filled
from nav_model.explore.closing import LeverSet, closing_sets

_HEAD = (6, 10, 0, 10)  # margin of the line above a chart

_OVER = {
    "position": "absolute", "top": "100%", "left": "10px", "right": "10px", "width": "auto",
    "max-height": "60vh", "overflow-y": "auto",
    "background": "var(--panel-surface-color, Canvas)", "box-shadow": "0 6px 22px rgb(0 0 0 / 30%)",
}  # fmt: skip
"""Of what opens over the page: the charts keep their size."""


class BudgetPage(View):
    """Everything below the bar.

    The first screen fills the window; its figures come just after it. What is folded below is made when it is opened.
    """

    session = required(Session)

    def __init__(self, session: Session) -> None:
        super().__init__(session=session)
        budget = session.budget
        self._details = Follower(lambda: self.session.budget)
        self._close = pmui.Button(
            label=_ask(budget), variant="text", end_icon="expand_more", margin=(6, 4), stylesheets=[PRINT_NOTHING]
        )
        self._close.on_click(self._toggle_ways)
        self._mode = VerdictSwitch(
            self._choose, label="Processing", options=verdicts_in_short(budget), value=budget.verdict.processing,
            margin=(8, 4), sizing_mode=None,
        )  # fmt: skip
        self._ways: Mapping[str, Way | LeverSet] = {}
        self._ways_of: tuple[Design, str, tuple[str, ...]] | None = None
        self._table = SortableTable(self._take, over=True, margin=(4, 14))
        self._panel = pn.Column(self._table, visible=False, styles=FRAME | _OVER)
        self._strip = AnswerStrip(self._answer, self._mode, self._close, self._panel)
        self._tiles = html_pane("", margin=0)
        self._lines = self._timelines(budget)
        self._stack = Timelines(self._lines)
        self._stack_head = html_pane("", margin=_HEAD)
        self._phase = html_pane("", margin=(0, 10, 4, 10))
        self._phase.param.update(sizing_mode="stretch_both", styles={"overflow": "hidden auto"})
        self._phase_head = html_pane("", margin=_HEAD)
        self._compared: Any = None
        self._was: tuple[KeyFigures | None, BarChart | None] = None, None
        self._response = ChartPane(
            lambda budget: charts.with_compared(charts.response_chart(budget), self._compared_budget),
            lambda: self.session.budget,
            moving=lambda budget: charts.with_compared(charts.response_curves(budget), self._compared_budget),
        )
        figures = [pn.pane.Bokeh(plot, sizing_mode="stretch_both") for plot in self._stack.plots]
        for figure in figures:  # the last has the axis
            figure.styles = {"flex": "1.25 1 0" if figure is figures[-1] else "1 1 0"}
        lines = pn.Column(self._stack_head, sizing_mode="stretch_both", stylesheets=[STACK_ON_A_PHONE])
        response = pn.Column(sizing_mode="stretch_both", stylesheets=[NARROW])
        self._view = pn.Column(
            self._strip,
            first_screen(
                self._tiles,
                left=[lines],
                right=[
                    pn.Column(self._phase_head, self._phase, sizing_mode="stretch_both", stylesheets=[NARROW]),
                    response,
                ],
            ),
        )
        self._tell_soon = debounce(self._tell)
        self._drawn_display = session.display
        self._feed(budget)
        self._tell()
        # The answer is on the screen while the figures, most of the browser's work, are still drawn.
        once_loaded(lambda: lines.extend(figures))
        once_loaded(lambda: response.append(self._response.view))
        once_loaded(lambda: self._view.append(self._folded()))

    @property
    def _compared_budget(self) -> Budget | None:
        return self._compared.budget if self._compared else None

    @property
    def _answer(self) -> Answer:
        return verdict_strip(self.session.budget, self._display).more(self.session.flight_words)

    @property
    def _display(self) -> Display:
        return display_of(self.session.display).of(self.session.design)

    def _timelines(self, budget: Budget) -> list[Chart]:
        return [self._display.timeline(chart) for chart in timelines.all_timelines(budget)]

    def show(self, budget: Budget) -> None:
        """Follow the current budget."""
        if self.session.compared is not self._compared or self._drawn_display != self.session.display:
            self._drawn_display = self.session.display
            self._hold()
        self._show_strip()
        self._offer_modes(both=False)
        self._lines = self._timelines(budget)
        with validate(False):  # computed here, so it needs no check at each step
            self._stack.feed(self._lines)
            self._response.show(budget)
        self._feed(budget)
        self._tell_soon()
        self._close.label = _ask(budget)
        if self._panel.visible:
            self._find_ways()
        self._details.follow()

    def _choose(self, mode: str) -> None:
        self.session.change({"processing.mode": mode})

    @param.depends("session.invalid", watch=True)
    def _show_strip(self) -> None:
        self._strip.show(self._answer, self.session.refused)

    def show_verdict(self, budget: Budget) -> None:
        """Follow the verdict alone, which the design's flight has changed."""
        self._show_strip()
        self._offer_modes()
        self._feed(budget)
        self._close.label = _ask(budget)
        self._details.follow()

    @param.depends("session.compared", watch=True)
    def _compare(self) -> None:
        """Show the comparison; skipped if the budget changes at the same time, which shows it anyway."""
        if self.session.budget is self._displayed_budget and self.session.compared is not self._compared:
            with pn.io.hold():
                self.show(self.session.budget)

    def _hold(self) -> None:
        """Prepare the comparison in the current display of figures."""
        self._compared = self.session.compared
        was, display = self._compared_budget, self._display
        self._was = (key_figures(was, display), display.bars(charts.phase_chart(was))) if was else (None, None)
        self._stack.compare(self._timelines(was) if was else None)

    def _feed(self, budget: Budget) -> None:
        """Update tiles and bars; unchanged text is not sent."""
        self._displayed_budget = budget
        figures, bars = self._was
        tiles = key_figures(budget, self._display, figures, self.session.last_flown)
        self._tiles.say(tiles_html(tiles, figures))
        self._phase.say(bars_html(self._display.bars(charts.phase_chart(budget)), bars))

    def _tell(self) -> None:
        """Updates that wait for a slider to stop: the other processing's verdict, and the lines above the charts with
        source, method and description."""
        self._offer_modes()
        budget, spread = self.session.budget, self._display.named()
        spreads = "" if spread == "1σ" else f", {spread}{self._display.scaled}"
        phase = charts.phase_chart(budget)
        lines = "".join(described(line) for line in self._lines)
        key = key_html(limit="limit", **({"faint": "compared"} if self._compared else {}))
        self._phase_head.say(head_html(f"{phase.title}{spreads}", phase.knowledge))
        knowledge = self._lines[0].knowledge
        self._stack_head.say(head_html(f"Position, velocity, attitude{spreads}", knowledge, lines, key))

    def _offer_modes(self, *, both: bool = True) -> None:
        budget = self.session.budget
        self._mode.param.update(options=verdicts_in_short(budget, both=both), value=budget.verdict.processing)

    # --- what would close it ---------------------------------------------------------------------------------

    def _toggle_ways(self, _: Any) -> None:
        self._panel.visible = not self._panel.visible
        self._close.end_icon = "expand_less" if self._panel.visible else "expand_more"
        if self._panel.visible:
            if self._ways_of != self._asked:  # buttons for an earlier design are removed
                self._table.html = "<p role='status'>Solving …</p>"
            self._find_ways()

    @property
    def _asked(self) -> tuple[Design, str, tuple[str, ...]]:
        """The design, what of it may change, and the names of the user's own sensors."""
        names = tuple(name for offered in self.session.offers.values() for name in offered)
        return self.session.design, self.session.settings.get("close", ""), names

    def _find_ways(self) -> None:
        if self._ways_of != self._asked:
            pn.state.execute(self._solve)

    async def _solve(self) -> None:
        """In a worker: sliders move on meanwhile, and what was asked for an earlier design is dropped."""
        asked, budget, offers = self._asked, self.session.budget, self.session.offers
        ways: Mapping[str, Way | LeverSet] = {}
        if not budget.straight_leg().checks:
            nothing = "Give a limit under Requirements. What meets it then appears here."
            block: Block = Text(ON_FLIGHT if flown_names(budget.design) else nothing)
        elif budget.straight_leg().closes:
            largest = await run_in_pool(largest_values, budget.design)
            block, ways = _largest(budget, largest), {way.text: way for way in largest}
        else:
            answer = await run_in_pool(partial(closing_sets, budget.design, **closing_options(asked[1], offers)))
            block, ways = closing_block(budget, answer), {set_name(each): each for each in answer.sets}
        if asked == self._asked:
            self._ways, self._ways_of = ways, asked
            self._table.html = html_of(block)

    def _take(self, text: str) -> None:
        way = self._ways.get(text)
        if way is not None and self._ways_of == self._asked:
            self.session.change(way.changes, way.written)
            self._toggle_ways(None)
        elif not text and self._panel.visible:
            self._toggle_ways(None)
            self._close.focus()

    # --- below the first screen ------------------------------------------------------------------------------

    def _folded(self) -> Folded:
        details = self._details
        return Folded(
            (
                ("Requirements and cautions", self._requirements),
                ("Phase and image location, real time and post-processed", lambda: details.text(_both)),
                (
                    "Paired echoes: vibration and oscillator",
                    lambda: details.text(lambda budget: html_of(echo_table(budget, "d"))),
                ),
                (
                    "What limits horizontal position: gyro or accelerometer?",
                    lambda: details.chart(charts.regime_chart, 340),
                ),
                ("Errors as data sheets print them, and what a vendor's table implies", self._vendor),
                ("Exports", self._exports),
            )
        )

    def _requirements(self) -> pn.Column:
        """Requirements and cautions, with a press for the one that a receiver class answers."""
        take = pmui.Button(variant="outlined", margin=(0, 10, 10, 10), stylesheets=[PRINT_NOTHING])

        def offer(budget: Budget) -> None:
            nearest = class_for_white_noise(budget.design)
            take.param.update(label=f"Take receiver class {nearest.name}" if nearest else "", visible=bool(nearest))

        def fill(_: Any) -> None:
            design = self.session.design
            if nearest := class_for_white_noise(design):
                self.session.change(*filled(nearest, design.baseline))

        take.on_click(fill)
        column = pn.Column(self._details.text(requirements), take)
        self._details.add(offer)
        return column

    def _vendor(self) -> VendorPanel:
        panel = VendorPanel(self.session)
        self._details.add(panel.show)
        return panel

    def _exports(self) -> Any:
        def sicd() -> bytes:
            return sicd_xml(error_statistics(self.session.design))

        return download("Image location errors: SICD XML", "error-statistics.xml", sicd, stylesheets=[PRINT_NOTHING])


def _ask(budget: Budget) -> str:
    return "Headroom" if budget.verdict.closes else "What would close it"


def _largest(budget: Budget, largest: tuple[Way, ...]) -> Block:
    """The largest values that leave a straight leg closing; a flight that fails has its options on its own page."""
    if budget.verdict.failing:
        return Text("The straight leg meets its limits, the flight does not: see the options on Flight.")
    if largest:
        return ways_table(budget, largest)
    where = " on a straight leg" if flown_names(budget.design) else ""
    return Text(f"Every requirement is met{where}, whatever a single input is.")


def requirements(budget: Budget) -> str:
    """Every requirement with its margin, and what a careful reader must know."""
    return html_of(requirement_table(budget), caution_list(budget))


def _both(budget: Budget) -> str:
    """The figures of the image in either processing."""
    try:
        return html_of(processing_table(budget, "d"))
    except InputError as error:  # of the processing that is not the design's
        return f"<p>{escape(str(error))}</p>"
