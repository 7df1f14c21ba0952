"""`navbudget report`: the report of some designs, with the studies asked for run first."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Sequence
from typing import Any

from app.console.files import whole_file
from app.console.progress import count_runs
from app.document.blocks import Section
from app.document.wording import chapter_key, design_labels
from app.report import kind_of, report_bytes
from app.report.studies import KINDS, study_sections
from nav_model.budget import analyse
from nav_model.design import Design
from nav_model.errors import InputError

_SETTLED = 400.0  # s with fixes before the design's outage: most filters have settled
_SAR_RUNS, _SIMULATION_RUNS = 200, 100
_RESULTS = 600  # kept along a simulated run


def write_report_with(designs: Sequence[Design], options: argparse.Namespace) -> None:
    """Write the report the command line asks for; progress of its studies on standard error.

    Raises
    ------
    InputError
        For an option or a key of a design that cannot be used, or a file that cannot be written.
    """
    kind = kind_of(options.output)
    wanted = _wanted(options.studies)
    budgets = [analyse(design) for design in designs]
    with whole_file(options.output) as file:  # refused now, not after the studies
        studies = [
            _sections(design, wanted, label, options)
            for design, label in zip(designs, design_labels(len(designs)), strict=True)
        ]
        file.write(report_bytes(budgets, kind, studies=studies))


def _wanted(text: str) -> list[str]:
    wanted = [name.strip() for name in text.split(",") if name.strip()]
    for name in wanted:
        if name not in KINDS:
            raise InputError("--with", f"{name!r} is not a study; {', '.join(KINDS)}")
    return wanted


def _sections(design: Design, wanted: Sequence[str], label: str, options: argparse.Namespace) -> tuple[Section, ...]:
    findings = {kind: _STUDIES[kind](design, options) for kind in KINDS if kind in wanted}
    return study_sections(findings, design, chapter_key(label))


def _simulation(design: Design, options: argparse.Namespace) -> Any:
    from app.subjects.simulation.console import fly_design

    named = not options.trajectory.lower().endswith(".csv")
    duration, outages = options.duration, list(options.outages)
    if duration is None and named:
        duration = _SETTLED + design.coast.duration
        outages = outages or [f"{_SETTLED!r},{duration!r}"]
    flown = argparse.Namespace(
        runs=_SIMULATION_RUNS if options.runs is None else options.runs,
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


def _sar(design: Design, options: argparse.Namespace) -> Any:
    from app.subjects.sar.run import SarResult, pictures
    from nav_model.sar.design_case import design_case
    from nav_model.sar.design_study import design_study

    runs = _SAR_RUNS if options.runs is None else options.runs
    if options.seed < 0:
        raise InputError("--seed", f"{options.seed} is not allowed; zero or a positive whole number")
    try:
        with count_runs("SAR: ") as progress:
            study = design_study(design, runs, options.seed, progress)
    except InputError as error:
        if error.key != "runs":
            raise
        raise error.under("--runs") from error
    points, scene = pictures(study.budget, study.typical)
    return SarResult(design_case(study.budget), study, points, scene)


def _suborbital(design: Design, options: argparse.Namespace) -> Any:
    from app.subjects.suborbital.charts import Shown
    from app.subjects.suborbital.finding import Finding
    from nav_model.suborbital.settings import DEFAULTS, from_design, read_changes
    from nav_model.suborbital.survey import run_survey

    settings = read_changes(from_design(DEFAULTS, design), {"seed": str(options.seed)}, "command line")
    said: list[str] = []

    def progress(share: float, what: str) -> None:
        line = f"suborbital: {10 * int(10 * share)} % {what}"
        if line not in said:
            said.append(line)
            _say(line)

    try:
        survey = run_survey(settings, progress=progress)
    except InputError:
        raise
    except ValueError as error:
        raise InputError("suborbital", str(error)) from error
    return Finding(Shown(survey, survey.study, "all"), settings)


_STUDIES: dict[str, Callable[[Design, argparse.Namespace], Any]] = {
    "simulation": _simulation,
    "sar": _sar,
    "suborbital": _suborbital,
}


def _say(line: str) -> None:
    print(line, file=sys.stderr, flush=True)
