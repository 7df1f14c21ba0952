"""A Monte Carlo study as sections of a report."""

import argparse

from app.document.blocks import Section, chart_block
from app.document.wording import identified
from app.subjects.simulation.charts import CHARTS, outage_chart
from app.subjects.simulation.tables import conditions_list, departures, run_table, sigma_table, verdict
from nav_model.design import Design
from nav_model.equations.literature import WORKS
from nav_model.simulation.design_study import SimulationStudy

REFERENCES = (
    f"{WORKS['Savage 1998']} Mechanisation of the simulator.",
    f"{WORKS['Bar-Shalom 2001']} NEES, NIS and their chi-square bands.",
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
    from nav_model.simulation.design_study import NAMED_TRAJECTORIES

    duration, outages = options.duration, list(options.outages)
    if duration is None and options.trajectory in NAMED_TRAJECTORIES:
        duration = _SETTLED + design.coast.duration
        outages = outages or [f"{_SETTLED!r},{duration!r}"]
    flown = argparse.Namespace(
        runs=_RUNS if options.runs is None else options.runs,
        seed=options.seed,
        duration=duration,
        outages=outages,
        trajectory=options.trajectory,
        height=None,
        ground=None,
        columns=None,
        every=max(1.0, round((duration or 0.0) / _RESULTS)),
        workers=options.workers,
        scheduler=None,
    )
    return fly_design(design, flown)


def another_design(study: SimulationStudy, design: Design) -> str:
    """The design it was flown for, where that is not exactly this one; else nothing."""
    return "" if study.design.input_hash == design.input_hash else identified(study.design)


def sections(study: SimulationStudy, key: str) -> tuple[Section, ...]:
    """Sections of a report: the runs and their results, then the charts."""
    drawn = (draw for draw in CHARTS if study.result.spec.outages or draw is not outage_chart)
    tables = (tell(study, key) for tell in (run_table, sigma_table, departures, conditions_list))
    return (
        Section(f"{key}-simulation", "Simulation: do the formulas hold?", (verdict(study), *tables), REFERENCES),
        Section(
            f"{key}-simulation-charts",
            "Simulation: errors against time",
            tuple(chart_block(draw(study), key) for draw in drawn),
        ),
    )
