"""The strategies as sections of a report: which to use and why, and the image quality of each."""

import argparse

from app.charts.kinds import Drawing
from app.document.blocks import Block, Section, Text, chart_block
from app.document.numbers import degrees
from app.document.wording import identified
from app.subjects.sar.charts import RUN_CHARTS, STRATEGY_CHARTS, point_pictures_of, winner_chart
from app.subjects.sar.command import studied
from app.subjects.sar.run import SarResult
from app.subjects.sar.tables import advised, cautions, error_table, reasons, run_tables
from nav_model.aperture.geometry import metres_to_phase
from nav_model.design import Design
from nav_model.equations.literature import WORKS
from nav_model.sar.design_case import design_case
from nav_model.sar.pictures import point_pictures

REFERENCES = (
    f"{WORKS['Rauch 1965']} Both smoothers.",
    "Tracking filter after Kim, Fellerhoff and Kohler, 2001, damping loop after Song et al., 2015 and 2017: "
    "reconstructions, as the literature gives no gains.",
)

_RUNS = 200


def study(design: Design, options: argparse.Namespace) -> SarResult:
    """The study that `navbudget report --with sar` asks for, progress on standard error.

    Raises
    ------
    InputError
        For an option or a key of the design that cannot be used.
    """
    result = studied(design, _RUNS if options.runs is None else options.runs, options.seed, "SAR: ")
    case, typical = design_case(result.budget), result.typical
    unfocused = None if case.focusing is None else point_pictures(result.budget, typical.line)
    return SarResult(case, result, point_pictures(result.budget, typical.residual), unfocused)


def another_design(result: SarResult, design: Design) -> str:
    """The design the strategies were run for, where that is not exactly this one; else nothing."""
    flown = result.study.budget.design
    return "" if flown.input_hash == design.input_hash else identified(flown)


def sections(result: SarResult, key: str) -> tuple[Section, ...]:
    """The answer with its tables, the histories and responses, the pictures, the maps."""
    study = result.study
    budget, closed = study.budget, study.closed
    parts, lobe, integrated, *engines = run_tables(study, result.beside, key)
    images = (*point_pictures_of(study, result.points, result.unfocused), result.uploaded)
    phase = degrees(float(metres_to_phase(1e-3, budget.sar.wavelength)))

    def drawn(*charts: Drawing) -> tuple[Block, ...]:
        return tuple(chart_block(chart, key) for chart in charts)

    return (
        Section(
            f"{key}-sar",
            "SAR: which strategy to use",
            (
                Text(advised(budget, closed, study)),
                *reasons(closed, study),
                error_table(budget, closed, study, key),
                *drawn(*(draw(budget, closed, study) for draw in STRATEGY_CHARTS)),
                parts,
                *engines,
            ),
            REFERENCES,
        ),
        Section(
            f"{key}-sar-responses",
            "SAR: error histories and impulse responses",
            (
                Text(f"One millimetre along the line of sight is {phase}° of two-way phase [T-13]."),
                *drawn(*(draw(study) for draw in RUN_CHARTS)),
                lobe,
                integrated,
            ),
        ),
        Section(f"{key}-sar-images", "SAR: images", drawn(*(chart for chart in images if chart is not None))),
        Section(
            f"{key}-sar-maps",
            "SAR: which strategy is best where",
            (*drawn(winner_chart(budget)), cautions(budget, study)),
        ),
    )
