"""What the Simulate page says about a study, as HTML."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from app.document.numbers import show
from app.document.prose import prose
from app.subjects.simulation.run import Compiling, Progress, Result
from nav_model.simulation.departures import SMALL, Departure, cause_in_words
from nav_model.simulation.design_study import SimulationStudy, moments
from nav_model.simulation.result import STATES
from nav_model.simulation.single_run import POSTERIOR

_DIMENSIONS = {"position": "length", "velocity": "speed", "attitude": "angle"}
_SURELY_COMPILING = 4.0  # seconds: a worker that finds the compiled simulator on disk has started by then
_PHASES_IN_WORDS = {"settling": "settling", "aided": "with fixes", "coast": "outage"}

DEPARTURES = (
    "Where they differ most, if by more than 10 %, just after the fix. Causes are found by flying this design with "
    "one thing changed at a time; their factors multiply to the whole, but for those below 3 % or a quarter of the "
    "largest. Simulated errors count when chance would bring them once in a thousand."
)
"""How the table of departures is to be read."""


def answer(result: Result, stale: bool) -> str:
    """Everything above the charts."""
    study = result.study
    return verdict_strip(result, stale) + comparison_table(study) + departure_table(study) + condition_list(study)


def verdict_strip(result: Result, stale: bool) -> str:
    """Consistent or not, in words first."""
    found = result.study.result
    head, _, figures = found.verdict.partition(": ")
    css, mark = ("good", "✓") if found.consistent else ("bad", "✗")
    if result.partial:
        css, mark = "open", "…"
    so_far = "; runs so far, more are flying" if result.partial else ""
    old = '<p><span class="stale">stale</span> the instruments or the flight have changed since</p>' if stale else ""
    nis = "" if found.nis is None else (
        f'<p>NIS <span class="num">{found.nis.mean:.2f}</span>, 95 % band <span class="num">'
        f"{found.nis.low:.2f} to {found.nis.high:.2f}</span></p>"
    )  # fmt: skip
    return (
        f'<div class="strip {css}" role="status"><h2><span aria-hidden="true">{mark}</span> '
        f"{escape(head[:1].upper() + head[1:])}</h2>"
        f'<p class="num">{escape(figures)}{so_far}</p>{nis}'
        f"<p>{escape(result.design.name or 'design')}, seed {found.spec.seed}, {found.spec.runs} × "
        f"{found.spec.duration:g} s in {found.wall_s:.1f} s</p>{old}</div>"
    )


def comparison_table(study: SimulationStudy) -> str:
    """Simulated, filter and closed-form sigma of every state, at the last fix and at the end of the outage."""
    result = study.result
    closed = result.closed_form_sigma
    assert closed is not None
    places = moments(study)
    heads = "".join(
        f'<th scope="colgroup" colspan="4" class="num">{name}, {result.time_s[row]:g} s</th>' for name, row in places
    )
    kinds = "".join(
        f'<th scope="col" class="num">{kind}</th>'
        for _ in places
        for kind in ("simulated", "filter", "closed form", "simulated / closed")
    )
    rows = ""
    for column, (group, axis, _) in enumerate(STATES):
        cells = ""
        for _, row in places:
            simulated = float(result.rms[POSTERIOR, row, column])
            values = (simulated, float(result.filter_sigma[POSTERIOR, row, column]), float(closed[row, column]))
            cells += "".join(f'<td class="num">{show(value, _DIMENSIONS[group])}</td>' for value in values)
            cells += f'<td class="num">{simulated / values[2]:.2f}</td>'
        rows += f'<tr><th scope="row">{group.capitalize()}, {axis}</th>{cells}</tr>'
    low, high = result.rms_band
    return (
        '<div class="scroll" tabindex="0" role="region" aria-label="Simulated, filter and closed form">'
        f'<table class="checks"><thead><tr><td></td>{heads}</tr><tr><th scope="col">1σ</th>{kinds}</tr></thead>'
        f"<tbody>{rows}</tbody></table></div>"
        f'<p class="know quiet">Just after the fix. The rms of {result.spec.runs} runs lies between {low:.2f} and '
        f"{high:.2f} of the true sigma with 95 % probability.</p>"
    )


def departure_table(study: SimulationStudy) -> str:
    """Where filter or simulated errors and the closed form part by more than a tenth, and why."""
    title = '<h3 style="margin-top: 8px">Where closed form and simulation part, and why</h3>'
    if not study.departures:
        return f"{title}<p>Nowhere by more than 10 %.</p>"
    rows = ""
    for found in alike(study):
        first = found[0]
        rows += (
            f'<tr><th scope="row">{first.group.capitalize()}, {", ".join(d.axis for d in found)}</th>'
            f'<td class="num">{when(found)}</td>'
            f'<td class="num">{_range([d.simulated for d in found])}</td>'
            f'<td class="num">{_range([d.ratio for d in found])}</td><td class="why">{_why(found, study)}</td></tr>'
        )
    return (
        f'{title}<div class="scroll" tabindex="0" role="region" aria-label="Departures">'
        '<table class="checks"><thead><tr><th scope="col">Error</th><th scope="col" class="num">When</th>'
        '<th scope="col" class="num">simulated / closed</th><th scope="col" class="num">filter / closed</th>'
        f'<th scope="col">Why, and how much of it</th></tr></thead><tbody>{rows}</tbody></table></div>'
        f'<p class="know quiet">{escape(DEPARTURES)}</p>'
    )


def when(found: Sequence[Departure]) -> str:
    """From when to when, and in which part of the flight."""
    start, stop = min(d.start_s for d in found), max(d.stop_s for d in found)
    return f"{start:g} to {stop:g} s, {_PHASES_IN_WORDS[found[0].phase]}"


def alike(study: SimulationStudy) -> list[list[Departure]]:
    """Departures of axes that part in the same phase for the same causes, together."""
    groups: dict[tuple[object, ...], list[Departure]] = {}
    for found in study.departures:
        causes = tuple(cause for cause, _ in found.steps)
        groups.setdefault((found.group, found.phase, causes), []).append(found)
    return list(groups.values())


def _why(found: Sequence[Departure], study: SimulationStudy) -> str:
    said = [
        f"{prose(cause_in_words(cause, study.result.spec))} "
        f'<span class="num">({_range([d.steps[place][1] for d in found])})</span>'
        for place, (cause, _) in enumerate(found[0].steps)
    ]
    return "; ".join(said) or SMALL


def _range(values: list[float]) -> str:
    low, high = f"{min(values):.2f}", f"{max(values):.2f}"
    return f"×{low}" if low == high else f"×{low} to {high}"


def condition_list(study: SimulationStudy) -> str:
    """What of the simulated world differs from the closed forms'."""
    items = "".join(f"<li>{prose(sentence)}</li>" for sentence in study.conditions)
    return f'<ul class="cautions quiet" aria-label="Conditions of the simulation">{items}</ul>'


def under_way(news: Compiling | Progress) -> str:
    """The progress bar with time left."""
    if isinstance(news, Progress) and news.left is not None:
        return (
            f'<p role="status"><progress aria-label="runs flown" value="{news.done}" max="{news.runs}"></progress> '
            f'<span class="num">{news.done} of {news.runs} runs, {news.left:.0f} s left</span></p>'
        )
    said = "Preparing: the flight, and the filter along it."
    if isinstance(news, Compiling) and news.seconds >= _SURELY_COMPILING:
        said = (
            "Compiling the simulator, once for this installation: half a minute or so; "
            f'<span class="num">{news.seconds:.0f} s</span> until now.'
        )
    return f'<p role="status"><progress aria-label="making ready"></progress> {said}</p>'
