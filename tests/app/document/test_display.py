"""Display choices: what a percentage of a figure means, and that no verdict follows them."""

import numpy as np
import pytest
from scipy import stats

from app.document.display import SPREADS, Display, display_of
from app.serving.server import first_design
from app.session import Session, link_parts
from app.subjects.budget.charts import phase_chart
from app.subjects.budget.key_figures import key_figures
from app.subjects.budget.page import BudgetPage
from app.subjects.budget.timelines import all_timelines
from nav_model.base.errors import InputError
from nav_model.budget import analyse


@pytest.mark.parametrize(("spread", "held", "pair"), [
    ("95 %", 0.95, False), ("95 %", 0.95, True), ("CEP", 0.5, True), ("2σ", stats.norm.cdf(2) * 2 - 1, False),
])  # fmt: skip
def test_a_spread_holds_the_share_it_is_named_for(spread: str, held: float, pair: bool) -> None:
    """Against SciPy's normal and Rayleigh distributions."""
    k = Display(spread).factor(pair=pair)
    share = stats.rayleigh.cdf(k) if pair else stats.norm.cdf(k) - stats.norm.cdf(-k)
    assert share == pytest.approx(held, abs=1e-12)


def test_words_go_there_and_back_and_others_are_refused() -> None:
    for spread in SPREADS:
        for units in ("data sheet", "SI"):
            assert display_of(Display(spread, units).word) == Display(spread, units)
    for word in ("3s", "95.mm", "<b>", "95.si.si"):
        with pytest.raises(InputError, match="is not a display choice"):
            display_of(word)
    assert link_parts("?arw=1deg/sqrt(h)&show=95.si&sar.runs=20") == ("arw=1deg/sqrt(h)", "sar.runs=20", "95.si")


def test_the_verdict_never_follows_and_curves_cross_their_limits_where_they_did() -> None:
    budget = analyse(first_design())
    for spread in SPREADS:
        display = Display(spread, "SI")
        for was, converted in zip(all_timelines(budget), map(display.timeline, all_timelines(budget)), strict=True):
            for limit, now in zip(was.limits, converted.limits, strict=True):
                kind = "vertical" if "vertical" in limit.key else "horizontal"
                pairs = [(a.y, b.y) for a, b in zip(was.lines, converted.lines, strict=True) if a.label == kind]
                for before, after in pairs:
                    np.testing.assert_allclose(after / now.level, before / limit.level, rtol=1e-12)
        plain, bars = phase_chart(budget), display.bars(phase_chart(budget))
        assert bars.bars[0].first / bars.first_limit == pytest.approx(plain.bars[0].first / plain.first_limit)
        figures = zip(key_figures(budget).items, key_figures(budget, display).items, strict=True)
        assert all((a.met, a.used) == (b.met, b.used) for a, b in figures)


def test_tiles_timelines_and_bars_follow_a_choice() -> None:
    session = Session(first_design())
    page = BudgetPage(session)
    summary = page._strip._text.object
    assert "0.404 m" in page._tiles.object
    session.display = "2s.si"
    page.show(session.budget)
    assert "0.808 m" in page._tiles.object  # twice 0.4039 m
    assert "limit 4 m<" in page._tiles.object  # 2 m at 1σ
    assert "54.7°, limit 20°" in summary
    assert "1.91\xa0rad, limit 0.698\xa0rad at 2σ" in page._strip._text.object
    assert page._stack.plots[2].yaxis[0].axis_label == "attitude,\n2σ [rad]"
    assert f"{2 * session.budget['quadratic_phase', 'real time'].sigma:.3g} rad</span>" in page._phase.object
    assert "°</span>" not in page._phase.object
    assert session.link.endswith("show=2s.si")
