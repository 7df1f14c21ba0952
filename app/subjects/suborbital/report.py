"""The suborbital study as sections of a report: what a star tracker repairs of an INS, and what it does not."""

import argparse
from collections.abc import Callable
from dataclasses import replace
from functools import partial

from app.charts.kinds import Chart
from app.document.blocks import Block, Row, Section, TableBlock, Text, chart_block, table
from app.subjects.suborbital import tables
from app.subjects.suborbital.answer import answer
from app.subjects.suborbital.charts import attitude, errors, flight
from app.subjects.suborbital.charts.content import Content
from app.subjects.suborbital.console import study_progress
from nav_model.design import Design
from nav_model.equations.literature import WORKS
from nav_model.suborbital.input_table import GROUPS
from nav_model.suborbital.settings import DEFAULTS, OF_DESIGN, Settings, follows_design, from_design, read_changes
from nav_model.suborbital.summary import explain
from nav_model.suborbital.survey import run_survey

_ERRORS = tuple(partial(draw, channel=c) for c in (2, 1, 0) for draw in (errors.source_chart, errors.aided_chart))
_FLIGHT = (flight.map_chart, flight.height_chart, flight.force_chart, flight.rate_chart, flight.gravity_chart)
REFERENCES = (f"{WORKS['van Leeuwen 2007']} The camera's stars.",)


def study(design: Design, options: argparse.Namespace) -> Content:
    """The study that `navbudget report --with suborbital` asks for, progress on standard error.

    Raises
    ------
    InputError
        For a key of the design or a seed that the study cannot take.
    """
    settings = read_changes(from_design(DEFAULTS, design), {"seed": str(options.seed)}, "command line")
    with study_progress("suborbital: ") as progress:
        survey = run_survey(settings, progress=progress)
    return Content(survey, survey.study, settings, "all")


def another_design(page: Content, design: Design) -> str:
    """The design whose inertial unit it took, where that is not this design's as it is now; else nothing."""
    settings = page.settings
    if not follows_design(settings) or dict(from_design(settings, design).values) == dict(settings.values):
        return ""
    return next((origin for origin in settings.origin.values() if origin.startswith(OF_DESIGN)), "none")


def sections(page: Content, key: str) -> tuple[Section, ...]:
    """The answer, the tables, the charts, every input with its origin."""
    prefix = f"{key}-suborbital"

    def section(part: str, title: str, *blocks: Block) -> Section:
        return Section(f"{prefix}-{part}", f"Suborbital flight: {title}", blocks)

    def table(build: Callable[[Content], TableBlock]) -> TableBlock:
        return _named(build(page), prefix)

    def drawn(*describe: Callable[[Content], Chart]) -> tuple[Block, ...]:
        return tuple(chart_block(draw(page), prefix) for draw in describe)

    return (
        Section(
            prefix,
            "Suborbital flight: what a star tracker repairs, and what it does not",
            (answer(page)[0], Text(explain(page.study)), Text(_sensors(page.settings)),
             *_paper_tables(page, prefix)),
            REFERENCES,
        ),
        section("errors", "errors by source, with and without star tracker",
                *drawn(*_ERRORS, errors.growth_chart), table(tables.source_table), table(tables.gap_table)),
        section("attitude", "attitude and stars",
                *drawn(attitude.inertial_attitude_chart, attitude.navigation_attitude_chart),
                table(tables.method_table),
                *drawn(attitude.star_chart)),
        section("flight", "trajectory and gravity", *drawn(*_FLIGHT), table(tables.gravity_table)),
        section("inputs", "inputs of the study", _inputs(page.settings, prefix)),
    )  # fmt: skip


def _sensors(settings: Settings) -> str:
    """Whose sensors these are."""
    if follows_design(settings):
        return (
            "Sensors: this design's IMU gives white noise and constant biases; instability, scale factor, "
            "misalignment and initial errors are those listed under the inputs of the study."
        )
    return "The study has its own inputs, listed at its end; they are not this design's IMU."


def _paper_tables(page: Content, prefix: str) -> tuple[TableBlock, ...]:
    """The four tables; the note they share is under the last."""
    *first, last = (_named(table, prefix) for table in tables.paper_tables(page))
    return (*(replace(table, note="") for table in first), last)


def _named(table: TableBlock, prefix: str) -> TableBlock:
    return replace(table, key=f"{prefix}-{table.key}")


def _inputs(settings: Settings, prefix: str) -> TableBlock:
    rows: list[Row] = []
    for title, group in GROUPS.items():
        rows.append((title,))
        rows += [
            (str(declared.label), settings.show(declared.key) or "none", settings.origin[declared.key])
            for declared in group
        ]
    return table(
        f"{prefix}-inputs-table",
        "Every input of the suborbital study, with its origin",
        (("Input", 1.3), ("Value", 1.2), ("Origin", 1.2)),
        rows,
    )
