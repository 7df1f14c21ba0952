"""Values that would close a design, held to the budget of the design that takes it at its word."""

import re

import numpy as np
import pytest

from app.document.allocation import entry_texts
from app.document.closing import value_ways, ways_table
from app.document.display import SPREADS, Display
from app.document.verdict import check_words, displayed_check, verdict_of, verdicts_in_short
from nav_model.base.units import parse_quantity
from nav_model.budget import Budget, analyse
from nav_model.budget.allocation import allocate
from nav_model.design.figures import REQUIRED
from nav_model.design.parts import declaration_of
from nav_model.explore.solve import solve


@pytest.fixture(scope="module")
def failing(mems: Budget) -> Budget:
    """One requirement, which it misses by half of the limit."""
    limit = mems["detrended_phase", "real time"].sigma / 1.5
    others = {f"requirements.{name}": None for name in REQUIRED}
    return analyse(mems.design.replace({**others, "requirements.detrended_phase": limit}))


def test_a_way_closes_at_the_value_that_it_says_and_a_percent_more_does_not(failing: Budget) -> None:
    assert not failing.verdict.closes
    ways = value_ways(failing.design, solve(failing.design, verify=False))
    assert len(ways) >= 3
    for way in ways:
        ((key, value),) = way.changes.items()
        # What a person would type, read from the words alone.
        read = declaration_of(key).read(way.value.removeprefix("at most ")).value
        assert read == pytest.approx(value, rel=1e-12), way.text
        assert analyse(failing.design.replace({key: read})).verdict.closes, way.text
        assert not analyse(failing.design.replace({key: 1.011 * read})).verdict.closes, way.text
        if failing.design[key] is not None:
            now = declaration_of(key).read(way.now).value
            assert now == pytest.approx(failing.design[key], rel=5e-3)
    rows = ways_table(failing, ways).rows
    assert [row[0].value for row in rows] == [way.text for way in ways]


def test_what_sources_may_take_adds_up_to_the_limit_less_its_reserve(failing: Budget) -> None:
    (check,) = failing.verdict.checks
    texts = entry_texts(failing.design, check, allocate(failing, check.name))
    allocated, estimated = (
        np.array([parse_quantity(text[name], "angle").value for text in texts]) for name in ("allocated", "estimated")
    )
    assert np.hypot.reduce(allocated) == pytest.approx(0.8 * check.limit, rel=5e-3)
    assert np.hypot.reduce(estimated) == pytest.approx(failing["detrended_phase", "real time"].sigma, rel=5e-3)
    assert list(estimated) == sorted(estimated, reverse=True)


@pytest.mark.parametrize("spread", SPREADS)
@pytest.mark.parametrize("units", ["data sheet", "SI"])
def test_value_and_limit_keep_their_ratio_however_they_are_shown(mems: Budget, spread: str, units: str) -> None:
    display = Display(spread, units).of(mems.design)
    for check in mems.verdict.checks:
        *texts, at, beside = displayed_check(mems.design, check, display)
        plain = (text.replace("\N{NO-BREAK SPACE}", " ") for text in texts)
        value, limit = (parse_quantity(text, check.dimension).value for text in plain)
        assert value / limit == pytest.approx(check.value / check.limit, rel=1e-2), check.name
        assert bool(at) is (check.confidence is not None)
        assert beside == ""  # no flight


def test_a_verdict_counts_what_is_met_and_names_the_tightest(mems: Budget) -> None:
    answer = verdict_of(mems)
    failed = [check for check in mems.verdict.checks if check.value > check.limit]
    ((met, count),) = re.findall(r"(\d+) of (\d+) requirements met", answer.sentences[0])
    assert (int(count) - int(met), answer.tone) == (len(failed), "bad")
    assert answer.sentences[0].count(" fails (") == len(failed)
    worst = max(mems.verdict.checks, key=lambda check: check.value / check.limit)
    words = check_words(mems.design, worst)
    assert f"{words.value} against {words.limit}" in answer.sentences[1]


def test_a_switch_leaves_open_what_takes_longer(mems: Budget) -> None:
    both, quick = verdicts_in_short(mems), verdicts_in_short(mems, both=False)
    assert list(both.values()) == list(quick.values()) == ["real time", "post-processed"]
    (first, second), (same, left_open) = both, quick
    assert first == same != "Real time …"
    assert left_open == "Post-processed …" != second
