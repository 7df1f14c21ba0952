"""The strategies through the aperture as sections of a report: which to use and why, their price in the image."""

from __future__ import annotations

import argparse
import math

from app.console.progress import show_progress
from app.document.blocks import Answer, Block, Bullets, Section, Text
from app.document.chart_block import chart_block
from app.document.numbers import number
from app.document.wording import title_of
from app.subjects.sar import charts
from app.subjects.sar.run import SarResult, pictures
from app.subjects.sar.tables import agreement_table, error_table, parts_table, response_tables
from nav_model.design import Design
from nav_model.errors import InputError
from nav_model.sar.design_case import design_case, flight_cautions, study_cautions
from nav_model.sar.design_study import design_study
from nav_model.sar.geometry import metres_to_phase

REFERENCES = (
    "Strategies: Rauch, Tung and Striebel, Maximum likelihood estimates of linear dynamic systems, AIAA Journal "
    "3(8), 1965 (8). After Kim, Fellerhoff and Kohler, 2001 (6), and Song et al., 2015 and 2017 (7): "
    "reconstructions, the literature names the schemes and not their gains.",
)


_RUNS = 200


def study(design: Design, options: argparse.Namespace) -> SarResult:
    """The study that `navbudget report --with sar` asks for, progress on standard error.

    Raises
    ------
    InputError
        For an option or a key of the design that cannot be used.
    """
    runs = _RUNS if options.runs is None else options.runs
    if options.seed < 0:
        raise InputError("--seed", f"{options.seed} is not allowed; zero or a positive whole number")
    try:
        with show_progress() as show:
            found = design_study(
                design, runs, options.seed, lambda done, of: show(f"SAR: {done} of {of} runs", done / of)
            )
    except InputError as error:
        if error.key != "runs":
            raise
        raise error.under("--runs") from error
    points, scene = pictures(found.budget, found.typical)
    return SarResult(design_case(found.budget), found, points, scene)


def belongs(result: SarResult, design: Design) -> bool:
    """Whether the strategies were run for exactly this design."""
    return result.study.budget.design.content_hash == design.content_hash


def of_design(result: SarResult) -> str:
    """The design they were run for."""
    design = result.study.budget.design
    return f"{title_of(design)} ({design.content_hash[:12]})"


def sections(result: SarResult, key: str) -> tuple[Section, ...]:
    """The answer with its tables, the histories and responses, the pictures, the maps."""
    study = result.study
    budget, closed = study.budget, study.closed
    inertial, filtered = "INS and corrected INS", "filters and smoother"
    histories = (
        charts.navigation_chart(study, charts.INERTIAL, inertial, "sar-error-ins"),
        charts.navigation_chart(study, charts.FILTERED, filtered, "sar-error-filter"),
        charts.responses_chart(study, charts.INERTIAL, inertial, "sar-response-ins"),
        charts.responses_chart(study, charts.FILTERED, filtered, "sar-response-filter"),
    )
    phase = math.degrees(float(metres_to_phase(1e-3, budget.sar.wavelength)))
    flown = flight_cautions(budget) if study.engine == "simulator" else ()
    scale = Text(f"A millimetre of line of sight is {number(phase)}° of two-way phase [T-13].")
    return (
        Section(
            f"{key}-sar",
            "SAR: which way of navigating through the aperture",
            (
                *_answer(result),
                error_table(study, key),
                chart_block(charts.residual_chart(budget, closed, study), key),
                chart_block(charts.quadratic_chart(budget, closed, study), key),
                parts_table(study, key),
                *(() if result.beside is None else (agreement_table(study, result.beside, key),)),
            ),
            REFERENCES,
        ),
        Section(
            f"{key}-sar-responses",
            "SAR: error histories and impulse responses",
            (scale, *(chart_block(chart, key) for chart in histories), *response_tables(study, key)),
        ),
        Section(
            f"{key}-sar-images",
            "SAR: images",
            (
                chart_block(charts.point_picture(result.points), key),
                chart_block(charts.scene_picture(result.scene), key),
                *(() if result.uploaded is None else (chart_block(result.uploaded, key),)),
            ),
        ),
        Section(
            f"{key}-sar-maps",
            "SAR: which strategy wins where",
            (
                chart_block(charts.gnss_winner_chart(budget), key),
                chart_block(charts.arw_winner_chart(budget), key),
                Bullets((*study_cautions(budget), *flown)),
            ),
        ),
    )


def _answer(result: SarResult) -> tuple[Block, ...]:
    """Which strategy, why, what would change the answer, what the runs add."""
    study = result.study
    closed, advice = study.closed, study.closed.advice
    word, tone = f"Strategy {advice.strategy}", "open"
    if closed.required_phase is not None:
        phase = float(metres_to_phase(advice.sigma[advice.strategy], study.budget.sar.wavelength))
        met = phase <= closed.required_phase
        word, tone = (f"✓ {word} meets the limit", "good") if met else (f"✗ {word} misses the limit", "bad")
    return (
        Answer(word, tone, (advice.sentence,)),
        Text(f"Why: {advice.because}"),
        Text(f"What would change it: {advice.would_change}"),
        Text(f"{study.sentence} Seed {study.seed}, {study.fixes} fixes in the aperture."),
    )
