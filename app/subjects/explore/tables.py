"""Solved values as an engineer reads them: the answer in one line, the table under it."""

from __future__ import annotations

from html import escape

from nav_model.budget import Budget
from nav_model.design import Design
from nav_model.explore.margins import ALL, label_of, quantity
from nav_model.explore.solve import Answer, Solution, remedies, resolution_for, round_down
from nav_model.units import from_si, join_quantity, plain_number

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


def shown(design: Design, key: str, value: float, down: bool = False) -> str:
    """A value in the unit its input is shown in, to three digits; `down` so that it still meets the limit."""
    dimension = quantity(key).dimension
    unit = design.unit(key) if dimension else ""
    number = from_si(value, unit, dimension) if dimension else value
    text = plain_number(round_down(number) if down else number, 3)
    return join_quantity(text, unit) if unit else f"{text} ×"


def answer(budget: Budget, solutions: tuple[Solution, ...]) -> str:
    """The line on top: the lever that matters most, how far it may go, and what it is now."""
    design, tightest = budget.design, budget.verdict.tightest
    if tightest is None:
        return (
            '<div class="strip open" role="status"><h2>Nothing to solve for</h2>'
            "<p>Give a limit under Requirements; every input is then solved backwards from it.</p></div>"
        )
    by_key = {solution.key: solution for solution in solutions}
    wanted = by_key.get(_LEVER.get(tightest.sensor, ""))
    order = [wanted, *solutions] if wanted else list(solutions)
    lever = next((solution for solution in order if solution.together.outcome == "limited"), None)
    if lever is None:
        head = "No single change closes it" if not budget.verdict.closes else "Every input may go to its bound"
        css = "closes" if budget.verdict.closes else "fails"
        return f'<div class="strip {css}" role="status"><h2>{head}</h2><p>{_stuck(budget, solutions)}</p></div>'
    value = lever.together.value or 0.0
    limit, now = shown(design, lever.key, value, down=True), shown(design, lever.key, lever.current)
    margin = abs(lever.together.margin or 0.0)
    room = value / lever.current if lever.current else float("inf")
    gap = f"{1 / room:.3g} times too much" if room < 1 else f"{room:.3g} times as much still closes"
    css = "closes" if budget.verdict.closes else "fails"
    other = "" if lever is wanted or wanted is None else f" No {NAMES[wanted.key]} alone would."
    return (
        f'<div class="strip {css}" role="status"><h2>Largest {NAMES[lever.key]} that closes: '
        f'<span class="num">{limit}</span></h2><p>You have <b class="num">{now}</b>: {gap}.{other}</p>'
        f"<p>Limited by <b>{escape(label_of(lever.together.binding).lower())}</b>. "
        f'Put back through the whole analysis it stands at the limit, to <span class="num">{margin:.0e}</span> of it.'
        "</p></div>"
    )


def unsolved(reason: str) -> str:
    """In place of the answer when solving failed its own check: a defect, said as one."""
    return (
        '<div class="strip bad" role="status"><h2>Not solved</h2>'
        f"<p>An answer put back did not meet its limit, so none is shown: {escape(reason)}.</p></div>"
    )


def _stuck(budget: Budget, solutions: tuple[Solution, ...]) -> str:
    if budget.verdict.closes:
        return "No requirement limits any of the inputs within what they may be."
    unmet = [check for check in budget.verdict.checks if not check.met]
    said = []
    for check in unmet:
        helps = ", ".join(_phrase(budget.design, found) for found in remedies(solutions, check.name))
        said.append(f"{escape(check.label)} alone would be met by {helps or 'no single input'}.")
    return " ".join(said) + " Change two inputs together: the map below shows which."


def _phrase(design: Design, found: Answer) -> str:
    text = f"{NAMES[found.key]} ≤ {shown(design, found.key, found.value or 0.0, down=True)}"
    if found.key == "radar.aperture_time":
        text += f" ({resolution_for(design, found.value or 1.0):.3g} m resolution)"
    return escape(text)


def solved_table(budget: Budget, solutions: tuple[Solution, ...]) -> str:
    """Every input solved for every requirement, with what would help where nothing does."""
    if not solutions:
        return ""
    design = budget.design
    names = [found.requirement for found in solutions[0].each]
    head = "".join(f'<th scope="col" class="num">{escape(label_of(name))}</th>' for name in names)
    rows = "".join(_row(design, solution) for solution in solutions)
    helpless = [solution for solution in solutions if solution.together.outcome == "no value"]
    left = [abs(found.together.margin) for found in solutions if found.together.margin is not None]
    checked = (
        " Put back through the whole analysis, each value under “All together” stands at its limit, to "
        f"{max(left):.0e} of it."
        if left
        else ""
    )
    return (
        '<div class="scroll" tabindex="0" role="region" aria-label="Solved values"><table class="checks">'
        '<thead><tr><th scope="col">Largest that still meets</th><th scope="col" class="num">You have</th>'
        f'<th scope="col" class="num">All together</th><th scope="col">Limited by</th>{head}</tr></thead>'
        f"<tbody>{rows}</tbody></table></div>{_helpless(design, helpless, solutions)}"
        '<p class="know quiet"><b>How do we know:</b> each value is a root of the closed forms, the others held, '
        "rounded down to three digits so that it still meets the limit; “any” means every value the input may "
        f"take meets it, “none” that no value does.{checked}</p>"
    )


def _row(design: Design, solution: Solution) -> str:
    together = solution.together
    limited = label_of(together.binding) if together.outcome != "any value" else ""
    note = "" if together.depends or together.outcome != "no value" else " (does not depend on it)"
    cells = "".join(f'<td class="num">{_cell(design, found)}</td>' for found in solution.each)
    name = NAMES[solution.key]
    met = together.outcome == "any value" or (together.value is not None and together.value >= solution.current)
    mark = "✓" if met else "✗"
    return (
        f"<tr><th scope='row'>{escape(name[0].upper() + name[1:])}</th>"
        f"<td class='num'>{shown(design, solution.key, solution.current)}</td>"
        f"<td class='num'><span class='mark'>{mark}</span> <b>{_cell(design, together)}</b></td>"
        f"<td>{escape(limited + note)}</td>{cells}</tr>"
    )


def _cell(design: Design, found: Answer) -> str:
    if found.value is None:
        return "any" if found.outcome == "any value" else "none"
    text = shown(design, found.key, found.value, down=True)
    if found.key == "radar.aperture_time":
        text += f" ({resolution_for(design, found.value):.3g} m)"
    return text


def _helpless(design: Design, helpless: list[Solution], solutions: tuple[Solution, ...]) -> str:
    """Inputs of which no value helps, and what would."""
    if not helpless:
        return ""
    names = " or ".join(NAMES[solution.key] for solution in helpless)
    would = "; ".join(_phrase(design, found) for found in remedies(solutions, ALL))
    tail = f"What would: {would}." if would else "No other single input closes it either."
    return f"<p><b>No value helps</b>, however small, of {escape(names)}. {tail}</p>"
