"""The Budget page: the answer, the key figures, then the charts that explain them."""

from __future__ import annotations

from collections.abc import Callable
from html import escape

import panel as pn

from app.charts.kinds import BarChart, Chart
from app.document.numbers import percent, show, signed_percent
from app.document.prose import prose
from app.session import Session
from app.subjects.budget.charts import (
    attitude_chart,
    phase_chart,
    position_chart,
    regime_chart,
    response_chart,
    velocity_chart,
)
from app.ui.chart_pane import ChartView
from app.ui.grid import cell, grid
from app.ui.html_pane import html_pane
from app.ui.turns import in_turns
from nav_model.budget import Budget
from nav_model.budget.provenance import cautions
from nav_model.budget.result import Check
from nav_model.sar.geometry import phase_to_metres

# Chart, height in pixels, columns of twelve on a wide screen.
_LAYOUT: tuple[tuple[Callable[[Budget], Chart | BarChart], int, int], ...] = (
    (position_chart, 380, 12),
    (velocity_chart, 300, 6),
    (attitude_chart, 300, 6),
    (phase_chart, 360, 6),
    (response_chart, 360, 6),
    (regime_chart, 340, 12),
)

_TIMELINES = 3  # the first charts share their time axis
_AROUND = 100  # pixels of title, legend and line of knowledge around a figure, at least


class BudgetPage:
    """Everything below the tab.

    The first screen is made at once: the answer and the first chart. The other charts follow when it stands, so
    that nobody waits for what is below the fold.
    """

    def __init__(self, session: Session) -> None:
        self._session = session
        self._answer = html_pane(answer(session.budget))
        self._charts: list[ChartView] = []
        # About the height of what will stand in each, so that nothing jumps.
        self._cells = [cell(columns, min_height=height + _AROUND) for _, height, columns in _LAYOUT]
        self.view = pn.Column(
            self._answer,
            grid(*self._cells),
            sizing_mode="stretch_width",
        )
        self._add_chart()
        pn.state.onload(lambda: in_turns([self._add_chart] * (len(_LAYOUT) - 1)))  # in a script or a test: at once

    def _add_chart(self) -> None:
        describe, height, _ = _LAYOUT[len(self._charts)]
        chart = ChartView(describe, self._session, height)
        if 0 < len(self._charts) < _TIMELINES:  # one time axis: panning one pans all
            chart.figure.plot.x_range = self._charts[0].figure.plot.x_range
        self._cells[len(self._charts)].append(chart.view)
        self._charts.append(chart)

    def show(self, budget: Budget) -> None:
        """Follow the budget in force."""
        self._answer.object = answer(budget)
        for chart in self._charts:
            chart.show(budget)


def answer(budget: Budget) -> str:
    """Everything above the charts, one pane so that a slider step sends it once."""
    return "".join(part(budget) for part in (verdict_strip, key_figures, requirement_table, caution_list))


def verdict_strip(budget: Budget) -> str:
    """The answer: closes or not, by how much, what dominates, at which confidence."""
    verdict = budget.verdict
    tightest = verdict.tightest
    sigma = f"{verdict.confidence:g}σ"
    if tightest is None:
        line = budget.sar.lines[max(range(len(budget.sar.lines)), key=lambda i: budget.sar.lines[i].share)]
        return (
            '<div class="strip open" role="status"><h2>No requirement set</h2>'
            "<p>Give a limit under Requirements to get a verdict.</p>"
            f"<p>Quadratic phase is dominated by <b>{escape(line.source)}</b> ({percent(line.share)}).</p></div>"
        )
    failed = sum(not check.met for check in verdict.checks)
    total = len(verdict.checks)
    head, css, mark = ("Closes", "good", "✓") if verdict.closes else ("Does not close", "bad", "✗")
    count = f"all {total} requirements met" if verdict.closes else f"{failed} of {total} requirements not met"
    return (
        f'<div class="strip {css}" role="status"><h2><span aria-hidden="true">{mark}</span> {head}</h2>'
        f"<p>{count} at {sigma}</p>"
        f'<p>Tightest: <b>{escape(tightest.label)}</b> <span class="num">'
        f"{show(tightest.value, tightest.dimension)}</span> against "
        f'<span class="num">{show(tightest.limit, tightest.dimension)}</span>, margin '
        f'<b class="num">{signed_percent(tightest.margin)}</b></p>'
        f"<p>Dominated by <b>{escape(tightest.sensor)}</b> "
        f"({percent(tightest.sensor_share)} of variance{_through(tightest)})</p></div>"
    )


def _through(check: Check) -> str:
    same = check.dominant == check.sensor
    return "" if same else f", mostly through {escape(check.dominant)}"


def key_figures(budget: Budget) -> str:
    """The cards: one figure each, which of closed, prior or posterior it is, and its limit."""
    steady, sar = budget.steady_state, budget.sar
    checks = {check.name: check for check in budget.verdict.checks}
    chosen = budget.design.requirements.steady_state
    moment = getattr(steady, chosen)
    named = {"prior": "just before a fix [T-8]", "posterior": "just after a fix [T-8]", "closed": "cycle rms [T-3]"}
    closed = steady.closed
    response = sar.impulse_response
    autofocus = "" if sar.autofocus_order == 1 else ", before autofocus"
    cards = [
        _settled("Position, horizontal", moment.position_horizontal, closed.position_horizontal, "length",
                 named[chosen], checks.get("horizontal_position")),
        _settled("Position, vertical", moment.position_vertical, closed.position_vertical, "length",
                 named[chosen].replace("T-3", "T-4"), checks.get("vertical_position")),
        _settled("Velocity, horizontal", moment.velocity_horizontal, closed.velocity_horizontal, "speed",
                 named[chosen], checks.get("horizontal_velocity")),
        _settled("Tilt, roll and pitch", moment.tilt, closed.tilt, "angle", named[chosen], checks.get("tilt")),
        _card(f"Position after {show(budget.coast.duration, 'time')}",
              show(budget.coast.end_refined_horizontal, "length"),
              f"horizontal, refined [T-17]; vertical {show(budget.coast.end_refined_vertical, 'length')}",
              checks.get("coast_horizontal_position")),
        _card("Quadratic phase", show(sar.quadratic, "angle"),
              f"{_millimetres(sar.quadratic, sar.wavelength)} of sight, closed form [S-5]{autofocus}",
              checks.get("quadratic_phase")),
        _card("Detrended phase, rms", show(sar.detrended, "angle"),
              f"{_millimetres(sar.detrended, sar.wavelength)} of sight, closed form [T-15]",
              checks.get("detrended_phase")),
        _card("Azimuth width",
              "no image" if response is None
              else show(float(response.half_power_extent_cells) * sar.cell_length, "length"),
              f"with 1σ quadratic; aperture {show(sar.aperture_time, 'time')}, "
              f"{show(sar.aperture_length, 'length')} [S-3]", None),
    ]  # fmt: skip
    return f'<dl class="cards" aria-label="Key figures, one sigma">{"".join(cards)}</dl>'


def _settled(label: str, value: float, closed: float, dimension: str, which: str, check: Check | None) -> str:
    other = "" if value == closed else f"; closed form {show(closed, dimension)}"
    return _card(label, show(value, dimension), f"1σ, {which}{other}", check)


def _card(label: str, value: str, fine: str, check: Check | None) -> str:
    limit = ""
    if check is not None:
        mark = "✓ within" if check.met else "✗ over"
        limit = (
            f'<dd class="fine"><span class="mark">{mark}</span> the limit '
            f'<span class="num">{show(check.limit, check.dimension)}</span></dd>'
        )
    return (
        f'<div class="card"><dt>{escape(label)}</dt><dd class="big num">{value}</dd>'
        f'<dd class="fine quiet">{prose(fine)}</dd>{limit}</div>'
    )


def _millimetres(phase: float, wavelength: float) -> str:
    return show(float(phase_to_metres(phase, wavelength)), "length")


def requirement_table(budget: Budget) -> str:
    """Every requirement with its figure, limit, margin and what dominates it."""
    verdict = budget.verdict
    if not verdict.checks:
        return ""
    rows = "".join(
        f"<tr><th scope='row'>{escape(check.label)}</th>"
        f"<td><span class='mark'>{'✓ met' if check.met else '✗ not met'}</span></td>"
        f"<td class='num'>{show(check.value, check.dimension)}</td>"
        f"<td class='num'>{show(check.limit, check.dimension)}</td>"
        f"<td class='num'>{signed_percent(check.margin)}</td>"
        f"<td>{escape(check.basis)} {prose(check.equation)}</td>"
        f"<td>{escape(check.sensor)} {percent(check.sensor_share)}</td></tr>"
        for check in verdict.checks
    )
    return (
        '<div class="scroll" tabindex="0" role="region" aria-label="Requirements">'
        '<table class="checks"><thead><tr><th scope="col">Requirement</th>'
        f'<th scope="col">Verdict</th><th scope="col" class="num">Value at {verdict.confidence:g}σ</th>'
        '<th scope="col" class="num">Limit</th><th scope="col" class="num">Margin</th>'
        '<th scope="col">Figure checked</th><th scope="col">Dominated by</th></tr></thead>'
        f"<tbody>{rows}</tbody></table></div>"
    )


def caution_list(budget: Budget) -> str:
    """What a careful reader must know."""
    items = "".join(f"<li>{prose(sentence)}</li>" for sentence in cautions(budget))
    return f'<ul class="cautions quiet" aria-label="Assumptions and cautions">{items}</ul>'
