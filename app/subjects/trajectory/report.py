"""The covariance along a flight as sections of a report."""

import argparse
from dataclasses import replace

from app.document.blocks import Block, Section, Text, chart_block
from app.document.wording import identified, printable
from app.subjects.trajectory.charts import map_chart, shares_chart, timelines
from app.subjects.trajectory.figures import main_figure
from app.subjects.trajectory.options import options_answer, options_table
from app.subjects.trajectory.run import closing_options
from app.subjects.trajectory.tables import line_table, verdict
from app.work.flight import Followed, follow
from nav_model.design import Design

_HOW = "Covariance [P-13], smoothed [P-14]; image errors of each line [P-15]."


def study(design: Design, options: argparse.Namespace) -> Followed:
    """The covariance along the flight of the design's plan, for `navbudget report --with trajectory`.

    Raises
    ------
    InputError
        For a key of the design that cannot be flown.
    """
    del options  # those of runs
    followed = follow(design, lengths=True)
    if all(line.closes for line in followed.result.lines):
        return followed
    return replace(followed, options=closing_options(design, progress=lambda share, what: None))


def another_design(study: Followed, design: Design) -> str:
    """The design it is of, where that is not exactly this one; else nothing."""
    return "" if study.design.input_hash == design.input_hash else identified(study.design)


def sections(study: Followed, key: str) -> tuple[Section, ...]:
    """The verdict and the lines, then the charts of what is limited most."""
    name = main_figure(study)
    lines = line_table(study, name)
    lines = replace(lines, key=f"{key}-{lines.key}")
    drawn = (map_chart(study), *timelines(study, name), shares_chart(study, name))
    return (
        Section(
            f"{key}-trajectory",
            "Flight: the lines and their limits",
            (verdict(study), Text(printable(study.flight)), lines, *_what_would_close(study, key), Text(_HOW)),
        ),
        Section(
            f"{key}-trajectory-charts",
            "Flight: errors along the plan",
            tuple(chart_block(chart, key) for chart in drawn),
        ),
    )


def _what_would_close(study: Followed, key: str) -> tuple[Block, ...]:
    """The options, where the flight needs any and they are known."""
    if study.options is None or study.options.closes:
        return ()
    return options_answer(study.options), options_table(study.options, study.design, f"{key}-options")
