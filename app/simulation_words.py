"""What the Simulate page says about a study, as HTML."""

from __future__ import annotations

from html import escape

from app.figures import show
from app.prose import prose
from app.simulation_run import Progress, Result
from nav_model.simulation.design_study import DesignStudy, moments
from nav_model.simulation.result import STATES
from nav_model.simulation.single_run import POSTERIOR

_DIMENSIONS = {"position": "length", "velocity": "speed", "attitude": "angle"}


def answer(result: Result, stale: bool) -> str:
    """Everything above the charts."""
    study = result.study
    return verdict_strip(result, stale) + comparison_table(study) + departure_list(study) + condition_list(study)


def verdict_strip(result: Result, stale: bool) -> str:
    """Consistent or not, in words first."""
    found = result.study.result
    head, _, figures = found.verdict.partition(": ")
    css, mark = ("closes", "✓") if found.consistent else ("fails", "✗")
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


def comparison_table(study: DesignStudy) -> str:
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


def departure_list(study: DesignStudy) -> str:
    """Where the closed form and the filter part by more than a tenth, and why."""
    title = '<h3 style="margin-top: 8px">Where closed form and simulation part, and why</h3>'
    if not study.departures:
        return f"{title}<p>Nowhere by more than 10 %.</p>"
    reasons: dict[str, list[str]] = {}
    for found in study.departures:
        reasons.setdefault(found.reason, []).append(
            f'{found.group} {found.axis} <span class="num">×{found.ratio:.2f}</span> from '
            f'<span class="num">{found.start_s:g} to {found.stop_s:g} s</span>'
        )
    items = "".join(
        f"<li>{prose(reason[:1].upper() + reason[1:])}: {'; '.join(states)}.</li>"
        for reason, states in reasons.items()
    )
    return f'{title}<ul class="cautions" aria-label="Departures">{items}</ul>' + (
        '<p class="know quiet">Filter sigma over closed form where they differ most, if by more than 10 %.</p>'
    )


def condition_list(study: DesignStudy) -> str:
    """What of the simulated world differs from the closed forms'."""
    items = "".join(f"<li>{prose(sentence)}</li>" for sentence in study.conditions)
    return f'<ul class="cautions quiet" aria-label="Conditions of the simulation">{items}</ul>'


def under_way(progress: Progress) -> str:
    """The progress bar with time left."""
    if progress.left is None:
        return (
            '<p role="status"><progress aria-label="runs flown"></progress> Preparing; the first use on a machine '
            "compiles the simulator, half a minute.</p>"
        )
    return (
        f'<p role="status"><progress aria-label="runs flown" value="{progress.done}" max="{progress.runs}">'
        "</progress> "
        f'<span class="num">{progress.done} of {progress.runs} runs, {progress.left:.0f} s left</span></p>'
    )
