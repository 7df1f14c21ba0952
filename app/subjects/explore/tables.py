"""What the questions of the Explore page find, as blocks: the answer first, the table under it."""

from __future__ import annotations

import math
from collections import Counter

from app.document.blocks import Answer, Block, Cell, Column, Table, Text
from app.document.numbers import number, percent, signed_percent
from nav_model.budget import Budget
from nav_model.design import Design
from nav_model.explore.margins import ALL, label_of, quantity
from nav_model.explore.search import Candidate
from nav_model.explore.solve import Answer as Solved
from nav_model.explore.solve import Solution, remedies, resolution_for, round_down
from nav_model.explore.uncertainty import Probability, UncertainVerdict
from nav_model.units import from_si, join_quantity

NAMES = {
    "imu.angle_random_walk": "gyro noise (angle random walk)",
    "imu.velocity_random_walk": "accelerometer noise (velocity random walk)",
    "imu.vibration_factor": "factor on both random walks",
    "gnss.position_noise": "GNSS noise",
    "gnss.vertical_position_noise": "vertical GNSS noise",
    "gnss.interval": "fix interval",
    "coast.duration": "outage",
    "coast.before_aperture": "coast before the aperture",
    "radar.aperture_time": "aperture time",
}
_LEVER = {
    "gyro noise": "imu.angle_random_walk",
    "accelerometer noise": "imu.velocity_random_walk",
    "GNSS noise": "gnss.position_noise",
    "coast before aperture": "coast.before_aperture",
}
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
    text = number(round_down(scaled) if down else scaled)
    return join_quantity(text, unit) if unit else f"{text} ×"


def answer(budget: Budget, solutions: tuple[Solution, ...]) -> Answer:
    """The lever that matters most, how far it may go, and what it is now."""
    design, tightest = budget.design, budget.verdict.tightest
    if tightest is None:
        why = "Give a limit under Requirements. Explore then finds the largest value of each input that meets it."
        return Answer("Nothing to solve for", "open", (why,))
    tone = "good" if budget.verdict.closes else "bad"
    by_key = {solution.key: solution for solution in solutions}
    wanted = by_key.get(_LEVER.get(tightest.sensor, ""))
    order = [wanted, *solutions] if wanted else list(solutions)
    lever = next((solution for solution in order if solution.together.outcome == "limited"), None)
    if lever is None:
        head = "Every input may go to its bound" if budget.verdict.closes else "No single change closes it"
        return Answer(head, tone, _stuck(budget, solutions))
    value = lever.together.value or 0.0
    limit, now = shown(design, lever.key, value, down=True), shown(design, lever.key, lever.current)
    room = value / lever.current if lever.current else math.inf
    gap = f"{number(1 / room)} times too much" if room < 1 else f"{number(room)} times as much still closes"
    other = () if lever is wanted or wanted is None else (f"No {NAMES[wanted.key]} alone is enough.",)
    binding = label_of(lever.together.binding).lower()
    said = (f"You have {now}: {gap}.", *other, f"Limited by {binding}.")
    return Answer(f"Largest {NAMES[lever.key]} that closes: {limit}", tone, said)


def unsolved(reason: str) -> Answer:
    """In place of the answer when solving failed its own check: a defect, said as one."""
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
    return (*said, "Change two inputs together: the map below shows which.")


def _phrase(design: Design, found: Solved) -> str:
    return f"{NAMES[found.key]} ≤ {_value(design, found)}"


def _value(design: Design, found: Solved) -> str:
    if found.value is None:
        return "any" if found.outcome == "any value" else "none"
    text = shown(design, found.key, found.value, down=True)
    if found.key == "radar.aperture_time":
        text += f" ({number(resolution_for(design, found.value))} m resolution)"
    return text


def solved_blocks(budget: Budget, solutions: tuple[Solution, ...]) -> tuple[Block, ...]:
    """Every input solved for every requirement, with what would help where nothing does."""
    if not solutions:
        return ()
    design = budget.design
    names = [found.requirement for found in solutions[0].each]
    table = Table(
        "solved",
        "Largest allowed value of each input, the others held",
        (
            Column("Input"),
            Column("You have", numeric=True),
            Column("All requirements", numeric=True),
            Column("Limited by"),
            *(Column(label_of(name), numeric=True) for name in names),
        ),
        tuple(_solved_row(design, solution) for solution in solutions),
        _SOLVED,
    )
    helpless = [NAMES[solution.key] for solution in solutions if solution.together.outcome == "no value"]
    if not helpless:
        return (table,)
    enough = "; ".join(_phrase(design, found) for found in remedies(solutions, ALL))
    tail = f"These would be enough: {enough}." if enough else "No other single input is enough either."
    return table, Text(f"Improving any one of these alone is not enough: {', '.join(helpless)}. {tail}")


def _solved_row(design: Design, solution: Solution) -> tuple[Cell, ...]:
    together = solution.together
    limited = label_of(together.binding) if together.outcome != "any value" else ""
    note = "" if together.depends or together.outcome != "no value" else " (does not depend on it)"
    name = NAMES[solution.key]
    met = together.outcome == "any value" or (together.value is not None and together.value >= solution.current)
    return (
        Cell(name[0].upper() + name[1:]),
        Cell(shown(design, solution.key, solution.current)),
        Cell(f"{'✓' if met else '✗'} {_value(design, together)}", tone="good" if met else "bad"),
        Cell(limited + note),
        *(Cell(_value(design, found)) for found in solution.each),
    )


def pair_name(row: Candidate) -> str:
    """What a pair of unit and receiver is called."""
    return f"{row.imu} with {row.gnss}"


def search_table(rows: list[Candidate], of: int) -> Table:
    """Pairs of unit and receiver, as many of them as are `rows`, each to be chosen."""
    titles = ("IMU", "Receiver", "Verdict", "Margin", "Tightest", "Dominant source", "Not confirmed")
    return Table(
        "search",
        f"Pairs of inertial unit and receiver: {len(rows)} of {of}",
        tuple(Column(title, numeric=title == "Margin", sortable=True) for title in titles),
        tuple(_candidate(row) for row in rows),
        choose="radio",
    )


def _candidate(row: Candidate) -> tuple[Cell, ...]:
    counts = Counter(doubt.rpartition(" ")[2] for doubt in row.doubts)
    return (
        Cell(row.imu, sort=row.imu, value=pair_name(row)),
        Cell(row.gnss),
        Cell("✓ closes", tone="good") if row.closes else Cell("✗ does not close", tone="bad"),
        Cell(signed_percent(row.margin), sort=row.margin),
        Cell(label_of(row.tightest)),
        Cell(f"{row.dominant} {percent(row.share)}"),
        Cell(", ".join(f"{count} {status}" for status, count in counts.items())),
    )


def uncertain_blocks(found: UncertainVerdict) -> tuple[Block, ...]:
    """The verdict as a probability, and what each requirement adds to it."""
    low, middle, high = map(signed_percent, found.margin)
    return (
        Answer(
            f"Closes with a probability of {_probability(found.closes)}",
            "open",
            (f"Tightest margin: {low}, {middle}, {high} (5, 50 and 95 % of {found.designs} designs).",),
        ),
        Table(
            "uncertain",
            "Requirements under these ranges",
            (Column("Requirement"), Column("Met with", numeric=True), Column("Tightest in", numeric=True)),
            tuple(
                (Cell(label_of(name)), Cell(_probability(p)), Cell(percent(found.limiting[name])))
                for name, p in found.each.items()
            ),
        ),
    )


def _probability(p: Probability) -> str:
    return f"{number(100 * p.value)} % ± {number(50 * (p.high - p.low), 2)}"
