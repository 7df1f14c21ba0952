"""A Monte Carlo study as sections of a report: was the filter consistent, do the closed forms hold, where not."""

from __future__ import annotations

import argparse
import math

from app.document.blocks import Answer, Block, Bullets, Cell, Column, Section, Table, Text
from app.document.chart_block import chart_block
from app.document.numbers import number
from app.subjects.simulation import charts
from app.subjects.simulation.tables import DEPARTURES, alike, when
from nav_model.design import Design
from nav_model.simulation.design_study import SimulationStudy, moments
from nav_model.simulation.result import STATES
from nav_model.simulation.single_run import POSTERIOR
from nav_model.simulation.study_inputs import STUDY_KEYS, added

_FLIGHTS = {
    "wandering": "nearly straight: some metres of wander, a degree or two of roll, pitch and yaw",
    "straight": "exactly straight and level",
    "turns": "turns, then a long straight leg",
    "climb": "a climb half way",
    "file": "from a file",
}
_UNITS = {"position": ("m", 1.0), "velocity": ("m/s", 1.0), "attitude": ("°", 180 / math.pi)}
_CHARTS = (
    charts.horizontal_position_chart,
    charts.vertical_position_chart,
    charts.outage_chart,
    charts.horizontal_velocity_chart,
    charts.vertical_velocity_chart,
    charts.tilt_chart,
    charts.yaw_chart,
    charts.ensemble_chart,
    charts.nees_chart,
    charts.path_chart,
    charts.designed_attitude_chart,
)
REFERENCES = (
    "Simulation: Savage, Strapdown inertial navigation integration algorithm design, Journal of Guidance, Control, "
    "and Dynamics 21, 1998 (mechanisation). Bar-Shalom, Li and Kirubarajan, Estimation with Applications to Tracking "
    "and Navigation, Wiley, 2001 (NEES, NIS and their chi-square bands).",
)


_SETTLED = 400.0  # s with fixes before the design's outage: most filters have settled
_RUNS = 100
_RESULTS = 600  # kept along a run


def study(design: Design, options: argparse.Namespace) -> SimulationStudy:
    """The study that `navbudget report --with simulation` asks for, progress on standard error.

    Raises
    ------
    InputError
        For an option or a key of the design that cannot be flown.
    """
    from app.subjects.simulation.console import fly_design

    duration, outages = options.duration, list(options.outages)
    if duration is None and not options.trajectory.lower().endswith(".csv"):
        duration = _SETTLED + design.coast.duration
        outages = outages or [f"{_SETTLED!r},{duration!r}"]
    flown = argparse.Namespace(
        runs=_RUNS if options.runs is None else options.runs,
        seed=options.seed,
        duration=duration,
        outages=outages,
        trajectory=options.trajectory,
        every=max(1.0, round((duration or 0.0) / _RESULTS)),
        states=9,
        workers=options.workers,
        scheduler=None,
    )
    return fly_design(design, flown)


def belongs(study: SimulationStudy, design: Design) -> bool:
    """Whether the study was flown for exactly this design."""
    return study.design.content_hash == design.content_hash


def of_design(study: SimulationStudy) -> str:
    """The design it was flown for."""
    return f"{study.design.name or 'without a name'} ({study.design.content_hash[:12]})"


def sections(study: SimulationStudy, key: str) -> tuple[Section, ...]:
    """What was run and found, then the charts."""
    skipped = () if study.result.spec.outages else (charts.outage_chart,)
    drawn = tuple(chart_block(draw(study), key) for draw in _CHARTS if draw not in skipped)
    return (
        Section(
            f"{key}-simulation",
            "Simulation: do the closed forms hold?",
            (_verdict(study), _run_table(study, key), _sigma_table(study, key), *_departures(study, key),
             Text("How the simulated world differs from that of the closed forms:"), Bullets(study.conditions)),
            REFERENCES,
        ),
        Section(f"{key}-simulation-charts", "Simulation: errors against time", drawn),
    )  # fmt: skip


def _verdict(study: SimulationStudy) -> Answer:
    result = study.result
    nees = result.nees
    word, tone = ("✓ Consistent", "good")
    meaning = "The filter's covariance describes the errors of the runs."
    if not nees.inside:
        high = nees.mean > nees.high
        word, tone = ("✗ Optimistic", "bad") if high else ("✗ Pessimistic", "warn")
        meaning = f"The runs' errors are {'larger' if high else 'smaller'} than the filter believes."
    sentence = (
        f"{meaning} Mean NEES {nees.mean:.2f} with {nees.states} states, 95 % band {nees.low:.2f} to "
        f"{nees.high:.2f}, {result.spec.runs} runs."
    )
    if result.nis is not None:
        nis = result.nis
        sentence += (
            f" Mean NIS {nis.mean:.2f} of {nis.states} measured axes, 95 % band {nis.low:.2f} to {nis.high:.2f}: "
            f"{'inside' if nis.inside else 'outside'}."
        )
    return Answer(word, tone, (sentence,))


def _run_table(study: SimulationStudy, key: str) -> Table:
    spec = study.result.spec
    outages = "; ".join(f"{start:g} to {stop:g} s" for start, stop in spec.outages) or "none"
    hours = spec.runs * spec.duration / 3600
    more = tuple((STUDY_KEYS[key].label, STUDY_KEYS[key].show(value)) for key, value in added(spec).items())
    rows = (
        ("Flight", _FLIGHTS[spec.trajectory.kind]),
        ("Runs, seed", f"{spec.runs}, {spec.seed}; every run repeats from seed and number, however many workers"),
        ("Length of a run", f"{spec.duration:g} s at {spec.imu.rate:g} Hz, {hours:.3g} h simulated in all"),
        ("Fixes", f"every {spec.gnss.interval:g} s; outages: {outages}"),
        ("Filter", f"closed-loop error-state Kalman filter of {spec.filter.states} states"),
        ("Inertial unit", f"strapdown, WGS 84; vibration factor {spec.imu.vibration_factor:g} on both random walks"),
        *more,
    )
    return Table(
        f"{key}-simulation-run",
        "What was flown",
        (Column("Part", width=0.5), Column("Flown", width=1.9)),
        tuple((Cell(name), Cell(text)) for name, text in rows),
    )


def _sigma_table(study: SimulationStudy, key: str) -> Table:
    """Simulated, filter, closed form and refined sigma of every state, at the last fix and at the outage's end."""
    result = study.result
    closed = result.closed_form_sigma
    assert closed is not None  # a study of a design has its closed forms
    rows: list[tuple[Cell, ...]] = []
    for name, at in moments(study):
        rows.append((Cell(f"{name[:1].upper()}{name[1:]}, {result.time_s[at]:g} s"),))
        for column, (group, axis, _) in enumerate(STATES):
            unit, scale = _UNITS[group]
            simulated = float(result.rms[POSTERIOR, at, column])
            own, form = float(result.filter_sigma[POSTERIOR, at, column]), float(closed[at, column])
            refined = float(study.refined_sigma[at, column]) if group == "position" else math.nan
            shown = ("–" if math.isnan(sigma) else number(scale * sigma) for sigma in (simulated, own, form, refined))
            label = f"{group.capitalize()}, {axis} [{unit}]"
            rows.append((Cell(label), *map(Cell, shown), Cell(f"{simulated / form:.2f}")))
    low, high = result.rms_band
    return Table(
        f"{key}-simulation-sigmas",
        "Standard deviations just after the fix, 1σ: simulated, the filter's own, closed form",
        (
            Column("State", width=1.3),
            Column("Simulated rms", numeric=True, width=1),
            Column("Filter", numeric=True, width=1),
            Column("Closed form", numeric=True, width=1),
            Column("Refined [T-17]", numeric=True, width=1),
            Column("Simulated / closed", numeric=True, width=1),
        ),
        tuple(rows),
        f"Closed form: cycle rms [T-3], [T-4], in an outage [T-9], [T-10], yaw [T-5]. The rms of {result.spec.runs} "
        f"runs lies between {low:.2f} and {high:.2f} of the true sigma with 95 % probability.",
    )


def _departures(study: SimulationStudy, key: str) -> tuple[Block, ...]:
    if not study.departures:
        return (Text("Filter, simulated errors and closed form agree within 10 % in every state at every time."),)
    rows = tuple(
        (
            Cell(f"{found[0].group.capitalize()}, {', '.join(d.axis for d in found)}"),
            Cell(when(found)),
            Cell(_range([d.simulated for d in found])),
            Cell(_range([d.ratio for d in found])),
            Cell(f"{found[0].reason[:1].upper()}{found[0].reason[1:]}"),
        )
        for found in alike(study)
    )
    columns = (
        Column("Error", width=1), Column("When", width=0.8), Column("Simulated / closed", numeric=True, width=0.75),
        Column("Filter / closed", numeric=True, width=0.75), Column("Why, and how much of it", width=2.2),
    )  # fmt: skip
    title = "Where closed form and simulation part, and why"
    return (Table(f"{key}-simulation-departures", title, columns, rows, DEPARTURES),)


def _range(values: list[float]) -> str:
    low, high = f"{min(values):.2f}", f"{max(values):.2f}"
    return low if low == high else f"{low} to {high}"
