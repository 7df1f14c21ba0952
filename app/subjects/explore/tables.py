"""Results of the questions of the page Close it, as blocks: the answer first, then the table."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from app.charts.kinds import TradeMapChart
from app.document.blocks import Answer, Block, Cell, Column, Row, TableBlock, Text, numbers, table
from app.document.closing import Way, ways_table
from app.document.numbers import margin_in_sentence, margin_in_short, number, percent, signed_percent
from app.document.verdict import before_flight
from app.document.wording import input_in_words
from nav_model.budget import Budget
from nav_model.budget.verdict import flown_names
from nav_model.design import Design
from nav_model.design.declaration import in_sentence
from nav_model.design.figures import figure_in_sentence
from nav_model.design.parts import PRESET_KEYS, declaration_of, quantity
from nav_model.explore.levers import Biases
from nav_model.explore.margins import label_of
from nav_model.explore.search import Candidate
from nav_model.explore.solve import Solution
from nav_model.explore.sweep import Column as Swept
from nav_model.explore.sweep import least_demanding, sweep_ratios
from nav_model.explore.sweep_plan import SweepPlan
from nav_model.explore.uncertainty import Probability, UncertainVerdict


def headroom_answer(budget: Budget, solutions: Sequence[Solution], ways: Sequence[Way]) -> Answer:
    """For a design that closes: the input that matters most, how far it may go, and what it is now.

    Grey where the flight decides: what is solved is of the straight leg.
    """
    tightest = budget.straight_leg().tightest
    mark, tone = ("", "open") if flown_names(budget.design) else ("✓ ", "good")
    wanted = next((each.key for each in solutions if tightest and quantity(each.key).source == tightest.dominant), "")
    most = next((way for way in ways if wanted in way.changes), ways[0] if ways else None)
    if most is None:
        sentence = "No requirement limits any input within its allowed range."
        return Answer(f"{mark}Every input may take any allowed value", tone, (sentence,))
    ((key, value),) = most.changes.items()
    now = next(solution.current for solution in solutions if solution.key == key)
    room = float(value) / now if now else math.inf  # type: ignore[arg-type]
    gap = "at the limit" if room < 1.005 else f"{percent(room - 1)} headroom"
    head = f"{most.what} may be up to {most.value.removeprefix('at most ')}"
    return Answer(f"{mark}{head}", tone, (f"Now {most.now}, {gap}.", f"{most.why[0].upper()}{most.why[1:]}."))


def solved_blocks(budget: Budget, solutions: Sequence[Solution], ways: Sequence[Way]) -> Iterator[Block]:
    """Every input with a value that closes the design, and the others by name."""
    if ways:
        yield ways_table(budget, ways)
    helpless = [
        in_sentence(declaration_of(solution.key).label)
        for solution in solutions
        if solution.together.outcome == "no value"
    ]
    if helpless:
        yield Text(f"No value alone is enough: {', '.join(helpless)}.")


def map_answer(chart: TradeMapChart, here: float) -> Answer:
    """The design's place on a map: ``here`` is its result over the map's reference."""
    result = chart.title.partition(":")[0]
    hint = "Click the map to apply a point to the design."
    if chart.limited:
        return Answer(f"{result}: {margin_in_short(1 - here)} in this design", "open", (hint,))
    return Answer(result, "open", ("No limit is set: the map compares with this design.", hint))


def biases_text(design: Design, biases: Biases = "design") -> str:
    """The residual biases that an answer assumes."""
    if biases == "sheet":
        return "Each unit with all errors that its sheet prints, residual biases as in your design"
    if biases == "in-run":
        return "Residual biases: each data sheet's in-run biases"
    sizes = {"imu.accelerometer_bias": design.imu.accelerometer_bias, "imu.gyro_bias": design.imu.gyro_bias}
    given = [input_in_words(design, key, size) for key, size in sizes.items() if size]
    if biases == "zero" or not given:
        return "Residual biases 0 assumed"
    return f"Residual biases as in your design: {' and '.join(given)}"


def search_answer(rows: Sequence[Candidate], yours: bool, unbiased: int) -> Answer:
    """Units or pairs that meet the requirements, and the one with the widest margin; `unbiased`: how many would
    with residual biases of zero."""
    good = [row for row in rows if row.closes]
    what = "IMUs pass with your receiver" if yours else "pairs of IMU and receiver pass"
    if not rows:
        return Answer("No IMU can be judged", "warn", ("No data sheet in the list gives both random walks.",))
    best = max(rows, key=lambda row: row.margin)
    name = best.imu if yours else best.pair
    if not good:
        why = f"Nearest: {name}, {margin_in_sentence(best.margin)} ({figure_in_sentence(best.tightest)})."
        other = ("Try all receivers, or change the radar or the limits.",) if yours else ()
        if unbiased:
            other = (f"With residual biases of zero, {unbiased} would: choose them below.",)
        return Answer(f"None of {len(rows)} {what}", "open", (why, *other))
    why = f"Widest margin: {name}, {signed_percent(best.margin)}."
    first = rows[0]
    if first.price is not None:
        name = first.imu if yours else first.pair
        why = f"Cheapest: {name}, {_price(first)}, {signed_percent(first.margin)}. {why}"
    return Answer(f"{len(good)} of {len(rows)} {what}", "open", (why,))


def search_table(
    design: Design, rows: Sequence[Candidate], yours: bool, in_design: Candidate | None = None, name: str = ""
) -> TableBlock:
    """Units, or pairs of unit and receiver, in the order of `search`; each can be taken into the design.

    Parameters
    ----------
    design : Design
    rows : sequence of Candidate
    yours : bool
        Whether all are with the design's own receiver, which is not named then.
    in_design : Candidate, optional
        The design with the unit in it: the first row.
    name : str
        Of its unit.
    """
    offers = any(value is not None for row in rows for value in (row.price, row.mass, row.power))
    titles = (
        "IMU",
        *(() if yours else ("Receiver",)),
        "Margin",
        "Tightest",
        "Main error source",
        *(_OFFERED if offers else ()),
        "Unverified",
    )
    what = "IMUs with your receiver" if yours else "Pairs of IMU and receiver"
    first = "cheapest that passes" if offers else "widest margin"
    return table(
        "search",
        f"{what}{before_flight(design)}, {first} first. Click one to apply it to the design.",
        tuple(Column(title, numeric=title in ("Margin", *_OFFERED), sortable=True) for title in titles),
        (
            *((_candidate(in_design, Cell(name, "● in the design", sort=name), yours, offers),) if in_design else ()),
            *(_candidate(row, Cell(row.imu, sort=row.imu, value=row.pair), yours, offers) for row in rows),
        ),
    )


_OFFERED = ("Price", "Mass", "Power")


def _price(row: Candidate) -> str:
    return f"{number(row.price or 0.0, 4, given=True)} {row.currency}"


def _amount(value: float, unit: str, thousandth: str) -> str:
    return f"{number(value)} {unit}" if value >= 1 else f"{number(1000 * value)} {thousandth}"


def _candidate(row: Candidate, name: Cell, yours: bool, offers: bool) -> Row:
    receiver = () if yours else (row.gnss,)
    texts = (_price(row), _amount(row.mass or 0.0, "kg", "g"), _amount(row.power or 0.0, "W", "mW"))
    values = (row.price, row.mass, row.power)
    offered = [
        Cell("not given", tone="quiet", sort="") if value is None else Cell(text, sort=value)
        for text, value in zip(texts, values, strict=True)
    ]
    return (
        name,
        *receiver,
        Cell(margin_in_short(row.margin), sort=row.margin),
        label_of(row.tightest),
        f"{row.dominant} {percent(row.share)}",
        *(offered if offers else ()),
        ", ".join(row.doubts),
    )


def uncertain_answer(verdict: UncertainVerdict) -> Answer:
    """The verdict as a probability."""
    high, middle, low = (number(1 - margin) for margin in verdict.margin)
    head = f"Probability of closing: {_probability(verdict.closes)}"
    text = f"Worst requirement {middle} × its limit (median), {low} to {high} × in 90 % of designs."
    return Answer(head, "open", (text,))


def uncertain_table(design: Design, verdict: UncertainVerdict) -> TableBlock:
    """Part of each requirement in the probability."""
    return table(
        "uncertain",
        f"Requirements under these ranges{before_flight(design)}",
        ("Requirement", *numbers("Met in", "Tightest in")),
        ((label_of(name), _probability(p), percent(verdict.limiting[name])) for name, p in verdict.each.items()),
    )


def _probability(p: Probability) -> str:
    if p.value in (0.0, 1.0):
        return f"less than {number(100 * p.high, 1)} %" if p.value == 0 else f"more than {number(100 * p.low, 4)} %"
    return f"{100 * p.value:.1f} % ± {math.ceil(500 * (p.high - p.low)) / 10:.1f} %"


_SWEPT = 200  # rows of a sweep's table on the page


def sweep_order(plan: SweepPlan, columns: Mapping[str, Swept]) -> NDArray[np.intp]:
    """Rows of a sweep: the `least_demanding`, the others that pass, those that fail; each the nearest to its limits
    first. In their order where there is no requirement."""
    if columns["closes"][0] is None:
        return np.arange(len(columns["row"]))
    ratios = sweep_ratios(columns)
    return np.lexsort((np.where(ratios <= 1, -ratios, ratios), ~least_demanding(plan, columns), ratios > 1))


def sweep_answer(plan: SweepPlan, columns: Mapping[str, Swept], stale: bool) -> Answer:
    """Number of designs of a sweep that meet all requirements, and the one that just does."""
    old = ("The results belong to an earlier sweep or design. Run again.",) if stale else ()
    if columns["closes"][0] is None:
        return Answer(f"{plan.rows:,} designs", "open", (*old, "No requirement is set, so no design is judged."))
    good = int(np.sum(np.asarray(columns["closes"], bool)))
    first = int(sweep_order(plan, columns)[0])
    margin = margin_in_sentence(float(1 - sweep_ratios(columns)[first]))
    word = f"{good:,} of {plan.rows:,} designs meet all requirements{before_flight(plan.design)}"
    front = int(np.sum(least_demanding(plan, columns)))
    which = "Smallest margin that passes" if good else "Nearest"
    sentence = f"{which}: {', '.join(_swept_values(plan, first))}; {margin}."
    if front:
        old = (*old, f"{front:,} of them are least demanding: relaxing any input would fail.")
    return Answer(word, "warn" if stale else "open", (*old, sentence))


def sweep_table(plan: SweepPlan, columns: Mapping[str, Swept]) -> TableBlock:
    """The first designs of a sweep in `sweep_order`; each can be taken into the design."""
    rows = sweep_order(plan, columns)[:_SWEPT]
    judged = columns["closes"][0] is not None
    count = f"{len(rows)} rows of {plan.rows:,}" if len(rows) < plan.rows else f"{plan.rows:,} designs"
    order = f", the least demanding that pass first (●){before_flight(plan.design)}" if judged else ""
    ratios = sweep_ratios(columns) if judged else np.full(plan.rows, np.nan)
    front = least_demanding(plan, columns) if judged else np.zeros(plan.rows, bool)
    names = [_swept_name(axis.key) for axis in plan.axes]
    return table(
        "sweep",
        f"{count}{order}. Click one to apply it to the design.",
        (
            Column(names[0], sortable=True),
            *numbers(*names[1:], sortable=True),
            *((Column("Margin", numeric=True, sortable=True),) if judged else ()),
        ),
        (
            (
                *_swept_row(plan, int(row), "●" if front[row] else ""),
                *((Cell(margin_in_short(float(1 - ratios[row])), sort=float(1 - ratios[row])),) if judged else ()),
            )
            for row in rows
        ),
    )


def _swept_name(key: str) -> str:
    return str(declaration_of(key).label) if key not in PRESET_KEYS else "Catalogue"


def _swept_cells(plan: SweepPlan, row: int) -> list[tuple[str, float | str]]:
    cells: list[tuple[str, float | str]] = []
    for axis, place in zip(plan.axes, plan.indices(row, row + 1), strict=True):
        value = axis.values[int(place[0])]
        text = input_in_words(plan.design, axis.key, value) if isinstance(value, float) else str(value)
        cells.append((text, value if isinstance(value, float) else text))
    return cells


def _swept_row(plan: SweepPlan, row: int, mark: str) -> list[Cell]:
    """The inputs of a row; the first is pressed to apply them all."""
    first, *others = (Cell(text, sort=sort) for text, sort in _swept_cells(plan, row))
    return [replace(first, mark=mark, value=str(row)), *others]


def _swept_values(plan: SweepPlan, row: int) -> list[str]:
    names = (in_sentence(_swept_name(axis.key)) for axis in plan.axes)
    return [f"{name} {text}" for name, (text, _) in zip(names, _swept_cells(plan, row), strict=True)]
