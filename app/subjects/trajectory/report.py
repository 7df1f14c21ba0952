"""The covariance along a flight as sections of a report."""

import argparse
from dataclasses import replace

from app.document.blocks import Section, Text, chart_block
from app.document.wording import identified, printable
from app.subjects.trajectory.charts import map_chart, shares_chart, timelines
from app.subjects.trajectory.figures import main_figure
from app.subjects.trajectory.run import Followed, follow
from app.subjects.trajectory.tables import line_table, verdict
from nav_model.design import Design

_STATES = 9
_HOW = "Covariance [P-13], smoothed [P-14]; image errors of each line [P-15]."


def study(design: Design, options: argparse.Namespace) -> Followed:
    """The covariance along the flight of the design's plan, for `navbudget report --with trajectory`.

    Raises
    ------
    InputError
        For a key of the design that cannot be flown.
    """
    del options  # those of runs
    return follow(design, _STATES, lengths=True)


def another_design(study: Followed, design: Design) -> str:
    """The design it is of, where that is not exactly this one; else nothing."""
    return "" if study.design.content_hash == design.content_hash else identified(study.design)


def sections(study: Followed, key: str) -> tuple[Section, ...]:
    """The verdict and the lines, then the charts of what is limited most."""
    name = main_figure(study.result)
    lines = line_table(study, name)
    lines = replace(lines, key=f"{key}-{lines.key}")
    drawn = (map_chart(study), *timelines(study, name), shares_chart(study, name))
    return (
        Section(
            f"{key}-trajectory",
            "Flight: the lines and their limits",
            (verdict(study, name), Text(printable(study.flight)), lines, Text(_HOW)),
        ),
        Section(
            f"{key}-trajectory-charts",
            "Flight: errors along the plan",
            tuple(chart_block(chart, key) for chart in drawn),
        ),
    )
