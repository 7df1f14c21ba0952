"""Results of the questions of the Explore page, as blocks: the answer first, then the table."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from app.charts.kinds import TradeMapChart
from app.document.blocks import Answer, Block, Cell, Column, Table, Text
from app.document.numbers import number, percent, signed_percent
from nav_model.base.units import from_si, join_quantity, to_si
from nav_model.budget import Budget
from nav_model.design import Design
from nav_model.design.declaration import sentence_label
from nav_model.design.parts import PRESET_KEYS, declaration_of
from nav_model.explore.margins import ALL, label_of, quantity
from nav_model.explore.search import Candidate
from nav_model.explore.solve import Answer as Solved
from nav_model.explore.solve import Solution, remedies, resolution_for, round_down
from nav_model.explore.sweep import Column as Swept
from nav_model.explore.sweep import sweep_ratios
from nav_model.explore.sweep_plan import Plan
from nav_model.explore.uncertainty import Probability, UncertainVerdict

_SOLVED = (
    "Each value is a root of the formulas with the other inputs held, rounded down to three digits so that it still "
    "meets the limit. “Any”: every value the input may take meets it. “None”: no value does. Verified by running "
    "the budget again."
)


def shown(design: Design, key: str, value: float, down: bool = False) -> str:
    """A value in the unit its input is shown in, to three digits; `down` so that it still meets the limit."""
    dimension = quantity(key).dimension
    unit = design.unit(key) if dimension else ""
    scaled = from_si(value, unit, dimension) if dimension else value
    text = number(round_down(scaled) if down else scaled, given=not down)
    return join_quantity(text, unit) if unit else f"{text} ×"


def answer(budget: Budget, solutions: tuple[Solution, ...]) -> Answer:
    """The input that matters most, how far it may go, and what it is now, for a budget with a requirement."""
    design, tightest = budget.design, budget.verdict.tightest
    assert tightest is not None
    tone = "good" if budget.verdict.closes else "bad"
    wanted = next((solution for solution in solutions if quantity(solution.key).source == tightest.sensor), None)
    order = [wanted, *solutions] if wanted else list(solutions)
    lever = next((solution for solution in order if solution.together.outcome == "limited"), None)
    if lever is None:
        head = "Every input may go to its bound" if budget.verdict.closes else "No single change closes it"
        return Answer(head, tone, _stuck(budget, solutions))
    value = lever.together.value or 0.0
    limit, now = shown(design, lever.key, value, down=True), shown(design, lever.key, lever.current)
    room = value / lever.current if lever.current else math.inf
    gap = f"{number(1 / room)} times too much" if room < 1 else f"{number(room)} times as much still closes"
    other = () if lever is wanted or wanted is None else (f"No {_named(wanted.key)} alone is enough.",)
    binding = label_of(lever.together.binding).lower()
    said = (f"You have {now}: {gap}.", *other, f"Limited by {binding}.")
    return Answer(f"Largest {_named(lever.key)} that closes: {limit}", tone, said)


def unsolved(reason: str) -> Answer:
    """The message in place of the answer when solving failed its own check, which is a defect."""
    why = f"The budget run again at the solved value did not meet its limit, so no value is shown: {reason}."
    return Answer("Not solved", "bad", (why,))


def _stuck(budget: Budget, solutions: tuple[Solution, ...]) -> tuple[str, ...]:
    if budget.verdict.closes:
        return ("No requirement limits any of the inputs within what they may be.",)
    said = []
    for check in budget.verdict.checks:
        if not check.met:
            helps = ", ".join(_phrase(budget.design, found) for found in remedies(solutions, check.name))
            said.append(f"{check.label} alone would be met by {helps or 'no single input'}.")
    return (*said, "Change two inputs together: see “Trade two inputs”.")


def _phrase(design: Design, found: Solved) -> str:
    return f"{_named(found.key)} ≤ {_value(design, found)}"


def _value(design: Design, found: Solved) -> str:
    if found.value is None:
        return "any" if found.outcome == "any value" else "none"
    text = shown(design, found.key, found.value, down=True)
    if found.key == "radar.aperture_time":
        text += f" ({number(resolution_for(design, found.value))} m resolution)"
    return text


def largest(design: Design, key: str, value: float) -> tuple[float, str]:
    """A solved value as a person would type it, rounded down so that it still meets the limit: SI, and its unit."""
    dimension = quantity(key).dimension
    if not dimension:
        return round_down(value), ""
    unit = design.unit(key)
    return to_si(round_down(from_si(value, unit, dimension)), unit, dimension), unit


def solved_blocks(budget: Budget, solutions: tuple[Solution, ...]) -> tuple[Block, ...]:
    """Every input solved for all requirements, each to be taken, with what would help where nothing does."""
    if not solutions:
        return ()
    design = budget.design
    table = Table(
        "solved",
        "Largest allowed value of each input, the others held. Press an input to take it.",
        (
            Column("Input"),
            Column("You have", numeric=True),
            Column("Largest allowed", numeric=True),
            Column("Limited by"),
        ),
        tuple(_solved_row(design, solution) for solution in solutions),
        _SOLVED,
        choose="button",
    )
    helpless = [_named(solution.key) for solution in solutions if solution.together.outcome == "no value"]
    if not helpless:
        return (table,)
    enough = "; ".join(_phrase(design, found) for found in remedies(solutions, ALL))
    tail = f"These would be enough: {enough}." if enough else "No other single input is enough either."
    return table, Text(f"Improving any one of these alone is not enough: {', '.join(helpless)}. {tail}")


def each_table(design: Design, solutions: tuple[Solution, ...]) -> Table:
    """Every input solved for each requirement alone."""
    return Table(
        "solved-each",
        "Largest allowed value for each requirement alone",
        (Column("Input"), *(Column(label_of(found.requirement), numeric=True) for found in solutions[0].each)),
        tuple(
            (Cell(str(quantity(solution.key).label)), *(Cell(_value(design, found)) for found in solution.each))
            for solution in solutions
        ),
    )


def _named(key: str) -> str:
    return sentence_label(quantity(key))


def _solved_row(design: Design, solution: Solution) -> tuple[Cell, ...]:
    together = solution.together
    limited = label_of(together.binding) if together.outcome != "any value" else ""
    note = "" if together.depends or together.outcome != "no value" else " (does not depend on it)"
    met = together.outcome == "any value" or (together.value is not None and together.value >= solution.current)
    return (
        Cell(str(quantity(solution.key).label), value=solution.key if together.value is not None else ""),
        Cell(shown(design, solution.key, solution.current)),
        Cell(f"{'✓' if met else '✗'} {_value(design, together)}", tone="good" if met else "bad"),
        Cell(limited + note),
    )


def map_answer(chart: TradeMapChart, here: float) -> Answer:
    """The design's place on a map: ``here`` is its result over the map's reference."""
    result = chart.title.partition(":")[0]
    hint = "Click the map to take a point into the design."
    if chart.limited:
        tone, word = ("good", "✓ Within the limit") if here <= 1 else ("bad", "✗ Over the limit")
        return Answer(word, tone, (f"{result}: {number(here)} × the limit in this design.", hint))
    return Answer(result, "open", ("No limit is set: the map compares with this design.", hint))


def pair_name(row: Candidate) -> str:
    """What a pair of unit and receiver is called."""
    return f"{row.imu} with {row.gnss}"


def search_answer(rows: Sequence[Candidate], own: bool) -> Answer:
    """How many units or pairs meet the requirements, and which does by the widest margin."""
    good = [row for row in rows if row.closes]
    what, name = ("IMUs pass with your receiver", _imu) if own else ("pairs of IMU and receiver pass", pair_name)
    if not rows:
        return Answer("No IMU can be judged", "warn", ("No data sheet in the list gives both random walks.",))
    best = rows[0]
    if not good:
        why = f"Nearest: {name(best)}, margin {signed_percent(best.margin)} ({label_of(best.tightest).lower()})."
        other = ("Try all receivers, or change the radar or the limits.",) if own else ()
        return Answer(f"None of {len(rows)} {what}", "bad", (why, *other))
    why = f"Widest margin: {name(best)}, {signed_percent(best.margin)}."
    return Answer(f"{len(good)} of {len(rows)} {what}", "good", (why,))


def _imu(row: Candidate) -> str:
    return row.imu


def search_table(rows: Sequence[Candidate], own: bool) -> Table:
    """Units, or pairs of unit and receiver, the widest margin first; each can be taken into the design."""
    titles = (
        "IMU",
        *(() if own else ("Receiver",)),
        "Verdict",
        "Margin",
        "Tightest",
        "Main error source",
        "Unverified",
    )
    what = "IMUs with your receiver" if own else "Pairs of IMU and receiver"
    return Table(
        "search",
        f"{what}, widest margin first. Press one to take it into the design.",
        tuple(Column(title, numeric=title == "Margin", sortable=True) for title in titles),
        tuple(_candidate(row, own) for row in rows),
        choose="button",
    )


def _candidate(row: Candidate, own: bool) -> tuple[Cell, ...]:
    receiver = () if own else (Cell(row.gnss),)
    return (
        Cell(row.imu, sort=row.imu, value=pair_name(row)),
        *receiver,
        Cell("✓ closes", tone="good") if row.closes else Cell("✗ does not close", tone="bad"),
        Cell(signed_percent(row.margin), sort=row.margin),
        Cell(label_of(row.tightest)),
        Cell(f"{row.dominant} {percent(row.share)}"),
        Cell(", ".join(row.doubts)),
    )


def uncertain_answer(found: UncertainVerdict) -> Answer:
    """The verdict as a probability."""
    low, middle, high = map(signed_percent, found.margin)
    head = f"Closes with a probability of {_probability(found.closes)}"
    return Answer(head, "open", (f"Tightest margin {middle} (median), {low} to {high} in 90 % of designs.",))


def uncertain_table(found: UncertainVerdict) -> Table:
    """What each requirement adds to the probability."""
    return Table(
        "uncertain",
        "Requirements under these ranges",
        (Column("Requirement"), Column("Met with", numeric=True), Column("Tightest in", numeric=True)),
        tuple(
            (Cell(label_of(name)), Cell(_probability(p)), Cell(percent(found.limiting[name])))
            for name, p in found.each.items()
        ),
    )


def _probability(p: Probability) -> str:
    return f"{number(100 * p.value)} % ± {number(50 * (p.high - p.low), 2)}"


_SWEPT = 200  # rows of a sweep's table on the page


def sweep_best(columns: Mapping[str, Swept]) -> NDArray[np.intp]:
    """Rows of a sweep, the widest margin first; in their order where there is no requirement."""
    if columns["closes"][0] is None:
        return np.arange(len(columns["row"]))
    return np.argsort(sweep_ratios(columns), kind="stable")


def sweep_answer(plan: Plan, columns: Mapping[str, Swept], stale: bool) -> Answer:
    """How many designs of a sweep meet all requirements, and the best of them."""
    old = ("The results belong to an earlier sweep or design. Run again.",) if stale else ()
    if columns["closes"][0] is None:
        return Answer(f"{plan.rows:,} designs", "open", (*old, "No requirement is set, so no design is judged."))
    good = int(np.sum(np.asarray(columns["closes"], bool)))
    best = int(sweep_best(columns)[0])
    margin = signed_percent(float(1 - sweep_ratios(columns)[best]))
    word = f"{good:,} of {plan.rows:,} designs meet all requirements"
    said = f"Widest margin {margin}: {', '.join(_swept_values(plan, best))}."
    return Answer(word, "warn" if stale else "good" if good else "bad", (*old, said))


def sweep_table(plan: Plan, columns: Mapping[str, Swept]) -> Table:
    """The best designs of a sweep; each can be taken into the design."""
    rows = sweep_best(columns)[:_SWEPT]
    judged = columns["closes"][0] is not None
    shown = f"{len(rows)} of {plan.rows:,} designs" if len(rows) < plan.rows else f"{plan.rows:,} designs"
    order = ", widest margin first" if judged else ""
    ratios = sweep_ratios(columns) if judged else np.full(plan.rows, np.nan)
    return Table(
        "sweep",
        f"{shown}{order}. Press one to take it into the design.",
        (
            Column("Design", sortable=True),
            *(Column(_swept_name(axis.key), numeric=True, sortable=True) for axis in plan.axes),
            *((Column("Margin", numeric=True, sortable=True),) if judged else ()),
        ),
        tuple(
            (
                Cell(f"{row + 1}", sort=int(row), value=str(row)),
                *(Cell(text, sort=sort) for text, sort in _swept_cells(plan, int(row))),
                *((_margin(float(1 - ratios[row])),) if judged else ()),
            )
            for row in rows
        ),
        choose="button",
    )


def _margin(margin: float) -> Cell:
    met = margin >= 0
    return Cell(f"{'✓' if met else '✗'} {signed_percent(margin)}", tone="good" if met else "bad", sort=margin)


def _swept_name(key: str) -> str:
    return str(declaration_of(key).label) if key not in PRESET_KEYS else "Catalogue"


def _swept_cells(plan: Plan, row: int) -> list[tuple[str, float | str]]:
    cells: list[tuple[str, float | str]] = []
    for axis, place in zip(plan.axes, plan.indices(row, row + 1), strict=True):
        value = axis.shown[int(place[0])]
        cells.append(
            (shown(plan.design, axis.key, value), value) if isinstance(value, float) else (str(value), str(value))
        )
    return cells


def _swept_values(plan: Plan, row: int) -> list[str]:
    names = (_swept_name(axis.key).lower() for axis in plan.axes)
    return [f"{name} {text}" for name, (text, _) in zip(names, _swept_cells(plan, row), strict=True)]
