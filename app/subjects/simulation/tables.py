"""A Monte Carlo study as blocks: filter consistency, and where and why the formulas differ."""

import math
from collections.abc import Iterable, Sequence

from app.document.blocks import Answer, Block, Bullets, Row, TableBlock, Text, numbers, table
from app.document.numbers import NONE, number
from nav_model.design.parts import quantity
from nav_model.simulation.departures import SMALL, Departure, cause_in_words
from nav_model.simulation.design_study import SimulationStudy, beside_noise, moments
from nav_model.simulation.result import STATES
from nav_model.simulation.single_run import POSTERIOR

_FLIGHTS = {
    "wandering": "nearly straight: about 1 m of wander, 1° to 2° of roll, pitch and heading",
    "straight": "exactly straight and level",
    "turns": "turns, then a long straight leg",
    "climb": "a climb at half time",
    "file": "from a file",
}
_PHASES = {"settling": "settling", "aided": "with fixes", "coast": "outage"}
_UNITS = {"position": ("m", 1.0), "velocity": ("m/s", 1.0), "attitude": ("°", 180 / math.pi)}


def verdict(study: SimulationStudy) -> Answer:
    """Answer to whether the filter's covariance describes the errors of the runs."""
    result = study.result
    nees = result.nees
    word, tone = "Consistent", "open"
    meaning = "The filter covariance matches the simulated errors."
    if not nees.inside:
        high = nees.mean > nees.high
        word, tone = "Optimistic" if high else "Pessimistic", "warn"
        meaning = f"The errors of the runs are {'larger' if high else 'smaller'} than the filter's sigmas."
    runs = f"{result.spec.runs} run{'' if result.spec.runs == 1 else 's'}"
    sentences = [
        f"{meaning} Mean NEES {number(nees.mean)} with {nees.states} states, 95 % band {number(nees.low)} to "
        f"{number(nees.high)}, {runs}."
    ]
    if result.nis is not None:
        nis = result.nis
        sentences.append(
            f"NIS {number(nis.mean)}, expected {number(nis.states)} "
            f"(95 % band {number(nis.low)} to {number(nis.high)})."
        )
    return Answer(word, tone, tuple(sentences))


def conditions_list(study: SimulationStudy, _: str) -> Bullets:
    """Differences of the simulation from what the formulas assume."""
    return Bullets(study.conditions, "How the simulation differs from the formulas' assumptions")


def run_table(study: SimulationStudy, key: str) -> TableBlock:
    """The parameters of the runs."""
    spec = study.result.spec
    beyond = beside_noise(study.design)
    outages = "; ".join(f"{start:g} to {stop:g} s" for start, stop in spec.outages) or "none"
    hours = number(spec.runs * spec.duration / 3600, given=True)
    rows = (
        ("Flight", _FLIGHTS[spec.trajectory.kind]),
        ("Runs, seed", f"{spec.runs}, {spec.seed}; the same seed gives the same errors again"),
        ("Length of a run", f"{spec.duration:g} s at {spec.imu.rate:g} Hz, {hours} h simulated in all"),
        ("Fixes", f"every {spec.gnss.interval:g} s; outages: {outages}"),
        ("Filter", f"closed-loop error-state Kalman filter of {spec.filter.states} states"),
        ("IMU", f"strapdown, WGS 84; vibration factor {spec.imu.vibration_factor:g} on both random walks"),
        *((quantity(name).label, quantity(name).show(value)) for name, value in beyond.items()),
    )
    return table(
        f"{key}-simulation-run",
        "Simulation set-up",
        (("Part", 0.5), ("Flown", 1.9)),
        ((str(name), text) for name, text in rows),
    )


def sigma_table(study: SimulationStudy, key: str) -> TableBlock:
    """Simulated, filter, closed form and refined sigma of every state, at the last fix and at the outage's end."""
    result = study.result
    closed = result.closed_form_sigma
    assert closed is not None  # a study of a design has its closed forms
    rows: list[Row] = []
    for name, at in moments(study):
        rows.append((f"{name[:1].upper()}{name[1:]}, {result.time_s[at]:g} s",))
        for column, (group, axis, _) in enumerate(STATES):
            unit, scale = _UNITS[group]
            simulated = float(result.rms[POSTERIOR, at, column])
            believed, form = float(result.filter_sigma[POSTERIOR, at, column]), float(closed[at, column])
            refined = float(study.refined_sigma[at, column]) if group == "position" else math.nan
            texts = (
                NONE if math.isnan(sigma) else number(scale * sigma) for sigma in (simulated, believed, form, refined)
            )
            label = f"{group.capitalize()}, {axis} [{unit}]"
            rows.append((label, *texts, number(simulated / form)))
    low, high = result.rms_band
    return table(
        f"{key}-simulation-sigmas",
        "Sigmas just after the fix, 1σ: simulated, filter, formula",
        (
            ("State", 1.3),
            *numbers("Simulated rms", "Filter", "Formula", "With Schuler, Coriolis [T-17]", width=1),
            *numbers("Simulated / formula", width=1),
        ),
        rows,
        f"Formula: average between fixes [T-3], [T-4], in an outage [T-9], [T-10], heading [T-5]. The rms "
        f"of {result.spec.runs} runs lies between {number(low)} and {number(high)} of the true sigma "
        "with 95 % probability.",
    )


def departures(study: SimulationStudy, key: str) -> Block:
    """Where filter or simulated errors and the formulas differ by more than a tenth, and why."""
    if not study.departures:
        return Text("Filter, simulated errors and formulas agree within 10 % in every state at every time.")
    rows = tuple(
        (
            f"{alike[0].group.capitalize()}, {', '.join(d.axis for d in alike)}",
            _when(alike),
            _range(d.simulated for d in alike),
            _range(d.ratio for d in alike),
            _why(alike, study),
        )
        for alike in _alike(study)
    )
    ratios = numbers("Simulated / formula", "Filter / formula", width=0.75)
    return table(
        f"{key}-simulation-departures",
        "Where formula and simulation differ, and why",
        (("Error", 1), ("When", 0.8), *ratios, ("Why, and by what factor", 2.2)),
        rows,
        "Differences above 10 % just after the fix that are significant at 0.1 %. Each "
        "cause is found by changing one thing at a time. Factors multiply; those below 3 % or a quarter "
        "of the largest are omitted.",
    )


def _alike(study: SimulationStudy) -> list[list[Departure]]:
    """Departures of axes that differ in the same phase for the same causes, together."""
    groups: dict[tuple[object, ...], list[Departure]] = {}
    for departure in study.departures:
        causes = tuple(cause for cause, _ in departure.steps)
        groups.setdefault((departure.group, departure.phase, departure.stretch, causes), []).append(departure)
    return list(groups.values())


def _when(alike: Sequence[Departure]) -> str:
    start, stop = min(d.start_s for d in alike), max(d.stop_s for d in alike)
    return f"{start:g} to {stop:g} s, {_PHASES[alike[0].phase]}"


def _why(alike: Sequence[Departure], study: SimulationStudy) -> str:
    causes = [
        f"{cause_in_words(cause, study.result.spec)} (×{_range(d.steps[place][1] for d in alike)})"
        for place, (cause, _) in enumerate(alike[0].steps)
    ]
    text = "; ".join(causes) or SMALL
    return f"{text[:1].upper()}{text[1:]}"


def _range(values: Iterable[float]) -> str:
    seen = sorted(values)
    low, high = number(seen[0]), number(seen[-1])
    return low if low == high else f"{low} to {high}"
